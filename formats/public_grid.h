/* public_grid.h - for files that implement the public headers: the grids that callers describe. */
#ifndef FORMATS_PUBLIC_GRID_H
#define FORMATS_PUBLIC_GRID_H

#include <leafcast_grid.h>

#include "formats/grid/grid.h"
#include "formats/public_fields.h"

/* The table of leafcast_grid. public_grid_check() - check one by it. */
extern const public_fields public_grid_table;
CHECKED status public_grid_check(const leafcast_grid *from);

/* public_grid_check_strides() - refuse strides that put one of so many nodes further from the first
 * than a pointer can reach. */
CHECKED status public_grid_check_strides(const uint32_t dims[3], const ptrdiff_t strides[3]);

/* public_grid_make() - make a grid as described. ST_USAGE where it lies in no sound place, or its
 * axes do not ascend or descend. Release the grid in any case. */
CHECKED status public_grid_make(mem *m, const leafcast_grid *from, grid *g);

#endif
