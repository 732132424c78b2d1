/* mixed_blocks.h - a treelet of a mixed mesh in memory: cells in blocks, a tree over these, and a
 * mask of each block's active cells.
 *
 * A cell is the hexahedron between eight nodes, some of them the same, trilinear in position and
 * value; or a quadratic tet. Cells are in the order of a space-filling curve, so a block is a run
 * of them, and eight blocks in a row are neighbours (treelet_tree.h).
 */
#ifndef STREAM_MIXED_BLOCKS_H
#define STREAM_MIXED_BLOCKS_H

#include "formats/leaf/mixed_geometry.h"
#include "stream/interest.h"
#include "stream/treelet_tree.h"

enum { MIXED_BLOCK = 16 };

typedef struct mixed_blocks {
    mixed_shape shape;
    uint64_t first;       /* number of its first cell in the whole file */
    const void *places;   /* of its step (mixed_geometry.h) */
    const float *p[3];    /* a coordinate of all nodes, in there */
    const float *values;  /* of all nodes */
    const uint16_t *rows; /* of the cells; mixed_row() */
    treelet_tree tree;    /* over the blocks; active: those with an active cell */
    uint32_t blocks;
    float (*ranges)[2]; /* of a block's finite values; inf, -inf: it has none */
    uint16_t *active;   /* per block: a bit for each cell, the first one lowest */
    mem *m;
} mixed_blocks;

/* mixed_blocks_init() - make the tree of a treelet. topology and places must outlive it; rows
 * have nodes of the treelet. mixed_blocks_bytes() - the memory that takes from m.
 * mixed_blocks_move() - coordinates are there, finite, or other ones: set boxes. */
CHECKED status mixed_blocks_init(mixed_blocks *b, mem *m, const mixed_shape *s,
                                 const void *topology, const void *places);
size_t mixed_blocks_bytes(const mixed_shape *s);
void mixed_blocks_release(mixed_blocks *b);
void mixed_blocks_move(mixed_blocks *b);

/* mixed_blocks_fill() - give it the values of a set, kept by reference. No cell is active then. */
void mixed_blocks_fill(mixed_blocks *b, const float *values);

/* mixed_blocks_select() - activate the cells whose values meet an interest: all of them finite
 * (interest.h). */
void mixed_blocks_select(mixed_blocks *b, const interest *in);

/* mixed_blocks_cells() - how many cells a block has; its first one is MIXED_BLOCK * block. */
static inline uint32_t mixed_blocks_cells(const mixed_blocks *b, uint32_t block) {
    const uint32_t left = b->shape.cells - MIXED_BLOCK * block;
    return left < MIXED_BLOCK ? left : MIXED_BLOCK;
}

/* mixed_blocks_is_quadratic() - whether a cell is a quadratic tet. */
static inline bool mixed_blocks_is_quadratic(const mixed_blocks *b, uint32_t i) {
    const uint16_t *row = b->rows + (size_t)b->shape.width * i;
    return b->shape.quadratic && row[CELL_ROW - 2] != row[CELL_ROW - 1];
}

#endif
