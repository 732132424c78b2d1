/* clock.h - time, for statistics and progress. No computed result depends on it. */
#ifndef FORMATS_BASE_CLOCK_H
#define FORMATS_BASE_CLOCK_H

#include <time.h>

static inline double clock_read(clockid_t which) {
    struct timespec t;
    clock_gettime(which, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* clock_seconds() - wall-clock seconds since an arbitrary start. */
static inline double clock_seconds(void) {
    return clock_read(CLOCK_MONOTONIC);
}

/* clock_cpu_seconds() - CPU seconds that all threads of this process have used. */
static inline double clock_cpu_seconds(void) {
    return clock_read(CLOCK_PROCESS_CPUTIME_ID);
}

#endif
