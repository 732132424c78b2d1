/* convert_report.h - what convert tells on standard output of what it has done, or would do with
 * --dry-run: lines, or with --json an object.
 */
#ifndef PREP_CONVERT_REPORT_H
#define PREP_CONVERT_REPORT_H

#include "formats/base/cli.h"
#include "prep/convert_sets.h"
#include "prep/grid/convert.h"
#include "prep/mesh/mesh_convert.h"

typedef struct convert_report {
    const cli_common *common;
    const convert_sets *sets;
    bool dry_run;
} convert_report;

typedef struct convert_outcome {
    convert_result result;
    double seconds;
} convert_outcome;

/* convert_report_grid() - o: NULL for a dry run. convert_report_mesh() - seconds: since the start.
 */
CHECKED status convert_report_grid(const convert_report *a, const convert_plan *plan, const grid *g,
                                   const convert_outcome *o);
CHECKED status convert_report_mesh(const convert_report *a, const mesh_result *r, double seconds);

#endif
