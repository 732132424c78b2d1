/* progress.h - how long jobs report their progress, and are asked to stop.
 *
 * The library calls these functions, from any thread. The caller decides what to show: a bar, a log
 * line, nothing.
 */
#ifndef FORMATS_BASE_PROGRESS_H
#define FORMATS_BASE_PROGRESS_H

#include <stdbool.h>

#include "formats/base/status.h"

typedef struct progress {
    /* fraction: done of the whole job, not of the stage, in [0, 1]; may be NULL */
    void (*report)(void *ctx, const char *stage, double fraction);
    /* returns true to stop the job as soon as nothing half-done would stay behind; may be NULL */
    bool (*stop)(void *ctx);
    void *ctx;
} progress;

/* progress_step() - report, and ask whether to go on: ST_OK or ST_STOPPED. p may be NULL. */
CHECKED status progress_step(const progress *p, const char *stage, double fraction);

/* A job that is a part of another: from 0 to 1 of it is from `from` to `to` of that one. */
typedef struct progress_part {
    const progress *of; /* or NULL */
    double from, to;
} progress_part;

/* progress_of_part() - what such a job reports to, and asks. part: by reference. */
progress progress_of_part(progress_part *part);

/* progress_ask() - only ask. */
CHECKED status progress_ask(const progress *p, const char *stage);

#endif
