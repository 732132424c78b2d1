/* mesh_convert.h - a tetrahedral mesh to a treelet file.
 *
 * Points, values and tets are gathered; tets get the place of their centroid along a Morton curve
 * as a key, are sorted by it, cut into treelets, and these are built by many threads. What does not
 * fit into the budget goes through scratch files beside the output. The file's bytes depend on the
 * input and the parameters alone.
 *
 * A series is sorted and cut by its first step. All of it is read first, so that it is known
 * whether anything moves; then treelets are built with all their values and positions at once, or,
 * where these are in scratch files, step after step, going through the tets once for each.
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
    leaf_header header; /* the file's */
    mesh_report report; /* of the reader */
    mesh_plan plan;
    double read_s, sort_s, build_s; /* how long the stages took */
} mesh_result;

/* mesh_options_default() - treelets and leaves of the best sizes, raw, no budget, one thread. */
mesh_options mesh_options_default(void);

/* mesh_convert_run() - x: just opened; of a series, its first step with the first field; the series
 * passes mesh_series_check(). p may be NULL. ST_CORRUPT for a mesh without a tet that
 * could be kept. Nothing is left under output's name or beside it unless ST_OK. */
CHECKED status mesh_convert_run(mem *m, mesh_input *x, const char *output, const mesh_options *o,
                                const progress *p, mesh_result *result);

/* mesh_convert_gathered() - the same from what was gathered (of a series: its fields and steps);
 * g is consumed. result->report comes from the caller. */
CHECKED status mesh_convert_gathered(mem *m, mesh_gather *g, const char *name, const char *output,
                                     const mesh_options *o, const progress *p, mesh_result *result);

/* mesh_convert_dry() - read x, keep nothing, and plan: result->report and result->plan. */
CHECKED status mesh_convert_dry(mem *m, mesh_input *x, const mesh_options *o, const progress *p,
                                mesh_result *result);

#endif
