/* bench_baseline.h - the counts of a suite held against those that were written down.
 *
 * A baseline is CSV: case,quantity,expected,tolerance. A case is the cells that name a row, joined
 * by " / "; a quantity is a heading; the tolerance is a share of what is expected. Times have no
 * baseline.
 */
#ifndef RENDER_BENCH_BENCH_BASELINE_H
#define RENDER_BENCH_BENCH_BASELINE_H

#include <stdio.h>

#include "formats/base/mem.h"
#include "formats/base/status.h"
#include "render/bench/bench_table.h"

/* A column that counts something. */
typedef struct bench_count {
    const char *column; /* NULL ends a list */
    double tolerance;
} bench_count;

/* bench_baseline_write() - those columns of every row whose name is its first `keys` cells. Rows of
 * kernels that not every CPU with SIMD has are left out: all but "scalar" and "sse42" of a column
 * "isa". */
void bench_baseline_write(const bench_table *t, int keys, const bench_count *counts, FILE *out);

typedef struct bench_verdict {
    int within, off;
    int absent; /* of kernels that this CPU has not */
} bench_verdict;

/* bench_baseline_check() - ST_FAILED when one is off its tolerance or gone, naming the first;
 * ST_CORRUPT for a line that is none. */
CHECKED status bench_baseline_check(mem *m, const bench_table *t, int keys, const char *path,
                                    bench_verdict *verdict);

#endif
