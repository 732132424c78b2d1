#include "stream/mixed_blocks.h"

#include <math.h>
#include <string.h>

static uint32_t block_count(const mixed_shape *s) {
    return (s->cells + MIXED_BLOCK - 1) / MIXED_BLOCK;
}

static size_t own_bytes(uint32_t blocks) {
    return blocks * (sizeof(float[2]) + sizeof(uint16_t));
}

size_t mixed_blocks_bytes(const mixed_shape *s) {
    const uint32_t blocks = block_count(s);
    return own_bytes(blocks) + treelet_tree_bytes(blocks);
}

/* What the cells of a block have of a value of the nodes; of those numbers that are finite. */
static void limits_of(const mixed_blocks *b, uint32_t block, const float *of_nodes, float *least,
                      float *greatest) {
    const uint32_t width = b->shape.width, cells = mixed_blocks_cells(b, block);
    const uint16_t *row = b->rows + (size_t)width * MIXED_BLOCK * block;
    *least = INFINITY;
    *greatest = -INFINITY;
    for (uint32_t i = 0; i < width * cells; i++) {
        const float x = of_nodes[row[i]];
        *least = isfinite(x) && x < *least ? x : *least;
        *greatest = isfinite(x) && x > *greatest ? x : *greatest;
    }
    if (b->shape.quadratic) {
        mixed_shape part = b->shape;
        part.cells = cells;
        mixed_widen(&part, row, of_nodes, least, greatest);
    }
}

status mixed_blocks_init(mixed_blocks *b, mem *m, const mixed_shape *s, const void *topology,
                         const void *places) {
    *b = (mixed_blocks){.shape = *s,
                        .places = places,
                        .rows = mixed_rows(s, topology),
                        .blocks = block_count(s),
                        .m = m};
    for (int a = 0; a < 3; a++)
        b->p[a] = mixed_coordinates(s, places, a);
    b->ranges = mem_zalloc(m, own_bytes(b->blocks));
    if (!b->ranges)
        return ST_NOMEM;
    b->active = (uint16_t *)(b->ranges + b->blocks);
    const status st = treelet_tree_init(&b->tree, m, NULL, b->blocks);
    if (st != ST_OK)
        mixed_blocks_release(b);
    return st;
}

void mixed_blocks_move(mixed_blocks *b) {
    treelet_bounds *boxes = b->tree.bounds[0];
    for (uint32_t n = 0; n < b->blocks; n++)
        for (int a = 0; a < 3; a++)
            limits_of(b, n, b->p[a], &boxes[n][a], &boxes[n][a + 3]);
    treelet_tree_move(&b->tree, (const treelet_bounds *)boxes);
}

void mixed_blocks_release(mixed_blocks *b) {
    treelet_tree_release(&b->tree);
    mem_free(b->m, b->ranges);
    b->ranges = NULL;
}

/* ---- values ---- */

void mixed_blocks_fill(mixed_blocks *b, const float *values) {
    b->values = values;
    memset(b->active, 0, b->blocks * sizeof *b->active);
    memset(b->tree.active[0], 0, b->blocks);
    treelet_tree_select(&b->tree, b->tree.active[0]);
    for (uint32_t n = 0; n < b->blocks; n++)
        limits_of(b, n, values, &b->ranges[n][0], &b->ranges[n][1]);
}

static bool is_active(const mixed_blocks *b, uint32_t cell, const interest *in) {
    const uint32_t width = b->shape.width;
    const uint16_t *row = b->rows + (size_t)width * cell;
    float lo = INFINITY, hi = -INFINITY, odd = 0.0f;
    for (uint32_t c = 0; c < width; c++) {
        const float x = b->values[row[c]];
        lo = fminf(lo, x);
        hi = fmaxf(hi, x);
        odd += x - x; /* NaN unless x is finite */
    }
    if (b->shape.quadratic && odd == 0.0f) {
        mixed_shape one = b->shape;
        one.cells = 1;
        mixed_widen(&one, row, b->values, &lo, &hi);
    }
    return odd == 0.0f && interest_meets(in, lo, hi);
}

void mixed_blocks_select(mixed_blocks *b, const interest *in) {
    for (uint32_t n = 0; n < b->blocks; n++) {
        const float *range = b->ranges[n];
        const uint32_t cells = mixed_blocks_cells(b, n);
        b->active[n] = 0;
        if (range[0] <= range[1] && interest_meets(in, range[0], range[1]))
            for (uint32_t i = 0; i < cells; i++)
                b->active[n] |= (uint16_t)(is_active(b, MIXED_BLOCK * n + i, in) << i);
        b->tree.active[0][n] = b->active[n] != 0;
    }
    treelet_tree_select(&b->tree, b->tree.active[0]);
}
