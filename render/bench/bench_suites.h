/* bench_suites.h - what `leafcast bench` can measure: the table of suites. */
#ifndef RENDER_BENCH_BENCH_SUITES_H
#define RENDER_BENCH_BENCH_SUITES_H

#include "render/bench/bench_suite.h"

/* bench_suite_at() - by index from 0 on; NULL behind the last. bench_suite_find() - by name, or
 * NULL. */
const bench_suite *bench_suite_at(int index);
const bench_suite *bench_suite_find(const char *name);

#endif
