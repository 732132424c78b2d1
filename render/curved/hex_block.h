/* hex_block.h - which cells of a block of 4^3 a ray may cross: all others are surely beside it.
 *
 * Each node is placed in the ray's space once for all cells that share it, by the operations of
 * sheared_ray_place(). A cell is beside the ray if its eight corners are on one side along one of
 * two axes. These are the same doubles and the same sides as a face's (patch_beside()), so no cell
 * that has a part of the ray is left out, whatever the rounding.
 */
#ifndef RENDER_CURVED_HEX_BLOCK_H
#define RENDER_CURVED_HEX_BLOCK_H

#include <stdint.h>

#include "formats/base/cpu.h"
#include "formats/curved/sheared_ray.h"

enum {
    HEX_BLOCK = 4,
    HEX_BLOCK_NODES = HEX_BLOCK + 1,
    HEX_BLOCK_ROW =
        8 /* floats that are read of a row of nodes; not more are looked at than it has */
};

/* Node (i, j, k) of a block has the coordinates p[a][i + row * j + slab * k]. Cells are cells[0] x
 * cells[1] x cells[2], 1 to HEX_BLOCK each. From the first of a row's nodes on, HEX_BLOCK_ROW
 * floats must be there. */
typedef struct hex_block {
    const float *p[3];
    uint32_t row, slab;
    uint32_t cells[3];
} hex_block;

/* hex_block_cells - a function that returns the cells that are not beside the ray: of cell (i, j,
 * k), bit i + 4 j + 16 k. */
typedef uint64_t (*hex_block_fn)(const hex_block *b, const sheared_ray *r);
extern const hex_block_fn hex_block_cells[CPU_ISAS];

#endif
