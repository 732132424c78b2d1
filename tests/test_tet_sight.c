/* test_tet_sight.c - the isopolygon that tiles make of all coordinates at a time against the
 * kernel's, to the bit: any tets, flat ones, values at the isovalue, beyond floats' middle range.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

#include "tests/support/simd_wide.h"

#include "render/tet_sight_template.h"
#include "tests/support/fields.h"

enum { TETS = 400000 };

/* Lattice points make tets that are flat, or that nearly are when they lie far from the origin. */
static tet any_tet(field_random *r) {
    static const double sizes[] = {1.0, 1e-30, 1e30, 1e-3};
    const double size = sizes[field_random_below(r, 4)];
    const bool lattice = field_random_below(r, 2) == 0;
    const double away = field_random_below(r, 4) == 0 ? 1e6 : 0.0;
    tet x;
    for (int v = 0; v < 4; v++) {
        for (int a = 0; a < 3; a++) {
            const double at =
                lattice ? (double)field_random_below(r, 3) : field_random_in(r, -1.0, 1.0);
            x.p[v][a] = (float)(size * (at + away));
        }
    }
    return x;
}

/* Values between, at and beyond; now and then none that is a number. */
static void any_values(field_random *r, float f[4]) {
    static const float odd[] = {0.0f, -0.0f, 3e38f, -3e38f, 1e-45f, INFINITY, -INFINITY, NAN};
    for (int v = 0; v < 4; v++)
        f[v] = field_random_below(r, 8) == 0 ? odd[field_random_below(r, 8)]
                                             : (float)field_random_in(r, -1.0, 1.0);
}

static void test_same_polygon(void **state) {
    (void)state;
    field_random r = {29};
    int any[5] = {0}, flat = 0;
    for (int i = 0; i < TETS; i++) {
        tet x = any_tet(&r);
        any_values(&r, x.f);
        const double iso = field_random_below(&r, 3) == 0 && isfinite(x.f[0])
                               ? (double)x.f[0]
                               : field_random_in(&r, -0.5, 0.5);
        isopolygon want, got;
        const bool there = isopolygon_of(&x, iso, &want);
        assert_int_equal(isopolygon_near(&x, iso, &got), there);
        any[there ? want.count : 0]++;
        if (!there)
            continue;
        assert_int_equal(got.count, want.count);
        assert_memory_equal(got.edge, want.edge, sizeof got.edge);
        assert_memory_equal(got.p, want.p, sizeof got.p);
        double p[4][3];
        for (int k = 0; k < 12; k++)
            p[k / 3][k % 3] = (double)x.p[k / 3][k % 3];
        flat += edge_sign_of_tet((const double(*)[3])p) == 0;
    }
    assert_true(any[0] > TETS / 20 && any[3] > TETS / 20 && any[4] > TETS / 20);
    assert_true(flat > TETS / 100);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_same_polygon),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
