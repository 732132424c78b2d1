/* leaf_histogram.h - histograms of treelet files: from payloads, or guessed where a file has
 * none. */
#ifndef FORMATS_LEAF_LEAF_HISTOGRAM_H
#define FORMATS_LEAF_LEAF_HISTOGRAM_H

#include <stdint.h>

#include "formats/base/mem.h"
#include "formats/base/status.h"
#include "formats/leaf/histogram.h"
#include "formats/leaf/histogram_draw.h"
#include "formats/leaf/leaf_file.h"
#include "formats/leaf/leaf_layout.h"
#include "formats/mesh/mesh_leaf.h"

/* leaf_histogram_take() - measure the nodes that are drawn from a treelet of level 0 of a grid.
 * Each element of cells is written for one treelet alone. */
void leaf_histogram_take(const leaf_layout *l, const histogram_draw *d, const histogram_space *s,
                         uint32_t t, const void *payload, histogram_cell *cells);

/* leaf_histogram_take_one() - the same for a treelet whose samples all equal this one. */
void leaf_histogram_take_one(const leaf_layout *l, const histogram_draw *d,
                             const histogram_space *s, uint32_t t, const void *sample,
                             histogram_cell *cells);

/* leaf_histogram_run() - the runs of tets, or other cells, that a set's histogram draws from: those
 * of when its segment was written. cells: of the whole file. */
histogram_run leaf_histogram_run(const leaf_file *f, uint32_t set, uint64_t cells);

/* leaf_histogram_take_tets() - the same for a mesh's treelet. first_tet: number of its first tet;
 * positions, values: of its vertices. */
void leaf_histogram_take_tets(const histogram_run *r, uint64_t first_tet, const mesh_shape *s,
                              const uint16_t (*tets)[4], const float (*positions)[3],
                              const float *values, histogram_cell *cells);

/* leaf_histogram_range() - the range of the finite values of a set, as its treelets state it; lo >
 * hi: there are none. */
void leaf_histogram_range(const leaf_file *f, uint32_t set, double range[2]);

/* leaf_histogram_get() - the histogram of a set of a file. If the file has none, guess one from the
 * ranges of its treelets: good for suggestions, and `total` counts treelets then. */
CHECKED status leaf_histogram_get(mem *m, const leaf_file *f, uint32_t set, histogram *out);

#endif
