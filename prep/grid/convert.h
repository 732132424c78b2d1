/* convert.h - converts a volume to a treelet file.
 *
 * The input is read once, front to back. Its slices fill the slab of level 0 and feed the rolling
 * window that makes the slices of level 1, and so on up the pyramid. A complete slab is cut into
 * families of siblings, which many threads turn into payloads. Peak memory is that of the plan,
 * whatever the input's size. The file's bytes depend on input and parameters alone.
 */
#ifndef PREP_GRID_CONVERT_H
#define PREP_GRID_CONVERT_H

#include <stdint.h>

#include "formats/base/mem.h"
#include "formats/base/progress.h"
#include "formats/base/status.h"
#include "formats/grid/volume.h"
#include "formats/leaf/histogram.h"
#include "formats/leaf/leaf.h"
#include "prep/grid/convert_plan.h"

typedef struct convert_result {
    leaf_header header;      /* of the file written */
    uint64_t trailing_bytes; /* of the input, behind its samples; they are ignored */
    absent_parts absent;     /* of the input, over all steps and fields */
    histogram_marker marker; /* of the first field or step with a marker; share 0: none has one */
} convert_result;

/* convert_run() - v: just opened; left at rest. plan: from convert_plan_make() for v and the same m
 * and options. p may be NULL. Unless ST_OK, nothing is left under output's name or beside it.
 */
CHECKED status convert_run(mem *m, volume *v, const char *output, const convert_options *o,
                           const convert_plan *plan, const progress *p, convert_result *result);

#endif
