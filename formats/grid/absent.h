/* absent.h - parts of an input that are missing, so that their samples are the format's fill value.
 *
 * Formats of chunks let a writer leave out chunks of one value. That is legal, but looks like a
 * copy that was cut short. So a reader that notices absent parts counts them, and the user is told.
 * An input of which all is absent is refused (--allow-missing takes it). Across an importer's pipe
 * the count travels in a key/value pair of NRRD's header, "leafcast absent".
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

/* absent_check() - ST_CORRUPT if all parts are absent and allow_missing is false. */
CHECKED status absent_check(const absent_parts *a, const char *file, bool allow_missing);

/* absent_add() - add the count of another step or field. */
void absent_add(absent_parts *sum, const absent_parts *more);

/* absent_print() - print "3 of 8 chunks are absent: their samples are the fill value"; "" for none.
 */
const char *absent_print(const absent_parts *a, char text[ABSENT_TEXT]);

/* absent_pair() - print the counts as the value of "leafcast absent" in an NRRD header:
 * "3 of 8 chunks". */
void absent_pair(const absent_parts *a, char text[ABSENT_TEXT]);

/* absent_parse() - read such a value. Leaves *out unchanged if it has another form. */
void absent_parse(const char *text, absent_parts *out);

#endif
