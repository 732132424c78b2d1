/* bench_frames.h - suites that draw whole frames, by every kernel there is: steps, frames,
 * figure414, zoom. */
#ifndef RENDER_BENCH_BENCH_FRAMES_H
#define RENDER_BENCH_BENCH_FRAMES_H

#include "render/bench/bench_suite.h"

/* M08 table 4.1: traversal steps of single rays against those of tiles, by picture size. */
CHECKED status bench_steps(bench_job *job);

/* M08 table 4.7: frames of all volumes, standard and close view. */
CHECKED status bench_frames(bench_job *job);

/* M08 figure 4.14: the same field on 32^3 to 1024^3 samples, all in one race. */
CHECKED status bench_figure414(bench_job *job);

/* Experiment E4: from far, near and inside, at zoom 0.5 to 50. */
CHECKED status bench_zoom(bench_job *job);

#endif
