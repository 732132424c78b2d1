/* convert_grid_sets.h - the fields and steps that a conversion takes of a grid. */
#ifndef PREP_GRID_CONVERT_GRID_SETS_H
#define PREP_GRID_CONVERT_GRID_SETS_H

#include "formats/grid/volume.h"
#include "prep/convert_sets.h"
#include "prep/grid/grid_series.h"

/* convert_grid_sets() - resolve "all fields" and the list of steps, if asked for. The default field
 * comes first, then the others in the file's order. If steps are taken, fields with another number
 * of steps are left out. ST_USAGE: there is no such step. */
CHECKED status convert_grid_sets(convert_sets *s, const volume *v, const char *name);

/* convert_grid_sets_alike() - keep only the fields that can share a file with the first, which is
 * v's. `left_out' is called with the reason for each other. Sets the number of fields of series. */
CHECKED status convert_grid_sets_alike(convert_sets *s, grid_series *series, const volume *v,
                                       void (*left_out)(void *ctx, const char *name,
                                                        const char *why),
                                       void *ctx);

#endif
