/* text_number.h - the number that a word of a text is. */
#ifndef FORMATS_INPUT_TEXT_NUMBER_H
#define FORMATS_INPUT_TEXT_NUMBER_H

#include <stdbool.h>
#include <stdint.h>

/* text_number_double() - correctly rounded, also nan and inf; false when it is none. */
bool text_number_double(const char *word, double *out);

/* text_number_whole() - a whole number; UINT64_MAX for a negative or larger one; false when it is
 * none. */
bool text_number_whole(const char *word, uint64_t *out);

/* text_number_int() - a whole number in lo .. hi; false when it is none. */
bool text_number_int(const char *word, int64_t lo, int64_t hi, int64_t *out);

#endif
