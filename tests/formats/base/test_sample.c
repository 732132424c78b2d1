/* test_sample.c - sample types: names, byte order, conversion to the stored types; and grids of
 * them.
 */
/* marks: bits */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <math.h>
#include <string.h>

#include "formats/base/sample.h"
#include "formats/grid/grid.h"

static void test_names(void **state) {
    (void)state;
    for (int t = SAMPLE_U8; t <= SAMPLE_I64; t++) {
        sample_type back = 0;
        assert_true(sample_parse(sample_name((sample_type)t), &back));
        assert_int_equal(back, t);
    }
    static const struct {
        const char *name;
        sample_type type;
    } good[] = {{"unsigned char", SAMPLE_U8}, {"UINT8", SAMPLE_U8},    {"signed char", SAMPLE_I8},
                {"ushort", SAMPLE_U16},       {"short", SAMPLE_I16},   {"unsigned int", SAMPLE_U32},
                {"int32_t", SAMPLE_I32},      {"float32", SAMPLE_F32}, {"Double", SAMPLE_F64}};
    for (size_t i = 0; i < sizeof good / sizeof *good; i++) {
        sample_type type = 0;
        assert_true(sample_parse(good[i].name, &type));
        assert_int_equal(type, good[i].type);
    }
    sample_type type = SAMPLE_I8;
    assert_false(sample_parse("int128", &type));
    assert_false(sample_parse("", &type));
    assert_int_equal(type, SAMPLE_I8);
    assert_int_equal(sample_size(0), 0);
    assert_int_equal(sample_size(12), 0);
    assert_string_equal(sample_name(12), "?");
}

static void test_swap(void **state) {
    (void)state;
    const uint8_t in[8] = {1, 2, 3, 4, 5, 6, 7, 8};
    const struct {
        sample_type type;
        uint8_t out[8];
    } cases[] = {{SAMPLE_U8, {1, 2, 3, 4, 5, 6, 7, 8}},
                 {SAMPLE_I16, {2, 1, 4, 3, 6, 5, 8, 7}},
                 {SAMPLE_F32, {4, 3, 2, 1, 8, 7, 6, 5}},
                 {SAMPLE_F64, {8, 7, 6, 5, 4, 3, 2, 1}}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        uint8_t bytes[9]; /* unaligned, too */
        memcpy(bytes + 1, in, 8);
        sample_swap(cases[i].type, bytes + 1, 8 / sample_size(cases[i].type));
        assert_memory_equal(bytes + 1, cases[i].out, 8);
    }
}

static void test_stored(void **state) {
    (void)state;
    const uint32_t u[3] = {0, 16777217, UINT32_MAX};
    float out[5];
    assert_true(sample_to_stored(SAMPLE_U32, u, out, 3) == 1);
    assert_true(out[1] == 16777216.0f && out[2] == 4294967296.0f);
    const int32_t i[2] = {-16777217, INT32_MIN};
    assert_true(sample_to_stored(SAMPLE_I32, i, out, 2) == 1);
    assert_true(out[0] == -16777216.0f && out[1] == -2147483648.0f);
    double d[5] = {0.5, NAN, INFINITY, -INFINITY, 1 + 0x1p-25};
    assert_true(sample_to_stored(SAMPLE_F64, d, d, 5) == 0x1p-25); /* in place */
    memcpy(out, d, sizeof out);
    assert_true(out[0] == 0.5f && isnan(out[1]) && out[2] == INFINITY && out[3] == -INFINITY);
    const double large[2] = {1, 1e300};
    assert_true(sample_to_stored(SAMPLE_F64, large, out, 2) == INFINITY);
    const int16_t s[2] = {-3, 4};
    int16_t copy[2];
    assert_true(sample_to_stored(SAMPLE_I16, s, copy, 2) == 0);
    assert_memory_equal(s, copy, sizeof s);
    assert_true(sample_get(SAMPLE_I16, s, 0) == -3);
}

/* ---- grids ---- */

static const uint32_t dims[3] = {3, 2, 4};

static void test_grid(void **state) {
    (void)state;
    grid g;
    grid_init(&g, dims, SAMPLE_U16);
    assert_int_equal(grid_check(&g, "it"), ST_OK);
    assert_int_equal(grid_samples(&g), 24);
    assert_int_equal(grid_slice_bytes(&g), 12);
    assert_false(grid_is_rectilinear(&g));
    grid bad = g;
    bad.dims[1] = 1;
    assert_int_equal(grid_check(&bad, "it"), ST_UNSUPPORTED);
    assert_non_null(strstr(status_text(), "it: 1 sample along y"));
    bad.dims[1] = GRID_DIM_MAX + 1;
    assert_int_equal(grid_check(&bad, "it"), ST_UNSUPPORTED);
    const double wrong[] = {0, NAN, INFINITY};
    for (int i = 0; i < 3; i++) {
        bad = g;
        bad.to_world[2][2] = wrong[i];
        assert_int_equal(grid_check(&bad, "it"), ST_CORRUPT);
    }
    /* Tiny and huge spacings are fine, also together, as far as pictures are right; directions in a
     * plane are not. */
    for (int row = 0; row < 3; row++)
        bad.to_world[row][row] = row == 1 ? -0x1p-201 : 0x1p200;
    assert_int_equal(grid_check(&bad, "it"), ST_CORRUPT);
    bad.to_world[1][1] = -0x1p-200;
    assert_int_equal(grid_check(&bad, "it"), ST_OK);
    bad.to_world[2][2] = 0x1p201;
    assert_int_equal(grid_check(&bad, "it"), ST_CORRUPT);
    bad.to_world[2][2] = 0x1p200;
    bad.to_world[1][0] = 0x1p200;
    bad.to_world[0][1] = bad.to_world[1][1] = 0x1p-200;
    assert_int_equal(grid_check(&bad, "it"), ST_CORRUPT);
}

static void test_axes(void **state) {
    (void)state;
    mem m;
    mem_init(&m, 0);
    grid g;
    grid_init(&g, dims, SAMPLE_U8);
    const double up[4] = {-1, 0, 5, 5.5}, down[3] = {4, 2, 1.5};
    assert_int_equal(grid_set_axis(&g, &m, "it", 2, up), ST_OK);
    assert_true(grid_is_rectilinear(&g));
    assert_memory_equal(g.axis[2], up, sizeof up);
    assert_true(g.axis[1][0] == 0 && g.axis[1][1] == 1);
    /* Decreasing coordinates are mirrored: node i of x still lies at down[i] in the world. */
    assert_int_equal(grid_set_axis(&g, &m, "it", 0, down), ST_OK);
    for (int i = 0; i < 3; i++) {
        assert_true(i == 0 || g.axis[0][i] > g.axis[0][i - 1]);
        assert_true(g.to_world[0][0] * g.axis[0][i] == down[i]);
    }
    const double bad[3][3] = {{0, 1, 1}, {0, -1, 2}, {0, NAN, 2}};
    static const char *const said[3] = {"coordinate 2 along x", "coordinate 2 along x",
                                        "coordinate 1 along x is nan"};
    for (int i = 0; i < 3; i++) {
        assert_int_equal(grid_set_axis(&g, &m, "it", 0, bad[i]), ST_CORRUPT);
        assert_non_null(strstr(status_text(), said[i]));
    }
    grid_release(&g, &m);
    assert_int_equal(mem_used(&m), 0);
}

static void test_missing(void **state) {
    (void)state;
    static const struct {
        sample_type type;
        double held, not_held;
    } rows[] = {{SAMPLE_U8, 255, 256},          {SAMPLE_I8, -128, -129},
                {SAMPLE_U16, 65535, -1},        {SAMPLE_I16, -32768, 32768},
                {SAMPLE_U32, 4294967295., 0.5}, {SAMPLE_I32, -2147483648., 2147483648.},
                {SAMPLE_F32, 0.1, 1e39},        {SAMPLE_F32, NAN, -1e39}};
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        assert_true(sample_holds(rows[i].type, rows[i].held));
        assert_false(sample_holds(rows[i].type, rows[i].not_held));
        assert_true(sample_holds(rows[i].type, NAN) != sample_is_integer(rows[i].type));
    }
    /* From the end of the same buffer. */
    float out[5];
    const uint8_t bytes[5] = {0, 255, 7, 255, 254};
    memcpy((char *)out + sizeof out - sizeof bytes, bytes, sizeof bytes);
    const void *in = (const char *)out + sizeof out - sizeof bytes;
    assert_int_equal(sample_to_floats(SAMPLE_U8, in, out, 5, 255), 5);
    assert_true(out[0] == 0 && isnan(out[1]) && out[2] == 7 && isnan(out[3]) && out[4] == 254);
    const int32_t wide[3] = {16777216, 16777217, 33554433};
    assert_int_equal(sample_to_floats(SAMPLE_I32, wide, out, 3, -1), 1);
    assert_int_equal(sample_to_floats(SAMPLE_I32, wide, out, 3, 16777217), 2);
    assert_true(out[0] == 16777216 && isnan(out[1]));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_names), cmocka_unit_test(test_swap), cmocka_unit_test(test_stored),
        cmocka_unit_test(test_grid),  cmocka_unit_test(test_axes), cmocka_unit_test(test_missing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
