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
    char *value;   /* without blanks around it; behind the key in one block */
    uint64_t hash; /* of the key, for the search */
    unsigned line; /* from 1 */
    bool pair;     /* NRRD: "key:=value", the user's own */
} header_field;

typedef struct header_fields {
    mem *m;
    const char *name; /* of the file; not owned */
    header_field *items;
    size_t count, room;
} header_fields;

typedef struct header_style {
    char separator;      /* ':' or '='; a separator ':' also knows the pairs ":=" */
    bool ends_blank;     /* the header ends at the first blank line, else blank lines are skipped */
    const char *end_key; /* the header ends behind the line with this key; NULL: it does not */
    const char *end_value; /* where its value begins so; NULL: whatever it is */
    unsigned lines_read;   /* lines in front of this header */
} header_style;

/* header_fields_read() - all fields up to the header's end, or the stream's; the stream then stands
 * behind them. Lines that start with # are comments. A key may not come twice. Release in any case.
 */
CHECKED status header_fields_read(header_fields *h, mem *m, byte_stream *s,
                                  const header_style *style);
void header_fields_release(header_fields *h);

/* header_fields_find() - a field (not a pair), or a pair, by its key; case and blanks in keys do
 * not matter. NULL when absent. */
const header_field *header_fields_find(const header_fields *h, const char *key);
const header_field *header_fields_find_pair(const header_fields *h, const char *key);

/* header_fields_same() - whether two keys are the same but for case and blanks. */
bool header_fields_same(const char *a, const char *b);

/* header_fields_fault() - describe what is wrong with a field; returns st. */
status header_fields_fault(const header_fields *h, const header_field *f, status st,
                           const char *fmt, ...) __attribute__((format(printf, 4, 5)));

/* header_fields_missing() - ST_CORRUPT: the file has no such field. */
status header_fields_missing(const header_fields *h, const char *key);

/* The value as exactly count numbers split by blanks, or as one whole number in lo .. hi. */
CHECKED status header_fields_numbers(const header_fields *h, const header_field *f, int count,
                                     double *out);
CHECKED status header_fields_int(const header_fields *h, const header_field *f, int64_t lo,
                                 int64_t hi, int64_t *out);

/* header_fields_sizes() - the value as the sizes of count axes: whole numbers from 1 below 2^32. */
enum { HEADER_FIELDS_AXES = 16 };
CHECKED status header_fields_sizes(const header_fields *h, const header_field *f, int count,
                                   uint32_t *out);

#endif
