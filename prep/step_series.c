#include "prep/step_series.h"

#include <math.h>
#include <string.h>

static status check_times(const leaf_sets *s) {
    for (uint32_t i = 0; s->times && i < s->steps; i++)
        if (!isfinite(s->times[i]) || (i > 0 && s->times[i] <= s->times[i - 1]))
            return status_describe(ST_USAGE, "times of steps must ascend, but step %u is at %g", i,
                                   s->times[i]);
    return ST_OK;
}

static status check_names(const leaf_sets *s) {
    for (uint32_t i = 0; s->names && i < s->fields; i++)
        for (uint32_t k = 0; k < i; k++)
            if (strcmp(s->names[i], s->names[k]) == 0)
                return status_describe(ST_USAGE, "the field \"%s\" is given twice", s->names[i]);
    return ST_OK;
}

status step_series_check(const step_series *s) {
    const uint64_t count = (uint64_t)s->sets.fields * s->sets.steps;
    if (count > LEAF_SETS_MAX)
        return status_describe(ST_UNSUPPORTED, "%u fields at %u steps: more than %d together",
                               s->sets.fields, s->sets.steps, LEAF_SETS_MAX);
    for (uint32_t i = 0; i < (s->in_file ? 1 : s->sets.steps); i++)
        if (strcmp(s->paths[i], "-") == 0 && count > 1)
            return status_describe(ST_USAGE, "standard input can be read only once, so it can be "
                                             "neither of several steps nor of several fields");
    status st = check_times(&s->sets);
    return st == ST_OK ? check_names(&s->sets) : st;
}

const char *step_series_path(const step_series *s, uint32_t step) {
    return s->paths[s->in_file ? 0 : step];
}

void step_series_seek(const step_series *s, uint32_t step, uint32_t *of_file) {
    if (s->in_file)
        *of_file = step_list_at(s->in_file, step);
}

const char *step_series_field(const step_series *s, uint32_t field) {
    return s->fields ? s->fields[field] : NULL;
}

bool step_series_follows(const step_series *s, uint32_t step) {
    return s->in_file && step > 0 &&
           step_list_at(s->in_file, step) == step_list_at(s->in_file, step - 1) + 1;
}
