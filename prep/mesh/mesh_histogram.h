/* mesh_histogram.h - histograms of a mesh's sets, made from its tets while they become treelets. */
#ifndef PREP_MESH_MESH_HISTOGRAM_H
#define PREP_MESH_MESH_HISTOGRAM_H

#include <stdint.h>

#include "formats/base/cell_row.h"
#include "formats/base/hexahedron.h"
#include "formats/base/mem.h"
#include "formats/base/state_io.h"
#include "formats/base/status.h"
#include "formats/leaf/histogram_draw.h"
#include "formats/leaf/leaf_writer.h"
#include "prep/mesh/mesh_pages.h"
#include "prep/mesh/mesh_sort.h"

/* Zeroed is fine: then there are no histograms. */
typedef struct mesh_histogram {
    histogram_run run;
    uint32_t sets;
    histogram_cell *cells; /* run.count cells per set */
    mem *m;
} mesh_histogram;

/* mesh_histogram_memory() - most bytes that mesh_histogram_begin() takes. */
uint64_t mesh_histogram_memory(void);

/* mesh_histogram_begin() - prepare for so many tets and sets. mesh_histogram_end() - when all was
 * taken: fill the writer's histograms. */
CHECKED status mesh_histogram_begin(mesh_histogram *h, mem *m, uint64_t tets, uint32_t sets);
void mesh_histogram_end(const mesh_histogram *h, leaf_writer *w);
void mesh_histogram_release(mesh_histogram *h);

/* mesh_histogram_keep() - save what was taken, or load it after mesh_histogram_begin(). */
CHECKED status mesh_histogram_keep(mesh_histogram *h, state_io *io);

/* mesh_histogram_take_cells() - the same for cells of a mixed mesh, as mixed_treelet_begin() takes
 * them. */
CHECKED status mesh_histogram_take_cells(const mesh_histogram *h, uint32_t set, uint64_t first,
                                         const uint32_t (*cells)[CELL_ROW], size_t count,
                                         mesh_pages *points, mesh_pages *values);

/* mesh_histogram_take() - for a set, take the samples drawn from tets first .. first + count - 1 of
 * the mesh. points, values: of the set's step, and of the set. Thread-safe for different tets. */
CHECKED status mesh_histogram_take(const mesh_histogram *h, uint32_t set, uint64_t first,
                                   const mesh_record *records, size_t count, mesh_pages *points,
                                   mesh_pages *values);

#endif
