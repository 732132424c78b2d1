#include "render/bench/bench_table.h"

#include <assert.h>
#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include "formats/base/num.h"

void bench_table_init(bench_table *t, const char *title, const char *headings) {
    memset(t, 0, sizeof *t);
    t->title = title;
    for (const char *at = headings;; at++) {
        const size_t n = strcspn(at, "|");
        assert(t->columns < BENCH_COLUMNS);
        snprintf(t->heading[t->columns++], BENCH_TEXT, "%.*s", (int)n, at);
        at += n;
        if (!*at)
            break;
    }
}

void bench_table_add(bench_table *t, const char *fmt, ...) {
    assert(t->rows < BENCH_ROWS);
    va_list args;
    va_start(args, fmt);
    vsnprintf(t->cell[t->rows][t->column], BENCH_TEXT, fmt, args);
    va_end(args);
    if (++t->column == t->columns) {
        t->column = 0;
        t->rows++;
    }
}

int bench_table_column(const bench_table *t, const char *heading) {
    for (int c = 0; heading && c < t->columns; c++)
        if (strcmp(t->heading[c], heading) == 0)
            return c;
    return -1;
}

/* The first column to the left, numbers to the right. */
static void print_row(const bench_table *t, const char (*cells)[BENCH_TEXT], const int *widths,
                      FILE *out) {
    for (int c = 0; c < t->columns; c++)
        fprintf(out, c == 0 ? "%-*s" : "  %*s", widths[c], cells[c]);
    fputc('\n', out);
}

void bench_table_print(const bench_table *t, FILE *out) {
    int widths[BENCH_COLUMNS];
    for (int c = 0; c < t->columns; c++) {
        widths[c] = (int)strlen(t->heading[c]);
        for (int r = 0; r < t->rows; r++)
            if ((int)strlen(t->cell[r][c]) > widths[c])
                widths[c] = (int)strlen(t->cell[r][c]);
    }
    fprintf(out, "%s\n", t->title);
    if (t->machine[0])
        fprintf(out, "%s\n", t->machine);
    fputc('\n', out);
    print_row(t, t->heading, widths, out);
    for (int r = 0; r < t->rows; r++)
        print_row(t, t->cell[r], widths, out);
    fputc('\n', out);
}

static void csv_row(const bench_table *t, const char (*cells)[BENCH_TEXT], FILE *out) {
    for (int c = 0; c < t->columns; c++)
        fprintf(out, "%s%s", c ? "," : "", cells[c]);
    fputc('\n', out);
}

void bench_table_csv(const bench_table *t, FILE *out) {
    csv_row(t, t->heading, out);
    for (int r = 0; r < t->rows; r++)
        csv_row(t, t->cell[r], out);
}

/* "n/a", "-" and the like stay text. */
static json_t *cell_json(const char *text) {
    double value = 0.0;
    if (num_double(text, "", &value) != ST_OK || !isfinite(value))
        return json_string(text);
    return json_real(value);
}

json_t *bench_table_json(const bench_table *t, const char *suite) {
    json_t *rows = json_array();
    for (int r = 0; r < t->rows; r++) {
        json_t *row = json_object();
        for (int c = 0; c < t->columns; c++)
            json_object_set_new(row, t->heading[c], cell_json(t->cell[r][c]));
        json_array_append_new(rows, row);
    }
    return json_pack("{s:s, s:s, s:s, s:o}", "suite", suite, "title", t->title, "machine",
                     t->machine, "rows", rows);
}

static int by_value(const void *a, const void *b) {
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

double bench_median(double *values, int count, double *spread) {
    qsort(values, (size_t)count, sizeof *values, by_value);
    if (spread)
        *spread = 0.5 * (values[count - 1 - count / 4] - values[count / 4]);
    return count % 2 ? values[count / 2] : 0.5 * (values[count / 2 - 1] + values[count / 2]);
}
