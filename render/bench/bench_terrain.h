/* bench_terrain.h - the suite "terrain": a wood of tiles on a ground, on more and more of them (M08
 * 5.2.3, table 5.7). */
#ifndef RENDER_BENCH_BENCH_TERRAIN_H
#define RENDER_BENCH_BENCH_TERRAIN_H

#include "render/bench/bench_suite.h"

CHECKED status bench_terrain(bench_job *job);

extern const char bench_terrain_headings[];

#endif
