/* curvilinear_thinned.h - every 2^n-th node of a set of a curvilinear grid's treelet file as a
 * source: the same grid, coarser in computational space. The nodes that are left stay where they
 * are, those of faces on faces. So it shows what a regular grid of as many nodes has lost: thin
 * cells at walls, shells.
 *
 * Along each axis node i is the grid's node 2^n i, the last one its last. A coarse cell is none if
 * all cells that it stands for are, or a corner of it is a corner of no cell at all. So what is
 * narrower than 2^n cells between blanked ones may vanish.
 */
#ifndef PREP_CURVILINEAR_CURVILINEAR_THINNED_H
#define PREP_CURVILINEAR_CURVILINEAR_THINNED_H

#include "formats/curvilinear/curvilinear_source.h"
#include "formats/leaf/leaf_file.h"
#include "formats/leaf/leaf_unpacker.h"

typedef struct curvilinear_thinned {
    curvilinear_source source; /* of one field; valid while the struct stays where it is */
    /* Inside: */
    mem *m;
    leaf_file *f;
    uint32_t set, log2; /* n */
    uint32_t (*nodes)[3];
    leaf_unpacker *unpacker;
    char *room;
} curvilinear_thinned;

/* curvilinear_thinned_init() - a source of set `set` of f, which must outlive it. log2: n, from 1
 * on. Reads all places once, to see whether a cell is none. Release it in any case. */
CHECKED status curvilinear_thinned_init(curvilinear_thinned *t, mem *m, leaf_file *f, uint32_t set,
                                        uint32_t log2);
void curvilinear_thinned_release(curvilinear_thinned *t);

/* curvilinear_thinned_log2() - the least n from 1 on with at most so many cells, or with but one
 * cell a zone. */
uint32_t curvilinear_thinned_log2(const leaf_file *f, uint64_t cells);

#endif
