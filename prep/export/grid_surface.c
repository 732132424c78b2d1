#include "prep/export/grid_surface.h"

#include <assert.h>
#include <math.h>
#include <string.h>

#include "formats/base/vec3.h"
#include "formats/leaf/leaf_unpacker.h"
#include "prep/export/marching_cell.h"

enum { OUTSIDE = 0, INSIDE = 1, NO_DATA = 2 };

#define NO_VERTEX UINT32_MAX

typedef struct unit {
    uint32_t treelet, isovalue;
} unit;

/* A thread's buffers for its treelet. */
typedef struct bench {
    const struct grid_surface *s;
    piece *p;
    char *payload;
    leaf_unpacker *unpacker;
    float *value;     /* samples, with the halo */
    uint8_t *side;    /* of the treelet's own nodes: inside, no data */
    uint32_t *vertex; /* [3][nodes]: vertex on the edge from a node along an axis */
    double *at[3];    /* coordinates per axis, of the halo too if those nodes exist */
    /* The current treelet: */
    double isovalue;
    uint32_t isovalue_index;
    leaf_payload shape;
    uint32_t node[3];           /* its first own node, in the level */
    uint32_t first[3], last[3]; /* range of its own nodes that are in the part */
    uint32_t low[3], high[3];   /* range of samples that are nodes of the level, both included */
    bool before[3], behind[3];  /* whether there are treelets before and behind it */
} bench;

typedef struct grid_surface {
    mem *m;
    leaf_file *f;
    const grid_part *part;
    const double *isovalues;
    unit *units;
    size_t count, room;
    double normal_map[3][3]; /* from gradients in grid space to world directions towards smaller
                                values */
    bool mirrored;
    int threads;
    bench *benches;
    marching_table table;
} grid_surface;

static uint32_t nodes_of(const leaf_file *f) {
    const uint32_t side = (1u << f->layout.cells_log2) + 1;
    return side * side * side;
}

static uint32_t samples_of(const leaf_file *f) {
    const uint32_t side = (1u << f->layout.cells_log2) + 1 + 2 * f->layout.halo;
    return side * side * side;
}

static uint64_t payload_of(const leaf_file *f) {
    return leaf_layout_aligned(leaf_layout_payload_max(&f->layout), LEAF_ALIGN_LOG2);
}

static uint32_t planes_of(const leaf_file *f) {
    return (1u << f->layout.cells_log2) + 1 + 2 * f->layout.halo;
}

uint64_t grid_surface_worker(const leaf_file *f) {
    return payload_of(f) + leaf_unpacker_memory(f) + samples_of(f) * sizeof(float) +
           nodes_of(f) * (sizeof(uint8_t) + 3 * sizeof(uint32_t)) + 4096;
}

/* ---- treelets with a surface ---- */

static bool reaches(const grid_surface *s, uint32_t t) {
    const leaf_layout *l = &s->f->layout;
    const leaf_payload shape = leaf_layout_payload(l, t);
    for (int a = 0; a < 3; a++) {
        const uint32_t first = l->place[t][a] << l->cells_log2, last = first + shape.cells[a];
        if (last <= s->part->lo[a] || first + 1 >= s->part->end[a])
            return false;
    }
    return true;
}

static status find_units(grid_surface *s, uint32_t isovalues) {
    const leaf_level *l = &s->f->layout.level[s->part->level];
    for (uint32_t i = 0; i < isovalues; i++)
        for (uint32_t t = l->first; t < l->first + l->count; t++) {
            const float *own = s->f->own[leaf_layout_samples(&s->f->layout, s->part->set, t)];
            const double lo = (double)own[0], hi = (double)own[1];
            if (!(lo < s->isovalues[i] && s->isovalues[i] <= hi) || !reaches(s, t))
                continue;
            status st = mem_grow(s->m, &s->units, sizeof *s->units, s->count, 64, &s->room);
            if (st != ST_OK)
                return st;
            s->units[s->count++] = (unit){t, i};
        }
    return ST_OK;
}

/* Set the normals' map: minus the inverse transpose of the grid's map, up to a positive factor. */
static void map_normals(grid_surface *s) {
    double column[3][3], length[3];
    for (int a = 0; a < 3; a++) {
        for (int row = 0; row < 3; row++)
            column[a][row] = s->f->header.to_world[4 * row + a];
        length[a] = fmax(fmax(fabs(column[a][0]), fabs(column[a][1])), fabs(column[a][2]));
        for (int row = 0; row < 3; row++)
            column[a][row] /= length[a];
    }
    s->mirrored = vec3_det(column[0], column[1], column[2]) < 0;
    for (int a = 0; a < 3; a++) {
        double across[3];
        vec3_cross(column[(a + 1) % 3], column[(a + 2) % 3], across);
        for (int row = 0; row < 3; row++)
            s->normal_map[row][a] = (s->mirrored ? across[row] : -across[row]) / length[a];
    }
}

static status make_bench(grid_surface *s, bench *b) {
    const leaf_file *f = s->f;
    b->s = s;
    b->payload = mem_alloc(s->m, payload_of(f));
    b->value = mem_alloc(s->m, samples_of(f) * sizeof *b->value);
    b->side = mem_alloc(s->m, nodes_of(f));
    b->vertex = mem_alloc(s->m, 3 * (size_t)nodes_of(f) * sizeof *b->vertex);
    b->at[0] = mem_alloc(s->m, 3 * (size_t)planes_of(f) * sizeof *b->at[0]);
    if (!b->payload || !b->value || !b->side || !b->vertex || !b->at[0])
        return ST_NOMEM;
    for (int a = 1; a < 3; a++)
        b->at[a] = b->at[0] + a * (size_t)planes_of(f);
    return leaf_unpacker_create(s->m, s->f, &b->unpacker);
}

/* ---- a treelet ---- */

/* i: x, y, z of a sample; they count from the halo on. */
static size_t sample_at(const bench *b, const uint32_t i[3]) {
    return ((size_t)i[2] * b->shape.samples[1] + i[1]) * b->shape.samples[0] + i[0];
}

static size_t own_at(const bench *b, uint32_t x, uint32_t y, uint32_t z) {
    return ((size_t)z * (b->shape.cells[1] + 1) + y) * (b->shape.cells[0] + 1) + x;
}

static void set_planes(bench *b, uint32_t t) {
    const leaf_layout *l = &b->s->f->layout;
    const leaf_level *level = &l->level[b->s->part->level];
    const uint32_t h = l->halo;
    for (int a = 0; a < 3; a++) {
        const uint32_t tile = l->place[t][a], cells = b->shape.cells[a];
        const uint32_t lo = b->s->part->lo[a], end = b->s->part->end[a];
        b->node[a] = tile << l->cells_log2;
        b->before[a] = tile > 0;
        b->behind[a] = tile + 1 < level->treelets[a];
        b->low[a] = b->before[a] ? 0 : h;
        b->high[a] = b->behind[a] ? cells + 2 * h : cells + h;
        b->first[a] = lo > b->node[a] ? lo - b->node[a] : 0;
        b->last[a] = end - b->node[a] <= cells ? end - b->node[a] - 1 : cells;
        for (uint32_t i = b->low[a]; i <= b->high[a]; i++)
            b->at[a][i] = grid_part_at(b->s->f, b->s->part->level, a, b->node[a] + i - h);
    }
}

static void take_values(bench *b) {
    const leaf_layout *l = &b->s->f->layout;
    const size_t count = (size_t)b->shape.samples[0] * b->shape.samples[1] * b->shape.samples[2];
    const char *samples = b->payload + b->shape.samples_at;
    for (size_t i = 0; i < count; i++)
        b->value[i] = sample_get(l->type, samples, i);
    const uint32_t *cells = b->shape.cells;
    for (uint32_t z = 0; z <= cells[2]; z++)
        for (uint32_t y = 0; y <= cells[1]; y++)
            for (uint32_t x = 0; x <= cells[0]; x++) {
                const uint32_t i[3] = {x + l->halo, y + l->halo, z + l->halo};
                const double value = (double)b->value[sample_at(b, i)];
                b->side[own_at(b, x, y, z)] = !isfinite(value)       ? NO_DATA
                                              : value >= b->isovalue ? INSIDE
                                                                     : OUTSIDE;
            }
}

/* ---- vertices ---- */

static void to_world(const bench *b, const double from[3], double world[3]) {
    const double *map = b->s->f->header.to_world;
    for (int row = 0; row < 3; row++)
        world[row] = vec3_dot(map + 4 * row, from) + map[4 * row + 3];
}

static void orient(const bench *b, const double gradient[3], double normal[3]) {
    for (int row = 0; row < 3; row++)
        normal[row] = vec3_dot(b->s->normal_map[row], gradient);
    if (!vec3_unit(normal, normal) || !isfinite(normal[0] + normal[1] + normal[2]))
        memset(normal, 0, 3 * sizeof *normal);
}

/* Slope along an axis from a sample to the next. Returns false if there is no next one. */
static bool slope(const bench *b, const uint32_t i[3], int axis, double *out) {
    if (i[axis] + 1 > b->high[axis])
        return false;
    uint32_t next[3] = {i[0], i[1], i[2]};
    next[axis]++;
    const double rise = (double)b->value[sample_at(b, next)] - (double)b->value[sample_at(b, i)];
    *out = rise / (b->at[axis][next[axis]] - b->at[axis][i[axis]]);
    return isfinite(*out);
}

/* Derivative of the interpolant across the edge from sample i along `axis`, at t on the edge. It is
 * the mean of both sides. */
static double across(const bench *b, const uint32_t i[3], int axis, double t, int other) {
    uint32_t from[3] = {i[0], i[1], i[2]}, to[3] = {i[0], i[1], i[2]};
    double sum = 0, first, second;
    int sides = 0;
    to[axis]++;
    for (int back = 0; back < 2; back++) {
        if (back && from[other] == b->low[other])
            continue;
        from[other] -= (uint32_t)back;
        to[other] -= (uint32_t)back;
        if (slope(b, from, other, &first) && slope(b, to, other, &second)) {
            sum += first + t * (second - first);
            sides++;
        }
    }
    return sides ? sum / sides : 0;
}

/* Returns whether neighbouring treelets have this edge, too. */
static bool is_shared(const bench *b, const uint32_t own[3], int axis) {
    bool shared = false;
    for (int a = 0; a < 3; a++)
        if (a != axis)
            shared |=
                (own[a] == 0 && b->before[a]) || (own[a] == b->shape.cells[a] && b->behind[a]);
    return shared;
}

static hash_id key_of(const bench *b, const uint32_t own[3], int axis) {
    const uint32_t name[5] = {b->isovalue_index, (uint32_t)axis, b->node[0] + own[0],
                              b->node[1] + own[1], b->node[2] + own[2]};
    return hash_identity(name, sizeof name);
}

static status make_vertex(bench *b, const uint32_t own[3], int axis, uint32_t *index) {
    const uint32_t h = b->s->f->layout.halo;
    const uint32_t i[3] = {own[0] + h, own[1] + h, own[2] + h};
    uint32_t next[3] = {i[0], i[1], i[2]};
    next[axis]++;
    const double from = (double)b->value[sample_at(b, i)],
                 to = (double)b->value[sample_at(b, next)];
    const double t = (b->isovalue - from) / (to - from);
    double node[3], gradient[3];
    for (int a = 0; a < 3; a++) {
        node[a] = b->at[a][i[a]];
        gradient[a] =
            a == axis ? (to - from) / (b->at[a][next[a]] - node[a]) : across(b, i, axis, t, a);
    }
    const double ends[2] = {node[axis], b->at[axis][next[axis]]};
    node[axis] = t == 1 ? ends[1] : ends[0] + t * (ends[1] - ends[0]);
    piece_vertex v;
    to_world(b, node, v.at);
    orient(b, gradient, v.normal);
    status st = piece_add_vertex(b->p, &v, index);
    if (st == ST_OK && is_shared(b, own, axis))
        st = piece_add_share(b->p, *index, key_of(b, own, axis));
    return st;
}

static status find_vertex(bench *b, const uint32_t cell[3], int edge, uint32_t *index) {
    const int axis = edge / 4, corner = b->s->table.edge[edge][0];
    const uint32_t own[3] = {cell[0] + (corner & 1), cell[1] + (corner >> 1 & 1),
                             cell[2] + (corner >> 2 & 1)};
    uint32_t *found =
        &b->vertex[axis * (size_t)nodes_of(b->s->f) + own_at(b, own[0], own[1], own[2])];
    if (*found == NO_VERTEX) {
        status st = make_vertex(b, own, axis, found);
        if (st != ST_OK)
            return st;
    }
    *index = *found;
    return ST_OK;
}

/* ---- centres ---- */

static status make_centre(bench *b, const uint32_t cell[3], const double f[HEX_CORNERS],
                          const marching_case *m, int n, uint32_t *index) {
    const uint32_t h = b->s->f->layout.halo;
    double u[3], gradient[3], node[3];
    marching_cell_centre(&b->s->table, m, n, f, u);
    (void)marching_cell_value(f, u, gradient);
    for (int a = 0; a < 3; a++) {
        const double *at = b->at[a] + cell[a] + h, width = at[1] - at[0];
        node[a] = at[0] + u[a] * width;
        gradient[a] /= width;
    }
    piece_vertex v;
    to_world(b, node, v.at);
    orient(b, gradient, v.normal);
    return piece_add_vertex(b->p, &v, index);
}

/* ---- cells ---- */

/* Values minus the isovalue. */
static void corners_of(const bench *b, const uint32_t cell[3], double f[HEX_CORNERS]) {
    const uint32_t h = b->s->f->layout.halo;
    for (int corner = 0; corner < HEX_CORNERS; corner++) {
        const uint32_t i[3] = {cell[0] + (corner & 1) + h, cell[1] + (corner >> 1 & 1) + h,
                               cell[2] + (corner >> 2 & 1) + h};
        f[corner] = (double)b->value[sample_at(b, i)] - b->isovalue;
    }
}

static status fill_cell(bench *b, const uint32_t cell[3], int mask) {
    double f[HEX_CORNERS];
    corners_of(b, cell, f);
    const marching_case *m = marching_cell_case(&b->s->table, mask, f);
    uint32_t index[MARCHING_EDGES + MARCHING_CENTRES];
    bool known[MARCHING_EDGES + MARCHING_CENTRES] = {false};
    status st = ST_OK;
    for (int i = 0; i < m->triangles; i++) {
        uint32_t corner[3];
        for (int k = 0; k < 3 && st == ST_OK; k++) {
            const int at = m->corner[i][k];
            if (!known[at])
                st = at < MARCHING_EDGES
                         ? find_vertex(b, cell, at, &index[at])
                         : make_centre(b, cell, f, m, at - MARCHING_EDGES, &index[at]);
            known[at] = true;
            corner[b->s->mirrored ? 2 - k : k] = index[at];
        }
        if (st == ST_OK)
            st = piece_add_triangle(b->p, corner);
        if (st != ST_OK)
            return st;
    }
    return ST_OK;
}

/* One bit per corner that is inside; 0 also if a corner has no data. */
static int mask_of(const bench *b, uint32_t x, uint32_t y, uint32_t z) {
    int mask = 0, all = 0;
    for (int row = 0; row < 4; row++) {
        const uint8_t *side = b->side + own_at(b, x, y + (row & 1), z + (row >> 1));
        mask |= ((side[0] & 1) | (side[1] & 1) << 1) << 2 * row;
        all |= side[0] | side[1];
    }
    return all & NO_DATA ? 0 : mask;
}

static status make(void *ctx, uint32_t index, int worker, piece *p) {
    grid_surface *s = ctx;
    bench *b = &s->benches[worker];
    const unit *u = &s->units[index];
    b->p = p;
    b->isovalue_index = u->isovalue;
    b->isovalue = s->isovalues[u->isovalue];
    piece_begin(p, false, b->isovalue);
    const uint32_t element = leaf_layout_samples(&s->f->layout, s->part->set, u->treelet);
    status st = leaf_file_load(s->f, element, b->unpacker, b->payload);
    if (st != ST_OK)
        return st;
    b->shape = leaf_layout_payload(&s->f->layout, u->treelet);
    set_planes(b, u->treelet);
    take_values(b);
    memset(b->vertex, 0xff, 3 * (size_t)nodes_of(s->f) * sizeof *b->vertex);
    for (uint32_t z = b->first[2]; z < b->last[2]; z++)
        for (uint32_t y = b->first[1]; y < b->last[1]; y++)
            for (uint32_t x = b->first[0]; x < b->last[0]; x++) {
                const int mask = mask_of(b, x, y, z);
                if (mask == 0 || mask == 255)
                    continue;
                st = fill_cell(b, (uint32_t[3]){x, y, z}, mask);
                if (st != ST_OK)
                    return st;
            }
    return ST_OK;
}

/* ---- all of it ---- */

static void destroy(void *ctx) {
    grid_surface *s = ctx;
    for (int i = 0; s->benches && i < s->threads; i++) {
        bench *b = &s->benches[i];
        mem_free(s->m, b->payload);
        leaf_unpacker_destroy(b->unpacker);
        mem_free(s->m, b->value);
        mem_free(s->m, b->side);
        mem_free(s->m, b->vertex);
        mem_free(s->m, b->at[0]);
    }
    mem_free(s->m, s->benches);
    mem_free(s->m, s->units);
    mem_free(s->m, s);
}

status grid_surface_create(mem *m, leaf_file *f, const grid_part *part, const double *isovalues,
                           uint32_t count, int threads, piece_source *out) {
    grid_surface *s = mem_zalloc(m, sizeof *s);
    if (!s)
        return ST_NOMEM;
    s->m = m;
    s->f = f;
    s->part = part;
    s->isovalues = isovalues;
    s->threads = threads;
    marching_table_init(&s->table);
    map_normals(s);
    status st = find_units(s, count);
    if (st == ST_OK && !(s->benches = mem_array(m, (size_t)threads, sizeof *s->benches)))
        st = ST_NOMEM;
    for (int i = 0; st == ST_OK && i < threads; i++)
        st = make_bench(s, &s->benches[i]);
    if (st != ST_OK) {
        destroy(s);
        return st;
    }
    assert(s->count <= UINT32_MAX);
    *out = (piece_source){.ctx = s, .pieces = (uint32_t)s->count, .make = make, .destroy = destroy};
    return ST_OK;
}
