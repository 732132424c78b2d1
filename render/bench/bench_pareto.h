/* bench_pareto.h - what error buys: intersector x level of detail x pixels, time against error. */
#ifndef RENDER_BENCH_BENCH_PARETO_H
#define RENDER_BENCH_BENCH_PARETO_H

#include "render/bench/bench_suite.h"

/* bench_pareto() - every combination against the exact picture (marmitt, full resolution, all
 * pixels): how far off the surfaces are that both see, in cells, and how many of its pixels see
 * one where the other does not. A pixel of a smaller picture stands for those that it covers. On
 * the front is what no other beats in time, distance and wrong pixels at once. */
CHECKED status bench_pareto(bench_job *job);

#endif
