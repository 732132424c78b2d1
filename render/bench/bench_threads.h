/* bench_threads.h - how frames scale with threads, beside a loop that only computes. */
#ifndef RENDER_BENCH_BENCH_THREADS_H
#define RENDER_BENCH_BENCH_THREADS_H

#include "render/bench/bench_suite.h"

/* bench_threads() - the standard view with 1 to --threads threads and, between the frames, a loop
 * of arithmetic in registers with as many: what the machine gives. "frame/loop" is the frame's
 * scaling over the loop's, the median over the runs. */
CHECKED status bench_threads(bench_job *job);

#endif
