/* bench_time4d.h - the suite "time4d": one tree over treelets and time steps, by the order of its
 * splits, beside a tree for each step (M08 5.1.3, table 5.3). */
#ifndef RENDER_BENCH_BENCH_TIME4D_H
#define RENDER_BENCH_BENCH_TIME4D_H

#include "render/bench/bench_suite.h"

/* One row an order: memory; nodes and time of three questions; what they find, and whether that is
 * what a look at all ranges finds; and a frame, in which a question about one step is asked. */
CHECKED status bench_time4d(bench_job *job);

extern const char bench_time4d_headings[];

#endif
