/* grid_series.h - several grids as the steps of one, or the steps of one file; several arrays of
 * theirs as its fields.
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
#include "formats/base/step_list.h"
#include "formats/grid/volume.h"
#include "formats/leaf/leaf_writer.h"

typedef struct grid_series {
    const char *const *paths;  /* of the steps, in order; one where they are in a file */
    const step_list *in_file;  /* the steps are these of the first path's file; NULL: one a path */
    leaf_sets sets;            /* names may be NULL where there is one field: what the hints take */
    const char *const *fields; /* likewise, as the input calls them */
    volume_hints hints;        /* but for `field` where there are names; `step` where in_file */
    bool fields_alike;         /* those of the first step have been found to be like the first */
} grid_series;

/* grid_series_check() - whether it can be; first: of the first set, just opened. All others are
 * opened, too, for their headers, but for further steps of a file. ST_USAGE for standard input
 * where more than one reading is needed, times that do not ascend, names given twice;
 * ST_UNSUPPORTED for more than LEAF_SETS_MAX sets, and for one that is unlike the first, which is
 * named. */
CHECKED status grid_series_check(mem *m, const grid_series *s, const volume *first);

/* grid_series_alike() - a set is opened, and has to be like the first: else ST_UNSUPPORTED. */
CHECKED status grid_series_alike(mem *m, const grid_series *s, uint32_t set, const volume *first);

/* grid_series_follows() - whether a set is the step behind the set before, in the same file. */
bool grid_series_follows(const grid_series *s, uint32_t set);

/* grid_series_open() - a set of it; set = field * steps + step. */
CHECKED status grid_series_open(mem *m, const grid_series *s, uint32_t set, volume **out);

#endif
