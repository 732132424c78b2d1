/* resample_cells.h - how a kind's treelets are read, and drawn into a block: a row each.
 */
#ifndef PREP_RESAMPLE_RESAMPLE_CELLS_H
#define PREP_RESAMPLE_RESAMPLE_CELLS_H

#include "formats/leaf/leaf_geometry.h"
#include "formats/leaf/leaf_unpacker.h"
#include "prep/resample/resample_block.h"

/* A treelet in memory, with the values of a set. */
typedef struct resample_treelet {
    leaf_file *f;
    uint32_t set, id;
    char *room; /* resample_cells.payloads() payloads, aligned to LEAF_ALIGN */
} resample_treelet;

/* resample_treelet_payload_bytes() - how far they are apart. */
static inline size_t resample_treelet_payload_bytes(const leaf_file *f) {
    return leaf_layout_aligned(leaf_layout_payload_max(&f->layout), LEAF_ALIGN_LOG2);
}
static inline char *resample_treelet_payload(const resample_treelet *t, int i) {
    return t->room + (size_t)i * resample_treelet_payload_bytes(t->f);
}

typedef struct resample_cells {
    const leaf_geometry *of; /* NULL: all whose cells are hexahedra */
    /* How many payloads a treelet has room for. */
    int (*payloads)(const leaf_file *f, uint32_t set);
    uint64_t (*nodes)(const leaf_file *f);  /* about; of the whole file */
    uint64_t (*coarse)(const leaf_file *f); /* how many a coarse grid has by default */
    /* Read and check the treelet's payloads. */
    status (*load)(const resample_treelet *t, leaf_unpacker *u);
    /* Draw the treelet's cells. A cell gives its value to nodes that it holds and no earlier cell
     * held. Only rows [first_row, first_row + rows) are touched, which must be in the block. So
     * threads may share a block. */
    void (*draw)(const resample_block *b, uint64_t first_row, uint64_t rows,
                 const resample_treelet *t);
} resample_cells;

/* The rows. A node's value in a tet: tet_value.h. In a hexahedron: hex_point.h; NaN if a corner of
 * it has no finite value. Cells that share a face hold a node of it once (formats/curved/patch.h).
 * Nodes on a side of the file's box would be held by none: they are taken 2^-30 of the box further
 * inside. */
extern const resample_cells resample_tets, resample_hexes;

/* resample_cells_of() - the row for a file; NULL: it is not resampled. */
const resample_cells *resample_cells_of(const leaf_file *f);

#endif
