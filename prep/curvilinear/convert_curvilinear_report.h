/* convert_curvilinear_report.h - what convert tells of a curvilinear grid (convert_report.h). */
#ifndef PREP_CURVILINEAR_CONVERT_CURVILINEAR_REPORT_H
#define PREP_CURVILINEAR_CONVERT_CURVILINEAR_REPORT_H

#include "prep/convert_request.h"
#include "prep/curvilinear/curvilinear_convert.h"

/* convert_curvilinear_report() - print what was done. r: NULL: what would be done. field: as of
 * convert_report.h. */
CHECKED status convert_curvilinear_report(const convert_request *a,
                                          const curvilinear_source *source, const char *field,
                                          const curvilinear_plan *plan, const curvilinear_result *r,
                                          double seconds);

#endif
