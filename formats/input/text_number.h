/* text_number.h - read a word as a number. */
#ifndef FORMATS_INPUT_TEXT_NUMBER_H
#define FORMATS_INPUT_TEXT_NUMBER_H

#include <stdbool.h>
#include <stdint.h>

/* text_number_double() - read a double, correctly rounded, also nan and inf. Returns false when the
 * word is no number. */
bool text_number_double(const char *word, double *out);

/* text_number_whole() - read a whole number; UINT64_MAX for a negative or larger one. Returns false
 * when the word is none. */
bool text_number_whole(const char *word, uint64_t *out);

/* text_number_int() - read a whole number in lo .. hi. Returns false when the word is none. */
bool text_number_int(const char *word, int64_t lo, int64_t hi, int64_t *out);

#endif
