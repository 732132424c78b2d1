#include "render/app/time_options.h"

#include <float.h>

#include "formats/base/cli_value.h"

status time_options_parse(const char *text, time_options *t) {
    t->given = t->names_time = true;
    return cli_finite(text, "--time", -DBL_MAX, DBL_MAX, &t->time);
}

void time_options_step(time_options *t) {
    t->given = false;
    t->names_step = true;
}

void time_options_inherit(time_options *t) {
    t->names_step = t->names_time = false;
}

status time_options_check(const time_options *t) {
    if (t->names_step && t->names_time)
        return status_describe(ST_USAGE, "either --step or --time: both say when");
    return ST_OK;
}

status time_options_find(time_options *t, const leafcast *volume, uint32_t *step) {
    t->between = 0.0;
    if (!t->given)
        return ST_OK;
    const status st = (status)leafcast_find_time(volume, t->time, step, &t->between);
    if (st != ST_OK || t->between == 0.0 || t->interpolate)
        return st;
    return status_describe(ST_USAGE,
                           "--time %g is between step %u at %g and the next one at %g: "
                           "--interpolate draws what is between",
                           t->time, *step, leafcast_step_time(volume, *step),
                           leafcast_step_time(volume, *step + 1));
}
