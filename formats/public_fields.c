#include "formats/public_fields.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "formats/public_status.h"

/* Where a value is in a struct: a path of names, from the innermost outwards. */
typedef struct place {
    const struct place *in;
    const char *name;
    size_t index;
    bool indexed;
} place;

enum { PLACE_TEXT = 256 };

static void print_place(const place *p, char text[PLACE_TEXT]) {
    text[0] = '\0';
    if (p->in)
        print_place(p->in, text);
    const size_t at = strlen(text);
    snprintf(text + at, PLACE_TEXT - at, "%s%s", p->in ? "." : "", p->name);
    const size_t end = strlen(text);
    if (p->indexed)
        snprintf(text + end, PLACE_TEXT - end, "[%zu]", p->index);
}

/* ---- Numbers ---- */

size_t public_fields_width(public_type type) {
    static const size_t widths[PUBLIC_TYPES] = {[PUBLIC_SIZE] = sizeof(size_t),
                                                [PUBLIC_BOOL] = 1,
                                                [PUBLIC_INT] = sizeof(int),
                                                [PUBLIC_UINT32] = 4,
                                                [PUBLIC_UINT64] = 8,
                                                [PUBLIC_FLOAT] = sizeof(float),
                                                [PUBLIC_DOUBLE] = sizeof(double),
                                                [PUBLIC_POINTER] = sizeof(void *),
                                                [PUBLIC_ANYTHING] = sizeof(void *)};
    return widths[type];
}

/* Copies bytes, since they may be no valid value of the member's type. */
static double number_at(public_type type, const char *at) {
    union {
        uint8_t byte;
        int whole;
        uint32_t u32;
        uint64_t u64;
        float f32;
        double f64;
    } x;
    memcpy(&x, at, public_fields_width(type));
    switch (type) {
    case PUBLIC_BOOL: return x.byte;
    case PUBLIC_INT: return x.whole;
    case PUBLIC_UINT32: return x.u32;
    case PUBLIC_UINT64: return (double)x.u64;
    case PUBLIC_FLOAT: return (double)x.f32;
    default: return x.f64;
    }
}

static bool is_possible(const public_field *row, double x) {
    if (row->how & PUBLIC_OR_ZERO && x == 0.0)
        return true;
    return (row->how & PUBLIC_ABOVE ? x > row->least : x >= row->least) &&
           (row->how & PUBLIC_BELOW ? x < row->most : x <= row->most);
}

static status refuse_number(const public_field *row, const place *at, double x) {
    char text[PLACE_TEXT], range[128];
    print_place(at, text);
    const char *zero = row->how & PUBLIC_OR_ZERO ? "0, or " : "";
    if (row->type == PUBLIC_BOOL)
        return status_describe(ST_USAGE, "%s is neither true nor false", text);
    const double whole = row->type == PUBLIC_FLOAT ? (double)FLT_MAX : DBL_MAX;
    if (row->most == whole && row->least == -whole)
        snprintf(range, sizeof range, "a finite number");
    else if (row->most == whole)
        snprintf(range, sizeof range, "%sa finite number from %.10g on", zero, row->least);
    else
        snprintf(range, sizeof range, "%s%s%.10g to %s%.10g", zero,
                 row->how & PUBLIC_ABOVE ? "above " : "", row->least,
                 row->how & PUBLIC_BELOW ? "below " : "", row->most);
    return status_describe(ST_USAGE, "%s is %.10g: %s is possible", text, x, range);
}

static status check_numbers(const public_field *row, const char *at, size_t count,
                            const place *where) {
    for (size_t i = 0; i < count; i++) {
        const double x = number_at(row->type, at + i * public_fields_width(row->type));
        const place here = {where->in, where->name, i, count > 1};
        if (!is_possible(row, x))
            return refuse_number(row, &here, x);
    }
    return ST_OK;
}

static status check_direction(const public_field *row, const char *at, const place *where) {
    char text[PLACE_TEXT];
    double most = 0.0;
    bool finite = true;
    for (uint32_t i = 0; i < row->values; i++) {
        const double x = fabs(number_at(row->type, at + i * public_fields_width(row->type)));
        finite = finite && x <= row->most;
        most = fmax(most, x);
    }
    if (finite && most >= row->least)
        return ST_OK;
    print_place(where, text);
    return status_describe(ST_USAGE,
                           "%s is no direction: its largest component must be %g to %g, up or down",
                           text, row->least, row->most);
}

/* ---- Pointers and arrays ---- */

static const public_field *row_named(const public_fields *table, const char *name) {
    for (int i = 0; i < table->count; i++)
        if (strcmp(table->rows[i].name, name) == 0)
            return &table->rows[i];
    return NULL;
}

/* How many elements a row has. Its counter says so, and was checked before. */
static size_t elements_of(const public_fields *table, const public_field *row, const char *of) {
    if (!row->counted_by)
        return 1;
    const public_field *counter = row_named(table, row->counted_by);
    return (size_t)number_at(counter->type, of + counter->offset);
}

static status check_struct(const public_fields *table, const char *of, const place *where);

static status check_structs(const public_fields *table, const char *at, size_t count, bool indexed,
                            const place *where) {
    status st = ST_OK;
    for (size_t i = 0; i < count && st == ST_OK; i++) {
        const place here = {where->in, where->name, i, indexed};
        st = check_struct(table, at + i * table->size, &here);
    }
    return st;
}

static status refuse_null(const public_field *row, const place *where, size_t count) {
    char text[PLACE_TEXT];
    print_place(where, text);
    if (!row->counted_by)
        return status_describe(ST_USAGE, "%s is NULL", text);
    return status_describe(ST_USAGE, "%s is NULL, and %s is %zu", text, row->counted_by, count);
}

static status check_pointer(const public_field *row, const char *at, size_t count,
                            const place *where) {
    const void *to;
    memcpy(&to, at, sizeof to);
    if (count == 0 || (!to && row->how & PUBLIC_OR_NULL))
        return ST_OK;
    if (!to)
        return refuse_null(row, where, count);
    if (row->element)
        return check_structs(row->element, to, count, row->counted_by != NULL, where);
    return row->number ? check_numbers(row->number, to, count * row->number->values, where) : ST_OK;
}

static status check_pointers(const public_field *row, const char *at, size_t count,
                             const place *where) {
    status st = ST_OK;
    for (uint32_t i = 0; i < row->values && st == ST_OK; i++) {
        const place here = {where->in, where->name, i, row->values > 1};
        st = check_pointer(row, at + i * sizeof(void *), count, &here);
    }
    return st;
}

/* ---- Structs ---- */

static status check_size(const public_fields *table, const char *at, const place *where) {
    char text[PLACE_TEXT];
    size_t given;
    memcpy(&given, at, sizeof given);
    if (given == table->size)
        return ST_OK;
    print_place(where, text);
    *strrchr(text, '.') = '\0'; /* public_size() adds ".size" */
    return public_size(text, given, table->size);
}

static status check_row(const public_fields *table, const public_field *row, const char *of,
                        const place *in) {
    const place where = {in, row->name, 0, false};
    const char *at = of + row->offset;
    const size_t count = elements_of(table, row, of);
    switch (row->type) {
    case PUBLIC_ANYTHING: return ST_OK;
    case PUBLIC_SIZE: return check_size(table, at, &where);
    case PUBLIC_POINTER: return check_pointers(row, at, count, &where);
    case PUBLIC_STRUCT:
        return check_structs(row->element, at, count, row->counted_by != NULL, &where);
    default: break;
    }
    return row->how & PUBLIC_DIRECTION ? check_direction(row, at, &where)
                                       : check_numbers(row, at, count * row->values, &where);
}

static status check_struct(const public_fields *table, const char *of, const place *where) {
    status st = ST_OK;
    for (int i = 0; i < table->count && st == ST_OK; i++)
        st = check_row(table, &table->rows[i], of, where);
    return st == ST_OK && table->together ? table->together(of) : st;
}

status public_fields_check(const public_fields *table, const void *of) {
    const place where = {.name = table->name};
    size_t size;
    if (!table->written)
        return check_struct(table, of, &where);
    memcpy(&size, of, sizeof size);
    return public_size(table->name, size, table->size);
}

status public_fields_check_all(const public_fields *table, const void *of, size_t count) {
    const place where = {.name = table->name};
    return check_structs(table, of, count, true, &where);
}

/* ---- Calls ---- */

status public_needs(const char *call, const char *names, const void *const pointers[]) {
    for (int i = 0; *names; i++) {
        const int length = (int)strcspn(names, " ");
        if (!pointers[i])
            return status_describe(ST_USAGE, "%s(): %.*s is NULL", call, length, names);
        names += length + (names[length] == ' ');
    }
    return ST_OK;
}

status public_in_range(const char *call, const char *name, double value, double least,
                       double most) {
    if (value >= least && value <= most)
        return ST_OK;
    return status_describe(ST_USAGE, "%s(): %s is %.10g: %.10g to %.10g is possible", call, name,
                           value, least, most);
}

status public_below(const char *call, const char *name, double value, double least, double most) {
    if (value >= least && value < most)
        return ST_OK;
    return status_describe(ST_USAGE, "%s(): %s is %.10g: %.10g to below %.10g is possible", call,
                           name, value, least, most);
}
