/* test_tet_reference.c - the reference for tetrahedra against what can be known without it:
 * formulas, parity, dense sampling. */
/* marks: long, plain */
#include <float.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "tests/support/exact_sum.h"
#include "tests/support/tet_meshes.h"
#include "tests/support/tet_reference.h"

enum { HITS_MAX = 4096, SIDE = 6, SEED = 1 };

static ref_hit hits[HITS_MAX], others[HITS_MAX];

static void check_near(double got, double want, double tolerance) {
    if (!(fabs(got - want) <= tolerance))
        fail_msg("got %.17g, want %.17g", got, want);
}

static tet_ref *reference_of(const lab_mesh *m) {
    tet_ref_mesh raw = lab_mesh_reference(m);
    tet_ref *r = tet_ref_create(&raw);
    assert_non_null(r);
    return r;
}

static void make(lab_mesh *m, const char *name) {
    if (!lab_mesh_make(m, name, SIDE, SEED))
        fail_msg("no mesh %s", name);
}

/* ---- exact sums ---- */

static long double sum_of(const double (*terms)[3], int count) {
    exact_sum s;
    exact_sum_clear(&s);
    for (int i = 0; i < count; i++)
        exact_sum_add(&s, terms[i][0], terms[i][1], terms[i][2]);
    return exact_sum_value(&s);
}

static void sums_are_exact(void **state) {
    (void)state;
    const double big = DBL_MAX, small = 0x1p-1074;
    const double vanishing[][3] = {
        {big, big, -big}, {3, 5, 7}, {small, small, small}, {big, big, big}, {-3, 35, 1}};
    assert_true(sum_of(vanishing, 5) == ldexpl(1, -3222));
    const double negative[][3] = {
        {big, big, -big}, {small, -small, small}, {-big, -big, big}, {0, big, 1}};
    assert_true(sum_of(negative, 4) == -ldexpl(1, -3222));
    const double nothing[][3] = {{0.1, 0.2, 0.3}, {-0.2, 0.3, 0.1}};
    assert_true(sum_of(nothing, 2) == 0);
    /* 0.1 and 0.2, 0.3 are not what they look like: 0.1 + 0.2 - 0.3 = 2^-55. */
    const double tenths[][3] = {{0.1, 1, 1}, {1, 0.2, 1}, {1, -1, 0.3}};
    assert_true(sum_of(tenths, 3) == ldexpl(1, -55));
    field_random r = {SEED};
    for (int n = 0; n < 20000; n++) {
        double t[4][3];
        long double want = 0;
        for (int i = 0; i < 4; i++) {
            for (int k = 0; k < 3; k++) /* 20 bits each: sums of products fit 64 */
                t[i][k] = (double)field_random_below(&r, 1 << 20) - (1 << 19);
            want += (long double)t[i][0] * t[i][1] * t[i][2];
        }
        assert_true(sum_of(t, 4) == want);
    }
}

/* ---- formulas ---- */

static double ramp(const double p[3]) {
    return p[0];
}

static double tilted(const double p[3]) {
    return 2 * p[0] + 3 * p[1] - p[2];
}

static double ball(const double p[3]) {
    return 1 - sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]);
}

static void make_kuhn(lab_mesh *m, int x, int y, int z, double (*f)(const double p[3])) {
    const int n[3] = {x, y, z};
    const double origin[3] = {0, 0, 0};
    lab_mesh_kuhn(m, n, origin, 1, f);
}

static void linear_field_is_a_plane(void **state) {
    (void)state;
    lab_mesh m;
    make_kuhn(&m, 5, 6, 7, tilted);
    tet_ref *r = reference_of(&m);
    const double iso = 11;
    field_random random = {SEED};
    int seen = 0;
    for (int n = 0; n < 9000; n++) {
        lab_ray kind = (lab_ray)(n % LAB_RAY_KINDS);
        ref_ray ray = lab_mesh_ray(&m, kind, &random);
        double slope = tilted(ray.d), t = (iso - tilted(ray.o)) / slope, depth = INFINITY;
        for (int a = 0; a < 3; a++) {
            double x = ray.o[a] + t * ray.d[a];
            depth = fmin(depth, fmin(x - m.lo[a], m.hi[a] - x));
        }
        size_t count = tet_ref_trace(r, &ray, &iso, 1, NULL, hits, HITS_MAX);
        if (fabs(slope) < 1e-9 || fabs(t) < 1e-9 || fabs(depth) < 1e-9)
            continue; /* in the plane, or at the ends of ray or mesh */
        if (count != (t > 0 && depth > 0))
            fail_msg("%s ray %d: %zu surfaces", lab_ray_name(kind), n, count);
        if (count) {
            check_near(hits[0].t, t, 1e-12 * (1 + 1 / fabs(slope)));
            assert_int_equal(hits[0].from_inside, slope < 0);
        }
        seen += count > 0;
    }
    assert_true(seen > 2000);
    tet_ref_destroy(r);
    lab_mesh_release(&m);
}

/* The worst distance from the true sphere of 500 rays towards its middle. */
static double sphere_error(int cubes, uint64_t seed) {
    const int n[3] = {cubes, cubes, cubes};
    const double origin[3] = {-1, -1, -1}, iso = 0.3, radius = 0.7;
    lab_mesh m;
    lab_mesh_kuhn(&m, n, origin, 2.0 / cubes, ball);
    tet_ref *r = reference_of(&m);
    field_random random = {seed};
    double worst = 0;
    for (int i = 0; i < 500; i++) {
        ref_ray ray;
        double od = 0, oo = 0, dd = 0;
        for (int a = 0; a < 3; a++) {
            ray.o[a] = field_random_in(&random, 1.1, 3) * (field_random_below(&random, 2) ? 1 : -1);
            ray.d[a] = field_random_in(&random, -0.3, 0.3) - ray.o[a];
            od += ray.o[a] * ray.d[a];
            oo += ray.o[a] * ray.o[a];
            dd += ray.d[a] * ray.d[a];
        }
        double root = sqrt(od * od - dd * (oo - radius * radius));
        assert_int_equal(tet_ref_trace(r, &ray, &iso, 1, NULL, hits, HITS_MAX), 2);
        worst = fmax(worst, sqrt(dd) * fabs(hits[0].t - (-od - root) / dd));
        worst = fmax(worst, sqrt(dd) * fabs(hits[1].t - (-od + root) / dd));
    }
    tet_ref_destroy(r);
    lab_mesh_release(&m);
    return worst;
}

static void sphere_error_falls_with_the_square_of_the_edge(void **state) {
    (void)state;
    double worst[3];
    for (int level = 0; level < 3; level++)
        worst[level] = sphere_error(12 << level, 11);
    assert_true(worst[0] < 0.03);
    for (int level = 0; level < 2; level++)
        if (!(worst[level] / worst[level + 1] > 3 && worst[level] / worst[level + 1] < 6))
            fail_msg("halving the edge: %g to %g", worst[level], worst[level + 1]);
}

/* ---- conventions ---- */

static void starting_inside_takes_the_side_of_the_origin(void **state) {
    (void)state;
    lab_mesh m;
    make_kuhn(&m, 4, 2, 2, ramp);
    tet_ref *r = reference_of(&m);
    const struct {
        double x, d, iso;
        size_t count;
        double t;
    } cases[] = {
        {1.5, 1, 2.5, 1, 1},
        {1.5, -1, 2.5, 0, 0}, /* outside; towards and away */
        {3.5, 1, 2.5, 0, 0},
        {3.5, -1, 2.5, 1, 1}, /* inside */
        {2, 1, 2.5, 1, 0.5},
        {3, -1, 2.5, 1, 0.5}, /* on a vertex's plane */
        {0, 1, 0.5, 1, 0.5},
        {4, -1, 3.5, 1, 0.5}, /* on the boundary */
        {2, 1, 2, 0, 0},
        {2, -1, 2, 1, 0}, /* on the surface, which is inside: leaving it */
        {2.25, 1, 2.25, 0, 0},
        {2.25, -1, 2.25, 1, 0}, /* the same within a tetrahedron */
        {2.25, 1, 2.25 + 1e-9, 1, 1e-9},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++)
        for (int lane = 0; lane < 2; lane++) { /* anywhere; along an edge */
            ref_ray ray = {{cases[i].x, lane ? 1 : 0.71, lane ? 1 : 0.37}, {cases[i].d, 0, 0}};
            size_t count = tet_ref_trace(r, &ray, &cases[i].iso, 1, NULL, hits, HITS_MAX);
            if (count != cases[i].count)
                fail_msg("case %zu: %zu surfaces", i, count);
            if (count)
                check_near(hits[0].t, cases[i].t, 1e-15);
        }
    tet_ref_destroy(r);
    lab_mesh_release(&m);
}

static const float row[9] = {5, 5, 7, 7, 7, 5, 7, 3, 7};
static double row_value(const double p[3]) {
    return row[(int)p[0]];
}

static void plateau_at_the_isovalue_is_inside(void **state) {
    (void)state;
    lab_mesh m;
    make_kuhn(&m, 8, 2, 2, row_value);
    tet_ref *r = reference_of(&m);
    const double iso = 7, want[5] = {3, 5, 7, 7, 9};
    const bool from_inside[5] = {false, true, false, true, false};
    for (int lane = 0; lane < 3; lane++) {
        const ref_ray ray = {{-1, lane ? 1 : 0.7, lane == 2 ? 1 : 0.4}, {1, 0, 0}};
        assert_int_equal(tet_ref_trace(r, &ray, &iso, 1, NULL, hits, HITS_MAX), 5);
        for (int i = 0; i < 5; i++) {
            check_near(hits[i].t, want[i], 1e-15);
            if (i != 2 && i != 3) /* equal t: in the order of their tetrahedra */
                assert_int_equal(hits[i].from_inside, from_inside[i]);
        }
        assert_int_not_equal(hits[2].from_inside, hits[3].from_inside);
    }
    tet_ref_destroy(r);
    lab_mesh_release(&m);
}

static void missing_data_holds_no_surface(void **state) {
    (void)state;
    const float bad[3] = {NAN, INFINITY, -INFINITY};
    for (int n = 0; n < 3; n++) {
        lab_mesh m;
        make_kuhn(&m, 4, 2, 2, ramp);
        m.values[2] = bad[n]; /* (2, 0, 0) */
        tet_ref *r = reference_of(&m);
        const double isos[4] = {0.5, 1.5, 2.5, 3.5};
        /* Through the edges at that point; beside them. */
        const ref_ray through = {{-1, 0.001, 0.0015}, {1, 0, 0}},
                      beside = {{-1, 1.5, 0.5}, {1, 0, 0}};
        assert_int_equal(tet_ref_trace(r, &through, isos, 4, NULL, hits, HITS_MAX), 2);
        assert_true(hits[0].iso == 0 && hits[1].iso == 3);
        assert_int_equal(tet_ref_trace(r, &beside, isos, 4, NULL, hits, HITS_MAX), 4);
        tet_ref_destroy(r);
        lab_mesh_release(&m);
    }
}

static void clipping_takes_the_side_anew(void **state) {
    (void)state;
    lab_mesh m;
    make_kuhn(&m, 4, 2, 2, ramp);
    tet_ref *r = reference_of(&m);
    const ref_ray ray = {{-1, 0.7, 0.4}, {1, 0, 0}};
    const double isos[3] = {0.5, 1.5, 2.5};
    ref_clip interval = {.t0 = 2, .t1 = 3.25};
    assert_int_equal(tet_ref_trace(r, &ray, isos, 3, &interval, hits, HITS_MAX), 1);
    assert_int_equal(hits[0].iso, 1);
    check_near(hits[0].t, 2.5, 1e-15);
    const double box[2][3] = {{1, 0, 0}, {3, 0.8, 1}};
    ref_clip boxed = {.t1 = INFINITY, .box = box};
    assert_int_equal(tet_ref_trace(r, &ray, isos, 3, &boxed, hits, HITS_MAX), 2);
    assert_true(hits[0].iso == 1 && hits[1].iso == 2);
    const double away[1][4] = {{0, 1, 0, -0.8}};
    ref_clip beside = {.t1 = INFINITY, .planes = away, .plane_count = 1};
    assert_int_equal(tet_ref_trace(r, &ray, isos, 3, &beside, hits, HITS_MAX), 0);
    tet_ref_destroy(r);
    lab_mesh_release(&m);
}

static void equal_t_orders_by_tetrahedron_then_isovalue(void **state) {
    (void)state;
    lab_mesh m;
    make_kuhn(&m, 4, 2, 2, ramp);
    tet_ref *r = reference_of(&m);
    const ref_ray ray = {{-1, 0.7, 0.4}, {1, 0, 0}};
    const double isos[4] = {2.25, 3.5, 2.25, 1.5};
    const int want[4] = {3, 0, 2, 1};
    assert_int_equal(tet_ref_trace(r, &ray, isos, 4, NULL, hits, HITS_MAX), 4);
    for (int i = 0; i < 4; i++)
        assert_int_equal(hits[i].iso, want[i]);
    assert_int_equal(tet_ref_trace(r, &ray, isos, 4, NULL, hits, 2), 4);
    assert_true(hits[0].iso == 3 && hits[1].iso == 0);
    tet_ref_destroy(r);
    lab_mesh_release(&m);
}

/* A square seen as two triangles from before, and as two others from behind; between them a
 * tetrahedron of no volume, without which the ray would slip through. */
static void flat_tetrahedra_close_holes(void **state) {
    (void)state;
    static const float points[6][3] = {{0, 0, 0}, {1, 0, 0},      {1, 1, 0},
                                       {0, 1, 0}, {0.5, 0.5, -1}, {0.5, 0.5, 1}};
    /* Along the diagonal 0-2 high, along 1-3 low. */
    static const float values[6] = {1, 0, 1, 0, 0.9f, 0};
    static const uint32_t tets[5][4] = {
        {0, 1, 2, 4}, {0, 2, 3, 4}, {0, 1, 3, 5}, {1, 2, 3, 5}, {0, 1, 2, 3}};
    const double iso = 0.5;
    const ref_ray ray = {{0.5, 0.45, -3}, {0, 0, 1}};
    for (size_t count = 4; count <= 5; count++) {
        tet_ref_mesh m = {6, count, points, values, tets};
        tet_ref *r = tet_ref_create(&m);
        assert_non_null(r);
        size_t found = tet_ref_trace(r, &ray, &iso, 1, NULL, hits, HITS_MAX);
        assert_int_equal(found, count == 5);
        if (found) {
            assert_true(hits[0].t == 3);
            assert_int_equal(hits[0].cell, 4);
        }
        tet_ref_destroy(r);
    }
}

/* ---- the same surface from the same mesh told otherwise ---- */

static void compare(const tet_ref *a, const tet_ref *b, const lab_mesh *m, double scale) {
    field_random random = {SEED};
    size_t seen = 0;
    for (int n = 0; n < 900; n++) {
        lab_ray kind = (lab_ray)(n % LAB_RAY_KINDS);
        ref_ray ray = lab_mesh_ray(m, kind, &random), there = ray;
        for (int x = 0; x < 3; x++) {
            there.o[x] *= scale;
            there.d[x] *= scale;
        }
        size_t count = tet_ref_trace(a, &ray, &m->iso, 1, NULL, hits, HITS_MAX);
        size_t other = tet_ref_trace(b, &there, &m->iso, 1, NULL, others, HITS_MAX);
        if (count != other)
            fail_msg("%s, %s ray %d: %zu surfaces and %zu", m->name, lab_ray_name(kind), n, count,
                     other);
        for (size_t i = 0; i < count; i++)
            if (fabsl(hits[i].t_exact - others[i].t_exact) * hits[i].cells_per_t > 1e-12L)
                fail_msg("%s, %s ray %d, surface %zu: %.17g and %.17g", m->name, lab_ray_name(kind),
                         n, i, hits[i].t, others[i].t);
        seen += count;
    }
    assert_true(seen > 300);
}

static void repeats_and_nonsense_change_nothing(void **state) {
    (void)state;
    lab_mesh m;
    make(&m, "repeated");
    tet_ref *with = reference_of(&m);
    m.tet_count = m.tet_count / 3 * 2; /* those it began with */
    tet_ref *without = reference_of(&m);
    compare(with, without, &m, 1);
    tet_ref_destroy(with);
    tet_ref_destroy(without);
    lab_mesh_release(&m);
}

static void order_and_orientation_change_nothing(void **state) {
    (void)state;
    static const char *const names[] = {"noise-turned", "vertex-values", "flat-steps", "wild"};
    for (size_t k = 0; k < sizeof names / sizeof names[0]; k++) {
        lab_mesh m;
        make(&m, names[k]);
        tet_ref_mesh raw = lab_mesh_reference(&m);
        uint32_t(*turned)[4] = malloc(m.tet_count * sizeof *turned);
        assert_non_null(turned);
        for (size_t i = 0; i < m.tet_count; i++)
            for (size_t v = 0; v < 4; v++)
                turned[m.tet_count - 1 - i][(v * 3 + i) % 4] = m.tets[i][v];
        tet_ref *a = tet_ref_create(&raw);
        raw.tets = (const uint32_t(*)[4])turned;
        tet_ref *b = tet_ref_create(&raw);
        compare(a, b, &m, 1);
        tet_ref_destroy(a);
        tet_ref_destroy(b);
        free(turned);
        lab_mesh_release(&m);
    }
}

static void size_changes_nothing(void **state) {
    (void)state;
    lab_mesh m, small;
    make(&m, "noise");
    make(&small, "noise");
    for (size_t i = 0; i < small.point_count; i++)
        for (int a = 0; a < 3; a++)
            small.points[i][a] *= 0x1p-60f;
    tet_ref *a = reference_of(&m), *b = reference_of(&small);
    compare(a, b, &m, 0x1p-60);
    tet_ref_destroy(a);
    tet_ref_destroy(b);
    lab_mesh_release(&m);
    lab_mesh_release(&small);
}

/* ---- parity and dense sampling ---- */

/* f - iso at a point by Cramer's rule in whichever tetrahedron holds it best; NaN outside. */
static long double value_at(const lab_mesh *m, const long double p[3], double iso) {
    long double best = -1e-9L, value = NAN;
    for (size_t i = 0; i < m->tet_count; i++) {
        long double e[4][3], w[4], sum = 0, least = INFINITY, f = 0;
        bool named = true;
        for (int k = 0; k < 4; k++)
            named = named && m->tets[i][k] < m->point_count;
        if (!named)
            continue;
        for (int k = 0; k < 4; k++)
            for (int a = 0; a < 3; a++)
                e[k][a] = m->points[m->tets[i][k]][a] - p[a];
        for (int k = 0; k < 4; k++) {
            const long double *A = e[(k + 1) % 4], *B = e[(k + 2) % 4], *C = e[(k + 3) % 4];
            w[k] = A[0] * (B[1] * C[2] - B[2] * C[1]) + A[1] * (B[2] * C[0] - B[0] * C[2]) +
                   A[2] * (B[0] * C[1] - B[1] * C[0]);
            w[k] *= k % 2 ? -1 : 1;
            sum += w[k];
        }
        for (int k = 0; k < 4; k++) {
            least = fminl(least, w[k] / sum);
            f += w[k] / sum * ((long double)m->values[m->tets[i][k]] - iso);
        }
        if (sum != 0 && least > best) {
            best = least;
            value = f;
        }
    }
    return value;
}

static bool begins_inside(const lab_mesh *m, lab_ray kind, const ref_ray *ray) {
    if (kind != LAB_RAY_INSIDE && kind != LAB_RAY_ON_VERTEX)
        return false;
    const long double o[3] = {ray->o[0], ray->o[1], ray->o[2]};
    return value_at(m, o, m->iso) >= 0;
}

/* Where a ray begins on the very surface its first side may be either. */
static bool begins_on_surface(const lab_mesh *m, const ref_ray *ray) {
    const long double o[3] = {ray->o[0], ray->o[1], ray->o[2]};
    return fabsl(value_at(m, o, m->iso)) < 1e-9;
}

/* From outside the sides alternate and the last surface leads outside; from inside, the first one
 * does. */
static void check_parity(const lab_mesh *m, const tet_ref *r, lab_ray kind, int n, ref_ray ray) {
    size_t count = tet_ref_trace(r, &ray, &m->iso, 1, NULL, hits, HITS_MAX);
    bool starts_within = kind == LAB_RAY_INSIDE || kind == LAB_RAY_ON_VERTEX;
    if (starts_within && (!m->sound || begins_on_surface(m, &ray)))
        return;
    bool inside = begins_inside(m, kind, &ray);
    if (count % 2 != inside)
        fail_msg("%s, seed %d, %s ray %d: %zu surfaces from %s", m->name, SEED, lab_ray_name(kind),
                 n, count, inside ? "inside" : "outside");
    for (size_t i = 0; i < count && m->sound; i++) {
        bool tied =
            (i > 0 && hits[i].t == hits[i - 1].t) || (i + 1 < count && hits[i].t == hits[i + 1].t);
        if (!tied && hits[i].from_inside != (inside ^ (i % 2 == 1)))
            fail_msg("%s, seed %d, %s ray %d: surface %zu from the wrong side", m->name, SEED,
                     lab_ray_name(kind), n, i);
    }
}

static void closed_surfaces_are_closed(void **state) {
    (void)state;
    int closed = 0;
    for (int k = 0; k < lab_mesh_count(); k++) {
        lab_mesh m;
        make(&m, lab_mesh_name(k));
        tet_ref *r = reference_of(&m);
        field_random random = {SEED};
        for (int n = 0; m.closed && n < 360; n++) {
            lab_ray kind = (lab_ray)(n % LAB_RAY_KINDS);
            check_parity(&m, r, kind, n, lab_mesh_ray(&m, kind, &random));
        }
        closed += m.closed;
        tet_ref_destroy(r);
        lab_mesh_release(&m);
    }
    assert_true(closed > 20);
}

/* Between two surfaces the field keeps its side. */
static void check_samples(const lab_mesh *m, const tet_ref *r, lab_ray kind, int n, ref_ray ray) {
    size_t count = tet_ref_trace(r, &ray, &m->iso, 1, NULL, hits, HITS_MAX);
    bool side = begins_inside(m, kind, &ray);
    for (size_t i = 0; i <= count; i++) {
        long double from = i ? hits[i - 1].t_exact : 0, to = i < count ? hits[i].t_exact : from + 2;
        for (int s = 1; s < 16 && to > from; s++) {
            long double t = from + (to - from) * s / 16, p[3];
            for (int a = 0; a < 3; a++)
                p[a] = ray.o[a] + t * ray.d[a];
            long double value = value_at(m, p, m->iso);
            if (fabsl(value) > 1e-9 && (value >= 0) != side)
                fail_msg("%s, seed %d, %s ray %d: at t %.17Lg behind surface %zu f - iso is %Lg",
                         m->name, SEED, lab_ray_name(kind), n, t, i, value);
        }
        side = !side;
    }
}

static void dense_samples_keep_their_side(void **state) {
    (void)state;
    static const char *const names[] = {"sphere", "waves",   "noise",          "noise-turned",
                                        "mixed",  "checker", "noise-jittered", "vertex-values"};
    for (size_t k = 0; k < sizeof names / sizeof names[0]; k++) {
        lab_mesh m;
        assert_true(lab_mesh_make(&m, names[k], 3, SEED));
        tet_ref *r = reference_of(&m);
        field_random random = {SEED};
        for (int n = 0; n < 90; n++) {
            lab_ray kind = (lab_ray)(n % LAB_RAY_KINDS);
            ref_ray ray = lab_mesh_ray(&m, kind, &random);
            if (kind == LAB_RAY_ON_VERTEX && begins_on_surface(&m, &ray))
                continue;
            check_samples(&m, r, kind, n, ray);
        }
        tet_ref_destroy(r);
        lab_mesh_release(&m);
    }
}

/* What every mesh must have for the tests that use them to mean something. */
static void meshes_are_what_they_say(void **state) {
    (void)state;
    for (int k = 0; k < lab_mesh_count(); k++) {
        lab_mesh m;
        make(&m, lab_mesh_name(k));
        tet_ref *r = reference_of(&m);
        field_random random = {SEED};
        size_t seen = 0;
        for (int n = 0; n < 180; n++) {
            lab_ray kind = (lab_ray)(n % LAB_RAY_KINDS);
            ref_ray ray = lab_mesh_ray(&m, kind, &random);
            bool outside = false;
            for (int a = 0; a < 3; a++)
                outside |= ray.o[a] < m.lo[a] || ray.o[a] > m.hi[a];
            if (!outside && kind != LAB_RAY_INSIDE && kind != LAB_RAY_ON_VERTEX)
                fail_msg("%s: %s ray %d begins inside", m.name, lab_ray_name(kind), n);
            seen += tet_ref_trace(r, &ray, &m.iso, 1, NULL, hits, HITS_MAX);
        }
        if (seen < 45)
            fail_msg("%s: only %zu surfaces", m.name, seen);
        tet_ref_destroy(r);
        lab_mesh_release(&m);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(sums_are_exact),
        cmocka_unit_test(linear_field_is_a_plane),
        cmocka_unit_test(sphere_error_falls_with_the_square_of_the_edge),
        cmocka_unit_test(starting_inside_takes_the_side_of_the_origin),
        cmocka_unit_test(plateau_at_the_isovalue_is_inside),
        cmocka_unit_test(missing_data_holds_no_surface),
        cmocka_unit_test(clipping_takes_the_side_anew),
        cmocka_unit_test(equal_t_orders_by_tetrahedron_then_isovalue),
        cmocka_unit_test(flat_tetrahedra_close_holes),
        cmocka_unit_test(repeats_and_nonsense_change_nothing),
        cmocka_unit_test(order_and_orientation_change_nothing),
        cmocka_unit_test(size_changes_nothing),
        cmocka_unit_test(meshes_are_what_they_say),
        cmocka_unit_test(closed_surfaces_are_closed),
        cmocka_unit_test(dense_samples_keep_their_side),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
