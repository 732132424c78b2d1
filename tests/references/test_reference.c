/* test_reference.c - the reference renderer against what can be known without it: formulas, parity,
 * dense sampling. */
/* marks: plain */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "tests/support/fields.h"
#include "tests/support/ref_camera.h"
#include "tests/support/ref_judge.h"
#include "tests/support/reference.h"

enum { HITS_MAX = 512 };

static void check_near(double got, double want, double tolerance) {
    if (!(fabs(got - want) <= tolerance))
        fail_msg("got %.17g, want %.17g", got, want);
}

/* A unit cube of 2^3 samples and a ray through it. */
static size_t trace_cube(const float samples[8], ref_ray ray, double iso, ref_hit *hits) {
    const long dims[3] = {2, 2, 2};
    ref_volume v = ref_volume_regular(dims, samples, NULL, NULL);
    return ref_trace(&v, &ray, &iso, 1, NULL, hits, HITS_MAX);
}

static size_t trace_field(const field *f, ref_ray ray, ref_hit *hits) {
    ref_volume v = field_volume(f);
    return ref_trace(&v, &ray, &f->iso, 1, NULL, hits, HITS_MAX);
}

/* ---- formulas ---- */

static void linear_field_is_a_plane(void **state) {
    (void)state;
    field f;
    assert_true(field_make(&f, "linear", 9, FIELD_SEED)); /* 2x + 3y - z = 11 */
    ref_volume v = field_volume(&f);
    field_random r = {7};
    int hits_seen = 0;
    for (int n = 0; n < 2000; n++) {
        ref_ray ray = field_random_ray(&v, &r, 20);
        double slope = 2 * ray.d[0] + 3 * ray.d[1] - ray.d[2];
        double t = (11 - (2 * ray.o[0] + 3 * ray.o[1] - ray.o[2])) / slope;
        bool inside = t >= 0;
        for (int a = 0; a < 3; a++) {
            double x = ray.o[a] + t * ray.d[a];
            inside = inside && x > 0 && x < (double)(f.dims[a] - 1);
        }
        ref_hit hits[HITS_MAX];
        size_t count = trace_field(&f, ray, hits);
        assert_int_equal(count, inside);
        if (count) {
            check_near(hits[0].t, t, 1e-13 * (1 + 1 / fabs(slope)));
            assert_int_equal(hits[0].from_inside, slope < 0);
        }
        hits_seen += inside;
    }
    assert_true(hits_seen > 500);
    field_release(&f);
}

static void sphere_error_falls_with_the_square_of_the_cell(void **state) {
    (void)state;
    double worst[3] = {0};
    for (int level = 0; level < 3; level++) {
        long n = 16l << level;
        field f;
        assert_true(field_make(&f, "sphere", n, FIELD_SEED));
        for (int a = 0; a < 3;
             a++) { /* node i at 2 i / (dims - 1) - 1: the formula's own coordinates */
            f.spacing[a] = 2 / (double)(f.dims[a] - 1);
            f.origin[a] = -1;
        }
        field_random r = {11};
        for (int i = 0; i < 500; i++) {
            /* From outside towards a point near the centre: radius 1 - iso. */
            ref_ray ray;
            double od = 0, oo = 0, dd = 0, radius = 1 - f.iso;
            for (int a = 0; a < 3; a++) {
                ray.o[a] = field_random_in(&r, 1.1, 3) * (field_random_below(&r, 2) ? 1 : -1);
                ray.d[a] = field_random_in(&r, -0.3, 0.3) - ray.o[a];
                od += ray.o[a] * ray.d[a];
                oo += ray.o[a] * ray.o[a];
                dd += ray.d[a] * ray.d[a];
            }
            double root = sqrt(od * od - dd * (oo - radius * radius));
            ref_hit hits[HITS_MAX];
            assert_int_equal(trace_field(&f, ray, hits), 2);
            worst[level] = fmax(worst[level], sqrt(dd) * fabs(hits[0].t - (-od - root) / dd));
            worst[level] = fmax(worst[level], sqrt(dd) * fabs(hits[1].t - (-od + root) / dd));
        }
        field_release(&f);
    }
    assert_true(worst[0] < 0.02);
    for (int level = 0; level < 2; level++)
        if (!(worst[level] / worst[level + 1] > 3 && worst[level] / worst[level + 1] < 6))
            fail_msg("halving the cell: %g to %g", worst[level], worst[level + 1]);
}

static void two_surfaces_in_one_cell(void **state) {
    (void)state;
    /* x (1 - y) + y (1 - x) on x = y = s: 2 s (1 - s). M08 figure 4.9: both ends on the same side.
     */
    const float saddle[8] = {0, 1, 1, 0, 0, 1, 1, 0};
    const ref_ray diagonal = {{0, 0, 0.5}, {1, 1, 0}};
    ref_hit hits[HITS_MAX];
    assert_int_equal(trace_cube(saddle, diagonal, 0.375, hits), 2);
    check_near(hits[0].t, 0.25, 1e-15);
    check_near(hits[1].t, 0.75, 1e-15);
    assert_false(hits[0].from_inside);
    assert_true(hits[1].from_inside);
    assert_int_equal(trace_cube(saddle, diagonal, 0.5 + 1e-12, hits), 0);
    assert_int_equal(trace_cube(saddle, diagonal, 0.5 - 1e-12, hits), 2);
    check_near(hits[0].t, 0.5 - sqrt(0.5e-12), 1e-9);
}

/* Corner values that make f the cubic (s - a)(s - b)(s - c) along the main diagonal: its blossom at
 * the corners. */
static void blossom_of(double a, double b, double c, float samples[8]) {
    for (int n = 0; n < 8; n++) {
        double x = n & 1, y = n >> 1 & 1, z = n >> 2;
        samples[n] = (float)(x * y * z - (a + b + c) * (x * y + y * z + x * z) / 3 +
                             (a * b + b * c + c * a) * (x + y + z) / 3 - a * b * c);
    }
}

static void three_surfaces_in_one_cell(void **state) {
    (void)state;
    const ref_ray diagonal = {{-1, -1, -1}, {1, 1, 1}};
    float samples[8];
    ref_hit hits[HITS_MAX];
    blossom_of(0.25, 0.5, 0.75, samples);
    assert_int_equal(trace_cube(samples, diagonal, 0, hits), 3);
    for (int i = 0; i < 3; i++) {
        check_near(hits[i].t, 1.25 + 0.25 * i, 1e-6); /* the corners are floats */
        assert_int_equal(hits[i].from_inside, i == 1);
    }
    /* A triple root is one surface or three close together, never none and never two. */
    blossom_of(0.5, 0.5, 0.5, samples);
    size_t count = trace_cube(samples, diagonal, 0, hits);
    assert_true(count == 1 || count == 3);
    check_near(hits[0].t, 1.5, 0.01);
}

static void constant_cells_hold_no_surface(void **state) {
    (void)state;
    field f;
    assert_true(field_make(&f, "constant", 6, FIELD_SEED));
    ref_volume v = field_volume(&f);
    field_random r = {3};
    const double isos[3] = {f.iso - 1, f.iso, f.iso + 1};
    for (int n = 0; n < 500; n++) {
        ref_hit hits[HITS_MAX];
        ref_ray ray = n % 2 ? field_exact_ray(&v, &r) : field_random_ray(&v, &r, 3);
        assert_int_equal(ref_trace(&v, &ray, isos, 3, NULL, hits, HITS_MAX), 0);
    }
    field_release(&f);
}

/* ---- conventions ---- */

/* f = x on 5 x 3 x 3 nodes. */
static const long ramp_dims[3] = {5, 3, 3};
static void make_ramp(float samples[45]) {
    for (int n = 0; n < 45; n++)
        samples[n] = (float)(n % 5);
}

static void rays_in_grid_planes_and_edges(void **state) {
    (void)state;
    float samples[45];
    make_ramp(samples);
    ref_volume v = ref_volume_regular(ramp_dims, samples, NULL, NULL);
    /* The cell that owns the line: y and z in [0, 2] in steps of a half; the last cell owns its
     * end. */
    for (int j = 0; j <= 4; j++)
        for (int k = 0; k <= 4; k++) {
            const ref_ray ray = {{-3, 0.5 * j, 0.5 * k}, {1, 0, -0.0}};
            const double iso = 2.25;
            ref_hit hits[HITS_MAX];
            assert_int_equal(ref_trace(&v, &ray, &iso, 1, NULL, hits, HITS_MAX), 1);
            assert_true(hits[0].t == 5.25);
            assert_int_equal(hits[0].cell, 2 + 4 * ((j >= 2) + 2 * (k >= 2)));
        }
    const ref_ray beside = {{-3, 2.0000001, 1}, {1, 0, 0}};
    const double iso = 2.25;
    ref_hit hits[HITS_MAX];
    assert_int_equal(ref_trace(&v, &beside, &iso, 1, NULL, hits, HITS_MAX), 0);
}

static void root_on_a_face_belongs_where_the_side_changes(void **state) {
    (void)state;
    float samples[45];
    make_ramp(samples);
    ref_volume v = ref_volume_regular(ramp_dims, samples, NULL, NULL);
    const double iso = 2;
    ref_hit hits[HITS_MAX];
    /* Upwards the node is the first point inside: the end of cell 1. Downwards it is the last: the
     * start of cell 1. */
    const ref_ray up = {{-1, 0.5, 0.5}, {1, 0, 0}}, down = {{6, 0.5, 0.5}, {-1, 0, 0}};
    assert_int_equal(ref_trace(&v, &up, &iso, 1, NULL, hits, HITS_MAX), 1);
    assert_true(hits[0].t == 3 && hits[0].cell == 1 && !hits[0].from_inside);
    assert_int_equal(ref_trace(&v, &down, &iso, 1, NULL, hits, HITS_MAX), 1);
    assert_true(hits[0].t == 4 && hits[0].cell == 1 && hits[0].from_inside);
    /* The smallest value: f >= iso everywhere, no surface. The largest: reached at the last plane
     * only. */
    const double ends[2] = {0, 4};
    assert_int_equal(ref_trace(&v, &up, &ends[0], 1, NULL, hits, HITS_MAX), 0);
    assert_int_equal(ref_trace(&v, &up, &ends[1], 1, NULL, hits, HITS_MAX), 1);
    assert_true(hits[0].t == 5 && hits[0].cell == 3);
}

static void visits_cross_x_then_y_then_z(void **state) {
    (void)state;
    const float zero[27] = {0};
    const long dims[3] = {3, 3, 3};
    ref_volume v = ref_volume_regular(dims, zero, NULL, NULL);
    ref_visit visits[16];
    const ref_ray up = {{-1, -1, -1}, {1, 1, 1}}, down = {{3, 3, 3}, {-1, -1, -1}};
    const int64_t up_cells[] = {0, 1, 3, 7}, down_cells[] = {7, 6, 4, 0};
    assert_int_equal(ref_visits(&v, &up, NULL, visits, 16), 4);
    for (int i = 0; i < 4; i++) {
        assert_int_equal(visits[i].cell, i < 2 ? up_cells[i] : i == 2 ? 3 : 7);
        assert_true(visits[i].t_out - visits[i].t_in == (i == 0 || i == 3 ? 1 : 0));
    }
    assert_int_equal(ref_visits(&v, &down, NULL, visits, 16), 4);
    for (int i = 0; i < 4; i++)
        assert_int_equal(visits[i].cell, down_cells[i]);
    /* Starting on the middle vertex: upwards its own cell; downwards from its own cell through two
     * of zero length. */
    const ref_ray from_up = {{1, 1, 1}, {1, 1, 1}}, from_down = {{1, 1, 1}, {-1, -1, -1}};
    assert_int_equal(ref_visits(&v, &from_up, NULL, visits, 16), 1);
    assert_int_equal(visits[0].cell, 7);
    assert_int_equal(ref_visits(&v, &from_down, NULL, visits, 16), 4);
    assert_int_equal(visits[0].cell, 7);
    assert_true(visits[2].t_out == 0);
}

static void starting_inside_takes_the_side_of_the_origin(void **state) {
    (void)state;
    float samples[45];
    make_ramp(samples);
    ref_volume v = ref_volume_regular(ramp_dims, samples, NULL, NULL);
    const struct {
        double x, d, iso;
        int count;
        double t;
    } cases[] = {
        {1.5, 1, 2.5, 1, 1},
        {1.5, -1, 2.5, 0, 0}, /* outside; towards and away */
        {3.5, 1, 2.5, 0, 0},
        {3.5, -1, 2.5, 1, 1}, /* inside */
        {2, 1, 2.5, 1, 0.5},
        {3, -1, 2.5, 1, 0.5}, /* on a voxel */
        {0, 1, 0.5, 1, 0.5},
        {4, -1, 3.5, 1, 0.5}, /* on the box */
        {2, 1, 2, 0, 0},
        {2, -1, 2, 1, 0}, /* on the surface, which is inside; leaving it counts */
        {2.25, 1, 2.25, 0, 0},
        {2.25, -1, 2.25, 1, 0}, /* the same within a cell */
        {2.25, 1, 2.25 + 1e-9, 1, 1e-9},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        ref_ray ray = {{cases[i].x, 1, 0.5}, {cases[i].d, 0, 0}};
        ref_hit hits[HITS_MAX];
        assert_int_equal(ref_trace(&v, &ray, &cases[i].iso, 1, NULL, hits, HITS_MAX),
                         cases[i].count);
        if (cases[i].count)
            check_near(hits[0].t, cases[i].t, 1e-16);
    }
}

static void plateau_at_the_isovalue_is_inside(void **state) {
    (void)state;
    /* Along x: 5 5 7 7 7 5 7 3 7, iso 7. */
    const float row[9] = {5, 5, 7, 7, 7, 5, 7, 3, 7};
    float samples[36];
    for (int n = 0; n < 36; n++)
        samples[n] = row[n % 9];
    const long dims[3] = {9, 2, 2};
    ref_volume v = ref_volume_regular(dims, samples, NULL, NULL);
    const ref_ray ray = {{-1, 0.5, 0}, {1, 0, 0}};
    const double iso = 7, want[5] = {3, 5, 7, 7, 9};
    const bool from_inside[5] = {false, true, false, true, false};
    ref_hit hits[HITS_MAX];
    assert_int_equal(ref_trace(&v, &ray, &iso, 1, NULL, hits, HITS_MAX), 5);
    for (int i = 0; i < 5; i++)
        assert_true(hits[i].t == want[i] && hits[i].from_inside == from_inside[i]);
}

static void missing_data_holds_no_surface(void **state) {
    (void)state;
    const float bad[3] = {NAN, INFINITY, -INFINITY};
    for (int n = 0; n < 3; n++) {
        float samples[45];
        make_ramp(samples);
        samples[2] = bad[n]; /* node (2, 0, 0): cells 1 and 2 of the first row */
        ref_volume v = ref_volume_regular(ramp_dims, samples, NULL, NULL);
        const double isos[4] = {0.5, 1.5, 2.5, 3.5};
        const ref_ray through = {{-1, 0.5, 0.5}, {1, 0, 0}}, beside = {{-1, 1.5, 0.5}, {1, 0, 0}};
        ref_hit hits[HITS_MAX];
        assert_int_equal(ref_trace(&v, &through, isos, 4, NULL, hits, HITS_MAX), 2);
        assert_true(hits[0].iso == 0 && hits[1].iso == 3);
        assert_int_equal(ref_trace(&v, &beside, isos, 4, NULL, hits, HITS_MAX), 4);
    }
}

static void clipping_takes_the_side_anew(void **state) {
    (void)state;
    float samples[45];
    make_ramp(samples);
    ref_volume v = ref_volume_regular(ramp_dims, samples, NULL, NULL);
    const ref_ray ray = {{-1, 0.5, 0.5}, {1, 0, 0}};
    const double isos[3] = {0.5, 1.5, 2.5};
    ref_hit hits[HITS_MAX];
    ref_clip interval = {.t0 = 2, .t1 = 3.25};
    assert_int_equal(ref_trace(&v, &ray, isos, 3, &interval, hits, HITS_MAX), 1);
    assert_true(hits[0].iso == 1 && hits[0].t == 2.5);
    const double planes[2][4] = {{1, 0, 0, -1}, {-1, 0, 0, 2.25}}; /* 1 <= x <= 2.25 */
    ref_clip slab = {.t1 = INFINITY, .planes = planes, .plane_count = 2};
    assert_int_equal(ref_trace(&v, &ray, isos, 3, &slab, hits, HITS_MAX), 1);
    const double box[2][3] = {{1, 0, 0}, {3, 0.5, 1}};
    ref_clip boxed = {.t1 = INFINITY, .box = box};
    assert_int_equal(ref_trace(&v, &ray, isos, 3, &boxed, hits, HITS_MAX), 2);
    assert_true(hits[0].iso == 1 && hits[1].iso == 2);
    const double away[1][4] = {{0, 1, 0, -0.6}};
    ref_clip beside = {.t1 = INFINITY, .planes = away, .plane_count = 1};
    assert_int_equal(ref_trace(&v, &ray, isos, 3, &beside, hits, HITS_MAX), 0);
}

static void equal_t_orders_by_cell_then_isovalue(void **state) {
    (void)state;
    float samples[45];
    make_ramp(samples);
    ref_volume v = ref_volume_regular(ramp_dims, samples, NULL, NULL);
    const ref_ray ray = {{-1, 0.5, 0.5}, {1, 0, 0}};
    const double isos[4] = {2, 3.5, 2, 1.5};
    const int want[4] = {3, 0, 2, 1};
    ref_hit hits[HITS_MAX];
    assert_int_equal(ref_trace(&v, &ray, isos, 4, NULL, hits, HITS_MAX), 4);
    for (int i = 0; i < 4; i++)
        assert_int_equal(hits[i].iso, want[i]);
    /* A short list holds the first ones. */
    assert_int_equal(ref_trace(&v, &ray, isos, 4, NULL, hits, 2), 4);
    assert_true(hits[0].iso == 3 && hits[1].iso == 0);
    assert_true(ref_trace(&v, &ray, isos, 4, NULL, hits, 1) > 0);
    assert_int_equal(hits[0].iso, 3);
}

static void spacing_and_axes_only_scale(void **state) {
    (void)state;
    field plain, moved;
    assert_true(field_make(&plain, "waves", 9, FIELD_SEED));
    assert_true(field_make(&moved, "waves", 9, FIELD_SEED));
    const double scale[3] = {-0.5, 4, 0.25};
    double coordinates[3][16];
    for (int a = 0; a < 3; a++) {
        moved.spacing[a] = scale[a];
        moved.origin[a] = 1024 * (a + 1);
        for (int i = 0; i < 16; i++)
            coordinates[a][i] = 8 + 2 * i;
    }
    ref_volume v = field_volume(&plain), w = field_volume(&moved), u = v;
    for (int a = 0; a < 3; a++)
        u.axis[a] = coordinates[a];
    field_random r = {5};
    for (int n = 0; n < 500; n++) {
        ref_ray ray = field_exact_ray(&v, &r), there = ray, apart = ray;
        for (int a = 0; a < 3; a++) {
            there.o[a] = 1024 * (a + 1) + scale[a] * ray.o[a];
            there.d[a] = scale[a] * ray.d[a];
            apart.o[a] = 8 + 2 * ray.o[a];
            apart.d[a] = 2 * ray.d[a];
        }
        ref_hit a[HITS_MAX], b[HITS_MAX], c[HITS_MAX];
        size_t count = ref_trace(&v, &ray, &plain.iso, 1, NULL, a, HITS_MAX);
        assert_int_equal(count, ref_trace(&w, &there, &plain.iso, 1, NULL, b, HITS_MAX));
        assert_int_equal(count, ref_trace(&u, &apart, &plain.iso, 1, NULL, c, HITS_MAX));
        for (size_t i = 0; i < count; i++) {
            assert_true(a[i].t == b[i].t && a[i].cell == b[i].cell);
            assert_true(a[i].t == c[i].t && a[i].cell == c[i].cell);
            check_near(a[i].cells_per_t, c[i].cells_per_t, 1e-12 * a[i].cells_per_t);
        }
    }
    field_release(&plain);
    field_release(&moved);
}

/* ---- parity and dense sampling ---- */

/* Close the surfaces: all of the field's boundary lies outside. */
static void close_surfaces(field *f) {
    size_t n = 0;
    for (long k = 0; k < f->dims[2]; k++)
        for (long j = 0; j < f->dims[1]; j++)
            for (long i = 0; i < f->dims[0]; i++, n++)
                if (i == 0 || j == 0 || k == 0 || i == f->dims[0] - 1 || j == f->dims[1] - 1 ||
                    k == f->dims[2] - 1)
                    f->samples[n] = (float)(f->iso - 1 - fabs(f->iso));
}

/* From outside the sides alternate and the last surface leads outside; from inside, the first one
 * does. */
static void check_parity(const field *f, const ref_volume *v, ref_ray ray, const char *what,
                         int n) {
    static ref_hit hits[4096];
    size_t count = ref_trace(v, &ray, &f->iso, 1, NULL, hits, 4096);
    long double o[3], d[3];
    ref_to_grid(v, &ray, o, d);
    bool inside = ref_value(v, o, f->iso) >= 0; /* beyond the box NaN, so outside */
    if (count % 2 != inside)
        fail_msg("%s, seed %d, %s ray %d: %zu surfaces from %s", f->name, FIELD_SEED, what, n,
                 count, inside ? "inside" : "outside");
    int balance = inside;
    for (size_t i = 0; i < count; i++)
        balance += hits[i].from_inside ? -1 : 1;
    assert_int_equal(balance, 0);
}

static void closed_surfaces_are_watertight(void **state) {
    (void)state;
    const char *const names[] = {"noise-u8",   "noise-i16", "noise-f32", "plateau",    "terraces",
                                 "checker",    "tiny",      "huge",      "wild",       "waves",
                                 "flat-cells", "far",       "mirrored",  "rectilinear"};
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
        field f;
        assert_true(field_make(&f, names[i], 7, FIELD_SEED));
        close_surfaces(&f);
        ref_volume v = field_volume(&f), unit = v;
        memset(unit.to_world, 0, sizeof unit.to_world);
        for (int a = 0; a < 3; a++) {
            unit.axis[a] = NULL;
            unit.to_world[a][a] = 1;
        }
        field_random r = {FIELD_SEED};
        for (int n = 0; n < 2000; n++) {
            check_parity(&f, &v, field_random_ray(&v, &r, 9), "random", n);
            check_parity(&f, &v, field_random_ray(&v, &r, -0.2), "inner", n);
            ref_ray exact = field_exact_ray(&unit, &r);
            check_parity(&f, &unit, exact, "exact", n);
            for (int a = 0; a < 3;
                 a++) /* the same line from its middle: a whole or half grid point */
                exact.o[a] += 64 * exact.d[a];
            check_parity(&f, &unit, exact, "exact inner", n);
        }
        field_release(&f);
    }
}

/* Between two surfaces f keeps its side, wherever it is sampled. */
static void dense_sampling_agrees(void **state) {
    (void)state;
    const char *const names[] = {"noise-f32", "checker",     "waves",
                                 "mirrored",  "rectilinear", "saddle"};
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
        field f;
        assert_true(field_make(&f, names[i], 6, FIELD_SEED));
        ref_volume v = field_volume(&f);
        field_random r = {FIELD_SEED + i};
        for (int n = 0; n < 200; n++) {
            ref_ray ray = field_random_ray(&v, &r, -0.01);
            ref_hit hits[HITS_MAX];
            ref_clip clip = {.t0 = 0, .t1 = 1};
            size_t count = ref_trace(&v, &ray, &f.iso, 1, &clip, hits, HITS_MAX), next = 0;
            long double o[3], d[3];
            ref_to_grid(&v, &ray, o, d);
            bool inside = ref_value(&v, o, f.iso) >= 0;
            for (int s = 0; s <= 1000; s++) {
                long double t = s / 1000.0L,
                            p[3] = {o[0] + t * d[0], o[1] + t * d[1], o[2] + t * d[2]};
                for (; next < count && hits[next].t_exact <= t; next++)
                    inside = !inside;
                long double value = ref_value(&v, p, f.iso);
                if (fabsl(value) > 1e-15L * (fabs(f.iso) + 1) && (value >= 0) != inside)
                    fail_msg("%s ray %d at t %g: f - iso = %Lg", names[i], n, (double)t, value);
            }
        }
        field_release(&f);
    }
}

/* ---- grazing, judging, camera ---- */

static void grazing_rays_are_named(void **state) {
    (void)state;
    const float saddle[8] = {0, 1, 1, 0, 0, 1, 1, 0};
    const long dims[3] = {2, 2, 2};
    ref_volume v = ref_volume_regular(dims, saddle, NULL, NULL);
    const ref_ray valley = {{0, 1, 0.5}, {1, -1, 0}}, steep = {{0.2, -1, 0.5}, {0, 1, 0}};
    const double touching = 0.5, clear = 0.625;
    assert_true(ref_grazing(&v, &valley, &touching, 1, NULL, 1));
    assert_false(ref_grazing(&v, &valley, &clear, 1, NULL, 1));
    assert_false(ref_grazing(&v, &steep, &clear, 1, NULL, 1));
    /* In the face of the box: beside it there is nothing. */
    const ref_ray in_face = {{0.2, -1, 0}, {0, 1, 0}};
    assert_true(ref_grazing(&v, &in_face, &clear, 1, NULL, 1));
}

static void judge_counts_each_fault(void **state) {
    (void)state;
    field f;
    assert_true(field_make(&f, "sphere", 12, FIELD_SEED));
    ref_volume v = field_volume(&f);
    ref_camera camera = ref_standard_view(&v, 2.2, 24, 24);
    double depth[24 * 24];
    int hit_at = -1, miss_at = 0, hits = 0;
    for (int n = 0; n < 24 * 24; n++) {
        ref_ray ray = ref_primary_ray(&camera, n % 24, n / 24);
        ref_hit hit;
        bool found = ref_trace(&v, &ray, &f.iso, 1, NULL, &hit, 1) > 0;
        depth[n] = found ? hit.t : (double)INFINITY;
        hits += found;
        hit_at = n == 24 * 12 + 12 ? n : hit_at;
    }
    assert_true(hits > 50 && isfinite(depth[hit_at]) && isinf(depth[miss_at]));
    ref_tally tally = {0};
    ref_compare(&tally, &v, &camera, &f.iso, 1, NULL, depth, 1, "", NULL);
    assert_true(tally.rays == 24 * 24 && ref_tally_faults(&tally) == 0 && tally.worst < 1e-12);
    assert_int_equal(tally.hits + tally.grazing, hits);

    depth[hit_at] += 3e-4;
    depth[hit_at + 1] = INFINITY;
    depth[miss_at] = 10;
    FILE *log = tmpfile();
    char line[256];
    assert_non_null(log);
    ref_compare(&tally, &v, &camera, &f.iso, 1, NULL, depth, 1, "oracle x", log);
    assert_true(tally.missed == 1 && tally.false_hits == 1 && tally.too_far == 1);
    check_near(tally.worst, 3e-4, 1e-6);
    rewind(log);
    assert_non_null(fgets(line, sizeof line, log));
    assert_non_null(strstr(line, "false hit: got 10,"));
    assert_non_null(strstr(line, "oracle x --pixel 0,0"));
    fclose(log);
    field_release(&f);
}

static void camera_follows_the_convention(void **state) {
    (void)state;
    const ref_camera camera = {{5, 1, 1}, {0, 1, 1}, {0, 0, 1}, 90, 6, 3};
    ref_ray centre = ref_primary_ray(&camera, 3, 1), top_left = ref_primary_ray(&camera, 0, 0);
    /* Looking along -x with z up, +y lies to the right. */
    check_near(centre.d[1] / -centre.d[0], 1 / 3.0, 1e-15);
    assert_true(centre.d[2] == 0);
    check_near(top_left.d[1] / -top_left.d[0], -5 / 3.0, 1e-15);
    check_near(top_left.d[2] / -top_left.d[0], 2 / 3.0, 1e-15);
    check_near(hypot(hypot(top_left.d[0], top_left.d[1]), top_left.d[2]), 1, 1e-15);

    const float zero[8] = {0};
    const long dims[3] = {2, 2, 2};
    const double spacing[3] = {-10, 4, 2}, origin[3] = {7, 0, 1};
    ref_volume v = ref_volume_regular(dims, zero, spacing, origin);
    ref_camera standard = ref_standard_view(&v, 2.2, 8, 8);
    check_near(standard.look_at[0], 2, 0);
    check_near(standard.look_at[2], 2, 0);
    check_near(standard.eye[0], 2 + 22 / sqrt(2), 1e-13);
    check_near(standard.eye[1], 2 + 0.6 * 22 / sqrt(2), 1e-13);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(linear_field_is_a_plane),
        cmocka_unit_test(sphere_error_falls_with_the_square_of_the_cell),
        cmocka_unit_test(two_surfaces_in_one_cell),
        cmocka_unit_test(three_surfaces_in_one_cell),
        cmocka_unit_test(constant_cells_hold_no_surface),
        cmocka_unit_test(rays_in_grid_planes_and_edges),
        cmocka_unit_test(root_on_a_face_belongs_where_the_side_changes),
        cmocka_unit_test(visits_cross_x_then_y_then_z),
        cmocka_unit_test(starting_inside_takes_the_side_of_the_origin),
        cmocka_unit_test(plateau_at_the_isovalue_is_inside),
        cmocka_unit_test(missing_data_holds_no_surface),
        cmocka_unit_test(clipping_takes_the_side_anew),
        cmocka_unit_test(equal_t_orders_by_cell_then_isovalue),
        cmocka_unit_test(spacing_and_axes_only_scale),
        cmocka_unit_test(closed_surfaces_are_watertight),
        cmocka_unit_test(dense_sampling_agrees),
        cmocka_unit_test(grazing_rays_are_named),
        cmocka_unit_test(judge_counts_each_fault),
        cmocka_unit_test(camera_follows_the_convention),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
