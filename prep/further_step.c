#include "prep/further_step.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "formats/base/num.h"

status further_step_refuse(const leaf_file *f, const char *input, const char *fmt, ...) {
    char text[STATUS_TEXT_MAX / 2];
    va_list args;
    va_start(args, fmt);
    vsnprintf(text, sizeof text, fmt, args);
    va_end(args);
    return status_describe(ST_USAGE, "%s: no further step of %s: %s", input, file_path(f->source),
                           text);
}

status further_step_check_field(const leaf_file *f, const char *input, uint32_t i,
                                const char *name) {
    const char *expected = leaf_file_field_name(f, i);
    if (!*name || !*expected || strcmp(name, expected) == 0)
        return ST_OK;
    return further_step_refuse(f, input, "field %u is %s, expected %s", i, name, expected);
}

static status check_fields(const leaf_file *f, const char *input, const leaf_sets *sets) {
    if (sets->fields != f->header.fields)
        return further_step_refuse(f, input, "%u fields are taken, expected %u", sets->fields,
                                   f->header.fields);
    status st = ST_OK;
    for (uint32_t i = 0; i < sets->fields && sets->names && st == ST_OK; i++)
        st = further_step_check_field(f, input, i, sets->names[i]);
    return st;
}

static status check_times(const leaf_file *f, const char *input, leaf_sets *sets) {
    char first[NUM_TEXT_MAX], last[NUM_TEXT_MAX];
    const double end = leaf_file_step_time(f, f->header.steps - 1);
    if (!f->has_times)
        sets->times = NULL;
    if (f->has_times && !sets->times)
        return further_step_refuse(f, input, "it has no time: --times gives it");
    if (!f->has_times || sets->times[0] > end)
        return ST_OK;
    return further_step_refuse(f, input, "its time %s is not behind the last one, %s",
                               num_print(sets->times[0], first), num_print(end, last));
}

status further_step_check(const leaf_file *f, const char *input, leaf_sets *sets) {
    status st = check_fields(f, input, sets);
    if (st == ST_OK && sets->steps > LEAF_SETS_MAX / sets->fields - f->header.steps)
        st = further_step_refuse(f, input, "it would have more than %d sets", LEAF_SETS_MAX);
    return st == ST_OK ? check_times(f, input, sets) : st;
}
