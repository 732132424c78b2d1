/* absent.h - parts of an input that are not there, whose samples are then the format's fill value.
 *
 * Formats of chunks let a writer leave out those of one value. That is legal, and looks the same as
 * a copy that was cut short. So what is absent is counted where a reader knows it, and told; an
 * input of which all is absent is refused (--allow-missing takes it). Across an importer's pipe the
 * count travels in a pair of NRRD's header, "leafcast absent".
 */
#ifndef FORMATS_GRID_ABSENT_H
#define FORMATS_GRID_ABSENT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "formats/base/status.h"

enum { ABSENT_PARTS_MAX = 16, ABSENT_TEXT = 128 };

/* Zeros: nothing is known to be absent. */
typedef struct absent_parts {
    uint64_t count, of;
    char parts[ABSENT_PARTS_MAX]; /* what is counted: "chunks" */
} absent_parts;

/* absent_check() - ST_CORRUPT where all is absent, and not allowed to be. */
CHECKED status absent_check(const absent_parts *a, const char *file, bool allow_missing);

/* absent_add() - those of another step or field. */
void absent_add(absent_parts *sum, const absent_parts *more);

/* absent_print() - "3 of 8 chunks are absent: their samples are the fill value"; "" for none. */
const char *absent_print(const absent_parts *a, char text[ABSENT_TEXT]);

/* absent_pair() - as the value of the header's pair: "3 of 8 chunks". absent_parse() - from it; a
 * value of another form tells nothing. */
void absent_pair(const absent_parts *a, char text[ABSENT_TEXT]);
void absent_parse(const char *text, absent_parts *out);

#endif
