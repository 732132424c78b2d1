/* test_fit_view.c - the view that fits: every corner of a box is in the picture, one at its margin;
 * of files, what is active.
 */
/* marks: bits */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <math.h>
#include <string.h>

#include "render/look/camera.h"
#include "tests/support/fixture.h"

/* camera.c leaves 4 % around what is fitted. */
static const double MARGIN = 1.04, PI = 3.14159265358979323846;

typedef double vector[3];

static double dot(const vector a, const vector b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void cross(const vector a, const vector b, vector out) {
    for (int i = 0; i < 3; i++)
        out[i] = a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3];
}

/* Where a point is in the picture: -1 to 1 from border to border; false when it is behind the
 * eye. */
static bool project(const leafcast_camera *c, const vector point, double at[2]) {
    vector towards, away, right, up;
    for (int a = 0; a < 3; a++) {
        towards[a] = c->look_at[a] - c->eye[a];
        away[a] = point[a] - c->eye[a];
    }
    cross(towards, c->up, right);
    cross(right, towards, up);
    const double half = tan(c->fov * PI / 360.0);
    const double depth = dot(away, towards) / sqrt(dot(towards, towards));
    at[0] = dot(away, right) / sqrt(dot(right, right)) / (depth * half) * c->height / c->width;
    at[1] = dot(away, up) / sqrt(dot(up, up)) / (depth * half);
    return depth > 0.0;
}

/* How far from the middle the corners are: the farthest one. */
static double farthest(const leafcast_camera *c, const double corners[8][3]) {
    double most = 0.0;
    for (int i = 0; i < 8; i++) {
        double at[2];
        if (!project(c, corners[i], at))
            return INFINITY;
        most = fmax(most, fmax(fabs(at[0]), fabs(at[1])));
    }
    return most;
}

/* A box of random edges, of sizes that differ up to a thousandfold, anywhere. */
static void random_box(field_random *r, double lo[3], double hi[3], double corners[8][3]) {
    const double scale = pow(10.0, field_random_in(r, -6, 6));
    for (int a = 0; a < 3; a++) {
        lo[a] = scale * field_random_in(r, -100, 100);
        hi[a] = lo[a] + scale * pow(10.0, field_random_in(r, -1, 2));
    }
    for (int i = 0; i < 8; i++)
        for (int a = 0; a < 3; a++)
            corners[i][a] = i >> a & 1 ? hi[a] : lo[a];
}

static int axis_of(const vector v) {
    return fabs(v[0]) > 0.0 ? 0 : fabs(v[1]) > 0.0 ? 1 : 2;
}

static void test_boxes(void **state) {
    (void)state;
    field_random r = {FIELD_SEED};
    for (int k = 0; k < 20000; k++) {
        double lo[3], hi[3], corners[8][3];
        random_box(&r, lo, hi, corners);
        const double fov = field_random_in(&r, 1, 120);
        const uint32_t width = (uint32_t)(1 + field_random_below(&r, 2000)),
                       height = (uint32_t)(1 + field_random_below(&r, 2000));
        const leafcast_camera c = camera_fit((const double(*)[3])corners, fov, width, height);
        const double most = farthest(&c, (const double(*)[3])corners);
        if (!(most < 1.0 && most > 1.0 / MARGIN - 1e-3))
            fail_msg("box %d: the farthest corner is at %.9g of the border", k, most);
        assert_true(c.width == width && c.height == height && c.fov == fov);
        for (int a = 0; a < 3; a++)
            assert_true(fabs(c.look_at[a] - 0.5 * (lo[a] + hi[a])) <=
                        1e-12 * (fabs(lo[a]) + hi[a] - lo[a]));
    }
}

/* Up and across, by what camera.h says of them. */
static void test_axes(void **state) {
    (void)state;
    field_random r = {FIELD_SEED + 1};
    int laid = 0;
    for (int k = 0; k < 5000; k++) {
        double lo[3], hi[3], corners[8][3], size[3];
        random_box(&r, lo, hi, corners);
        for (int a = 0; a < 3; a++)
            size[a] = hi[a] - lo[a];
        const leafcast_camera c = camera_fit((const double(*)[3])corners, 35, 640, 480);
        const int longer = size[0] >= size[1] ? 0 : 1;
        const bool down = size[2] > 2.0 * size[longer];
        laid += down;
        assert_int_equal(axis_of(c.up), down ? longer : 2);
        assert_true(c.up[0] >= 0 && c.up[1] >= 0 && c.up[2] >= 0);
        /* The axis that lies across goes farther to the side than the third one of as many units.
         */
        const int across = down ? 2 : longer, third = 3 - axis_of(c.up) - across;
        vector towards, right;
        for (int a = 0; a < 3; a++)
            towards[a] = c.look_at[a] - c.eye[a];
        cross(towards, c.up, right);
        assert_true(fabs(right[across]) > fabs(right[third]));
        assert_true(right[across] > 0);      /* left to right */
        assert_true(dot(towards, c.up) < 0); /* from above */
    }
    assert_true(laid > 100);
}

/* ---- files ---- */

/* A block of 200 in noise below 100; the field is released by the caller. */
static void make_block(field *f, field_random *r, long from[3], long to[3]) {
    assert_true(field_make(f, "noise-u8", 40, FIELD_SEED));
    for (int a = 0; a < 3; a++) {
        from[a] = 1 + field_random_below(r, f->dims[a] - 12);
        to[a] = from[a] + 4 + field_random_below(r, f->dims[a] - from[a] - 5);
        f->spacing[a] = field_random_in(r, 0.2, 3);
        f->origin[a] = field_random_in(r, -50, 50);
    }
    for (long z = 0; z < f->dims[2]; z++)
        for (long y = 0; y < f->dims[1]; y++)
            for (long x = 0; x < f->dims[0]; x++) {
                float *s = &f->samples[(z * f->dims[1] + y) * f->dims[0] + x];
                const bool in = x >= from[0] && x < to[0] && y >= from[1] && y < to[1] &&
                                z >= from[2] && z < to[2];
                *s = in ? 200.0f : (float)((int)*s % 100);
            }
}

/* Corners of the box of these nodes. */
static void node_corners(const field *f, const long lo[3], const long hi[3], double out[8][3]) {
    for (int i = 0; i < 8; i++)
        for (int a = 0; a < 3; a++)
            out[i][a] = f->origin[a] + f->spacing[a] * (double)(i >> a & 1 ? hi[a] : lo[a]);
}

/* The fitted view of a box of nodes. */
static void check_view(const leafcast *volume, const field *f, double iso, double fov,
                       const long lo[3], const long hi[3]) {
    double corners[8][3];
    leafcast_camera c = {.size = sizeof c};
    node_corners(f, lo, hi, corners);
    assert_int_equal(leafcast_fit_view(volume, 0, 0, &iso, 1, fov, 300, 200, &c), LEAFCAST_OK);
    assert_true(c.fov == (fov > 0.0 ? fov : LEAFCAST_FIT_FOV));
    const double most = farthest(&c, (const double(*)[3])corners);
    if (!(most < 1.0 && most > 1.0 / MARGIN - 1e-3))
        fail_msg("isovalue %g: the farthest corner is at %.9g of the border", iso, most);
}

/* A file without histograms: the box is that of treelets, of 16 cells here. */
static void check_block(field_random *r) {
    field f;
    long from[3], to[3], lo[3], hi[3];
    const long first[3] = {0, 0, 0};
    double suggested[LEAFCAST_SUGGESTIONS_MAX];
    leafcast_camera c = {.size = sizeof c};
    int count = 0;
    make_block(&f, r, from, to);
    const long last[3] = {f.dims[0] - 1, f.dims[1] - 1, f.dims[2] - 1};
    for (int a = 0; a < 3; a++) {
        lo[a] = (from[a] - 1) / 16 * 16;
        hi[a] = ((to[a] - 1) / 16 + 1) * 16;
        hi[a] = hi[a] < last[a] ? hi[a] : last[a];
    }
    leafcast *volume = fixture_open(fixture_leaf(&f, 4, 1, false), NULL);
    check_view(volume, &f, 150.0, 0.0, lo, hi);
    check_view(volume, &f, 250.0, 60.0, first, last); /* nothing is active: all of it */
    assert_int_equal(leafcast_suggested_isovalues(volume, 0, 0, suggested, 1, &count), LEAFCAST_OK);
    assert_int_equal(count, 1);
    assert_int_equal(leafcast_fit_view(volume, 1, 0, suggested, 1, 0.0, 8, 8, &c), LEAFCAST_USAGE);
    assert_int_equal(leafcast_fit_view(volume, 0, 1, suggested, 1, 0.0, 8, 8, &c), LEAFCAST_USAGE);
    leafcast_close(volume);
    field_release(&f);
}

static void test_files(void **state) {
    (void)state;
    field_random r = {FIELD_SEED + 2};
    for (int k = 0; k < 12; k++)
        check_block(&r);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_boxes),
        cmocka_unit_test(test_axes),
        cmocka_unit_test(test_files),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
