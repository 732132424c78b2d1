/* test_forms.c - trilinear forms and such with squares: their values, parts of a box, and what is
 * said of maps that bend little, against places drawn by chance.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "formats/base/hexahedron.h"
#include "tests/support/fields.h"

#include "formats/base/simd_one.h" /* before templates */

#include "formats/base/form_template.h"

enum { MAPS = 3000, PLACES = 20 };

static double draw(field_random *r, double most) {
    return field_random_in(r, -most, most);
}

static void draw_place(field_random *r, double most, double x[3]) {
    for (int i = 0; i < 3; i++)
        x[i] = draw(r, most);
}

static void test_corners(void **state) {
    field_random random = {FIELD_SEED};
    (void)state;
    for (int n = 0; n < MAPS; n++) {
        double v[TRILINEAR], form[FORM_TERMS], x[3], slope[3], unit[3];
        for (int c = 0; c < TRILINEAR; c++)
            v[c] = draw(&random, 1.0);
        form_of_corners(v, form);
        assert_true(form_size(form, TRILINEAR) <= 8.0);
        for (int c = 0; c < TRILINEAR; c++) {
            const double corner[3] = {c & 1 ? 1.0 : -1.0, c & 2 ? 1.0 : -1.0, c & 4 ? 1.0 : -1.0};
            assert_true(fabs(form_at(form, TRILINEAR, corner) - v[c]) < 1e-14);
        }
        draw_place(&random, 1.0, x);
        const double at[3] = {0.5 + 0.5 * x[0], 0.5 + 0.5 * x[1], 0.5 + 0.5 * x[2]};
        form_slope(form, TRILINEAR, x, slope);
        hexahedron_slope(v, at, unit);
        assert_true(fabs(form_at(form, TRILINEAR, x) - hexahedron_at(v, at)) < 1e-14);
        for (int i = 0; i < 3; i++)
            assert_true(fabs(slope[i] - 0.5 * unit[i]) < 1e-14); /* per half a side */
    }
}

/* What a form is by its definition. */
static double sum_of(const double *form, int terms, const double x[3]) {
    double sum = 0.0;
    for (int c = 0; c < terms; c++) {
        double term = form[c];
        for (int a = 0; a < 3; a++)
            term *= c < TRILINEAR ? (c >> a & 1 ? x[a] : 1.0)
                                  : (c == TRILINEAR + a ? x[a] * x[a] : 1.0);
        sum += term;
    }
    return sum;
}

static void test_forms(void **state) {
    static const int kinds[] = {TRILINEAR, FORM_TERMS};
    field_random random = {FIELD_SEED};
    (void)state;
    for (int n = 0; n < MAPS; n++) {
        const int terms = kinds[n % 2];
        double form[FORM_TERMS], part[FORM_TERMS], x[3], middle[3], half[3], slope[3], inside[3];
        double size = 0.0;
        for (int c = 0; c < terms; c++) {
            form[c] = part[c] = draw(&random, 1.0);
            size += fabs(form[c]);
        }
        draw_place(&random, 1.0, x);
        assert_true(fabs(form_at(form, terms, x) - sum_of(form, terms, x)) < 1e-14);
        assert_true(fabs(form_size(form, terms) - size) < 1e-14);
        assert_true(fabs(size - form_bent(form, terms) - fabs(form[0]) - fabs(form[1]) -
                         fabs(form[2]) - fabs(form[4])) < 1e-14);
        form_slope(form, terms, x, slope);
        for (int i = 0; i < 3; i++) {
            /* Quadratic in each parameter: the difference of two values is exact. */
            double before[3] = {x[0], x[1], x[2]}, after[3] = {x[0], x[1], x[2]};
            before[i] -= 0.5;
            after[i] += 0.5;
            assert_true(fabs(sum_of(form, terms, after) - sum_of(form, terms, before) - slope[i]) <
                        1e-14);
            middle[i] = draw(&random, 0.5);
            half[i] = 0.25 * (1.0 + field_random_unit(&random));
            inside[i] = middle[i] + half[i] * x[i];
        }
        form_restrict(part, terms, middle, half);
        assert_true(fabs(form_at(part, terms, x) - form_at(form, terms, inside)) < 1e-14);
    }
}

static void jacobian(const double form[3][FORM_TERMS], const double x[3], double out[3][3]) {
    for (int k = 0; k < 3; k++)
        form_slope(form[k], FORM_TERMS, x, out[k]);
}

/* A straight map, and products and squares of the parameters, more of them from map to map. */
static void draw_map(field_random *r, double bent, int products, double form[3][FORM_TERMS]) {
    for (int k = 0; k < 3; k++)
        for (int c = 0; c < FORM_TERMS; c++) {
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
        static const int products[] = {1 << 7, 1 << 3, 1 << 3 | 1 << 5 | 1 << 6,
                                       0xff,   1 << 8, 0x768};
        const int which = n % 6, terms = which < 4 ? TRILINEAR : FORM_TERMS;
        double form[3][FORM_TERMS];
        form_bend b;
        draw_map(&random, 1.2 * field_random_unit(&random), products[which], form);
        if (!form_bend_of(form, terms, rounding, &b))
            continue;
        const double larger = n % 2 ? 1.0 : 1.125;
        const bool single = form_is_single(&b, terms, larger);
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
            turns = turns || !(form_invert(mixed, inverse) * b.det > 0.0);
        }
        assert_false(single && turns);
        said += single;
        turned += turns;
        /* A root in the box is no further from at[] than the rest is large. */
        double root[3];
        draw_place(&random, 1.0, root);
        for (int k = 0; k < 3; k++)
            form[k][0] -= form_at(form[k], terms, root);
        assert_true(form_bend_of(form, terms, rounding, &b));
        for (int i = 0; i < 3; i++) {
            const double rest = form_rest(&b, terms, i);
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
    double form[3][FORM_TERMS] = {{0.0, 1.0}, {0.0, 0.0, 1.0}, {0.0, 1.0, 1.0, 0.0, 0.0}};
    form_bend b;
    (void)state;
    assert_false(form_bend_of(form, TRILINEAR, rounding, &b));
    form[2][4] = 1.0;
    assert_true(form_bend_of(form, TRILINEAR, rounding, &b));
    assert_false(form_bend_of(form, TRILINEAR, much, &b));
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_corners), cmocka_unit_test(test_forms),
                                       cmocka_unit_test(test_single), cmocka_unit_test(test_flat)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
