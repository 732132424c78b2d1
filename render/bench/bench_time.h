/* bench_time.h - the suite "time": a new time step in every frame, by both schemas (W07 8.5). */
#ifndef RENDER_BENCH_BENCH_TIME_H
#define RENDER_BENCH_BENCH_TIME_H

#include "render/bench/bench_suite.h"

/* One row a schema: frames a second the first time through the series, later, and of a step that
 * stays; CPU time of a frame; bytes read a step, of all treelets that are kept, of the budget. */
CHECKED status bench_time(bench_job *job);

extern const char bench_time_headings[];

#endif
