/* grid_series.h - several grids as the steps of one, several arrays of theirs as its fields.
 *
 * All have the sizes, the type and the place of the first. Each set is read once, one after the
 * other.
 */
#ifndef PREP_GRID_GRID_SERIES_H
#define PREP_GRID_GRID_SERIES_H

#include <stdint.h>

#include "formats/base/mem.h"
#include "formats/base/status.h"
#include "formats/grid/volume.h"
#include "formats/leaf/leaf_writer.h"

typedef struct grid_series {
    const char *const *paths; /* of the steps, in order */
    leaf_sets sets;           /* names may be NULL where there is one field: what the hints take */
    volume_hints hints;       /* but for `field` where there are names */
} grid_series;

/* grid_series_check() - whether it can be; first: of the first set, just opened. All others are
 * opened, too, for their headers. ST_USAGE for standard input where more than one reading is
 * needed, times that do not ascend, names given twice; ST_UNSUPPORTED for more than LEAF_SETS_MAX
 * sets, and for one that is unlike the first, which is named. */
CHECKED status grid_series_check(mem *m, const grid_series *s, const volume *first);

/* grid_series_open() - a set of it; set = field * steps + step. */
CHECKED status grid_series_open(mem *m, const grid_series *s, uint32_t set, volume **out);

#endif
