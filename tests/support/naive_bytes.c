#include "tests/support/naive_bytes.h"

#include <math.h>
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

float naive_sample(const unsigned char *samples, int type, size_t index) {
    const unsigned char *at = samples + index * (size_t)(type < 3 ? 1 : type < 5 ? 2 : 4);
    switch (type) {
    case 1: return (float)at[0];
    case 2: return (float)(at[0] < 128 ? at[0] : at[0] - 256);
    case 3: return (float)naive_number(at, 2);
    case 4: return (float)((long)naive_number(at, 2) - (at[1] < 128 ? 0 : 65536));
    default: return naive_real32(at);
    }
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

bool naive_minus_zero(float value) {
    return value == 0 && signbit(value);
}

const char *naive_labels(const unsigned char *file, const unsigned char *names, long fields,
                         const unsigned char *times, long steps, char (**names_out)[64],
                         double **times_out) {
    double *t = *times_out = times ? calloc((size_t)steps, sizeof *t) : NULL;
    *names_out = names ? calloc((size_t)fields, 64) : NULL;
    if ((names && !*names_out) || (times && !t))
        return "no memory";
    for (long i = 0; names && i < fields; i++) {
        if (!naive_text(names + 64 * i, 64))
            return "a field's name";
        memcpy((*names_out)[i], names + 64 * i, 64);
    }
    if (names && memcmp(names, file + 1424, 64) != 0)
        return "two names of the first field";
    for (long i = 0; times && i < steps; i++) {
        t[i] = naive_real64(times + 8 * i);
        if (!isfinite(t[i]) || (i > 0 && !(t[i] > t[i - 1])))
            return "a step's time";
    }
    return NULL;
}

bool naive_hashes(const unsigned char *file, uint64_t sections) {
    const uint64_t directory = naive_number(file + 1504, 8);
    size_t size = 4096 + 32 * sections;
    unsigned char *copy = malloc(size);
    if (!copy)
        return false;
    memcpy(copy, file, 4096);
    memcpy(copy + 4096, file + (directory ? directory : 4096), 32 * sections);
    memset(copy + 248, 0, 8);
    bool good = XXH3_64bits(copy, 4096) == naive_number(file + 248, 8);
    memset(copy + 232, 0, 16);
    memset(copy + 1512, 0, 12);
    XXH128_hash_t id = XXH3_128bits(copy, size);
    free(copy);
    return good && id.low64 == naive_number(file + 232, 8) &&
           id.high64 == naive_number(file + 240, 8);
}
