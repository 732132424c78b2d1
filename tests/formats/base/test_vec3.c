/* test_vec3.c - vectors of three doubles: signs, orders of operations, extreme lengths. */
/* marks: bits */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

#include "formats/base/vec3.h"

static const double A[3] = {1, 2, 3}, B[3] = {-4, 5, 7}, C[3] = {0.5, -8, 2};

static void check(const double got[3], double x, double y, double z) {
    const double want[3] = {x, y, z};
    assert_memory_equal(got, want, sizeof want);
}

static void test_products(void **state) {
    (void)state;
    double v[3];
    assert_true(vec3_dot(A, B) == 27);
    vec3_cross(A, B, v);
    check(v, -1, -19, 13);
    assert_true(vec3_det(A, B, C) == 177.5 && vec3_det(B, A, C) == -177.5);
    assert_true(vec3_size(B) == 16 && vec3_length((const double[3]){2, -3, 6}) == 7);
    vec3_sub(A, B, v);
    check(v, 5, -3, -4);
    vec3_sub(v, v, v);
    check(v, 0, 0, 0);
}

/* x, then y, then z: pictures depend on the last bit. */
static void test_order(void **state) {
    (void)state;
    const double one[3] = {1, 1, 1}, large[3] = {1, 0x1p60, -0x1p60};
    assert_true(vec3_dot(one, large) == 0 && vec3_dot(large, one) == 0);
    const double late[3] = {0x1p60, -0x1p60, 1};
    assert_true(vec3_dot(one, late) == 1);
}

static void test_unit(void **state) {
    (void)state;
    static const double scales[] = {1, 0x1p-1074, 0x1p-600, 0x1p600, 0x1p1021};
    for (size_t i = 0; i < sizeof scales / sizeof *scales; i++) {
        double v[3] = {3 * scales[i], 0, -4 * scales[i]};
        assert_true(vec3_unit(v, v));
        assert_true(fabs(v[0] - 0.6) < 1e-15 && v[1] == 0 && fabs(v[2] + 0.8) < 1e-15);
    }
    static const double without[][3] = {
        {0, -0.0, 0}, {1, -INFINITY, 0}, {NAN, INFINITY, 0}, {NAN, NAN, NAN}};
    for (size_t i = 0; i < sizeof without / sizeof *without; i++) {
        double v[3] = {1, 2, 3};
        assert_false(vec3_unit(without[i], v));
        check(v, 1, 2, 3);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_products),
                                       cmocka_unit_test(test_order), cmocka_unit_test(test_unit)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
