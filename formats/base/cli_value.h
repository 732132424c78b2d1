/* cli_value.h - parse the values of options, beside num.h.
 *
 * Each function parses the whole text, or returns ST_USAGE naming `what` ("--size") and the text.
 * out is then untouched, except that an array may be partly written.
 */
#ifndef FORMATS_BASE_CLI_VALUE_H
#define FORMATS_BASE_CLI_VALUE_H

#include <stdint.h>

#include "formats/base/sample.h"
#include "formats/base/status.h"

CHECKED status cli_int(const char *text, const char *what, int lo, int hi, int *out);
CHECKED status cli_uint(const char *text, const char *what, uint32_t lo, uint32_t hi,
                        uint32_t *out);

/* cli_finite() - a finite number in lo .. hi. */
CHECKED status cli_finite(const char *text, const char *what, double lo, double hi, double *out);

/* cli_positive() - a finite number above 0. */
CHECKED status cli_positive(const char *text, const char *what, double *out);

/* cli_vector() - `count` finite numbers, separated by commas. */
CHECKED status cli_vector(const char *text, const char *what, int count, double *out);

/* cli_dims() - three whole numbers in lo .. hi, separated by commas, blanks or x. */
CHECKED status cli_dims(const char *text, const char *what, uint32_t lo, uint32_t hi,
                        uint32_t out[3]);

/* cli_dims_or_one() - as cli_dims(), or a single number. *count: 3 or 1; numbers not given are
 * 0. */
CHECKED status cli_dims_or_one(const char *text, const char *what, uint32_t lo, uint32_t hi,
                               uint32_t out[3], int *count);

/* cli_sample_type() - the sample type that --type names. */
CHECKED status cli_sample_type(const char *text, sample_type *out);

/* cli_word() - the index of a text among words separated by '|', as an option's row lists them. */
CHECKED status cli_word(const char *text, const char *what, const char *words, int *index);

#endif
