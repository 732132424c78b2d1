/* series_check.h - whether inputs can be the steps of a series, and these its fields. */
#ifndef PREP_SERIES_CHECK_H
#define PREP_SERIES_CHECK_H

#include <stdbool.h>

#include "formats/base/status.h"
#include "formats/leaf/leaf_writer.h"

/* series_check() - paths: of the steps, or, in_file, of the one file that has them all. ST_USAGE
 * for standard input where more than one reading is needed, times that do not ascend, names given
 * twice; ST_UNSUPPORTED for more than LEAF_SETS_MAX fields times steps. */
CHECKED status series_check(const char *const *paths, bool in_file, const leaf_sets *sets);

#endif
