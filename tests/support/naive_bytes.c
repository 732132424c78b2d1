#include "tests/support/naive_bytes.h"

#include <stdlib.h>
#include <string.h>
#include <xxhash.h>

uint64_t naive_number(const unsigned char *at, int bytes) {
    uint64_t value = 0;
    for (int b = bytes - 1; b >= 0; b--)
        value = value << 8 | at[b];
    return value;
}

float naive_float_of(uint64_t bits) {
    uint32_t word = (uint32_t)bits;
    float value;
    memcpy(&value, &word, 4);
    return value;
}

float naive_real32(const unsigned char *at) {
    return naive_float_of(naive_number(at, 4));
}

double naive_real64(const unsigned char *at) {
    uint64_t bits = naive_number(at, 8);
    double value;
    memcpy(&value, &bits, 8);
    return value;
}

uint64_t naive_up_to(uint64_t value, uint64_t multiple) {
    return (value + multiple - 1) / multiple * multiple;
}

bool naive_zeros(const unsigned char *bytes, uint64_t from, uint64_t to) {
    for (uint64_t i = from; i < to; i++)
        if (bytes[i] != 0)
            return false;
    return true;
}

bool naive_text(const unsigned char *at, uint64_t size) {
    const unsigned char *end = memchr(at, 0, size);
    return end && naive_zeros(at, (uint64_t)(end - at), size);
}

bool naive_hashes(const unsigned char *file, uint64_t sections) {
    size_t size = 4096 + 32 * sections;
    unsigned char *copy = malloc(size);
    if (!copy)
        return false;
    memcpy(copy, file, size);
    memset(copy + 248, 0, 8);
    bool good = XXH3_64bits(copy, 4096) == naive_number(file + 248, 8);
    memset(copy + 232, 0, 16);
    XXH128_hash_t id = XXH3_128bits(copy, size);
    free(copy);
    return good && id.low64 == naive_number(file + 232, 8) &&
           id.high64 == naive_number(file + 240, 8);
}
