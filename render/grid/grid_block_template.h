/* grid_block_template.h - the samples of a block of 4^3 cells as scores, and the greatest of each
 * cell's eight; included by the units of an ISA (see formats/base/simd.h).
 */
#ifndef RENDER_GRID_GRID_BLOCK_TEMPLATE_H
#define RENDER_GRID_GRID_BLOCK_TEMPLATE_H

#include "formats/base/simd.h"

#ifdef SIMD_NAME

#include <string.h>

#include "render/grid/walk.h"

enum {
    BLOCK_ROWS = (BLOCK_SIDE + 1) * (BLOCK_SIDE + 1),
    BLOCK_SLICE = (BLOCK_SIDE + 1) * BLOCK_SIDE, /* numbers in a slice of rows */
    BLOCK_NUMBERS = (BLOCK_ROWS * BLOCK_SIDE + 15) / 16 * 16
};
_Static_assert(BLOCK_SIDE == 4, "a slice of cells is sixteen");

/* Rows of nodes along x lie one after the other, in the order (BLOCK_SIDE + 1) z + y. `lower` has
 * each row without its last node, `upper` without its first one. */
typedef struct block_scores {
    _Alignas(64) float lower[BLOCK_NUMBERS + 32], upper[BLOCK_NUMBERS + 32];
    float most[BLOCK_NUMBERS +
               32]; /* greatest score of the cell whose first node is at the same place */
} block_scores;

/* Returns the place of a cell of the block: its first node's in `lower`. */
static inline unsigned block_place(unsigned x, unsigned y, unsigned z) {
    return BLOCK_SLICE * z + BLOCK_SIDE * y + x;
}

/* Rows as they lie in a treelet: the samples at which they begin, and the number of samples. */
typedef struct block_rows {
    const void *samples;
    size_t first[BLOCK_ROWS], end;
} block_rows;

#define BLOCK_OF(NAME, TYPE)                                                     \
    static void NAME(const block_rows *rows, float sign, block_scores *b) {      \
        TYPE lower[BLOCK_SIDE * BLOCK_ROWS], upper[BLOCK_SIDE * BLOCK_ROWS];     \
        for (unsigned r = 0; r < BLOCK_ROWS; r++) {                              \
            const TYPE *from = (const TYPE *)rows->samples + rows->first[r];     \
            const size_t left = rows->end - rows->first[r];                      \
            TYPE short_row[BLOCK_SIDE + 1] = {0};                                \
            if (left <= BLOCK_SIDE)                                              \
                from = memcpy(short_row, from, left * sizeof *from);             \
            memcpy(lower + BLOCK_SIDE * r, from, BLOCK_SIDE * sizeof *from);     \
            memcpy(upper + BLOCK_SIDE * r, from + 1, BLOCK_SIDE * sizeof *from); \
        }                                                                        \
        for (unsigned i = 0; i < BLOCK_SIDE * BLOCK_ROWS; i++) {                 \
            b->lower[i] = (float)lower[i] * sign;                                \
            b->upper[i] = (float)upper[i] * sign;                                \
        }                                                                        \
    }

BLOCK_OF(block_of_u8, uint8_t)
BLOCK_OF(block_of_i8, int8_t)
BLOCK_OF(block_of_u16, uint16_t)
BLOCK_OF(block_of_i16, int16_t)
BLOCK_OF(block_of_f32, float)

/* Rows beyond the treelet repeat its last row: cells that do not exist then have numbers, too. */
static block_rows block_rows_of(const walk_scene *scene, const resident_grid *at,
                                const uint32_t cell[3]) {
    const size_t row = at->shape.samples[0], slice = row * at->shape.samples[1];
    const size_t x = cell[0] - at->first_cell[0] + scene->halo;
    block_rows rows = {.samples = at->samples, .end = slice * at->shape.samples[2]};
    for (unsigned r = 0; r < BLOCK_ROWS; r++) {
        size_t y = cell[1] - at->first_cell[1] + scene->halo + r % (BLOCK_SIDE + 1);
        size_t z = cell[2] - at->first_cell[2] + scene->halo + r / (BLOCK_SIDE + 1);
        y = y < at->shape.samples[1] ? y : at->shape.samples[1] - 1;
        z = z < at->shape.samples[2] ? z : at->shape.samples[2] - 1;
        rows.first[r] = x + row * y + slice * z;
    }
    return rows;
}

static void block_load(const walk_scene *scene, const resident_grid *at, const uint32_t cell[3],
                       float sign, block_scores *b) {
    const block_rows rows = block_rows_of(scene, at, cell);
    switch (scene->type) {
    case SAMPLE_U8: block_of_u8(&rows, sign, b); break;
    case SAMPLE_I8: block_of_i8(&rows, sign, b); break;
    case SAMPLE_U16: block_of_u16(&rows, sign, b); break;
    case SAMPLE_I16: block_of_i16(&rows, sign, b); break;
    default: block_of_f32(&rows, sign, b);
    }
}

/* Find the greatest score of each cell: of pairs along x, then y, then z. */
SIMD void block_maxima(block_scores *b) {
    float pairs[BLOCK_NUMBERS + 32];
    for (unsigned i = 0; i < BLOCK_NUMBERS; i += VF_N)
        f_store(pairs + i, f_max(f_load(b->lower + i), f_load(b->upper + i)));
    for (unsigned i = 0; i < BLOCK_NUMBERS; i += VF_N)
        f_store(pairs + i, f_max(f_load(pairs + i), f_load(pairs + i + BLOCK_SIDE)));
    for (unsigned i = 0; i < BLOCK_SIDE * BLOCK_SLICE; i += VF_N)
        f_store(b->most + i, f_max(f_load(pairs + i), f_load(pairs + i + BLOCK_SLICE)));
}

/* block_cell() - reads the eight scores of the cell at a place. */
static inline void block_cell(const block_scores *b, unsigned place, float scores[8]) {
    for (unsigned i = 0; i < 4; i++) {
        const unsigned row = place + (i & 1u) * BLOCK_SIDE + (i >> 1) * BLOCK_SLICE;
        scores[2 * i] = b->lower[row];
        scores[2 * i + 1] = b->upper[row];
    }
}

#endif
#endif
