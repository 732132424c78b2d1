/* bench_projections.h - the suite "projections": the greatest, least, mean and first value on rays,
 * beside the opaque isosurface of the same view. */
#ifndef RENDER_BENCH_BENCH_PROJECTIONS_H
#define RENDER_BENCH_BENCH_PROJECTIONS_H

#include "render/bench/bench_suite.h"

/* Five rows a volume, drawn in turn: the isosurface, flat, and the projections, the first value
 * that reaches the isovalue among them. `x surface`: times as long; what each read, of what it
 * might have had to read, in a volume of its own; `differ`: in how many pixels value or place has
 * other bits than when each ray goes alone. One thread, medians of CPU time. */
CHECKED status bench_projections(bench_job *job);

#endif
