/* bench_walk.h - experiments E1 (below 4^3) and E2 (float filter) on a treelet file. */
#ifndef RENDER_BENCH_BENCH_WALK_H
#define RENDER_BENCH_BENCH_WALK_H

#include "formats/base/mem.h"
#include "formats/base/status.h"
#include "render/app/view_options.h"
#include "render/bench/bench_table.h"

extern const char bench_walk_headings[];
extern const char bench_filter_headings[];

/* bench_walk() - E1: the same picture with every treelet resident, by masks of active cells, by 2^3
 * groups, by 8-corner tests, interleaved. Adds one row a kernel. The pictures' depths are compared
 * bit by bit: ST_FAILED when they differ. */
CHECKED status bench_walk(mem *m, const char *path, const view_options *view, int runs,
                          bench_table *t);

/* bench_filter() - E2: all-double cell kernel against a float filter in front of it. Adds one row.
 */
CHECKED status bench_filter(const char *path, const view_options *view, bench_table *t);

#endif
