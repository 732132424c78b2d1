/* bench_time.h - the suite "time": a new time step in every frame, of grids by single rays and by
 * tiles (M08 tables 5.3 to 5.6), of meshes by both schemas (W07 8.5). */
#ifndef RENDER_BENCH_BENCH_TIME_H
#define RENDER_BENCH_BENCH_TIME_H

#include "render/bench/bench_suite.h"

/* One row a way and size: frames a second the first time through the series, later, and of a step
 * that stays; CPU time of a frame; bytes read a step, of all treelets that are kept, of the budget;
 * in how many pixels pictures differ from those of the step alone. */
CHECKED status bench_time(bench_job *job);

extern const char bench_time_headings[];

#endif
