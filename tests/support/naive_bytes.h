/* naive_bytes.h - what the second readers of grids and of meshes share: numbers in bytes, and the
 * header's hashes; from formats/FORMAT.md alone. */
#ifndef TESTS_SUPPORT_NAIVE_BYTES_H
#define TESTS_SUPPORT_NAIVE_BYTES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Little endian, of so many bytes. */
uint64_t naive_number(const unsigned char *at, int bytes);
float naive_float_of(uint64_t bits);
float naive_real32(const unsigned char *at);
double naive_real64(const unsigned char *at);

/* Sample `index` of a type, by its number in the header. */
float naive_sample(const unsigned char *samples, int type, size_t index);

uint64_t naive_up_to(uint64_t value, uint64_t multiple);

/* Whether bytes from .. to are all 0. */
bool naive_zeros(const unsigned char *bytes, uint64_t from, uint64_t to);

/* A text of up to size - 1 bytes: a 0 behind it, and nothing else. */
bool naive_text(const unsigned char *at, uint64_t size);

bool naive_minus_zero(float value);

/* Names of fields and times of steps (section 6), either NULL where there are none, as arrays to
 * free. Returns NULL, or what is wrong with them. */
const char *naive_labels(const unsigned char *file, const unsigned char *names, long fields,
                         const unsigned char *times, long steps, char (**names_out)[64],
                         double **times_out);

/* Section 2: whether checksum and id are those of header and table, which must be all there. */
bool naive_hashes(const unsigned char *file, uint64_t sections);

#endif
