/* cli_value.h - the values of options, beside those of num.h: each is parsed whole, or ST_USAGE
 * with `what` ("--size") and the text; out is then untouched, or partly written where it is an
 * array.
 */
#ifndef FORMATS_BASE_CLI_VALUE_H
#define FORMATS_BASE_CLI_VALUE_H

#include <stdint.h>

#include "formats/base/sample.h"
#include "formats/base/status.h"

CHECKED status cli_int(const char *text, const char *what, int lo, int hi, int *out);
CHECKED status cli_uint(const char *text, const char *what, uint32_t lo, uint32_t hi,
                        uint32_t *out);

/* cli_finite() - a finite number of lo .. hi. */
CHECKED status cli_finite(const char *text, const char *what, double lo, double hi, double *out);

/* cli_vector() - so many finite numbers, divided by commas. */
CHECKED status cli_vector(const char *text, const char *what, int count, double *out);

/* cli_dims() - three whole numbers of lo .. hi, divided by commas, blanks or x. */
CHECKED status cli_dims(const char *text, const char *what, uint32_t lo, uint32_t hi,
                        uint32_t out[3]);

/* cli_dims_or_one() - likewise, or one; *count: how many there were. The others are then 0. */
CHECKED status cli_dims_or_one(const char *text, const char *what, uint32_t lo, uint32_t hi,
                               uint32_t out[3], int *count);

/* cli_sample_type() - --type. */
CHECKED status cli_sample_type(const char *text, sample_type *out);

/* cli_word() - which one it is of some words divided by '|', as an option's row shows them. */
CHECKED status cli_word(const char *text, const char *what, const char *words, int *index);

#endif
