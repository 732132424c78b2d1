/* num.h - numbers to and from text, the same in every locale; text is never accepted in part. */
#ifndef FORMATS_BASE_NUM_H
#define FORMATS_BASE_NUM_H

#include <stddef.h>
#include <stdint.h>

#include "formats/base/status.h"

/* Each parses the whole text or returns ST_USAGE naming `what` ("--iso", "file.nrrd: line 3") and
 * the text. */
CHECKED status num_double(const char *text, const char *what,
                          double *out); /* also inf, nan, hex floats */
CHECKED status num_int(const char *text, const char *what, int64_t lo, int64_t hi, int64_t *out);
CHECKED status num_size(const char *text, const char *what,
                        uint64_t *out); /* bytes; suffix K M G T = powers of 1024 */

/* num_doubles() - parse exactly count numbers, separated by any of the separators (", " "x"). */
CHECKED status num_doubles(const char *text, const char *what, const char *separators, int count,
                           double *out);

/* num_print() - print the shortest decimal that reads back as the same double; returns buffer.
 * num_print_float() - the shortest that reads back as the same float: -1e+34 where the double needs
 * -9.999999790214768e+33. */
enum { NUM_TEXT_MAX = 32 };
const char *num_print(double value, char buffer[NUM_TEXT_MAX]);
const char *num_print_float(float value, char buffer[NUM_TEXT_MAX]);

/* num_print_list() - print numbers with commas between, the first ones that fit. */
void num_print_list(char *text, size_t room, const double *x, int count);

#endif
