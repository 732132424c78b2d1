#include "render/bench_curve.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "render/bench_plot.h"

enum { LEFT = 80, TOP = 40, WIDTH = 560, HEIGHT = 380, BELOW = 50, LEGEND = 240, TICKS = 6 };

/* Apart also for those who see few colours: light to dark. */
static const char *const COLOURS[] = {"#d55e00", "#0072b2", "#009e73", "#cc79a7",
                                      "#e69f00", "#56b4e9", "#222222", "#8a6d3b"};
enum { COLOUR_COUNT = sizeof COLOURS / sizeof *COLOURS };

typedef struct axis {
    int column;
    bool log;
    double lo, hi; /* log: powers of ten */
} axis;

static bool number(const bench_table *t, int row, int column, double *value) {
    char *end;
    *value = strtod(t->cell[row][column], &end);
    return end != t->cell[row][column] && isfinite(*value);
}

static axis axis_of(const bench_table *t, const char *heading, bool log) {
    axis a = {bench_table_column(t, heading), log, INFINITY, -INFINITY};
    for (int r = 0; a.column >= 0 && r < t->rows; r++) {
        double v;
        if (!number(t, r, a.column, &v) || (log && !(v > 0.0)))
            continue;
        a.lo = fmin(a.lo, log ? log10(v) : v);
        a.hi = fmax(a.hi, log ? log10(v) : v);
    }
    if (!(a.lo <= a.hi))
        a.lo = 0.0, a.hi = 1.0;
    if (log) {
        a.lo = floor(a.lo - 1e-9);
        a.hi = fmax(ceil(a.hi + 1e-9), a.lo + 1.0);
    } else {
        a.lo = fmin(a.lo, 0.0);
        a.hi = a.hi > a.lo ? a.hi + 0.05 * (a.hi - a.lo) : a.lo + 1.0;
    }
    return a;
}

/* In [0, 1] along the axis. */
static double place(const axis *a, double value) {
    if (a->log)
        value = value > 0.0 ? log10(value) : a->lo;
    return fmin(fmax((value - a->lo) / (a->hi - a->lo), 0.0), 1.0);
}

static double x_at(const axis *a, double value) {
    return LEFT + WIDTH * place(a, value);
}

static double y_at(const axis *a, double value) {
    return TOP + HEIGHT * (1.0 - place(a, value));
}

static void print_ticks(const axis *a, bool upright, FILE *out) {
    const double step = a->log ? fmax(1.0, ceil((a->hi - a->lo) / TICKS)) : (a->hi - a->lo) / TICKS;
    for (double at = a->lo; at <= a->hi + 1e-9 * step; at += step) {
        const double value = a->log ? pow(10.0, at) : at;
        const double x = upright ? LEFT : x_at(a, value);
        const double y = upright ? y_at(a, value) : TOP + HEIGHT;
        fprintf(out, "<path d=\"M%.1f %.1f%s\" stroke=\"#ddd\"/>\n", x, y,
                upright ? "h560" : "v-380");
        fprintf(out, "<text x=\"%.1f\" y=\"%.1f\" text-anchor=\"%s\">%.3g</text>\n",
                upright ? x - 6 : x, upright ? y + 4 : y + 16, upright ? "end" : "middle", value);
    }
}

static void series_of(const bench_table *t, const bench_curve *c, int row,
                      char name[2 * BENCH_TEXT]) {
    name[0] = 0;
    for (int i = 0; i < 2; i++) {
        const int column = bench_table_column(t, c->series[i]);
        if (column >= 0)
            strcat(strcat(name, name[0] ? ", " : ""), t->cell[row][column]);
    }
}

/* The first row of the same series. */
static int first_of(const bench_table *t, const bench_curve *c, int row) {
    char mine[2 * BENCH_TEXT], other[2 * BENCH_TEXT];
    series_of(t, c, row, mine);
    for (int r = 0; r < row; r++) {
        series_of(t, c, r, other);
        if (strcmp(mine, other) == 0)
            return r;
    }
    return row;
}

static void draw_point(const bench_table *t, const bench_curve *c, const axis axes[2], int row,
                       const char *colour, FILE *out) {
    double x, y;
    if (!number(t, row, axes[0].column, &x) || !number(t, row, axes[1].column, &y))
        return;
    const int mark = bench_table_column(t, c->mark);
    const bool marked = mark >= 0 && strcmp(t->cell[row][mark], c->marked) == 0;
    fprintf(out, "<circle cx=\"%.1f\" cy=\"%.1f\" r=\"%d\" fill=\"%s\"%s/>\n", x_at(&axes[0], x),
            y_at(&axes[1], y), marked ? 6 : 3, colour,
            marked ? " stroke=\"#000\" stroke-width=\"1.5\"" : "");
}

/* The line through a series, its points and its name in the legend. */
static void draw_series(const bench_table *t, const bench_curve *c, const axis axes[2], int first,
                        int nth, FILE *out) {
    const char *colour = COLOURS[nth % COLOUR_COUNT];
    char name[2 * BENCH_TEXT];
    bool begun = false;
    if (c->joined)
        fprintf(out, "<path fill=\"none\" stroke=\"%s\" stroke-width=\"1.5\" d=\"", colour);
    for (int r = first; c->joined && r < t->rows; r++) {
        double x, y;
        if (first_of(t, c, r) != first || !number(t, r, axes[0].column, &x) ||
            !number(t, r, axes[1].column, &y))
            continue;
        fprintf(out, "%s%.1f %.1f", begun ? "L" : "M", x_at(&axes[0], x), y_at(&axes[1], y));
        begun = true;
    }
    if (c->joined)
        fprintf(out, "\"/>\n");
    for (int r = first; r < t->rows; r++)
        if (first_of(t, c, r) == first)
            draw_point(t, c, axes, r, colour, out);
    series_of(t, c, first, name);
    const double y = TOP + 10 + 18.0 * nth;
    fprintf(out, "<circle cx=\"%d\" cy=\"%.1f\" r=\"4\" fill=\"%s\"/>\n", LEFT + WIDTH + 16, y - 4,
            colour);
    bench_plot_text(out, LEFT + WIDTH + 26, y, "", name);
}

void bench_curve_draw(const bench_table *t, const bench_curve *c, FILE *out) {
    const axis axes[2] = {axis_of(t, c->x, c->log_x), axis_of(t, c->y, c->log_y)};
    int count = 0;
    for (int r = 0; r < t->rows; r++)
        count += first_of(t, c, r) == r;
    const int legend = TOP + 18 * (count + 1), chart = TOP + HEIGHT + BELOW;
    bench_plot_open(out, LEFT + WIDTH + LEGEND, legend > chart ? legend : chart);
    if (axes[0].column >= 0 && axes[1].column >= 0) {
        print_ticks(&axes[0], false, out);
        print_ticks(&axes[1], true, out);
        fprintf(out, "<path d=\"M%d %dV%dH%d\" fill=\"none\" stroke=\"#000\"/>\n", LEFT, TOP,
                TOP + HEIGHT, LEFT + WIDTH);
        bench_plot_text(out, LEFT + WIDTH / 2.0, TOP + HEIGHT + 38, "text-anchor=\"middle\"", c->x);
        bench_plot_text(out, LEFT, TOP - 14, "font-weight=\"bold\"", c->y);
        int nth = 0;
        for (int r = 0; r < t->rows; r++)
            if (first_of(t, c, r) == r)
                draw_series(t, c, axes, r, nth++, out);
    }
    bench_plot_close(out);
}
