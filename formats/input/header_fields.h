/* header_fields.h - the "key: value" and "key = value" lines that NRRD and MetaImage headers are
 * made of.
 *
 * Faults are described as "file: line N: key: ..."; a malformed value is ST_CORRUPT.
 */
#ifndef FORMATS_INPUT_HEADER_FIELDS_H
#define FORMATS_INPUT_HEADER_FIELDS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "formats/base/mem.h"
#include "formats/base/status.h"
#include "formats/input/byte_stream.h"

typedef struct header_field {
    char *key;
    char *value;   /* without blanks around it; stored in one block with the key */
    uint64_t hash; /* of the key, to speed up the search */
    unsigned line; /* from 1 */
    bool pair;     /* NRRD: "key:=value", the user's own */
} header_field;

typedef struct header_fields {
    mem *m;
    const char *name; /* the file's name; not owned */
    header_field *items;
    size_t count, room;
} header_fields;

typedef struct header_style {
    char separator;  /* ':' or '='; with ':' the pairs ":=" are read, too */
    bool ends_blank; /* the header ends at the first blank line; false: blank lines are skipped */
    const char *end_key;   /* the header ends behind the line with this key; NULL: no such line */
    const char *end_value; /* that line's value begins so; NULL: any value */
    unsigned lines_read;   /* lines in front of this header */
} header_style;

/* header_fields_read() - read all fields up to the end of the header, or of the stream, which then
 * stands behind them. Lines that start with # are comments. A key may not come twice. Release in
 * any case. */
CHECKED status header_fields_read(header_fields *h, mem *m, byte_stream *s,
                                  const header_style *style);
void header_fields_release(header_fields *h);

/* header_fields_find() - find a field (not a pair) by its key. Case and blanks in keys do not
 * matter. NULL when absent.
 * header_fields_find_pair() - find a pair likewise. */
const header_field *header_fields_find(const header_fields *h, const char *key);
const header_field *header_fields_find_pair(const header_fields *h, const char *key);

/* header_fields_same() - returns whether two keys are equal, apart from case and blanks. */
bool header_fields_same(const char *a, const char *b);

/* header_fields_fault() - describe what is wrong with a field; returns st. */
status header_fields_fault(const header_fields *h, const header_field *f, status st,
                           const char *fmt, ...) __attribute__((format(printf, 4, 5)));

/* header_fields_missing() - return ST_CORRUPT and say that the file lacks such a field. */
status header_fields_missing(const header_fields *h, const char *key);

/* Read the value as exactly count numbers split by blanks, or as one whole number in lo .. hi. */
CHECKED status header_fields_numbers(const header_fields *h, const header_field *f, int count,
                                     double *out);
CHECKED status header_fields_int(const header_fields *h, const header_field *f, int64_t lo,
                                 int64_t hi, int64_t *out);

/* header_fields_sizes() - read the value as the sizes of count axes: whole numbers from 1, below
 * 2^32. */
enum { HEADER_FIELDS_AXES = 16 };
CHECKED status header_fields_sizes(const header_fields *h, const header_field *f, int count,
                                   uint32_t *out);

#endif
