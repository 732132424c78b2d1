#include "formats/surface/plc_table.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

#include "formats/base/num.h"
#include "formats/input/text_number.h"

enum { COLUMNS_MAX = 4096, CELL_MAX = 255 };

typedef struct table {
    plc_source *s;
    text_line line;
    uint64_t number; /* line number, from 1 */
    int axis[3];     /* columns, from 0 */
    int column;      /* column of the field; -1: none */
} table;

/* ---- cells ---- */

static bool is_blank(char c) {
    return c == ' ' || c == '\t';
}

static bool is_split(char c) {
    return c == ',' || c == ';';
}

/* Read the next cell of *at, without blanks and quotes around it, cut at CELL_MAX. Returns false at
 * the line's end. Blanks alone split cells, too. */
static bool next_cell(const char **at, char cell[CELL_MAX + 1]) {
    const char *p = *at;
    while (is_blank(*p))
        p++;
    cell[0] = 0;
    if (!*p || *p == '#')
        return false;
    const char *first = p;
    const bool quoted = *p == '"';
    for (p += quoted; *p && (quoted ? *p != '"' : !is_blank(*p) && !is_split(*p) && *p != '#'); p++)
        continue;
    first += quoted;
    snprintf(cell, CELL_MAX + 1, "%.*s", (int)(p - first < CELL_MAX ? p - first : CELL_MAX), first);
    p += quoted && *p;
    while (is_blank(*p))
        p++;
    *at = p + is_split(*p);
    return true;
}

static status next_row(table *t, bool *got) {
    const char *at;
    do {
        status st = byte_stream_line(t->s->data, &t->line, got);
        if (st != ST_OK || !*got)
            return st;
        t->number++;
        for (at = t->line.text; is_blank(*at); at++)
            continue;
    } while (!*at || *at == '#');
    return ST_OK;
}

static status bad_cell(const table *t, const char *cell, const char *expected) {
    return status_describe(ST_CORRUPT, "%s: line %llu: \"%.60s\", expected %s",
                           byte_stream_name(t->s->data), (unsigned long long)t->number, cell,
                           expected);
}

/* ---- the columns ---- */

/* Returns the axis that a column's name (x, X, Points:0, Points_0, ...) means, or -1. */
static int axis_named(const char *name) {
    static const char *const forms[] = {"%c", "points:%d", "points_%d"};
    for (int a = 0; a < 3; a++)
        for (int f = 0; f < 3; f++) {
            char want[16];
            snprintf(want, sizeof want, forms[f], f == 0 ? "xyz"[a] : a);
            if (strcasecmp(name, want) == 0)
                return a;
        }
    return -1;
}

static bool is_axis(const table *t, int column) {
    return column == t->axis[0] || column == t->axis[1] || column == t->axis[2];
}

static void take_column(table *t, int column, const char *name) {
    plc *x = t->s->out;
    t->column = column;
    snprintf(x->field, sizeof x->field, "%.*s", MESH_NAME_MAX, name);
}

/* Returns whether the field is "columnN" or "N", from 1, of this column. For tables without names.
 */
static bool column_numbered(const char *field, int column) {
    int64_t number = 0;
    const char *digits = strncmp(field, "column", 6) == 0 ? field + 6 : field;
    return num_int(digits, "", 1, COLUMNS_MAX, &number) == ST_OK && number == column + 1;
}

/* Read the first row, which has names, or numbers already. Chooses the field. */
static status choose_columns(table *t, bool *names) {
    const plc_hints *hints = &t->s->hints;
    const char *at = t->line.text;
    char cell[CELL_MAX + 1], name[CELL_MAX + 1];
    double number;
    int columns = 0, found[3] = {-1, -1, -1};
    *names = false;
    for (; next_cell(&at, cell); columns++) {
        const int axis = axis_named(cell);
        *names = *names || (cell[0] && !text_number_double(cell, &number));
        if (axis >= 0 && found[axis] < 0)
            found[axis] = columns;
    }
    if (columns < 3 || columns > COLUMNS_MAX)
        return bad_cell(t, t->line.text, "three columns or more: x, y, z");
    if (found[0] >= 0 && found[1] >= 0 && found[2] >= 0)
        memcpy(t->axis, found, sizeof found);
    at = t->line.text;
    for (int c = 0; c < columns && t->column < 0; c++) {
        if (!next_cell(&at, cell) || is_axis(t, c))
            continue;
        snprintf(name, sizeof name, "column%d", c + 1);
        if (!hints->field || (*names && strcmp(cell, hints->field) == 0) ||
            (!*names && column_numbered(hints->field, c)))
            take_column(t, c, *names && cell[0] ? cell : name);
    }
    if (hints->field && !hints->optional && t->column < 0)
        return status_describe(ST_UNSUPPORTED, "%s: no field \"%s\" among the %d columns",
                               byte_stream_name(t->s->data), hints->field, columns);
    return ST_OK;
}

/* ---- rows ---- */

static status read_row(table *t) {
    plc *x = t->s->out;
    const char *at = t->line.text;
    char cell[CELL_MAX + 1];
    double xyz[3] = {0}, value = (double)NAN, number;
    int seen = 0;
    for (int c = 0; next_cell(&at, cell); c++) {
        if (!is_axis(t, c) && c != t->column)
            continue;
        const bool empty = !cell[0] && c == t->column;
        if (!empty && !text_number_double(cell, &number))
            return bad_cell(t, cell, "a number");
        for (int a = 0; a < 3; a++)
            if (c == t->axis[a]) {
                xyz[a] = number;
                seen++;
            }
        if (c == t->column && !empty)
            value = number;
    }
    if (seen < 3)
        return bad_cell(t, t->line.text, "x, y and z");
    status st = plc_add_point(t->s, xyz, t->number);
    return st == ST_OK && t->column >= 0 ? plc_add(x, &x->values, &value, sizeof value) : st;
}

status plc_table_read(plc_source *s) {
    table t = {.s = s, .line = {.m = s->out->m}, .axis = {0, 1, 2}, .column = -1};
    bool got, names = false;
    status st = next_row(&t, &got);
    if (st == ST_OK && got)
        st = choose_columns(&t, &names);
    if (st == ST_OK && got && names)
        st = next_row(&t, &got);
    while (st == ST_OK && got) {
        st = read_row(&t);
        if (st == ST_OK)
            st = next_row(&t, &got);
    }
    byte_stream_line_release(&t.line);
    return st;
}
