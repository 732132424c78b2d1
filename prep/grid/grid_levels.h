/* grid_levels.h - slices on their way up the pyramid: into the slab of each level, and thinned out
 * for the next one.
 */
#ifndef PREP_GRID_GRID_LEVELS_H
#define PREP_GRID_GRID_LEVELS_H

#include "prep/grid/grid_conversion.h"

/* grid_levels_pass() - go on to the first slab that slices_done do not complete. Returns whether
 * there was one that they do.
 * grid_levels_run() - take all slices of the input, from slices_done on. Saves the state when that
 * is due. */
bool grid_levels_pass(grid_conversion *c);
CHECKED status grid_levels_run(grid_conversion *c);

#endif
