/* bench_lanes.h - the suite "lanes": how full the vectors of tiles' kernels are. */
#ifndef RENDER_BENCH_BENCH_LANES_H
#define RENDER_BENCH_BENCH_LANES_H

#include "render/bench/bench_suite.h"

/* A row a stage of a kernel (lane_counts.h) and an ISA: vectors that were not empty, lanes that
 * were filled. By kernels that count, in one thread; what they draw is not timed. */
CHECKED status bench_lanes(bench_job *job);

#endif
