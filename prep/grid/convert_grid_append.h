/* convert_grid_append.h - whether grids are further steps of a treelet file. */
#ifndef PREP_GRID_CONVERT_GRID_APPEND_H
#define PREP_GRID_CONVERT_GRID_APPEND_H

#include "formats/grid/grid.h"
#include "prep/convert_request.h"

/* convert_grid_append_check() - ST_USAGE, naming what differs, if these are not further steps of
 * the file that is added to; ST_OK without one. Leaves out the times of the sets where the file has
 * none. */
CHECKED status convert_grid_append_check(const convert_request *a, const grid *g, leaf_sets *sets);

#endif
