/* convert_grid_report.h - what convert tells on standard output of a grid. */
#ifndef PREP_GRID_CONVERT_GRID_REPORT_H
#define PREP_GRID_CONVERT_GRID_REPORT_H

#include "prep/convert_request.h"
#include "prep/grid/convert.h"

typedef struct convert_outcome {
    convert_result result;
    double seconds;
} convert_outcome;

/* convert_grid_report() - o: NULL for a dry run. */
CHECKED status convert_grid_report(const convert_request *a, const convert_plan *plan,
                                   const grid *g, const convert_outcome *o);

#endif
