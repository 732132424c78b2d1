/* test_slice_planes.c - where slices lie: curved ones along their lines; layers of nodes, which are
 * the samples; planes' own rectangles; faces of the volume. */
/* marks: bits threads */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <math.h>
#include <stdlib.h>

#include "formats/base/vec3.h"
#include "tests/support/fixture.h"
#include "tests/support/slice_subject.h"

/* ---- Curved slices ---- */

static void test_curved(void **state) {
    static const double line[][3] = {{3, 4, 5},   {20, 4, 5},     {20, 4, 5},
                                     {30, 25, 8}, {12.5, 30, 20}, {12.5, 30, 20}};
    static double value[SLICE_PIXELS];
    enum { POINTS = sizeof line / sizeof *line };
    (void)state;
    slice_subject *x = slice_subject_of_field("noise-u8", NULL, 41, false);
    leafcast *v = fixture_open(x->path, NULL);
    leafcast_slice_pixels s = slice_subject_sized(SLICE_WIDTH, SLICE_HEIGHT);
    s.line = line;
    s.line_count = POINTS;
    s.v[1] = 2.5;
    s.v[2] = 40;
    (void)slice_subject_sample(v, &s, value);
    long double length[POINTS] = {0};
    for (int k = 1; k < POINTS; k++) {
        long double sum = 0;
        for (int a = 0; a < 3; a++)
            sum += (line[k][a] - line[k - 1][a]) * (line[k][a] - line[k - 1][a]);
        length[k] = length[k - 1] + sqrtl(sum);
    }
    int inside = 0;
    for (int i = 0; i < SLICE_PIXELS; i++) {
        const long double at = (i % SLICE_WIDTH + 0.5L) / SLICE_WIDTH * length[POINTS - 1];
        double point[3];
        int k = 0;
        while (length[k + 1] < at)
            k++;
        for (int a = 0; a < 3; a++)
            point[a] = (double)(line[k][a] +
                                (at - length[k]) / (length[k + 1] - length[k]) *
                                    (line[k + 1][a] - line[k][a]) +
                                (i / SLICE_WIDTH + 0.5L) / SLICE_HEIGHT * s.v[a]);
        const naive_point truth = naive_points_grid(&x->grid, 0, point);
        assert_true(truth.doubtful || truth.inside == !isnan(value[i]));
        inside += truth.inside;
        if (truth.inside && !truth.doubtful)
            assert_true(fabsl(value[i] - truth.linear) <= 1e-9L * truth.magnitude);
    }
    assert_true(inside > SLICE_PIXELS / 2 && inside < SLICE_PIXELS);
    leafcast_close(v);
    slice_subject_free(x);
}

/* ---- Slices across the volume ---- */

/* All node planes, in the nearest interpolation, are the samples. */
static void test_layers_are_samples(void **state) {
    (void)state;
    slice_subject *x = slice_subject_turned();
    leafcast *v = fixture_open(x->path, NULL);
    const long dims[3] = {SLICE_TURNED_X, SLICE_TURNED_Y, SLICE_TURNED_Z};
    double *value = malloc(sizeof *value << 20);
    for (int axis = 0; axis < 3; axis++) {
        const int right = axis == 0 ? 1 : 0, up = axis == 2 ? 1 : 2;
        for (long k = 0; k < dims[axis]; k++) {
            leafcast_slice_pixels s = slice_subject_sized(0, 0);
            s.interpolation = LEAFCAST_INTERPOLATION_NEAREST;
            assert_int_equal(leafcast_layer_slice(v, axis, (uint32_t)k, &s), LEAFCAST_OK);
            s.width = (uint32_t)dims[right]; /* cells are no cubes */
            s.height = (uint32_t)dims[up];
            (void)slice_subject_sample(v, &s, value);
            for (long row = 0; row < dims[up]; row++)
                for (long column = 0; column < dims[right]; column++) {
                    long node[3];
                    node[axis] = k;
                    node[right] = column;
                    node[up] = dims[up] - 1 - row;
                    assert_true(value[row * dims[right] + column] ==
                                (double)slice_subject_turned_value(node[0], node[1], node[2]));
                }
        }
    }
    free(value);
    leafcast_close(v);
    slice_subject_free(x);
}

static void test_layer_size(void **state) {
    (void)state;
    field f;
    assert_true(field_make(&f, "noise-u8", 41, FIELD_SEED));
    leafcast *v = fixture_open(fixture_leaf(&f, 4, 1, false), NULL);
    for (int nearest = 0; nearest < 2; nearest++)
        for (int axis = 0; axis < 3; axis++) {
            leafcast_slice_pixels s = slice_subject_sized(0, 0);
            s.interpolation = (leafcast_interpolation)nearest;
            assert_int_equal(leafcast_layer_slice(v, axis, 3, &s), LEAFCAST_OK);
            assert_int_equal(s.width, f.dims[axis == 0] - 1 + nearest);
            assert_int_equal(s.height, f.dims[axis == 2 ? 1 : 2] - 1 + nearest);
            s.level = 1;
            assert_int_equal(leafcast_layer_slice(v, axis, 3, &s), LEAFCAST_OK);
            assert_int_equal(s.width, f.dims[axis == 0] / 2 + nearest);
        }
    leafcast_close(v);
    field_release(&f);
}

/* The plane's own rectangle: in the plane, seen from the right side, holding all of the cut and no
 * more. */
static void check_plane(leafcast *v, const double plane[4], const double corners[8][3]) {
    leafcast_slice_pixels s = slice_subject_sized(0, 0);
    assert_int_equal(leafcast_plane_slice(v, plane, &s), LEAFCAST_OK);
    const double n = vec3_length(plane), u = vec3_length(s.u), w = vec3_length(s.v);
    double seen[3], least[2] = {1, 1}, most[2] = {0, 0};
    assert_true(fabs(vec3_dot(plane, s.u)) < 1e-9 * n * u);
    assert_true(fabs(vec3_dot(plane, s.v)) < 1e-9 * n * w);
    assert_true(fabs(vec3_dot(s.u, s.v)) < 1e-9 * u * w);
    assert_true(fabs(vec3_dot(plane, s.origin) + plane[3]) < 1e-9 * n * (u + w));
    vec3_cross(s.u, s.v, seen);
    assert_true(vec3_dot(seen, plane) < 0.0); /* down, not up */
    assert_true(s.v[2] < 0.0 || (fabs(s.v[2]) < 1e-9 * w && s.v[1] < 0.0));
    for (int i = 0; i < 8; i++)
        for (int a = 0; a < 3; a++) {
            const double *p = corners[i], *q = corners[i | 1 << a];
            const double from = vec3_dot(plane, p) + plane[3], to = vec3_dot(plane, q) + plane[3];
            if (i >> a & 1 || (from > 0) == (to > 0))
                continue;
            double at[3];
            for (int k = 0; k < 3; k++)
                at[k] = p[k] + from / (from - to) * (q[k] - p[k]) - s.origin[k];
            const double share[2] = {vec3_dot(at, s.u) / (u * u), vec3_dot(at, s.v) / (w * w)};
            for (int k = 0; k < 2; k++) {
                least[k] = fmin(least[k], share[k]);
                most[k] = fmax(most[k], share[k]);
            }
        }
    for (int k = 0; k < 2; k++)
        assert_true(fabs(least[k]) < 1e-9 && fabs(most[k] - 1.0) < 1e-9);
}

static void test_planes(void **state) {
    (void)state;
    slice_subject *x = slice_subject_turned();
    leafcast *v = fixture_open(x->path, NULL);
    const double last[3] = {SLICE_TURNED_X - 1, SLICE_TURNED_Y - 1, SLICE_TURNED_Z - 1};
    double corners[8][3];
    field_random r = {17};
    for (int i = 0; i < 8; i++)
        for (int a = 0; a < 3; a++) {
            corners[i][a] = x->grid.to_world[a][3];
            for (int k = 0; k < 3; k++)
                corners[i][a] += x->grid.to_world[a][k] * (i >> k & 1 ? last[k] : 0.0);
        }
    for (int round = 0; round < 300; round++) {
        double plane[4], through[3] = {0};
        for (int a = 0; a < 3; a++) {
            plane[a] =
                round < 6 ? (round % 3 == a) * (round < 3 ? 1 : -2) : field_random_in(&r, -3, 3);
            for (int i = 0; i < 8; i++)
                through[a] += corners[i][a] / 8;
            through[a] += field_random_in(&r, -2, 2);
        }
        plane[3] = -vec3_dot(plane, through);
        check_plane(v, plane, (const double(*)[3])corners);
    }
    const double beside[4] = {0, 0, 1, 1000}, none[4] = {0, 0, 0, 1};
    leafcast_slice_pixels s = slice_subject_sized(0, 0);
    assert_int_equal(leafcast_plane_slice(v, beside, &s), LEAFCAST_USAGE);
    assert_int_equal(leafcast_plane_slice(v, none, &s), LEAFCAST_USAGE);
    leafcast_close(v);
    slice_subject_free(x);
}

/* A face of the volume is a slice like another: its border is inside. */
static void test_faces(void **state) {
    static double value[1 << 16];
    (void)state;
    field f;
    assert_true(field_make(&f, "noise-u8", 33, FIELD_SEED));
    f.spacing[0] = 0.3;
    f.spacing[1] = -0.7;
    f.origin[2] = 0.1;
    leafcast *v = fixture_open(fixture_leaf(&f, 4, 1, false), NULL);
    const leafcast_info info = leafcast_describe(v);
    for (int face = 0; face < 6; face++) {
        double plane[4] = {0};
        plane[face / 2] = 1;
        plane[3] = -info.bounds[face % 2][face / 2];
        leafcast_slice_pixels s = slice_subject_sized(0, 0);
        assert_int_equal(leafcast_plane_slice(v, plane, &s), LEAFCAST_OK);
        assert_true((size_t)s.width * s.height < sizeof value / sizeof *value);
        (void)slice_subject_sample(v, &s, value);
        for (uint32_t i = 0; i < s.width * s.height; i++)
            assert_false(isnan(value[i]));
    }
    leafcast_close(v);
    field_release(&f);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_curved),     cmocka_unit_test(test_layers_are_samples),
        cmocka_unit_test(test_layer_size), cmocka_unit_test(test_planes),
        cmocka_unit_test(test_faces),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
