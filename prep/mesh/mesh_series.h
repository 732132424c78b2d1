/* mesh_series.h - several meshes as the steps of one, several arrays of theirs as its fields.
 *
 * The tets of every step must be, one by one, those of the first; points may move. A file is read
 * once, with all its fields.
 */
#ifndef PREP_MESH_MESH_SERIES_H
#define PREP_MESH_MESH_SERIES_H

#include <stdint.h>

#include "formats/base/mem.h"
#include "formats/base/status.h"
#include "formats/base/step_list.h"
#include "formats/mesh/mesh_input.h"
#include "prep/mesh/mesh_gather.h"

typedef struct mesh_series {
    const char *const *paths; /* of the steps, in order; one where they are in a file */
    const step_list *in_file; /* the steps are these of the first path's file; NULL: one a path */
    uint32_t steps;           /* 1 or more */
    const char *const *names; /* of the fields; NULL: one, that which the hints take */
    uint32_t fields;          /* 1 or more */
    const double *times;      /* of the steps, ascending; NULL: untold */
    mesh_hints hints;         /* but for `field` where there are names; `step` where in_file */
} mesh_series;

/* mesh_series_check() - whether it can be: ST_USAGE for standard input where more than one reading
 * is needed, times that do not ascend, names given twice; ST_UNSUPPORTED for more than
 * LEAF_SETS_MAX fields times steps. */
CHECKED status mesh_series_check(const mesh_series *s);

/* mesh_series_read() - all of it to sink, that of g; first: the first step's mesh, just opened,
 * with any of the fields. report: of the first reading. ST_CORRUPT names the file that is unlike
 * the first, and the first tet that is. */
CHECKED status mesh_series_read(mem *m, const mesh_series *s, mesh_input *first, mesh_gather *g,
                                const mesh_sink *sink, mesh_report *report);

#endif
