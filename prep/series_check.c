#include "prep/series_check.h"

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

status series_check(const char *const *paths, bool in_file, const leaf_sets *s) {
    if ((uint64_t)s->fields * s->steps > LEAF_SETS_MAX)
        return status_describe(ST_UNSUPPORTED, "%u fields at %u steps: more than %d together",
                               s->fields, s->steps, LEAF_SETS_MAX);
    for (uint32_t i = 0; i < (in_file ? 1 : s->steps); i++)
        if (strcmp(paths[i], "-") == 0 && (uint64_t)s->fields * s->steps > 1)
            return status_describe(ST_USAGE, "standard input can be read only once, so it can be "
                                             "neither of several steps nor of several fields");
    status st = check_times(s);
    return st == ST_OK ? check_names(s) : st;
}
