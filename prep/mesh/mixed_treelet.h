/* mixed_treelet.h - makes the payloads of one treelet of a mixed mesh (mixed_geometry.h).
 *
 * A treelet has its cells in the order given, and its nodes, each once, in the order in which cells
 * use them first. The payloads depend on the cells and the nodes alone.
 */
#ifndef PREP_MESH_MIXED_TREELET_H
#define PREP_MESH_MIXED_TREELET_H

#include "formats/base/cell_row.h"
#include "formats/base/mem.h"
#include "formats/leaf/leaf_writer.h"
#include "formats/leaf/mixed_geometry.h"
#include "prep/mesh/mesh_pages.h"

typedef struct mixed_treelet {
    float bounds[6]; /* lo x y z, hi x y z of its nodes, of the step built last */
    uint32_t counts[4];
    leaf_entry entry;                          /* of the values built last */
    const void *topology, *positions, *values; /* owned by the builder, until it builds others */
    uint64_t folded;                           /* cells that are, of the places built last */
} mixed_treelet;

/* Quadratic tets may be among the cells. */
enum { MIXED_TREELET_MAX = MIXED_QUADRATIC_MAX };

/* One thread's buffers to build treelets. */
typedef struct mixed_treelet_builder mixed_treelet_builder;

/* mixed_treelet_create() - for treelets of at most so many cells, up to MIXED_TREELET_MAX.
 * mixed_treelet_memory() - bytes it takes. mixed_treelet_payload_max() - of the largest payload.
 * mixed_treelet_counts_max() - its element of COUNTS. */
CHECKED status mixed_treelet_create(mem *m, uint32_t treelet_cells, mixed_treelet_builder **out);
void mixed_treelet_destroy(mixed_treelet_builder *b); /* NULL is fine */
uint64_t mixed_treelet_memory(uint32_t treelet_cells);
size_t mixed_treelet_payload_max(uint32_t treelet_cells);
void mixed_treelet_counts_max(uint32_t treelet_cells, uint32_t counts[4]);

/* mixed_treelet_begin() - begin a treelet of 1 or more cells: sets out->counts. cells: rows of ids
 * (cell_row.h), four or more of them different.
 * mixed_treelet_place() - points: float[3] of every node. step 0 sets out->topology, a later one
 * out->positions; both bounds and folded.
 * mixed_treelet_value() - values: float of every node. Sets out->values, out->entry.
 * Fail only if reading does. */
void mixed_treelet_begin(mixed_treelet_builder *b, const uint32_t (*cells)[CELL_ROW], size_t count,
                         mixed_treelet *out);
CHECKED status mixed_treelet_place(mixed_treelet_builder *b, mesh_pages *points, uint32_t step,
                                   mixed_treelet *out);
CHECKED status mixed_treelet_value(mixed_treelet_builder *b, mesh_pages *values,
                                   mixed_treelet *out);

#endif
