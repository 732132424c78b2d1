/* exodus_blocks.h - the element blocks of an Exodus file: what shape they have, and their elements.
 */
#ifndef PREP_IMPORT_EXODUS_EXODUS_BLOCKS_H
#define PREP_IMPORT_EXODUS_EXODUS_BLOCKS_H

#include <stdbool.h>

#include "formats/base/cell_shape.h"
#include "formats/base/mem.h"
#include "formats/base/status.h"
#include "prep/import/exodus/exodus_numbers.h"

typedef struct exodus_block {
    uint64_t number; /* in the file, from 1 */
    int connect;     /* the variable */
    uint64_t cells;
    size_t nodes; /* of each element, its corners first */
    cell_shape shape;
} exodus_block;

typedef struct exodus_blocks {
    mem *m;
    exodus_block *of; /* those with volumes */
    size_t count, room;
    uint64_t cells[CELL_SHAPES];
    uint64_t higher;  /* elements of higher order */
    uint64_t skipped; /* elements that are no volumes, in blocks that are not here */
} exodus_blocks;

/* exodus_blocks_read() - by_corners: take elements of higher order as linear ones. Release b in any
 * case. */
CHECKED status exodus_blocks_read(mem *m, const exodus_numbers *n, bool by_corners,
                                  exodus_blocks *b);
void exodus_blocks_release(exodus_blocks *b);

/* exodus_block_cells() - `count` elements of a block from `first` on: the ids of their shape's
 * vertices from 0, UINT32_MAX for what is none. */
CHECKED status exodus_block_cells(const exodus_block *block, exodus_numbers *n, uint64_t first,
                                  size_t count, uint32_t *ids);

/* exodus_blocks_cells() - the same for elements of a shape, over all blocks. */
CHECKED status exodus_blocks_cells(const exodus_blocks *b, exodus_numbers *n, cell_shape shape,
                                   uint64_t first, size_t count, uint32_t *ids);

#endif
