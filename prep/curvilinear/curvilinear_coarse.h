/* curvilinear_coarse.h - makes what stands for a set of a curvilinear grid in previews (leaf.h,
 * COARSE): a regular grid, or where that would lose too much, of thin cells or shells, the same
 * grid with fewer nodes (curvilinear_thinned.h).
 */
#ifndef PREP_CURVILINEAR_CURVILINEAR_COARSE_H
#define PREP_CURVILINEAR_CURVILINEAR_COARSE_H

#include <stdbool.h>

#include "prep/curvilinear/curvilinear_convert.h"
#include "prep/resample/coarse_grids.h"

typedef struct curvilinear_coarse {
    coarse_grids regular; /* dims not 0: these, whatever they lose */
    bool thinned;         /* found by the first set, for all */
} curvilinear_coarse;

/* curvilinear_coarse_of() - for a conversion. */
curvilinear_coarse curvilinear_coarse_of(const curvilinear_options *o);

/* curvilinear_coarse_maker() - one that makes it so; c: by reference. */
coarse_maker curvilinear_coarse_maker(curvilinear_coarse *c);

#endif
