/* bench_behind.h - the suite "behind": what surfaces behind the first one cost, and shadows. */
#ifndef RENDER_BENCH_BENCH_BEHIND_H
#define RENDER_BENCH_BENCH_BEHIND_H

#include "render/bench/bench_suite.h"

/* Four rows a volume, of the same view, drawn in turn: opaque; with a light (or those of the view)
 * and shadows; with opacity 0.3, two layers; the same with all layers. Times, also as multiples of
 * the opaque frame's; rays and surfaces that were met; in how many pixels distance or colour has
 * other bits than when each ray goes alone. */
CHECKED status bench_behind(bench_job *job);

#endif
