/* progress.h - how long jobs say how far they are, and are asked to stop.
 *
 * The library calls back; what becomes of it (a bar, a log line, nothing) is the caller's affair.
 * May be called from any thread.
 */
#ifndef FORMATS_BASE_PROGRESS_H
#define FORMATS_BASE_PROGRESS_H

#include <stdbool.h>

#include "formats/base/status.h"

typedef struct progress {
    /* fraction of the whole job in [0, 1], not of the stage; may be NULL */
    void (*report)(void *ctx, const char *stage, double fraction);
    /* true: stop as soon as nothing half-done stays behind; may be NULL */
    bool (*stop)(void *ctx);
    void *ctx;
} progress;

/* progress_step() - report and look whether to go on: ST_OK or ST_STOPPED. p may be NULL. */
CHECKED status progress_step(const progress *p, const char *stage, double fraction);

#endif
