/* bench_plot.h - a benchmark's table as bars, in SVG. */
#ifndef RENDER_BENCH_BENCH_PLOT_H
#define RENDER_BENCH_BENCH_PLOT_H

#include <stdbool.h>
#include <stdio.h>

#include "render/bench/bench_table.h"

/* One chart: a bar a row. */
typedef struct bench_chart {
    const char *column; /* heading of the values */
    const char *spread; /* heading of their spread; NULL: none */
    bool log;           /* logarithmic: errors over many powers of ten; zeros have no bar */
} bench_chart;

/* bench_plot_open(), bench_plot_close(), bench_plot_text() - what a picture of any kind begins and
 * ends with; text with its attributes, escaped. */
void bench_plot_open(FILE *out, int width, int height);
void bench_plot_close(FILE *out);
void bench_plot_text(FILE *out, double x, double y, const char *style, const char *text);

/* bench_plot_label() - the first cells of a row, escaped, with commas between. */
void bench_plot_label(const bench_table *t, int row, int columns, FILE *out);

/* bench_plot() - the charts below each other; rows are labelled by the first label_columns cells.
 * Columns that are not there are left out. */
void bench_plot(const bench_table *t, int label_columns, const bench_chart *charts, int count,
                FILE *out);

#endif
