#include "formats/leaf/deviation_verify.h"

#include <math.h>

#include "formats/leaf/deviation.h"

enum {
    CELLS_MAX = 1 << LEAF_CELLS_LOG2_MAX,
    SIDE_MAX = CELLS_MAX / DEVIATION_BRICK,
    BRICKS_MAX = SIDE_MAX * SIDE_MAX * SIDE_MAX,
    FINE_ROWS = 2 * DEVIATION_BRICK
};

/* A treelet's samples, starting at its first own node. */
typedef struct nodes {
    const char *first;
    size_t row, slice; /* in samples */
} nodes;

/* A parent and one of its children. */
typedef struct family {
    const leaf_file *f;
    uint32_t set, level, child; /* level: the child's */
    nodes fine, coarse;         /* coarse: starts where the child begins */
    leaf_payload shape;         /* of the child */
    uint32_t from[3];           /* the parent's cell where the child begins */
    double weight[3][CELLS_MAX / 2];
    deviation_band *band;
    void *scratch;
    double most[BRICKS_MAX]; /* of the parent's bricks, so far */
} family;

static nodes nodes_of(const leaf_layout *l, uint32_t t, const void *payload,
                      const uint32_t from[3]) {
    const leaf_payload p = leaf_layout_payload(l, t);
    nodes n = {.row = p.samples[0], .slice = (size_t)p.samples[0] * p.samples[1]};
    const size_t at =
        l->halo * (1 + n.row + n.slice) + from[0] + from[1] * n.row + from[2] * n.slice;
    n.first = (const char *)payload + p.samples_at + at * sample_size(l->type);
    return n;
}

static const char *node(const family *x, const nodes *n, uint32_t row, uint32_t slice) {
    return n->first + (row * n->row + slice * n->slice) * sample_size(x->f->layout.type);
}

/* Add a layer of fine bricks, at z of the child, to the parent's bricks. It has been compared. */
static void fold(family *x, uint32_t row, uint32_t z) {
    const leaf_layout *l = &x->f->layout;
    const uint16_t *own = x->f->deviations + deviation_at(l, x->set, x->child);
    for (uint32_t y = row; y < row + FINE_ROWS && y < x->shape.cells[1]; y += DEVIATION_BRICK)
        for (uint32_t c = 0; c < x->shape.cells[0]; c += DEVIATION_BRICK) {
            double most =
                deviation_of_brick(x->band, c / DEVIATION_BRICK, (y - row) / DEVIATION_BRICK);
            if (x->level > 0)
                most += deviation_value(own[deviation_brick(l, c, y, z)]);
            double *to = &x->most[deviation_brick(l, x->from[0] + c / 2, x->from[1] + y / 2,
                                                  x->from[2] + z / 2)];
            *to = fmax(*to, most);
        }
}

/* Compare the rows of the child that a band covers, from `row` on. */
static void compare_band(family *x, uint32_t row) {
    const leaf_layout *l = &x->f->layout;
    const bool straight = !x->f->header.rectilinear;
    const uint32_t left = x->shape.cells[1] + 1 - row, *cells = x->shape.cells;
    deviation_slice s = {.type = l->type,
                         .nodes = cells[0] + 1,
                         .rows = left < FINE_ROWS + 1 ? left : FINE_ROWS + 1,
                         .fine_row = x->fine.row,
                         .coarse_row = x->coarse.row};
    if (!straight) {
        s.weight[0] = x->weight[0];
        s.weight[1] = x->weight[1] + row / 2;
    }
    deviation_band_begin(x->band, s.nodes);
    for (uint32_t z = 0; z <= cells[2]; z++) {
        s.fine = node(x, &x->fine, row, z);
        s.coarse[0] = node(x, &x->coarse, row / 2, z / 2);
        s.coarse[1] = node(x, &x->coarse, row / 2, (z + 1) / 2);
        s.weight_z = z % 2 == 0 ? 0.0 : straight ? 0.5 : x->weight[2][z / 2];
        deviation_compare(&s, x->scratch, x->band);
        if (z == 0 || (z % DEVIATION_BRICK && z < cells[2]))
            continue;
        fold(x, row, (z - 1) / DEVIATION_BRICK * DEVIATION_BRICK);
        deviation_band_begin(x->band, s.nodes);
        deviation_compare(&s, x->scratch, x->band);
    }
}

static void compare_child(family *x, const void *parent, uint32_t t, const void *payload) {
    const leaf_layout *l = &x->f->layout;
    static const uint32_t origin[3] = {0, 0, 0};
    const uint32_t half = 1u << (l->cells_log2 - 1);
    x->shape = leaf_layout_payload(l, x->child);
    for (int a = 0; a < 3; a++) {
        const uint32_t place = l->place[x->child][a], first = place * half;
        x->from[a] = (place & 1) * half;
        for (uint32_t i = 0; i < (x->shape.cells[a] + 1) / 2; i++)
            x->weight[a][i] =
                deviation_weight(x->f->axis[a], l->level[0].cells[a], x->level, first + i);
    }
    x->fine = nodes_of(l, x->child, payload, origin);
    x->coarse = nodes_of(l, t, parent, x->from);
    for (uint32_t row = 0; row < x->shape.cells[1]; row += FINE_ROWS)
        compare_band(x, row);
}

static status check_bricks(const family *x, uint32_t t) {
    const leaf_layout *l = &x->f->layout;
    const uint16_t *codes = x->f->deviations + deviation_at(l, x->set, t);
    for (uint32_t i = 0; i < deviation_bricks(l); i++)
        if (!(deviation_value(codes[i]) >= x->most[i]))
            return status_describe(
                ST_CORRUPT, "%s: treelet %u: brick %u deviates by %g, where its deviation is %g",
                file_path(x->f->source), t, i, x->most[i], deviation_value(codes[i]));
    return ST_OK;
}

/* The parts of a thread's room, which lie one behind the other. */
static size_t payload_room(const leaf_layout *l) {
    return leaf_layout_aligned(leaf_layout_payload_max(l), LEAF_ALIGN_LOG2);
}

static size_t band_room(void) {
    return leaf_layout_aligned(deviation_band_bytes(CELLS_MAX + 1), LEAF_ALIGN_LOG2);
}

static size_t family_room(void) {
    return leaf_layout_aligned(sizeof(family), LEAF_ALIGN_LOG2);
}

size_t deviation_verify_bytes(const leaf_layout *l) {
    return payload_room(l) + band_room() + family_room() + deviation_scratch_bytes(CELLS_MAX + 1);
}

status deviation_verify(leaf_file *f, uint32_t set, uint32_t t, const void *payload,
                        leaf_unpacker *u, void *room) {
    const leaf_layout *l = &f->layout;
    char *child = room, *band = child + payload_room(l);
    family *x = (family *)(void *)(band + band_room());
    *x = (family){.f = f,
                  .set = set,
                  .level = l->level_of[t] - 1u,
                  .band = (deviation_band *)(void *)band,
                  .scratch = (char *)x + family_room()};
    uint32_t children = (uint32_t)__builtin_popcount(leaf_layout_children(l, t));
    for (x->child = l->first_child[t]; children > 0; children--, x->child++) {
        const status st = leaf_file_load(f, leaf_layout_samples(l, set, x->child), u, child);
        if (st != ST_OK)
            return st;
        compare_child(x, payload, t, child);
    }
    return check_bricks(x, t);
}
