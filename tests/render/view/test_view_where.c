/* test_view_where.c - the squares with provisional pixels, against pixel by pixel.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "render/view/view_where.h"
#include "tests/support/fields.h"

enum { SIDE_MAX = 700 };

/* What a reader makes of it: a byte a square. */
static uint8_t *read_runs(json_t *described, uint32_t *side, uint32_t *columns, size_t *count) {
    json_t *run;
    size_t k;
    uint8_t *squares = NULL;
    *side = (uint32_t)json_integer_value(json_object_get(described, "side"));
    *columns = (uint32_t)json_integer_value(json_object_get(described, "columns"));
    *count = 0;
    json_array_foreach(json_object_get(described, "runs"), k, run) {
        const size_t length = (size_t)json_integer_value(run);
        assert_true(length > 0 || k == 0);
        squares = realloc(squares, *count + length + 1);
        assert_non_null(squares);
        memset(squares + *count, k % 2, length);
        *count += length;
    }
    return squares;
}

static void check(const uint8_t *provisional, uint32_t width, uint32_t height) {
    uint32_t side, columns;
    size_t count;
    json_t *described = view_where_describe(provisional, width, height);
    assert_non_null(described);
    uint8_t *squares = read_runs(described, &side, &columns, &count);
    uint8_t *expected = calloc(count + 1, 1);
    assert_non_null(expected);
    assert_true(side >= 1 && columns == (width + side - 1) / side);
    assert_int_equal(count, (size_t)columns * ((height + side - 1) / side));
    assert_true((size_t)(width / side) * (height / side) <= VIEW_WHERE_MAX);
    for (uint32_t y = 0; y < height; y++)
        for (uint32_t x = 0; x < width; x++)
            expected[(size_t)(y / side) * columns + x / side] |=
                !provisional || provisional[(size_t)y * width + x];
    assert_memory_equal(squares, expected, count);
    json_decref(described);
    free(squares);
    free(expected);
}

static void test_random(void **state) {
    (void)state;
    static uint8_t provisional[SIDE_MAX * SIDE_MAX];
    field_random r = {FIELD_SEED};
    for (int k = 0; k < 300; k++) {
        const uint32_t width = 1 + (uint32_t)field_random_below(&r, SIDE_MAX);
        const uint32_t height = 1 + (uint32_t)field_random_below(&r, SIDE_MAX);
        const long rare = k % 3 == 0 ? 2 : 20000;
        for (size_t i = 0; i < (size_t)width * height; i++)
            provisional[i] = field_random_below(&r, rare) == 0;
        check(provisional, width, height);
        check(NULL, width, height);
    }
}

/* A small picture is told pixel by pixel. */
static void test_small(void **state) {
    (void)state;
    const uint8_t pixels[6] = {1, 1, 0, 0, 1, 0};
    json_t *described = view_where_describe(pixels, 3, 2);
    json_t *expected =
        json_pack("{s:i,s:i,s:[i,i,i,i,i]}", "side", 1, "columns", 3, "runs", 0, 2, 2, 1, 1);
    assert_true(json_equal(described, expected));
    json_decref(described);
    json_decref(expected);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_random),
        cmocka_unit_test(test_small),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
