/* plot3d_text.h - the numbers of a PLOT3D file that is text ("formatted"), as Fortran's
 * list-directed READ takes them.
 *
 * Words stand between blanks, line ends or commas. 4*1.5 is 1.5 four times; an exponent may begin
 * with e, d, or its sign alone. One pass counts the numbers and keeps the place of every 1024th, so
 * that any run of them can be read: 16 bytes of memory for 1024 numbers. One thread per file.
 */
#ifndef FORMATS_CURVILINEAR_PLOT3D_TEXT_H
#define FORMATS_CURVILINEAR_PLOT3D_TEXT_H

#include <stdbool.h>

#include "formats/base/file.h"

typedef struct plot3d_text plot3d_text;

/* plot3d_text_known() - returns whether these first bytes of a file are numbers in text. */
bool plot3d_text_known(const uint8_t *start, size_t size);

/* plot3d_text_open() - count the numbers of a file, which must outlive *out. ST_CORRUPT naming file
 * and line: a word is longer than any number; ST_NOMEM. */
CHECKED status plot3d_text_open(mem *m, file *f, plot3d_text **out);
void plot3d_text_close(plot3d_text *t); /* NULL is fine */
uint64_t plot3d_text_count(const plot3d_text *t);

/* plot3d_text_read() - read count numbers from number `first` on; quick where the last ones ended.
 * ST_CORRUPT naming file and line: a word is no number, or there are fewer than were counted. */
CHECKED status plot3d_text_read(plot3d_text *t, uint64_t first, size_t count, double *out);

/* The whole numbers that a file begins with, 0 to 2^31 - 1, up to so many, each in 4 bytes, most
 * significant first: what C binary begins with. plot3d_text_wholes(): *count: how many.
 * plot3d_text_wholes_at() - of first bytes, without those that are cut; returns how many. */
CHECKED status plot3d_text_wholes(plot3d_text *t, size_t most, uint8_t *out, size_t *count);
size_t plot3d_text_wholes_at(const uint8_t *start, size_t size, size_t most, uint8_t *out);

#endif
