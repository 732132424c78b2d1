#include "render/bench/bench_baseline.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "formats/base/file.h"

enum { CASE = 256 };
static const double ROUNDING = 0.00051; /* of a table's third decimal */
static const char HEADER[] = "case,quantity,expected,tolerance";

static void case_of(const bench_table *t, int keys, int row, char name[CASE]) {
    name[0] = 0;
    for (int c = 0; c < keys; c++)
        strcat(strcat(name, c ? " / " : ""), t->cell[row][c]);
}

void bench_baseline_write(const bench_table *t, int keys, const bench_count *counts, FILE *out) {
    const int isa = bench_table_column(t, "isa");
    fprintf(out, "%s\n", HEADER);
    for (int r = 0; r < t->rows; r++) {
        char name[CASE];
        if (isa >= 0 && strcmp(t->cell[r][isa], "scalar") != 0 &&
            strcmp(t->cell[r][isa], "sse42") != 0)
            continue;
        case_of(t, keys, r, name);
        for (const bench_count *c = counts; c->column; c++) {
            const int column = bench_table_column(t, c->column);
            if (column >= 0 && strcmp(t->cell[r][column], "-") != 0)
                fprintf(out, "%s,%s,%s,%g\n", name, c->column, t->cell[r][column], c->tolerance);
        }
    }
}

/* ---- checking ---- */

typedef struct expectation {
    char name[CASE], quantity[BENCH_TEXT];
    double value, tolerance;
} expectation;

static bool read_line(const char *line, expectation *e) {
    return sscanf(line, "%255[^,],%39[^,],%lf,%lf", e->name, e->quantity, &e->value,
                  &e->tolerance) == 4;
}

/* Whether the case is one of kernels that no row of the table is about. */
static bool is_elsewhere(const bench_table *t, const char *name) {
    const int isa = bench_table_column(t, "isa");
    bool here = false, about = strstr(name, "sse42") != NULL;
    for (int r = 0; isa >= 0 && r < t->rows; r++)
        here |= strcmp(t->cell[r][isa], "sse42") == 0;
    return about && !here;
}

/* The cell that an expectation is about; NULL when it is not in the table. */
static const char *cell_of(const bench_table *t, int keys, const expectation *e) {
    const int column = bench_table_column(t, e->quantity);
    for (int r = 0; column >= 0 && r < t->rows; r++) {
        char name[CASE];
        case_of(t, keys, r, name);
        if (strcmp(name, e->name) == 0)
            return t->cell[r][column];
    }
    return NULL;
}

static void hold(const bench_table *t, int keys, const expectation *e, bench_verdict *v,
                 status *st) {
    const char *cell = cell_of(t, keys, e);
    if (!cell && is_elsewhere(t, e->name)) {
        v->absent++;
        return;
    }
    const double value = cell ? strtod(cell, NULL) : (double)NAN;
    if (fabs(value - e->value) <= fabs(e->value) * e->tolerance + ROUNDING) {
        v->within++;
        return;
    }
    if (v->off++ == 0)
        *st =
            status_describe(ST_FAILED, "%s: %s is %s, expected %g within %g %%", e->name,
                            e->quantity, cell ? cell : "not there", e->value, 100.0 * e->tolerance);
}

/* The file as text that ends in 0. */
static status read_text(mem *m, const char *path, char **text) {
    file *f = NULL;
    *text = NULL;
    status st = file_open(m, path, &f);
    if (st == ST_OK) {
        *text = mem_zalloc(m, (size_t)file_size(f) + 1);
        st = *text ? file_read_at(f, 0, *text, (size_t)file_size(f)) : ST_NOMEM;
    }
    file_close(f);
    return st;
}

status bench_baseline_check(mem *m, const bench_table *t, int keys, const char *path,
                            bench_verdict *verdict) {
    char *text = NULL, *rest = NULL;
    status verdict_st = ST_OK, st = read_text(m, path, &text);
    int number = 0;
    *verdict = (bench_verdict){0};
    for (char *line = text ? strtok_r(text, "\n", &rest) : NULL; line && st == ST_OK;
         line = strtok_r(NULL, "\n", &rest)) {
        expectation e;
        if (number++ == 0)
            st =
                strcmp(line, HEADER) == 0
                    ? ST_OK
                    : status_describe(ST_CORRUPT, "%s: expected a first line \"%s\"", path, HEADER);
        else if (!read_line(line, &e))
            st = status_describe(ST_CORRUPT, "%s: line %d: expected %s", path, number, HEADER);
        else
            hold(t, keys, &e, verdict, &verdict_st);
    }
    mem_free(m, text);
    return st == ST_OK ? verdict_st : st;
}
