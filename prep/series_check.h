/* series_check.h - checks whether inputs can be the steps of a series with the given fields. */
#ifndef PREP_SERIES_CHECK_H
#define PREP_SERIES_CHECK_H

#include <stdbool.h>

#include "formats/base/status.h"
#include "formats/leaf/leaf_writer.h"

/* series_check() - paths: one per step, or with in_file the one file that has all steps. ST_USAGE:
 * standard input would be read more than once, times do not ascend, or a name is given twice.
 * ST_UNSUPPORTED: more than LEAF_SETS_MAX fields times steps. */
CHECKED status series_check(const char *const *paths, bool in_file, const leaf_sets *sets);

#endif
