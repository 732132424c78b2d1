/* bench_table.h - what benchmarks share: rows of text with headings, as a table or as CSV; medians
 * with their spread. */
#ifndef RENDER_BENCH_BENCH_TABLE_H
#define RENDER_BENCH_BENCH_TABLE_H

#include <jansson.h>
#include <stdio.h>

#include "render/bench/bench_machine.h"

enum { BENCH_COLUMNS = 24, BENCH_ROWS = 512, BENCH_TEXT = 40 };

typedef struct bench_table {
    const char *title;
    char machine[BENCH_MACHINE_MAX]; /* bench_machine(); "": not told */
    int columns, rows, column;       /* column: of the row under way */
    char heading[BENCH_COLUMNS][BENCH_TEXT];
    char cell[BENCH_ROWS][BENCH_COLUMNS][BENCH_TEXT];
} bench_table;

/* bench_table_init() - headings separated by '|'. The title is kept by reference. */
void bench_table_init(bench_table *t, const char *title, const char *headings);

/* bench_table_add() - the next cell of the row under way; a full row ends by itself. */
void bench_table_add(bench_table *t, const char *fmt, ...) __attribute__((format(printf, 2, 3)));

/* bench_table_column() - by its heading; -1 when there is none such (or heading is NULL). */
int bench_table_column(const bench_table *t, const char *heading);

void bench_table_print(const bench_table *t, FILE *out);
void bench_table_csv(const bench_table *t, FILE *out);

/* bench_table_json() - {"suite": ..., "title": ..., "machine": ..., "rows": [{HEADING: CELL, ...},
 * ...]}, where cells that are numbers are numbers. NULL where there is no memory. */
json_t *bench_table_json(const bench_table *t, const char *suite);

/* bench_median() - of count >= 1 values, which are sorted; *spread, unless NULL: half the range of
 * the middle half. */
double bench_median(double *values, int count, double *spread);

#endif
