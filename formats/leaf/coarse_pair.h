/* coarse_pair.h - the coarse grids of a file at two steps, as one file: what lies between them can
 * then be shown like what lies between the steps of any grid (leaf_between.h).
 */
#ifndef FORMATS_LEAF_COARSE_PAIR_H
#define FORMATS_LEAF_COARSE_PAIR_H

#include "formats/leaf/leaf_file.h"

/* coarse_pair_has() - whether f has the coarse grids of a set and of the next step.
 * coarse_pair_open() - open both as a grid of two steps, which may outlive f. It has neither
 * histograms nor deviations. ST_CORRUPT also where they are not grids of the same samples' places
 * and types, as those of cells that stay always are. */
bool coarse_pair_has(const leaf_file *f, uint32_t set);
CHECKED status coarse_pair_open(mem *m, const leaf_file *f, uint32_t set, leaf_file **out);

#endif
