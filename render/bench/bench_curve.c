#include "render/bench/bench_curve.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "render/bench/bench_plot.h"

enum { LEFT = 80, TOP = 40, WIDTH = 560, HEIGHT = 380, BELOW = 50, LEGEND = 240, TICKS = 6 };

/* Apart also for those who see few colours: light to dark. */
static const char *const COLOURS[] = {"#d55e00", "#0072b2", "#009e73", "#cc79a7",
                                      "#e69f00", "#56b4e9", "#222222", "#8a6d3b"};
enum { COLOUR_COUNT = sizeof COLOURS / sizeof *COLOURS };
/* When they begin anew. */
static const char *const DASHES[] = {"", " stroke-dasharray=\"6 3\"", " stroke-dasharray=\"2 3\""};
enum { DASH_COUNT = sizeof DASHES / sizeof *DASHES };

typedef struct axis {
    int column;
    bool log;
    double lo, hi; /* log: powers of ten */
    double step;   /* between ticks; log: 0 for those at 1, 2 and 5 */
    bool below;    /* log: there are values that are not positive */
} axis;

static bool number(const bench_table *t, int row, int column, double *value) {
    char *end;
    *value = strtod(t->cell[row][column], &end);
    return end != t->cell[row][column] && isfinite(*value);
}

/* 1, 2 or 5 times a power of ten, at least x. */
static double round_step(double x) {
    const double power = pow(10.0, floor(log10(x)));
    return power * (x <= 1.0001 * power ? 1.0
                    : x <= 2.0 * power  ? 2.0
                    : x <= 5.0 * power  ? 5.0
                                        : 10.0);
}

static void round_linear(axis *a) {
    a->lo = fmin(a->lo, 0.0);
    a->hi = a->hi > a->lo ? a->hi : a->lo + 1.0;
    a->step = round_step((a->hi - a->lo) / TICKS);
    a->lo = a->step * floor(a->lo / a->step);
    a->hi = a->step * ceil(a->hi / a->step);
}

/* Ends at 1, 2 or 5 where that are few, else at powers of ten. */
static void round_log(axis *a) {
    if (a->hi - a->lo > 3.0) {
        a->lo = floor(a->lo);
        a->hi = ceil(a->hi);
        a->step = ceil((a->hi - a->lo) / (2 * TICKS));
        return;
    }
    a->hi = log10(round_step(pow(10.0, a->hi) * 0.9999));
    a->lo = -log10(round_step(pow(10.0, -a->lo) * 0.9999));
    if (a->hi <= a->lo)
        a->hi = a->lo + 1.0;
}

static axis axis_of(const bench_table *t, const char *heading, bool log) {
    axis a = {
        .column = bench_table_column(t, heading), .log = log, .lo = INFINITY, .hi = -INFINITY};
    for (int r = 0; a.column >= 0 && r < t->rows; r++) {
        double v;
        if (!number(t, r, a.column, &v))
            continue;
        if (log && !(v > 0.0)) {
            a.below = true;
            continue;
        }
        a.lo = fmin(a.lo, log ? log10(v) : v);
        a.hi = fmax(a.hi, log ? log10(v) : v);
    }
    if (!(a.lo <= a.hi))
        a.lo = 0.0, a.hi = 1.0;
    if (log)
        round_log(&a);
    else
        round_linear(&a);
    return a;
}

/* In [0, 1] along the axis. */
static double share_along(const axis *a, double value) {
    if (a->log)
        value = value > 0.0 ? log10(value) : a->lo;
    return fmin(fmax((value - a->lo) / (a->hi - a->lo), 0.0), 1.0);
}

static double x_at(const axis *a, double value) {
    return LEFT + WIDTH * share_along(a, value);
}

static double y_at(const axis *a, double value) {
    return TOP + HEIGHT * (1.0 - share_along(a, value));
}

static void print_tick(const axis *a, double value, bool upright, FILE *out) {
    const double x = upright ? LEFT : x_at(a, value);
    const double y = upright ? y_at(a, value) : TOP + HEIGHT;
    fprintf(out, "<path d=\"M%.1f %.1f%s%d\" stroke=\"#ddd\"/>\n", x, y, upright ? "h" : "v",
            upright ? WIDTH : -HEIGHT);
    fprintf(out, "<text x=\"%.1f\" y=\"%.1f\" text-anchor=\"%s\">%.3g</text>\n",
            upright ? x - 6 : x, upright ? y + 4 : y + 16, upright ? "end" : "middle", value);
}

static void print_ticks(const axis *a, bool upright, FILE *out) {
    static const double mantissas[] = {1.0, 2.0, 5.0};
    if (a->step > 0.0) {
        for (double at = a->lo; at <= a->hi + 1e-9 * a->step; at += a->step)
            print_tick(a, a->log ? pow(10.0, at) : at, upright, out);
        return;
    }
    for (double decade = floor(a->lo); decade <= a->hi; decade += 1.0)
        for (int i = 0; i < 3; i++) {
            const double at = decade + log10(mantissas[i]);
            if (at >= a->lo - 1e-9 && at <= a->hi + 1e-9)
                print_tick(a, pow(10.0, at), upright, out);
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

/* A point says which row it is when it is pointed at. */
static void draw_point(const bench_table *t, const bench_curve *c, const axis axes[2], int row,
                       const char *colour, FILE *out) {
    double x, y;
    if (!number(t, row, axes[0].column, &x) || !number(t, row, axes[1].column, &y))
        return;
    const int mark = bench_table_column(t, c->mark);
    const bool marked = mark >= 0 && strcmp(t->cell[row][mark], c->marked) == 0;
    fprintf(out, "<circle cx=\"%.1f\" cy=\"%.1f\" r=\"%d\" fill=\"%s\"%s><title>",
            x_at(&axes[0], x), y_at(&axes[1], y), marked ? 6 : 3, colour,
            marked ? " stroke=\"#000\" stroke-width=\"1.5\"" : "");
    bench_plot_label(t, row, c->labels, out);
    fprintf(out, "</title></circle>\n");
}

/* The line through a series, its points and its name in the legend. */
static void draw_series(const bench_table *t, const bench_curve *c, const axis axes[2], int first,
                        int nth, FILE *out) {
    const char *colour = COLOURS[nth % COLOUR_COUNT];
    char name[2 * BENCH_TEXT];
    bool begun = false;
    if (c->joined)
        fprintf(out, "<path fill=\"none\" stroke=\"%s\" stroke-width=\"1.5\"%s d=\"", colour,
                DASHES[nth / COLOUR_COUNT % DASH_COUNT]);
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
        char title[2 * BENCH_TEXT];
        snprintf(title, sizeof title, "%s%s", c->y, axes[1].below ? " (0: on the axis)" : "");
        bench_plot_text(out, LEFT, TOP - 14, "font-weight=\"bold\"", title);
        int nth = 0;
        for (int r = 0; r < t->rows; r++)
            if (first_of(t, c, r) == r)
                draw_series(t, c, axes, r, nth++, out);
    }
    bench_plot_close(out);
}
