/* grid_families.h - cuts complete slabs into families, which many threads turn into payloads. */
#ifndef PREP_GRID_GRID_FAMILIES_H
#define PREP_GRID_GRID_FAMILIES_H

#include "prep/grid/grid_conversion.h"

/* grid_families_take() - put all families of a level's complete slab, and begin the next slab. */
CHECKED status grid_families_take(grid_conversion *c, uint32_t level);

#endif
