#include "tests/support/box_lab.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "tests/support/fields.h"

enum { GUARD = 0xA5, AROUND = 96 }; /* samples before the first box, and behind each */

static size_t volume(const uint32_t size[3]) {
    return (size_t)size[0] * size[1] * size[2];
}

/* Strides of a box; returns how many samples it reaches over. */
static size_t stride_of(const uint32_t size[3], box_lie lie, uint32_t stride[3]) {
    static const int order[BOX_LIES][3] = {{0, 1, 2}, {0, 1, 2}, {2, 0, 1}};
    const uint32_t gap = lie == BOX_GAPPED;
    uint32_t step = 1 + gap;
    for (int n = 0; n < 3; n++) {
        const int a = order[lie][n];
        stride[a] = step;
        step = step * size[a] + 3 * gap;
    }
    return step;
}

static unsigned char *sample_at(const box_lab *b, const coded_box *box, const uint32_t p[3]) {
    return (unsigned char *)box->at +
           b->width * ((size_t)p[0] * box->stride[0] + (size_t)p[1] * box->stride[1] +
                       (size_t)p[2] * box->stride[2]);
}

/* The place of sample n of a box in its order. */
static void place_of(const coded_box *box, size_t n, uint32_t p[3]) {
    p[0] = (uint32_t)(n % box->size[0]);
    p[1] = (uint32_t)(n / box->size[0] % box->size[1]);
    p[2] = (uint32_t)(n / box->size[0] / box->size[1]);
}

void box_lab_make(box_lab *b, sample_type type, const box_shape *shape, box_lie lie) {
    size_t at = AROUND;
    size_t begin[BOX_LAB_MAX];
    *b = (box_lab){.type = type, .width = sample_size(type), .count = shape->count};
    for (uint32_t i = 0; i < b->count; i++) {
        memcpy(b->boxes[i].size, shape->size[i], sizeof shape->size[i]);
        begin[i] = at;
        at += stride_of(shape->size[i], lie, b->boxes[i].stride) + AROUND;
        b->samples += volume(shape->size[i]);
    }
    b->bytes = at * b->width;
    b->memory = malloc(b->bytes);
    b->inside = calloc(b->bytes, sizeof b->inside[0]);
    assert_true(b->memory && b->inside);
    box_lab_wipe(b);
    for (uint32_t i = 0; i < b->count; i++) {
        b->boxes[i].at = b->memory + begin[i] * b->width;
        for (size_t n = 0; n < volume(b->boxes[i].size); n++) {
            uint32_t p[3];
            place_of(&b->boxes[i], n, p);
            memset(b->inside + (sample_at(b, &b->boxes[i], p) - b->memory), 1, b->width);
        }
    }
}

void box_lab_release(box_lab *b) {
    free(b->memory);
    free(b->inside);
}

void box_lab_wipe(box_lab *b) {
    memset(b->memory, GUARD, b->bytes);
}

bool box_lab_kept(const box_lab *b) {
    for (size_t i = 0; i < b->bytes; i++)
        if (!b->inside[i] && b->memory[i] != GUARD)
            return false;
    return true;
}

unsigned char *box_lab_list(const box_lab *b) {
    unsigned char *list = malloc(b->samples * b->width), *to = list;
    assert_non_null(list);
    for (uint32_t i = 0; i < b->count; i++)
        for (size_t n = 0; n < volume(b->boxes[i].size); n++, to += b->width) {
            uint32_t p[3];
            place_of(&b->boxes[i], n, p);
            memcpy(to, sample_at(b, &b->boxes[i], p), b->width);
        }
    return list;
}

/* ---- values ---- */

static uint32_t bits_of(float value) {
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    return bits;
}

static double wave_of(const uint32_t p[3]) {
    return sin(0.13 * p[0]) + cos(0.11 * p[1]) + sin(0.07 * p[2] + 1);
}

/* A multiple in -3 most .. 3 most; false: NaN. */
static bool multiple_of(const uint32_t p[3], double most, field_random *r, double *multiple) {
    *multiple = nearbyint(most * wave_of(p)) + (double)field_random_below(r, 9);
    return field_random_below(r, 20) != 0;
}

static uint32_t strange(field_random *r) {
    static const uint32_t bits[] = {0x7fc00000, 0xffc00000, 0x7fc00001, 0x7f800001, 0xffffffff,
                                    0x7fffffff, 0x7f800000, 0xff800000, 0x80000000, 0x00000001,
                                    0x807fffff, 0x7f7fffff, 0xff7fffff, 0x3f800000, 0x00000000};
    return bits[field_random_below(r, sizeof bits / sizeof bits[0])];
}

static uint32_t float_of(box_values what, int detail, const uint32_t p[3], bool last,
                         field_random *r) {
    static const double tens[7] = {1, 1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6};
    static const float near_limit[] = {0x1p30F - 64, 64 - 0x1p30F, 1, -3, 0, 0x1p29F};
    double multiple;
    switch (what) {
    case BOX_CONSTANT: return bits_of(-1.7e-5F);
    case BOX_RAMP: return bits_of(0.37F * (float)p[0] - 1.1F * (float)p[1] + (float)p[2] / 3);
    case BOX_SMOOTH: return bits_of((float)wave_of(p));
    case BOX_EXTREMES: return field_random_below(r, 2) ? 0x7f7fffff : 0xff7fffff;
    case BOX_SPARSE:
        if (p[0] + p[1] + p[2] > 4 && field_random_below(r, 400))
            return bits_of(0.3F);
        return bits_of((float)wave_of(p));
    case BOX_STRAY:
        if (last)
            return bits_of(0.1F + 0x1p-20F);
        /* fallthrough */
    case BOX_DECIMALS:
        /* Binaries are few: of large floats, all are multiples of 10^-6. */
        return multiple_of(p, 9000, r, &multiple) ? bits_of((float)(multiple * tens[detail]))
                                                  : 0x7fc00000;
    case BOX_BINARIES:
        return multiple_of(p, 150, r, &multiple) ? bits_of((float)ldexp(multiple, -detail))
                                                 : 0x7fc00000;
    case BOX_STRANGE: return field_random_below(r, 3) ? bits_of((float)wave_of(p)) : strange(r);
    case BOX_LIMITS: return bits_of(ldexpf(near_limit[field_random_below(r, 6)], -detail));
    case BOX_QUIET: return 0x7fc00000;
    case BOX_ZEROS: return field_random_below(r, 5) ? 0 : 0x80000000;
    default: return (uint32_t)field_random_bits(r);
    }
}

static uint32_t integer_of(box_values what, int bits, const uint32_t p[3], field_random *r) {
    const uint32_t all = bits == 8 ? 0xff : 0xffff;
    switch (what) {
    case BOX_CONSTANT: return 77;
    case BOX_RAMP: return 3 * p[0] - 5 * p[1] + 2 * p[2];
    case BOX_SMOOTH: return (uint32_t)((all / 8) * (4 + wave_of(p)));
    case BOX_EXTREMES: return field_random_below(r, 2) ? all / 2 : all / 2 + 1;
    case BOX_SPARSE:
        return p[0] + p[1] + p[2] > 4 && field_random_below(r, 400) ? 3 : p[0] * p[1] + 60;
    default: return (uint32_t)field_random_bits(r);
    }
}

void box_lab_fill(box_lab *b, box_values what, int detail, uint64_t seed) {
    field_random r = {seed};
    for (uint32_t i = 0; i < b->count; i++) {
        const coded_box *box = &b->boxes[i];
        for (size_t n = 0; n < volume(box->size); n++) {
            uint32_t p[3];
            const bool last = i + 1 == b->count && n + 1 == volume(box->size);
            place_of(box, n, p);
            const uint32_t bits = b->type == SAMPLE_F32
                                      ? float_of(what, detail, p, last, &r)
                                      : integer_of(what, 8 * (int)b->width, p, &r);
            memcpy(sample_at(b, box, p), &bits, b->width);
        }
    }
}
