/* test_stored_samples.c - samples as inputs store them: half, 64-bit numbers, several numbers a
 * sample, slope and intercept, another order, steps; as NRRD, MetaImage and raw files have them.
 */
/* marks: bits */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "formats/grid/stored_samples.h"
#include "tests/support/scratch.h"
#include "tests/support/volumes.h"

/* ---- numbers ---- */

/* By the definition of binary16. */
static double half_value(unsigned h) {
    const double sign = h >> 15 ? -1 : 1;
    const int exponent = (int)(h >> 10 & 31);
    const double bits = h & 0x3ff;
    if (exponent == 31)
        return bits != 0 ? (double)NAN : sign * (double)INFINITY;
    return sign * (exponent ? ldexp(1 + bits / 1024, exponent - 15) : ldexp(bits / 1024, -14));
}

static void test_half(void **state) {
    (void)state;
    for (unsigned h = 0; h < 65536; h++) {
        const uint16_t in = (uint16_t)h;
        const double want = half_value(h);
        double out = 1;
        assert_int_equal(sample_to_doubles(SAMPLE_F16, &in, &out, 1), 1);
        if (!(out == want && signbit(out) == signbit(want)) && !(isnan(out) && isnan(want)))
            fail_msg("half %04x is %g, not %g", h, out, want);
    }
}

static void test_wide_integers(void **state) {
    (void)state;
    static const struct {
        uint64_t v;
        bool held, as_signed;
    } cases[] = {
        {0, true, true},
        {(1ull << 53) - 1, true, true},
        {1ull << 53, true, true},
        {(1ull << 53) + 1, false, false},
        {(1ull << 53) + 2, true, true},
        {1ull << 63, true, true},
        {UINT64_MAX, false, true},
        {UINT64_MAX - 2047, true, true},
        {UINT64_MAX - 2048, false, true},
        {INT64_MAX, false, false},
        {0 - ((1ull << 53) + 1), false, false},
        {0 - ((1ull << 53) + 2), false, true},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        double out;
        const size_t held = sample_to_doubles(SAMPLE_U64, &cases[i].v, &out, 1);
        if (held != cases[i].held || (held && (long double)out != (long double)cases[i].v))
            fail_msg("u64 %llu: %zu, %.17g", (unsigned long long)cases[i].v, held, out);
        const size_t as_signed = sample_to_doubles(SAMPLE_I64, &cases[i].v, &out, 1);
        if (as_signed != cases[i].as_signed ||
            (as_signed && (long double)out != (long double)(int64_t)cases[i].v))
            fail_msg("i64 %lld: %zu, %.17g", (long long)cases[i].v, as_signed, out);
    }
}

/* ---- what becomes of them ---- */

static void test_choice(void **state) {
    (void)state;
    static const struct {
        stored_samples s;
        uint32_t hint;
        status st;
        sample_type type, source;
    } cases[] = {
        {{.type = SAMPLE_I16}, 0, ST_OK, SAMPLE_I16, SAMPLE_I16},
        {{.type = SAMPLE_I16}, 1, ST_OK, SAMPLE_I16, SAMPLE_I16},
        {{.type = SAMPLE_I16}, 2, ST_USAGE, 0, 0},
        {{.type = SAMPLE_I16, .slope = 1}, 0, ST_OK, SAMPLE_I16, SAMPLE_I16},
        {{.type = SAMPLE_I16, .slope = 2}, 0, ST_OK, SAMPLE_F32, SAMPLE_I16},
        {{.type = SAMPLE_U8, .slope = 1, .intercept = 1}, 0, ST_OK, SAMPLE_F32, SAMPLE_U8},
        {{.type = SAMPLE_F16}, 0, ST_OK, SAMPLE_F32, SAMPLE_F16},
        {{.type = SAMPLE_U64}, 0, ST_OK, SAMPLE_F64, SAMPLE_U64},
        {{.type = SAMPLE_I64, .slope = 3}, 0, ST_OK, SAMPLE_F64, SAMPLE_I64},
        {{.type = SAMPLE_I32, .slope = 3}, 0, ST_OK, SAMPLE_F64, SAMPLE_I32},
        {{.type = SAMPLE_F32, .slope = 3}, 0, ST_OK, SAMPLE_F32, SAMPLE_F32},
        {{.type = SAMPLE_F16, .slope = 3}, 0, ST_OK, SAMPLE_F32, SAMPLE_F16},
        {{.type = SAMPLE_F64, .components = 2}, 0, ST_OK, SAMPLE_F64, SAMPLE_F64},
        {{.type = SAMPLE_U8, .components = 3}, 0, ST_OK, SAMPLE_F32, SAMPLE_U8},
        {{.type = SAMPLE_U8, .components = 3}, 3, ST_OK, SAMPLE_U8, SAMPLE_U8},
        {{.type = SAMPLE_U8, .components = 3}, 4, ST_USAGE, 0, 0},
        {{.type = SAMPLE_U8, .components = 300}, 4, ST_UNSUPPORTED, 0, 0},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const volume_hints hints = {.component = cases[i].hint};
        stored_samples s = cases[i].s;
        grid g = {0};
        assert_int_equal(stored_samples_choose(&s, "x", &hints, &g), cases[i].st);
        if (cases[i].st != ST_OK)
            continue;
        assert_int_equal(g.type, cases[i].type);
        assert_int_equal(grid_source(&g), cases[i].source);
    }
}

static void check_taken(const stored_samples *s, sample_type to, const void *in, size_t bytes,
                        const void *want, size_t count) {
    char copy[256], out[256] = {0};
    memcpy(copy, in, bytes);
    assert_int_equal(bytes, count * stored_samples_bytes(s));
    assert_int_equal(stored_samples_take(s, copy, to, out, count), count);
    assert_memory_equal(out, want, count * sample_size(to));
}

static void test_taken(void **state) {
    (void)state;
    const int16_t v[6] = {3, 4, 12, -1, 2, -2};
    const float lengths[2] = {13, 3};
    const int16_t second[2] = {4, 2};
    check_taken(&(stored_samples){.type = SAMPLE_I16, .components = 3}, SAMPLE_F32, v, sizeof v,
                lengths, 2);
    check_taken(&(stored_samples){.type = SAMPLE_I16, .components = 3, .component = 2}, SAMPLE_I16,
                v, sizeof v, second, 2);
    /* Computed in double, rounded once. */
    const double slope = 0.1, intercept = -7.3;
    float scaled[6];
    for (int i = 0; i < 6; i++)
        scaled[i] = (float)(slope * (double)v[i] + intercept);
    check_taken(&(stored_samples){.type = SAMPLE_I16, .slope = slope, .intercept = intercept},
                SAMPLE_F32, v, sizeof v, scaled, 6);
    const uint8_t rgba[8] = {255, 128, 64, 9, 1, 0, 0, 9};
    const float luminances[2] = {(float)(0.2126 * 255 + 0.7152 * 128 + 0.0722 * 64), (float)0.2126};
    check_taken(&(stored_samples){.type = SAMPLE_U8, .components = 4, .colours = true}, SAMPLE_F32,
                rgba, sizeof rgba, luminances, 2);
    const uint8_t grey[4] = {200, 9, 17, 9};
    const float greys[2] = {200, 17};
    check_taken(&(stored_samples){.type = SAMPLE_U8, .components = 2, .colours = true}, SAMPLE_F32,
                grey, sizeof grey, greys, 2);
}

/* ---- in files ---- */

enum { N = VOLUMES_SAMPLES };

/* The test volume's numbers, times 10, plus the component. */
static int number(int n, int component) {
    return 10 * (7 * n - 50) + component;
}

/* Reads a file of the test volume's size; checks the type and what the input's is. */
static void read_file(const char *path, const volume_hints *hints, sample_type type,
                      sample_type source, void *samples) {
    grid g;
    if (volumes_read(path, hints, &g, samples) != ST_OK)
        fail_msg("%s", status_text());
    assert_int_equal(g.type, type);
    assert_int_equal(grid_source(&g), source);
    assert_int_equal(grid_samples(&g), N);
}

static void check_components(const char *path, int count, const volume_hints *more) {
    for (int c = 0; c <= count; c++) {
        volume_hints hints = more ? *more : (volume_hints){0};
        hints.component = (uint32_t)c;
        int16_t one[N];
        float all[N];
        read_file(path, &hints, c ? SAMPLE_I16 : SAMPLE_F32, SAMPLE_I16, c ? (void *)one : all);
        for (int n = 0; n < N; n++) {
            double sum = 0;
            for (int i = 0; i < count; i++)
                sum += (double)number(n, i) * number(n, i);
            if (c ? one[n] != number(n, c - 1) : all[n] != (float)sqrt(sum))
                fail_msg("%s: component %d of sample %d: %g", path, c, n,
                         c ? (double)one[n] : (double)all[n]);
        }
    }
    volumes_refused(path, &(volume_hints){.component = (uint32_t)count + 1}, ST_USAGE,
                    "no component");
    volumes_refused(path, &(volume_hints){.step = 1}, ST_USAGE, "no step 1: there is 1");
}

/* Side by side, or one component behind the other; big endian. */
static size_t put_components(bool planar, int count, uint8_t *out) {
    for (int n = 0; n < N; n++)
        for (int c = 0; c < count; c++) {
            uint8_t *at = out + 2 * (size_t)(planar ? c * N + n : n * count + c);
            at[0] = (uint8_t)((unsigned)number(n, c) >> 8);
            at[1] = (uint8_t)number(n, c);
        }
    return 2u * N * (size_t)count;
}

#define VECTORS "NRRD0004\ntype: short\ndimension: 4\nendian: big\nencoding: "

static void test_vectors_of_nrrd(void **state) {
    (void)state;
    uint8_t bytes[2 * 3 * N];
    size_t size = put_components(false, 3, bytes), packed;
    const char *path = volumes_file(
        "a.nrrd", VECTORS "raw\nsizes: 3 4 3 2\nkinds: vector domain domain domain\n\n", bytes,
        size);
    check_components(path, 3, NULL);
    volumes_truncate(path, NULL, 0);
    volumes_faults(path, NULL);
    size = put_components(true, 3, bytes);
    path = volumes_file(
        "a.nrrd", VECTORS "raw\nsizes: 4 3 2 3\nkinds: space space space vector\n\n", bytes, size);
    check_components(path, 3, NULL);
    volumes_truncate(path, NULL, 0);
    volumes_faults(path, NULL);
    uint8_t *data = volumes_deflate(bytes, size, true, 2, &packed);
    path =
        volumes_file("a.nrrd", VECTORS "gzip\nsizes: 4 3 2 3\nkinds: space space space vector\n\n",
                     data, packed);
    free(data);
    check_components(path, 3, NULL);
    volumes_faults(path, NULL);
}

static void test_channels_of_metaimage(void **state) {
    (void)state;
    uint8_t bytes[2 * 2 * N];
    const size_t size = put_components(false, 2, bytes);
    check_components(volumes_file("a.mha",
                                  "ObjectType = Image\nNDims = 3\nDimSize = 4 3 2\n"
                                  "ElementType = MET_SHORT\nElementNumberOfChannels = 2\n"
                                  "BinaryDataByteOrderMSB = True\nElementDataFile = LOCAL\n",
                                  bytes, size),
                     2, NULL);
}

static void test_colours(void **state) {
    (void)state;
    uint8_t rgb[3 * N];
    float out[N];
    for (int i = 0; i < 3 * N; i++)
        rgb[i] = (uint8_t)(3 * i);
    static const char *const headers[] = {
        "NRRD0004\ntype: uchar\ndimension: 4\nsizes: 3 4 3 2\nencoding: raw\n"
        "kinds: RGB-color domain domain domain\n\n",
        "ObjectType = Image\nNDims = 3\nDimSize = 4 3 2\nElementType = MET_UCHAR\n"
        "ElementNumberOfChannels = 3\nElementDataFile = LOCAL\n"};
    for (int i = 0; i < 2; i++) {
        read_file(volumes_file(i ? "a.mha" : "a.nrrd", headers[i], rgb, sizeof rgb), NULL,
                  SAMPLE_F32, SAMPLE_U8, out);
        for (int n = 0; n < N; n++) {
            const double r = rgb[3 * n], g = rgb[3 * n + 1], b = rgb[3 * n + 2];
            assert_true(out[n] == (float)(0.2126 * r + 0.7152 * g + 0.0722 * b));
        }
    }
}

static void test_steps(void **state) {
    (void)state;
    int16_t in[3 * N], out[N];
    size_t packed;
    for (int i = 0; i < 3 * N; i++)
        in[i] = (int16_t)(i * 5);
    uint8_t *gzip = volumes_deflate(in, sizeof in, true, 1, &packed);
    char text[3 * N * 6 + 1], *at = text;
    for (int i = 0; i < 3 * N; i++)
        at += sprintf(at, "%d ", in[i]);
    const char *paths[4];
    paths[0] = volumes_file("a.nrrd",
                            "NRRD0004\ntype: short\ndimension: 4\nsizes: 4 3 2 3\nencoding: raw\n"
                            "endian: little\nkinds: space space space time\n\n",
                            in, sizeof in);
    volumes_truncate(paths[0], NULL, 0);
    paths[0] = strdup(paths[0]);
    paths[1] = strdup(volumes_file("b.nrrd",
                                   "NRRD0004\ntype: short\ndimension: 4\nsizes: 4 3 2 3\n"
                                   "encoding: gzip\nendian: little\n"
                                   "kinds: space space space time\n\n",
                                   gzip, packed));
    paths[2] = strdup(volumes_file("a.mha",
                                   "ObjectType = Image\nNDims = 4\nDimSize = 4 3 2 3\n"
                                   "ElementType = MET_SHORT\nElementDataFile = LOCAL\n",
                                   in, sizeof in));
    paths[3] = strdup(volumes_file("b.mha",
                                   "ObjectType = Image\nNDims = 4\nDimSize = 4 3 2 3\n"
                                   "ElementType = MET_SHORT\nBinaryData = False\n"
                                   "ElementDataFile = LOCAL\n",
                                   text, strlen(text)));
    for (int i = 0; i < 4; i++) {
        for (uint32_t step = 0; step < 3; step++) {
            read_file(paths[i], &(volume_hints){.step = step}, SAMPLE_I16, SAMPLE_I16, out);
            assert_memory_equal(out, in + step * N, sizeof out);
        }
        volumes_refused(paths[i], &(volume_hints){.step = 3}, ST_USAGE, "no step 3: there are 3");
        free((char *)(uintptr_t)paths[i]);
    }
    free(gzip);
}

static void test_wide_files(void **state) {
    (void)state;
    int64_t in[N];
    double out[N];
    for (int n = 0; n < N; n++)
        in[n] = ((int64_t)n - 12) * (1ll << 55);
    const volume_hints hints = {.dims = {4, 3, 2}, .type = SAMPLE_I64};
    read_file(scratch_write("a.raw", in, sizeof in), &hints, SAMPLE_F64, SAMPLE_I64, out);
    for (int n = 0; n < N; n++)
        assert_true(out[n] == (double)in[n]);
    in[17] = (1ll << 53) + 1;
    const char *path = scratch_write("a.raw", in, sizeof in);
    volumes_refused(path, &hints, ST_UNSUPPORTED,
                    "slice 1 (counted from 0): the sample with index 5 ");
    read_file(volumes_file("a.nrrd",
                           "NRRD0004\ntype: unsigned long long\ndimension: 3\nsizes: 4 3 2\n"
                           "encoding: text\n\n",
                           "18446744073709549568 9223372036854775808 2 3 4 5 6 7 8 9 0 1 2 3 4 5 "
                           "6 7 8 9 0 1 2 3",
                           85),
              NULL, SAMPLE_F64, SAMPLE_U64, out);
    assert_true(out[0] == 18446744073709549568.0 && out[1] == 0x1p63 && out[23] == 3);
    uint16_t halves[N];
    float floats[N];
    for (int n = 0; n < N; n++)
        halves[n] = (uint16_t)(n * 2500);
    const volume_hints of_halves = {.dims = {4, 3, 2}, .type = SAMPLE_F16};
    read_file(scratch_write("a_4x3x2_float16.raw", halves, sizeof halves), &of_halves, SAMPLE_F32,
              SAMPLE_F16, floats);
    for (int n = 0; n < N; n++)
        assert_true(floats[n] == (float)half_value(halves[n]) || isnan(half_value(halves[n])));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_half),
        cmocka_unit_test(test_wide_integers),
        cmocka_unit_test(test_choice),
        cmocka_unit_test(test_taken),
        cmocka_unit_test(test_vectors_of_nrrd),
        cmocka_unit_test(test_channels_of_metaimage),
        cmocka_unit_test(test_colours),
        cmocka_unit_test(test_steps),
        cmocka_unit_test(test_wide_files),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
