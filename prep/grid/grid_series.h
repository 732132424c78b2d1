/* grid_series.h - several grids as the steps of one, or the steps of one file; several arrays as
 * its fields.
 *
 * All have the sizes, the type and the place of the first. Each set is read once, one after the
 * other.
 */
#ifndef PREP_GRID_GRID_SERIES_H
#define PREP_GRID_GRID_SERIES_H

#include <stdbool.h>
#include <stdint.h>

#include "formats/base/mem.h"
#include "formats/base/status.h"
#include "formats/grid/volume.h"
#include "prep/step_series.h"

typedef struct grid_series {
    step_series of;
    volume_hints
        hints;         /* `field` is unused if there are names, `step` if the steps are in a file */
    bool fields_alike; /* the first step's fields are known to be like the first */
} grid_series;

/* grid_series_check() - check a series. first: volume of the first set, just opened. All others are
 * opened for their headers, except further steps of a file. As step_series_check(); ST_UNSUPPORTED
 * also for a set unlike the first, which is named. */
CHECKED status grid_series_check(mem *m, const grid_series *s, const volume *first);

/* grid_series_alike() - open a set and compare it with the first. ST_UNSUPPORTED: it differs. */
CHECKED status grid_series_alike(mem *m, const grid_series *s, uint32_t set, const volume *first);

/* grid_series_open() - open one set; set = field * steps + step. */
CHECKED status grid_series_open(mem *m, const grid_series *s, uint32_t set, volume **out);

#endif
