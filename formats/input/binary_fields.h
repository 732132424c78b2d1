/* binary_fields.h - read numbers of a binary header, at any address and in either byte order. */
#ifndef FORMATS_INPUT_BINARY_FIELDS_H
#define FORMATS_INPUT_BINARY_FIELDS_H

#include <stdbool.h>
#include <stdint.h>
#include <string.h>

static inline uint64_t binary_unsigned(const uint8_t *at, int bytes, bool big) {
    uint64_t value = 0;
    for (int i = 0; i < bytes; i++)
        value = value << 8 | at[big ? i : bytes - 1 - i];
    return value;
}

static inline int64_t binary_signed(const uint8_t *at, int bytes, bool big) {
    const int above = 64 - 8 * bytes;
    return (int64_t)(binary_unsigned(at, bytes, big) << above) >> above;
}

/* binary_real() - read a float of 4 or 8 bytes. */
static inline double binary_real(const uint8_t *at, int bytes, bool big) {
    const uint64_t wide = binary_unsigned(at, bytes, big);
    const uint32_t narrow = (uint32_t)wide;
    double d;
    float f;
    memcpy(&d, &wide, sizeof d);
    memcpy(&f, &narrow, sizeof f);
    return bytes == 8 ? d : (double)f;
}

#endif
