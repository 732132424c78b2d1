/* exodus_averages.h - variables of an Exodus file's elements, averaged to its nodes
 * (mesh_average.h).
 */
#ifndef PREP_IMPORT_EXODUS_EXODUS_AVERAGES_H
#define PREP_IMPORT_EXODUS_EXODUS_AVERAGES_H

#include "formats/mesh/mesh_average.h"
#include "prep/import/exodus/exodus_blocks.h"

/* The caller sets the first five. */
typedef struct exodus_averages {
    mem *m;
    exodus_numbers *n;
    const exodus_blocks *blocks;
    uint64_t nodes;
    uint32_t step;
    uint32_t variable; /* whose sums these are, from 1; 0: none */
    mesh_average sums;
} exodus_averages;

/* exodus_averages_read() - means at `count` nodes from `first` on, of an element variable, from 0.
 * A variable's nodes are asked for in order. Blocks that lack the variable do not count. */
CHECKED status exodus_averages_read(exodus_averages *a, uint32_t variable, uint64_t first,
                                    size_t count, float *to);
void exodus_averages_release(exodus_averages *a);

#endif
