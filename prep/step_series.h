/* step_series.h - the fields and steps that a conversion takes, and where each is read: one file a
 * step, or the steps of one file. For every kind of data.
 */
#ifndef PREP_STEP_SERIES_H
#define PREP_STEP_SERIES_H

#include <stdbool.h>

#include "formats/base/status.h"
#include "formats/base/step_list.h"
#include "formats/leaf/leaf_writer.h"

typedef struct step_series {
    const char *const *paths;  /* of the steps, in order; one path if the steps are in a file */
    const step_list *in_file;  /* chosen steps of the first path's file; NULL: one step per path */
    leaf_sets sets;            /* names may be NULL for one field: the reader's hints choose it */
    const char *const *fields; /* the names as the input spells them; NULL: the hints choose */
} step_series;

/* step_series_check() - ST_USAGE: standard input would be read more than once, times do not ascend,
 * or a name is given twice. ST_UNSUPPORTED: more than LEAF_SETS_MAX fields times steps. */
CHECKED status step_series_check(const step_series *s);

/* step_series_path() - the file of a step.
 * step_series_seek() - set *step to the file's own number of a step, if it has several.
 * step_series_field() - a field as the input spells it; NULL: the hints choose. */
const char *step_series_path(const step_series *s, uint32_t step);
void step_series_seek(const step_series *s, uint32_t step, uint32_t *of_file);
const char *step_series_field(const step_series *s, uint32_t field);

/* step_series_follows() - whether a step is the next one in the same file as the step before. */
bool step_series_follows(const step_series *s, uint32_t step);

#endif
