/* time_options.h - the flags --time and --interpolate: a step by its time, or a time between steps.
 */
#ifndef RENDER_APP_TIME_OPTIONS_H
#define RENDER_APP_TIME_OPTIONS_H

#include "formats/base/status.h"
#include "render/leafcast.h"

typedef struct time_options {
    bool given, interpolate; /* --time and --interpolate were */
    bool names_step,
        names_time; /* one command line, line of a script or entry of a path has --step,
                       --time: it may not have both */
    double time;
    double
        between; /* found: so much of the way from the step to the next; 0 without --interpolate */
} time_options;

/* What verbs say of them in their tables. */
#define TIME_OPTIONS_TIME        "of several time steps: draw the one of this time, instead of --step"
#define TIME_OPTIONS_INTERPOLATE "--time may lie between two steps; all is then linear in time"

/* time_options_parse() - the value of --time. time_options_step() - --step is given: of both, the
 * last one counts, where a line of a script names another one than the command line.
 * time_options_inherit() - what comes next is another line or entry. time_options_check() -
 * ST_USAGE if one has both. */
CHECKED status time_options_parse(const char *text, time_options *t);
void time_options_step(time_options *t);
void time_options_inherit(time_options *t);
CHECKED status time_options_check(const time_options *t);

/* time_options_find() - find the step of the given time, and the share of the way to the next one.
 * Without
 * --time the step stays as it is. ST_USAGE outside of the volume's times; between steps without
 * --interpolate. */
CHECKED status time_options_find(time_options *t, const leafcast *volume, uint32_t *step);

#endif
