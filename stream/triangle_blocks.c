#include "stream/triangle_blocks.h"

#include <math.h>
#include <string.h>

static uint32_t block_count(const triangle_shape *s) {
    return (s->triangles + TRIANGLE_BLOCK - 1) / TRIANGLE_BLOCK;
}

size_t triangle_blocks_bytes(const triangle_shape *s) {
    const uint32_t blocks = block_count(s);
    return blocks * sizeof(uint8_t) + treelet_tree_bytes(blocks);
}

static uint32_t triangles_in(const triangle_blocks *b, uint32_t block) {
    const uint32_t left = b->shape.triangles - TRIANGLE_BLOCK * block;
    return left < TRIANGLE_BLOCK ? left : TRIANGLE_BLOCK;
}

status triangle_blocks_init(triangle_blocks *b, mem *m, const triangle_shape *s,
                            const uint16_t (*rows)[3], const void *places) {
    *b = (triangle_blocks){.shape = *s, .rows = rows, .blocks = block_count(s), .m = m};
    for (int a = 0; a < 3; a++)
        b->p[a] = triangle_coordinates(s, places, a);
    b->normals = triangle_place_normals(s, places);
    b->active = mem_zalloc(m, b->blocks * sizeof *b->active);
    if (!b->active)
        return ST_NOMEM;
    const status st = treelet_tree_init(&b->tree, m, NULL, b->blocks);
    if (st != ST_OK)
        triangle_blocks_release(b);
    return st;
}

void triangle_blocks_release(triangle_blocks *b) {
    treelet_tree_release(&b->tree);
    mem_free(b->m, b->active);
    b->active = NULL;
}

void triangle_blocks_move(triangle_blocks *b) {
    treelet_bounds *boxes = b->tree.bounds[0];
    for (uint32_t n = 0; n < b->blocks; n++) {
        const uint16_t *node = b->rows[TRIANGLE_BLOCK * n];
        const uint32_t nodes = TRIANGLE_CORNERS * triangles_in(b, n);
        for (int a = 0; a < 3; a++) {
            const float *x = b->p[a];
            float lo = x[node[0]], hi = lo;
            for (uint32_t i = 1; i < nodes; i++) {
                lo = x[node[i]] < lo ? x[node[i]] : lo;
                hi = x[node[i]] > hi ? x[node[i]] : hi;
            }
            boxes[n][a] = lo;
            boxes[n][a + 3] = hi;
        }
    }
    treelet_tree_move(&b->tree, (const treelet_bounds *)boxes);
}

void triangle_blocks_fill(triangle_blocks *b, const float *values) {
    b->values = values;
    memset(b->active, 0, b->blocks * sizeof *b->active);
    memset(b->tree.active[0], 0, b->blocks);
    treelet_tree_select(&b->tree, b->tree.active[0]);
}

static bool is_active(const triangle_blocks *b, uint32_t triangle, const interest *in) {
    const uint16_t *v = b->rows[triangle];
    const float x = b->values[v[0]], y = b->values[v[1]], z = b->values[v[2]];
    return isfinite((double)x + (double)y + (double)z) &&
           interest_meets(in, fminf(fminf(x, y), z), fmaxf(fmaxf(x, y), z));
}

void triangle_blocks_select(triangle_blocks *b, const interest *in) {
    for (uint32_t n = 0; n < b->blocks; n++) {
        const uint32_t triangles = triangles_in(b, n);
        unsigned active = 0;
        for (uint32_t i = 0; i < triangles; i++)
            active |= (unsigned)is_active(b, TRIANGLE_BLOCK * n + i, in) << i;
        b->active[n] = (uint8_t)active;
        b->tree.active[0][n] = active != 0;
    }
    treelet_tree_select(&b->tree, b->tree.active[0]);
}
