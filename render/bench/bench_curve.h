/* bench_curve.h - two columns of a benchmark's table against each other, in SVG. */
#ifndef RENDER_BENCH_BENCH_CURVE_H
#define RENDER_BENCH_BENCH_CURVE_H

#include <stdbool.h>
#include <stdio.h>

#include "render/bench/bench_table.h"

typedef struct bench_curve {
    const char *x, *y;         /* headings of the values */
    const char *series[2];     /* rows that agree in these columns make a series; NULL: none */
    bool log_x, log_y;         /* values that are not positive lie on the axis' lower end */
    bool joined;               /* a line through each series, in the order of the rows */
    int labels;                /* columns that name a row */
    const char *mark, *marked; /* rows that say `marked` in column `mark` stand out; may be NULL */
} bench_curve;

/* bench_curve_draw() - a whole SVG document. Rows without a number in x or y are left out. */
void bench_curve_draw(const bench_table *t, const bench_curve *curve, FILE *out);

#endif
