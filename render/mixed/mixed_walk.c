#include "render/mixed/mixed_walk.h"

#include "render/walk/tree_points.h"

curved_cell mixed_walk_cell(const mixed_blocks *b, uint32_t index) {
    const uint16_t *row = b->rows + (size_t)b->shape.width * index;
    curved_cell out = {.quadratic = mixed_blocks_is_quadratic(b, index),
                       .sense = hex_code_sense(mixed_code(&b->shape, b->places, index)),
                       .number = b->first + index};
    for (int n = 0; n < curved_cell_nodes(&out); n++) {
        const double p[3] = {(double)b->p[0][row[n]], (double)b->p[1][row[n]],
                             (double)b->p[2][row[n]]};
        curved_cell_put(&out, n, p, (double)b->values[row[n]]);
    }
    return out;
}

/* Whether all corners of a cell are on one side of the ray, along one of two axes: then none of its
 * faces is crossed (patch_beside()). */
static bool is_beside(const hexahedron *h, const sheared_ray *r) {
    int above = 0, left = 0, right = 0;
    for (int c = 0; c < HEX_CORNERS; c++) {
        double q[3];
        sheared_ray_place(r, h->p[c], q);
        above += q[1] >= 0.0;
        right += q[0] > 0.0;
        left += q[0] < 0.0;
    }
    return above == 0 || above == HEX_CORNERS || right == HEX_CORNERS || left == HEX_CORNERS;
}

/* hex_way.next: active cells that are not beside the ray, block by block. */
static bool next_cell(hex_way *way, double limit, curved_cell *out) {
    mixed_way *w = (mixed_way *)way;
    for (;;) {
        while (!w->ahead) {
            w->at = tree_passages_next(&w->passages, w->at, limit);
            if (w->at.t == LEAF_NO_TREELET)
                return false;
            w->ahead = w->blocks->active[w->at.t];
        }
        const uint32_t bit = (uint32_t)__builtin_ctz(w->ahead);
        w->ahead &= w->ahead - 1;
        *out = mixed_walk_cell(w->blocks, MIXED_BLOCK * w->at.t + bit);
        if (!out->quadratic && is_beside(&out->hexahedron, &way->sheared))
            continue; /* of a quadratic tet its path tells */
        way->counters->cells++;
        return true;
    }
}

void mixed_way_begin(mixed_way *w, const mixed_blocks *b, const ray *r, const hit *after,
                     ray_counters *counters) {
    w->way = (hex_way){r, sheared_ray_of(r->o, r->d), counters, next_cell};
    w->blocks = b;
    w->at = (tree_passage){.t_in = -INFINITY};
    w->ahead = 0;
    tree_passages_begin(&w->passages, &b->tree, r, after, counters);
}

bool mixed_walk_point(const mixed_blocks *b, const double point[3], leafcast_sample *out) {
    uint32_t block = LEAF_NO_TREELET;
    while ((block = tree_box_at(&b->tree, point, block)) != LEAF_NO_TREELET) {
        const uint32_t cells = mixed_blocks_cells(b, block);
        for (uint32_t i = 0; i < cells; i++) {
            const curved_cell c = mixed_walk_cell(b, MIXED_BLOCK * block + i);
            if (hex_walk_sample(&c, point, out))
                return true;
        }
    }
    return false;
}
