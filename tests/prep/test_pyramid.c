/* test_pyramid.c - the rolling window against the formula, bit for bit, for any batches and
 * threads.
 */
/* marks: threads, bits */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "formats/base/fault.h"
#include "prep/grid/pyramid.h"
#include "tests/support/fields.h"
#include "tests/support/leaf_files.h"

typedef struct fine {
    uint32_t dims[3];
    sample_type type;
    const void *samples;
} fine;

static double at(const fine *f, int64_t x, int64_t y, int64_t z) {
    int64_t i[3] = {x, y, z};
    for (int a = 0; a < 3; a++)
        i[a] = i[a] < 0 ? 0 : i[a] >= f->dims[a] ? f->dims[a] - 1 : i[a];
    return (double)sample_get(f->type, f->samples,
                              (size_t)(i[0] + f->dims[0] * (i[1] + (int64_t)f->dims[1] * i[2])));
}

static double weigh(const double v[5]) {
    double sum = v[0];
    sum += 4 * v[1];
    sum += 6 * v[2];
    sum += 4 * v[3];
    return sum + v[4];
}

/* Sum over 5^3 nodes around (x, y, z), x innermost; weights instead of samples if so asked. */
static double sum_around(const fine *f, int64_t x, int64_t y, int64_t z, bool weights, bool *same) {
    double planes[5], rows[5], v[5];
    for (int c = 0; c < 5; c++) {
        for (int b = 0; b < 5; b++) {
            for (int a = 0; a < 5; a++) {
                double sample = at(f, x + a - 2, y + b - 2, z + c - 2);
                v[a] = isfinite(sample) ? (weights ? 1 : sample) : 0;
            }
            rows[b] = weigh(v);
        }
        planes[c] = weigh(rows);
    }
    *same = true;
    for (int c = 1; c < 5; c++)
        *same &= planes[c] == planes[0];
    return weigh(planes);
}

static double half_to_even(double v) {
    double below = floor(v), rest = v - below;
    if (rest != 0.5)
        return floor(v + 0.5);
    return fmod(below, 2) == 0 ? below : below + 1;
}

/* A float of PYRAMID_BITS behind the leading one; of the smallest exponent those that it has. */
static float shortened(float v) {
    int exponent;
    (void)frexpf(v, &exponent);
    exponent = exponent < -125 ? -125 : exponent;
    const double step = ldexp(1, exponent - 1 - PYRAMID_BITS), steps = fabs((double)v) / step;
    double result = half_to_even(steps) * step;
    result = result > (double)FLT_MAX ? floor(steps) * step : result;
    return copysignf((float)result, v);
}

static void check_slice(const fine *f, const uint32_t coarse[3], uint32_t k, const void *slice) {
    for (uint32_t j = 0; j < coarse[1]; j++)
        for (uint32_t i = 0; i < coarse[0]; i++) {
            bool same;
            double weight = sum_around(f, 2 * i, 2 * j, 2 * k, true, &same);
            double mean = sum_around(f, 2 * i, 2 * j, 2 * k, false, &same) / weight;
            float expected = (float)(f->type == SAMPLE_F32 ? mean : half_to_even(mean));
            if (f->type == SAMPLE_F32 && !same)
                expected = shortened(expected);
            if (!isfinite(at(f, 2 * i, 2 * j, 2 * k)))
                expected = NAN;
            float got = sample_get(f->type, slice, i + (size_t)coarse[0] * j);
            if (memcmp(&got, &expected, sizeof got) != 0)
                fail_msg("%s %ux%ux%u node %u,%u,%u: %a, expected %a", sample_name(f->type),
                         f->dims[0], f->dims[1], f->dims[2], i, j, k, (double)got,
                         (double)expected);
        }
}

static void check_level(const fine *f, int threads, uint64_t seed) {
    mem m;
    mem_init(&m, 0);
    pool *workers;
    pyramid *p;
    field_random r = {seed};
    uint32_t coarse[3];
    for (int a = 0; a < 3; a++)
        coarse[a] = pyramid_coarse(f->dims[a]);
    size_t size = sample_size(f->type), fine_bytes = f->dims[0] * f->dims[1] * size,
           coarse_bytes = coarse[0] * coarse[1] * size;
    assert_int_equal(pool_create(&m, threads, &workers), ST_OK);
    size_t before = mem_used(&m);
    assert_int_equal(pyramid_create(&m, f->type, false, f->dims, threads, &p), ST_OK);
    assert_true(mem_used(&m) - before <= pyramid_memory(f->type, f->dims, threads));
    char *out = malloc(coarse_bytes * (coarse[2] + 2));
    uint32_t done = 0;
    for (uint32_t z = 0; z < f->dims[2];) {
        uint32_t count = 1 + (uint32_t)field_random_below(&r, 7);
        count = count < f->dims[2] - z ? count : f->dims[2] - z;
        uint32_t made = pyramid_ready(p, count);
        assert_true(made <= count / 2 + 2 && done + made <= coarse[2]);
        assert_int_equal(pyramid_feed(p, workers, (const char *)f->samples + z * fine_bytes, NULL,
                                      count, out, NULL),
                         ST_OK);
        for (uint32_t k = 0; k < made; k++)
            check_slice(f, coarse, done + k, out + k * coarse_bytes);
        done += made;
        z += count;
    }
    assert_int_equal(done, coarse[2]);
    free(out);
    pyramid_destroy(p);
    pool_destroy(workers);
    assert_int_equal(mem_used(&m), 0);
}

static void test_formula(void **state) {
    (void)state;
    static const uint32_t sizes[][3] = {{2, 2, 2},    {3, 3, 3}, {4, 5, 6}, {2, 9, 3},
                                        {7, 2, 8},    {5, 4, 2}, {6, 7, 7}, {19, 70, 9},
                                        {40, 33, 12}, {9, 8, 40}};
    for (size_t i = 0; i < sizeof sizes / sizeof sizes[0]; i++)
        for (int type = SAMPLE_U8; type <= SAMPLE_F32; type++)
            for (int non_finite = 0; non_finite <= (type == SAMPLE_F32 ? 60 : 0);
                 non_finite += 20) {
                leaf_case c =
                    leaf_files_case(sizes[i][0], sizes[i][1], sizes[i][2], (sample_type)type);
                void *samples = leaf_files_random(&c, FIELD_SEED + i, non_finite);
                fine f = {
                    .dims = {c.dims[0], c.dims[1], c.dims[2]}, .type = c.type, .samples = samples};
                check_level(&f, 1 + (int)i % 3, i);
                free(samples);
            }
}

/* Sums that end in exactly a half, on both sides of zero. */
static void test_halves(void **state) {
    (void)state;
    int8_t samples[5 * 3 * 3] = {0};
    for (int v = -128; v <= 127; v++) {
        /* x alone varies: node 1 becomes (6 v + 4 w) / 16 with w = 2 (v mod 3) around it. */
        for (int i = 0; i < 45; i++)
            samples[i] = (int8_t)(i % 5 == 2 ? v : i % 5 == 1 ? v / 2 : 0);
        fine f = {.dims = {5, 3, 3}, .type = SAMPLE_I8, .samples = samples};
        check_level(&f, 1, 1);
    }
}

/* A constant stays what it is, also at the ends of the type; a linear ramp stays one inside. */
static void test_constant(void **state) {
    (void)state;
    static const float values[] = {0, 1e-45F, 1e30F, -3.4e38F, 3.4e38F};
    float samples[6 * 5 * 7];
    for (size_t n = 0; n < sizeof values / sizeof values[0]; n++) {
        for (size_t i = 0; i < sizeof samples / sizeof samples[0]; i++)
            samples[i] = values[n];
        fine f = {.dims = {6, 5, 7}, .type = SAMPLE_F32, .samples = samples};
        check_level(&f, 2, 1);
    }
    uint16_t most[4 * 4 * 4];
    memset(most, 0xFF, sizeof most);
    fine f = {.dims = {4, 4, 4}, .type = SAMPLE_U16, .samples = most};
    check_level(&f, 2, 1);
    int16_t least[4 * 4 * 4];
    for (size_t i = 0; i < 64; i++)
        least[i] = INT16_MIN;
    f = (fine){.dims = {4, 4, 4}, .type = SAMPLE_I16, .samples = least};
    check_level(&f, 2, 1);
}

/* Returns all slices of the level above: of samples that are colours, or of bytes. */
static void *level_above(sample_type type, const uint32_t dims[3], const void *samples) {
    mem m;
    pool *workers;
    pyramid *p;
    mem_init(&m, 0);
    const size_t plane = (size_t)pyramid_coarse(dims[0]) * pyramid_coarse(dims[1]);
    void *out = malloc(plane * pyramid_coarse(dims[2]) * sample_size(type));
    assert_int_equal(pool_create(&m, 2, &workers), ST_OK);
    assert_int_equal(pyramid_create(&m, type, type == SAMPLE_F32, dims, 2, &p), ST_OK);
    assert_int_equal(pyramid_ready(p, dims[2]), pyramid_coarse(dims[2]));
    assert_int_equal(pyramid_feed(p, workers, samples, NULL, dims[2], out, NULL), ST_OK);
    pyramid_destroy(p);
    pool_destroy(workers);
    return out;
}

/* Each byte of colours is what it is alone. */
static void test_colours(void **state) {
    static const uint32_t dims[3] = {21, 2, 38};
    enum { SAMPLES = 21 * 2 * 38 };
    (void)state;
    uint8_t byte[3][SAMPLES];
    float colours[SAMPLES];
    field_random r = {4};
    for (int i = 0; i < SAMPLES; i++) {
        for (int c = 0; c < 3; c++)
            byte[c][i] = (uint8_t)(i % 5 ? field_random_below(&r, 256) : i % 2 ? 255 : 0);
        colours[i] = (float)(byte[0][i] << 16 | byte[1][i] << 8 | byte[2][i]);
    }
    float *got = level_above(SAMPLE_F32, dims, colours);
    uint8_t *expected[3];
    for (int c = 0; c < 3; c++)
        expected[c] = level_above(SAMPLE_U8, dims, byte[c]);
    for (size_t i = 0; i < (size_t)pyramid_coarse(21) * pyramid_coarse(2) * pyramid_coarse(38); i++)
        assert_int_equal((uint32_t)got[i],
                         (uint32_t)expected[0][i] << 16 | expected[1][i] << 8 | expected[2][i]);
    for (int c = 0; c < 3; c++)
        free(expected[c]);
    free(got);
}

static void test_faults(void **state) {
    (void)state;
    mem m;
    mem_init(&m, 0);
    static const uint32_t dims[3] = {9, 8, 7};
    long k = 0;
    for (bool fired = true; fired;) {
        pyramid *p = NULL;
        fault_arm(FAULT_ALLOC, ++k);
        status st = pyramid_create(&m, SAMPLE_F32, false, dims, 2, &p);
        fired = fault_fired(FAULT_ALLOC);
        fault_arm(FAULT_ALLOC, 0);
        assert_int_equal(st, fired ? ST_NOMEM : ST_OK);
        if (!fired)
            pyramid_destroy(p);
        assert_int_equal(mem_used(&m), 0);
    }
    assert_true(k > 10);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_formula),  cmocka_unit_test(test_halves),
        cmocka_unit_test(test_constant), cmocka_unit_test(test_colours),
        cmocka_unit_test(test_faults),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
