/* test_packed_samples.c - what packed samples become: types, fill values, ranges, 64 bits,
 * components. The importers' tests hold whole files against other readers; here are the edges.
 */
/* marks: bits */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <math.h>
#include <stdint.h>
#include <string.h>

#include "prep/import/packed_samples.h"

static packed_samples plain(sample_type type) {
    packed_samples p;
    packed_init(&p, type, PACKED_NARROW);
    return p;
}

static void keeps_what_needs_nothing(void **state) {
    static const sample_type types[] = {SAMPLE_U8,  SAMPLE_I8,  SAMPLE_U16, SAMPLE_I16,
                                        SAMPLE_F32, SAMPLE_U32, SAMPLE_I32, SAMPLE_F64};
    (void)state;
    for (size_t i = 0; i < sizeof types / sizeof types[0]; i++) {
        packed_samples p = plain(types[i]);
        uint8_t in[64], out[64];
        for (uint8_t k = 0; k < sizeof in; k++)
            in[k] = (uint8_t)(k * 37 + 11);
        const size_t count = sizeof in / sample_size(types[i]);
        assert_int_equal(packed_type(&p), types[i]);
        assert_int_equal(packed_unpack(&p, in, out, count), count);
        assert_memory_equal(in, out, sizeof in);
    }
}

static void tells_the_type(void **state) {
    static const struct {
        sample_type from, scaled, filled;
    } rows[] = {{SAMPLE_U8, SAMPLE_F32, SAMPLE_F32},
                {SAMPLE_I16, SAMPLE_F32, SAMPLE_F32},
                {SAMPLE_U32, SAMPLE_F64, SAMPLE_F64},
                {SAMPLE_F32, SAMPLE_F32, SAMPLE_F32},
                {SAMPLE_F64, SAMPLE_F64, SAMPLE_F64}};
    (void)state;
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        packed_samples scaled = plain(rows[i].from), filled = plain(rows[i].from);
        scaled.scale = 2;
        packed_fill(&filled, 1);
        assert_int_equal(packed_type(&scaled), rows[i].scaled);
        assert_int_equal(packed_type(&filled), rows[i].filled);
    }
}

static void marks_fills_and_range_in_stored_numbers(void **state) {
    const int16_t in[] = {-9, 7, 8, 100, 101};
    float out[5];
    packed_samples p = plain(SAMPLE_I16);
    (void)state;
    packed_fill(&p, 7);
    p.has_range = true;
    p.least = -8;
    p.most = 100;
    p.scale = 0.5;
    p.offset = 1;
    assert_int_equal(packed_unpack(&p, in, out, 5), 5);
    assert_true(isnan(out[0]) && isnan(out[1]) && isnan(out[4]));
    assert_true(out[2] == 5 && out[3] == 51);
    p.valid_values = true; /* now 1 + half of it lies in the range */
    assert_int_equal(packed_unpack(&p, in, out, 5), 5);
    assert_true(out[0] == -3.5f && isnan(out[1]) && out[4] == 51.5f);
}

static void compares_fills_as_the_type_has_them(void **state) {
    const float in[] = {-1e34f, 3};
    float out[2];
    packed_samples p = plain(SAMPLE_F32);
    (void)state;
    packed_fill(&p, -1e34L); /* which no float is */
    assert_int_equal(packed_unpack(&p, in, out, 2), 2);
    assert_true(isnan(out[0]) && out[1] == 3);
}

static void refuses_what_no_double_holds(void **state) {
    const int64_t in[] = {INT64_MIN, (1ll << 53) + 2, -(1ll << 53) - 1, 0};
    const uint64_t large[] = {UINT64_MAX, UINT64_MAX - 2047};
    double out[4];
    packed_samples p, u;
    (void)state;
    packed_init(&p, SAMPLE_F64, PACKED_I64);
    packed_init(&u, SAMPLE_F64, PACKED_U64);
    assert_int_equal(packed_unpack(&p, in, out, 2), 2);
    assert_true(out[0] == -0x1p63 && out[1] == 0x1p53 + 2);
    assert_int_equal(packed_unpack(&p, in, out, 4), 2);
    assert_int_equal(packed_unpack(&u, large, out, 2), 0);
    packed_fill(&u, (long double)UINT64_MAX); /* told apart from its neighbours */
    assert_int_equal(packed_unpack(&u, large, out, 2), 2);
    assert_true(isnan(out[0]) && out[1] == 0x1p64 - 2048);
}

static void takes_components_across_blocks(void **state) {
    enum { SAMPLES = 5000 };
    static uint8_t in[SAMPLES * 3], one[SAMPLES];
    static float light[SAMPLES];
    packed_samples p = plain(SAMPLE_U8);
    (void)state;
    for (size_t i = 0; i < sizeof in; i++)
        in[i] = (uint8_t)(i * 7);
    p.components = 3;
    assert_int_equal(packed_unpack(&p, in, light, SAMPLES), SAMPLES);
    p.component = 2;
    assert_int_equal(packed_type(&p), SAMPLE_U8);
    assert_int_equal(packed_unpack(&p, in, one, SAMPLES), SAMPLES);
    for (size_t i = 0; i < SAMPLES; i++) {
        const uint8_t *c = in + 3 * i;
        assert_true(one[i] == c[1]);
        assert_true(light[i] == (float)(0.2126 * c[0] + 0.7152 * c[1] + 0.0722 * c[2]));
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(keeps_what_needs_nothing),
        cmocka_unit_test(tells_the_type),
        cmocka_unit_test(marks_fills_and_range_in_stored_numbers),
        cmocka_unit_test(compares_fills_as_the_type_has_them),
        cmocka_unit_test(refuses_what_no_double_holds),
        cmocka_unit_test(takes_components_across_blocks),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
