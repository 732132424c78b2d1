/* cell_treelet.h - makes the payloads of one treelet of cells that are listed as rows of nodes
 * (listed_geometry.h): a row of functions for each kind of cells.
 *
 * A treelet has its cells in the order given, and its nodes, each once, in the order in which cells
 * use them first. The payloads depend on the cells and the nodes alone.
 */
#ifndef PREP_MESH_CELL_TREELET_H
#define PREP_MESH_CELL_TREELET_H

#include "formats/base/cell_row.h"
#include "formats/base/mem.h"
#include "formats/leaf/leaf_coder.h"
#include "formats/leaf/leaf_writer.h"
#include "prep/mesh/mesh_pages.h"

typedef struct cell_treelet {
    float bounds[6]; /* lo x y z, hi x y z of its nodes, of the step built last */
    uint32_t counts[4];
    leaf_entry entry;                          /* of the values built last */
    const void *topology, *positions, *values; /* owned by the builder, until it builds others */
    uint64_t folded;                           /* cells that are, of the places built last */
} cell_treelet;

typedef struct cell_treelets {
    uint32_t kind;        /* of files: leaf_kind */
    uint32_t corners;     /* ids of a cell, where cells are gathered: CELL_ROW, or 3 */
    uint32_t cells_max;   /* of a treelet */
    uint32_t nodes_least; /* of a treelet */
    const char *cells;    /* what they are called: "cells" */
    bool histograms;      /* of their values are made */
    const leaf_coder *coder;

    /* memory(): bytes that a builder takes, for treelets of at most so many cells. payload_max():
     * of the largest payload. counts_max(): its element of COUNTS. */
    uint64_t (*memory)(uint32_t treelet_cells);
    size_t (*payload_max)(uint32_t treelet_cells);
    void (*counts_max)(uint32_t treelet_cells, uint32_t counts[4]);

    /* One thread's buffers to build treelets. destroy(): NULL is fine. */
    status (*create)(mem *m, uint32_t treelet_cells, void **out);
    void (*destroy)(void *builder);

    /* begin(): begin a treelet of 1 or more cells: sets out->counts. cells: rows of ids
     * (cell_row.h); of a triangle three, then the last one again. place(): points: float[3] of
     * every node. step 0 sets out->topology, a later one out->positions; both bounds and folded.
     * value(): values: float of every node. Sets out->values, out->entry. Fail only if reading
     * does. */
    void (*begin)(void *builder, const uint32_t (*cells)[CELL_ROW], size_t count,
                  cell_treelet *out);
    status (*place)(void *builder, mesh_pages *points, uint32_t step, cell_treelet *out);
    status (*value)(void *builder, mesh_pages *values, cell_treelet *out);
} cell_treelets;

#endif
