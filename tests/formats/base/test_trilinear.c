/* test_trilinear.c - trilinear forms: their values, parts of a box, and what is said of maps that
 * bend little, against places drawn by chance.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "formats/base/hexahedron.h"
#include "formats/base/simd_one.h"
#include "formats/base/trilinear_template.h"
#include "tests/support/fields.h"

enum { MAPS = 3000, PLACES = 20 };

static double draw(field_random *r, double most) {
    return field_random_in(r, -most, most);
}

static void draw_place(field_random *r, double most, double x[3]) {
    for (int i = 0; i < 3; i++)
        x[i] = draw(r, most);
}

static void test_forms(void **state) {
    field_random random = {FIELD_SEED};
    (void)state;
    for (int n = 0; n < MAPS; n++) {
        double v[TRILINEAR], form[TRILINEAR], part[TRILINEAR], x[3], middle[3], half[3];
        for (int c = 0; c < TRILINEAR; c++)
            v[c] = draw(&random, 1.0);
        trilinear_of(v, form);
        assert_true(trilinear_size(form) <= 8.0);
        for (int c = 0; c < TRILINEAR; c++) {
            const double corner[3] = {c & 1 ? 1.0 : -1.0, c & 2 ? 1.0 : -1.0, c & 4 ? 1.0 : -1.0};
            assert_true(fabs(trilinear_at(form, corner) - v[c]) < 1e-14);
            part[c] = form[c];
        }
        draw_place(&random, 1.0, x);
        const double at[3] = {0.5 + 0.5 * x[0], 0.5 + 0.5 * x[1], 0.5 + 0.5 * x[2]};
        double slope[3], unit[3], inside[3];
        trilinear_slope(form, x, slope);
        hexahedron_slope(v, at, unit);
        assert_true(fabs(trilinear_at(form, x) - hexahedron_at(v, at)) < 1e-14);
        for (int i = 0; i < 3; i++) {
            assert_true(fabs(slope[i] - 0.5 * unit[i]) < 1e-14); /* per half a side */
            middle[i] = draw(&random, 0.5);
            half[i] = 0.25 * (1.0 + field_random_unit(&random));
            inside[i] = middle[i] + half[i] * x[i];
        }
        trilinear_restrict(part, middle, half);
        assert_true(fabs(trilinear_at(part, x) - trilinear_at(form, inside)) < 1e-14);
    }
}

static void jacobian(const double form[3][TRILINEAR], const double x[3], double out[3][3]) {
    for (int k = 0; k < 3; k++)
        trilinear_slope(form[k], x, out[k]);
}

/* A straight map, and products of the parameters, more of them from map to map. */
static void draw_map(field_random *r, double bent, int products, double form[3][TRILINEAR]) {
    for (int k = 0; k < 3; k++)
        for (int c = 0; c < TRILINEAR; c++) {
            const bool linear = c == 1 || c == 2 || c == 4, own = c == 1 << k;
            form[k][c] = linear ? own + draw(r, 0.3) : products >> c & 1 ? draw(r, bent) : 0.0;
        }
}

/* Where maps are said to be single no determinant changes its sign, with each column at a place of
 * its own; where one does change it, they are not said to be. */
static void test_single(void **state) {
    field_random random = {FIELD_SEED};
    const double rounding[3] = {0x1p-48, 0x1p-48, 0x1p-48};
    long said = 0, turned = 0, roots = 0;
    (void)state;
    for (int n = 0; n < MAPS; n++) {
        static const int products[] = {1 << 7, 1 << 3, 1 << 3 | 1 << 5 | 1 << 6, 0xff};
        double form[3][TRILINEAR];
        trilinear_bend b;
        draw_map(&random, 1.2 * field_random_unit(&random), products[n % 4], form);
        if (!trilinear_bend_of(form, rounding, &b))
            continue;
        const double larger = n % 2 ? 1.0 : 1.125;
        const bool single = trilinear_is_single(&b, larger);
        bool turns = false;
        for (int i = 0; i < PLACES * PLACES; i++) {
            double mixed[3][3], inverse[3][3];
            for (int column = 0; column < 3; column++) {
                double x[3], slope[3][3];
                draw_place(&random, larger, x);
                for (int a = 0; a < 3; a++) /* at corners, more often than not */
                    x[a] = i % 4 ? (x[a] > 0.0 ? larger : -larger) : x[a];
                jacobian(form, x, slope);
                for (int k = 0; k < 3; k++)
                    mixed[k][column] = slope[k][column];
            }
            turns = turns || !(trilinear_invert(mixed, inverse) * b.det > 0.0);
        }
        assert_false(single && turns);
        said += single;
        turned += turns;
        /* A root in the box is no further from at[] than the rest is large. */
        double root[3];
        draw_place(&random, 1.0, root);
        for (int k = 0; k < 3; k++)
            form[k][0] -= trilinear_at(form[k], root);
        assert_true(trilinear_bend_of(form, rounding, &b));
        for (int i = 0; i < 3; i++) {
            const double rest = b.two[0][i] + b.two[1][i] + b.two[2][i] + b.all[i];
            assert_true(fabs(b.at[i] - root[i]) <= rest + 1e-12);
            roots += fabs(b.at[i] - root[i]) > 0.5 * rest;
        }
    }
    print_message("%ld of %d single, %ld not; %ld parameters beyond half of the rest\n", said, MAPS,
                  turned, roots);
    assert_true(said > MAPS / 4 && turned > MAPS / 10 && roots > MAPS / 10);
}

static void test_flat(void **state) {
    const double rounding[3] = {0.0, 0.0, 0.0}, much[3] = {0.0, 1e-5, 0.0};
    double form[3][TRILINEAR] = {{0.0, 1.0}, {0.0, 0.0, 1.0}, {0.0, 1.0, 1.0, 0.0, 0.0}};
    trilinear_bend b;
    (void)state;
    assert_false(trilinear_bend_of(form, rounding, &b));
    form[2][4] = 1.0;
    assert_true(trilinear_bend_of(form, rounding, &b));
    assert_false(trilinear_bend_of(form, much, &b));
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_forms), cmocka_unit_test(test_single),
                                       cmocka_unit_test(test_flat)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
