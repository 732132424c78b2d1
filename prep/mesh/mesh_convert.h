/* mesh_convert.h - converts a tetrahedral mesh to a treelet file.
 *
 * Points, values and tets are gathered. The key of a tet is its centroid's place along a Morton
 * curve. Tets are sorted by key and cut into treelets, which many threads build. What does not fit
 * into the budget goes through scratch files beside the output. The file's bytes depend on the
 * input and the parameters alone, and not on where an earlier run ended (mesh_conversion.h).
 *
 * A series is sorted and cut by its first step. All of it is read first, to know whether anything
 * moves. Then treelets are built with all their values and positions at once. If these are in
 * scratch files, they are built step after step, going through the tets once for each.
 */
#ifndef PREP_MESH_MESH_CONVERT_H
#define PREP_MESH_MESH_CONVERT_H

#include <stdint.h>

#include "formats/base/mem.h"
#include "formats/base/progress.h"
#include "formats/base/status.h"
#include "formats/leaf/leaf.h"
#include "formats/mesh/mesh_input.h"
#include "prep/mesh/mesh_plan.h"

typedef struct mesh_result {
    leaf_header header; /* of the file written */
    mesh_report report; /* from the reader */
    mesh_plan plan;
    double read_s, sort_s, build_s; /* seconds that the stages took */
} mesh_result;

/* mesh_options_default() - best sizes of treelets and leaves, raw, no budget, one thread. */
mesh_options mesh_options_default(void);

/* mesh_convert_run() - x: just opened; for a series, its first step with the first field. A series
 * must have passed step_series_check(). p may be NULL. ST_CORRUPT: no tet could be kept. Unless
 * ST_OK, nothing is left under output's name or beside it, except in o->work. */
CHECKED status mesh_convert_run(mem *m, mesh_input *x, const char *output, const mesh_options *o,
                                const progress *p, mesh_result *result);

/* mesh_convert_gathered() - the same for gathered data (of a series: its fields and steps), without
 * o->work. Consumes g. The caller sets result->report. */
CHECKED status mesh_convert_gathered(mem *m, mesh_gather *g, const char *name, const char *output,
                                     const mesh_options *o, const progress *p, mesh_result *result);

/* mesh_convert_dry() - read x, keep nothing, and plan: sets result->report and result->plan. */
CHECKED status mesh_convert_dry(mem *m, mesh_input *x, const mesh_options *o, const progress *p,
                                mesh_result *result);

#endif
