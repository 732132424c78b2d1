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
#include "prep/mesh/mesh_vertices.h"

typedef struct cell_treelet {
    float bounds[6]; /* lo x y z, hi x y z of its nodes, of the step built last */
    uint32_t counts[4];
    leaf_entry entry;                          /* of the values built last */
    const void *topology, *positions, *values; /* owned by the builder, until it builds others */
    uint64_t folded;                           /* cells that are, of the places built last */
} cell_treelet;

/* The most that treelets of so many cells take: their element of COUNTS, and bytes of payloads. */
typedef struct cell_treelet_most {
    uint32_t counts[4], topology_bytes, value_bytes;
} cell_treelet_most;

/* One thread's buffers. */
typedef struct cell_builder {
    mem *m;
    mesh_vertices nodes;
    uint32_t counts[4]; /* of the current treelet */
    float (*xyz)[3];    /* of its nodes */
    char *topology, *values;
    mesh_pages *normals; /* of the current step: uint32_t of every node; NULL: there are none */
} cell_builder;

typedef struct cell_treelets {
    uint32_t kind;        /* of files: leaf_kind */
    uint32_t corners;     /* ids of a cell, where cells are gathered: CELL_ROW, or 3 */
    uint32_t cells_max;   /* of a treelet */
    uint32_t nodes_least; /* of a treelet */
    const char *cells;    /* what they are called: "cells" */
    bool histograms;      /* of their values are made */
    const leaf_coder *coder;

    /* The topology is the largest payload. */
    cell_treelet_most (*most)(uint32_t treelet_cells);

    /* begin(): begin a treelet of 1 or more cells: sets out->counts. cells: rows of ids
     * (cell_row.h); of a triangle three, then the last one again. place(): points: float[3] of
     * every node. step 0 sets out->topology, a later one out->positions; both bounds and folded.
     * value(): values: float of every node. Sets out->values, out->entry. Fail only if reading
     * does. */
    void (*begin)(cell_builder *b, const uint32_t (*cells)[CELL_ROW], size_t count,
                  cell_treelet *out);
    status (*place)(cell_builder *b, mesh_pages *points, uint32_t step, cell_treelet *out);
    status (*value)(cell_builder *b, mesh_pages *values, cell_treelet *out);
} cell_treelets;

/* cell_builder_memory() - bytes that a builder takes, for treelets of at most so many cells.
 * cell_builder_destroy() - NULL is fine. */
uint64_t cell_builder_memory(const cell_treelets *kind, uint32_t treelet_cells);
CHECKED status cell_builder_create(const cell_treelets *kind, mem *m, uint32_t treelet_cells,
                                   cell_builder **out);
void cell_builder_destroy(cell_builder *b);

/* For the kinds. cell_builder_place(): fetch positions, put them at the start of the topology, one
 * axis after another, and set out->bounds, out->topology and out->positions. cell_builder_value():
 * make the payload of values, of value_bytes; set out->values and out->entry.
 * cell_builder_clear(): zero bytes of a payload. */
CHECKED status cell_builder_place(cell_builder *b, mesh_pages *points, cell_treelet *out);
CHECKED status cell_builder_value(cell_builder *b, mesh_pages *values, uint32_t value_bytes,
                                  cell_treelet *out);
void cell_builder_clear(char *payload, uint32_t from, uint32_t end);

#endif
