/* public_fields.h - what callers of the public headers may pass: tables of the fields of structs,
 * and the one function that checks a struct by its table.
 *
 * Each public struct has a table, with a row for each field: its type, its range, whether it may
 * also be 0 or NULL, and which other field counts its elements. All fields are checked, whether the
 * call uses them or not, so a struct of zeros or defaults must pass. Elements beyond the count of
 * their array are not looked at. A function of the table checks how several fields fit together.
 *
 * Whoever adds a field adds its row: tests/formats/test_public_fields.c reads the headers, and
 * fails until the row exists. A fault is described as "leafcast_scene.lights[1].rgb[0] is nan:
 * ...", ST_USAGE.
 */
#ifndef FORMATS_PUBLIC_FIELDS_H
#define FORMATS_PUBLIC_FIELDS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "formats/base/status.h"

typedef enum public_type {
    PUBLIC_SIZE, /* the member `size` */
    PUBLIC_BOOL, /* a byte, 0 or 1 */
    PUBLIC_INT,  /* enumerations, too */
    PUBLIC_UINT32,
    PUBLIC_UINT64, /* size_t, too */
    PUBLIC_FLOAT,
    PUBLIC_DOUBLE,
    PUBLIC_STRUCT,   /* described by `element` */
    PUBLIC_POINTER,  /* to anything, or to what `element` or `number` describes */
    PUBLIC_ANYTHING, /* a context of the caller's, or a function that may be NULL */
    PUBLIC_TYPES
} public_type;

enum {
    PUBLIC_OR_ZERO = 1,   /* 0 is allowed, too */
    PUBLIC_ABOVE = 2,     /* `least` itself is not allowed */
    PUBLIC_BELOW = 4,     /* nor is `most` */
    PUBLIC_OR_NULL = 8,   /* a pointer may be NULL; one with a count of 0 always may */
    PUBLIC_DIRECTION = 16 /* only the largest magnitude of its values must be in [least, most] */
};

typedef struct public_field {
    const char *name;
    size_t offset;
    public_type type;
    uint32_t values;    /* numbers side by side; in a counted array: per element */
    double least, most; /* the range of numbers; a NaN is never in it */
    unsigned how;
    const char *counted_by;              /* the field that counts the elements; NULL: none */
    const struct public_fields *element; /* of PUBLIC_STRUCT; or what a pointer points to, */
    const struct public_field *number;   /* or the numbers it points to; both NULL: unknown */
} public_field;

typedef struct public_fields {
    const char *name;
    size_t size;
    const public_field *rows; /* a counter comes before what it counts; NULL for `written` */
    int count;
    bool written; /* the library fills it; the caller sets only `size`, if there is one */
    status (*together)(const void *of);
} public_fields;

/* Rows. A number has the type of its member. */
#define PUBLIC_FIRST(s, f) \
    _Generic(((s *)0)->f,               \
    bool: PUBLIC_BOOL, bool *: PUBLIC_BOOL,                    \
    int: PUBLIC_INT, int *: PUBLIC_INT,                        \
    uint32_t: PUBLIC_UINT32, uint32_t *: PUBLIC_UINT32,        \
    uint64_t: PUBLIC_UINT64, uint64_t *: PUBLIC_UINT64,        \
    float: PUBLIC_FLOAT, float *: PUBLIC_FLOAT,                \
    double: PUBLIC_DOUBLE, double *: PUBLIC_DOUBLE,            \
    double(*)[4]: PUBLIC_DOUBLE)
#define PUBLIC_WIDTH(s, f)                                                                        \
    _Generic(((s *)0)->f, bool : 1, bool * : 1, int : 4, int * : 4, uint32_t : 4, uint32_t * : 4, \
             uint64_t : 8, uint64_t * : 8, float : 4, float * : 4, double : 8, double * : 8,      \
             double(*)[4] : 8)
#define PUBLIC_MEMBER(s, f) .name = #f, .offset = offsetof(s, f)
#define PUBLIC_NUMBER(s, f, lo, hi, as)                                                            \
    {                                                                                              \
        PUBLIC_MEMBER(s, f), .type = PUBLIC_FIRST(s, f), .least = (lo), .most = (hi), .how = (as), \
                             .values = sizeof(((s *)0)->f) / PUBLIC_WIDTH(s, f)                    \
    }
#define PUBLIC_NUMBERS_OF(s, f, lo, hi, counter)                                      \
    {                                                                                 \
        PUBLIC_MEMBER(s, f), .type = PUBLIC_FIRST(s, f), .least = (lo), .most = (hi), \
                             .values = sizeof(((s *)0)->f[0]) / PUBLIC_WIDTH(s, f),   \
                             .counted_by = (counter)                                  \
    }
#define PUBLIC_ENUM(s, f, last) \
    { PUBLIC_MEMBER(s, f), .type = PUBLIC_INT, .values = 1, .most = (last) }
#define PUBLIC_FLAG(s, f) \
    { PUBLIC_MEMBER(s, f), .type = PUBLIC_BOOL, .values = 1, .most = 1 }
#define PUBLIC_OWN_SIZE(s) \
    { PUBLIC_MEMBER(s, size), .type = PUBLIC_SIZE, .values = 1 }
#define PUBLIC_PLACE(s, f, as)                                              \
    {                                                                       \
        PUBLIC_MEMBER(s, f), .type = PUBLIC_POINTER, .how = (as),           \
                             .values = sizeof(((s *)0)->f) / sizeof(void *) \
    }
#define PUBLIC_ANY(s, f) \
    { PUBLIC_MEMBER(s, f), .type = PUBLIC_ANYTHING, .values = 1 }
#define PUBLIC_TABLE(s, rows_of, ...)                                    \
    {                                                                    \
        .name = #s, .size = sizeof(s), .rows = (rows_of),                \
        .count = (int)(sizeof(rows_of) / sizeof *(rows_of)), __VA_ARGS__ \
    }
#define PUBLIC_WRITTEN(s) \
    { .name = #s, .size = sizeof(s), .written = true }

/* public_fields_width() - bytes of one value; not for structs, whose table has their size. */
size_t public_fields_width(public_type type);

/* public_fields_check() - check one struct by its table; of a `written` one only the size.
 * public_fields_check_all() - check count structs. */
CHECKED status public_fields_check(const public_fields *table, const void *of);
CHECKED status public_fields_check_all(const public_fields *table, const void *of, size_t count);

/* public_needs() - ST_USAGE where one of a call's pointers is NULL. names: of all pointers, in
 * order, separated by a space. */
CHECKED status public_needs(const char *call, const char *names, const void *const pointers[]);

/* public_in_range() - ST_USAGE where a call's number is not in [least, most]. public_below() - the
 * same of [least, most). */
CHECKED status public_in_range(const char *call, const char *name, double value, double least,
                               double most);
CHECKED status public_below(const char *call, const char *name, double value, double least,
                            double most);

#endif
