#include "render/bench/bench_plot.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { ROW = 18, LABEL = 300, BARS = 480, VALUE = 120, HEAD = 44, PAD = 12 };

static double value_of(const bench_table *t, int row, int column) {
    return column < 0 ? 0.0 : strtod(t->cell[row][column], NULL);
}

static void print_escaped(FILE *out, const char *text) {
    for (; *text; text++) {
        if (*text == '<' || *text == '&')
            fputs(*text == '<' ? "&lt;" : "&amp;", out);
        else
            fputc(*text, out);
    }
}

void bench_plot_open(FILE *out, int width, int height) {
    fprintf(out,
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%d\" height=\"%d\" "
            "font-family=\"sans-serif\" font-size=\"12\">\n"
            "<rect width=\"100%%\" height=\"100%%\" fill=\"#fff\"/>\n",
            width, height);
}

void bench_plot_close(FILE *out) {
    fputs("</svg>\n", out);
}

void bench_plot_text(FILE *out, double x, double y, const char *style, const char *text) {
    fprintf(out, "<text x=\"%.1f\" y=\"%.1f\" %s>", x, y, style);
    print_escaped(out, text);
    fputs("</text>\n", out);
}

void bench_plot_label(const bench_table *t, int row, int columns, FILE *out) {
    for (int c = 0; c < columns; c++) {
        fputs(c ? ", " : "", out);
        print_escaped(out, t->cell[row][c]);
    }
}

/* The values that bars begin and end at. */
static void range_of(const bench_table *t, const bench_chart *chart, int column, double range[2]) {
    range[0] = chart->log ? INFINITY : 0.0;
    range[1] = chart->log ? 0.0 : 1e-300;
    for (int r = 0; r < t->rows; r++) {
        const double x = value_of(t, r, column);
        range[1] = fmax(range[1], x);
        if (chart->log && x > 0.0)
            range[0] = fmin(range[0], x);
    }
    if (chart->log && !(range[0] < INFINITY))
        range[0] = range[1] = 1.0;
    if (chart->log) {
        range[0] = floor(log10(range[0])) - 1.0;
        range[1] = fmax(ceil(log10(range[1])), range[0] + 1.0);
    }
}

static void draw_row(const bench_table *t, int r, int labels, const bench_chart *chart, int column,
                     const double range[2], double y, FILE *out) {
    const double x = value_of(t, r, column);
    const double at = chart->log ? (x > 0.0 ? log10(x) : range[0]) : x;
    const double scale = BARS / (range[1] - range[0]);
    const double width = fmax(0.0, (at - range[0]) * scale);
    const double spread = value_of(t, r, bench_table_column(t, chart->spread)) * scale;
    fprintf(out, "<text x=\"%d\" y=\"%.1f\" text-anchor=\"end\">", LABEL - 6, y + 13);
    bench_plot_label(t, r, labels, out);
    fputs("</text>\n", out);
    fprintf(out, "<rect x=\"%d\" y=\"%.1f\" width=\"%.1f\" height=\"%d\" fill=\"#4a7ba6\"/>\n",
            LABEL, y + 2, width, ROW - 5);
    if (spread > 0.0 && !chart->log)
        fprintf(
            out,
            "<path d=\"M%.1f %.1fH%.1f\" stroke=\"#222\" stroke-width=\"1.5\" fill=\"none\"/>\n",
            LABEL + fmax(0.0, width - spread), y + 2 + (ROW - 5) / 2.0, LABEL + width + spread);
    bench_plot_text(out, LABEL + width + fmax(spread, 0.0) + 6, y + 13, "fill=\"#555\"",
                    t->cell[r][column]);
}

void bench_plot(const bench_table *t, int label_columns, const bench_chart *charts, int count,
                FILE *out) {
    const int height = PAD + count * (HEAD + t->rows * ROW);
    bench_plot_open(out, LABEL + BARS + VALUE, height);
    double y = PAD;
    for (int i = 0; i < count; i++) {
        const int column = bench_table_column(t, charts[i].column);
        if (column < 0)
            continue;
        double range[2];
        char title[BENCH_TEXT * 2];
        snprintf(title, sizeof title, "%s%s%s", charts[i].column,
                 charts[i].spread ? " (line: spread)" : "", charts[i].log ? " (logarithmic)" : "");
        range_of(t, &charts[i], column, range);
        bench_plot_text(out, LABEL, y + 20, "font-weight=\"bold\"", title);
        y += HEAD - PAD;
        for (int r = 0; r < t->rows; r++, y += ROW)
            draw_row(t, r, label_columns, &charts[i], column, range, y, out);
        y += PAD;
    }
    bench_plot_close(out);
}
