/* test_tet_kernel.c - isopolygons and hits in single tets against the plain formula in long double:
 * where the line is inside the tet, f is linear. */
/* marks: bits */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "render/mesh/tet_kernel.h"
#include "tests/support/fields.h"
#include "tests/support/tet_hit.h"

enum { SEED = 7, COUNT = 40000 };

static field_random dice;

static double uniform(void) {
    return field_random_in(&dice, -1.0, 1.0);
}

/* ---- the formula ----------------------------------------------------------------------------- */

typedef struct truth {
    long double t, margin; /* of the line with the isosurface's plane; least barycentric there */
    long double slope;     /* df/dt */
} truth;

static long double determinant_of(long double m[3][3]) {
    return m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
           m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
           m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
}

/* Barycentric coordinates of p, or with a direction their slope. */
static void barycentric(const tet *x, const double p[3], bool direction, long double b[4]) {
    long double m[3][3], from[3];
    for (int k = 0; k < 3; k++)
        from[k] = (long double)p[k] - (direction ? 0.0L : (long double)x->p[0][k]);
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++)
            m[i][k] = (long double)x->p[i + 1][k] - (long double)x->p[0][k];
    const long double whole = determinant_of(m);
    b[0] = direction ? 0.0L : 1.0L;
    for (int i = 0; i < 3; i++) {
        long double n[3][3];
        memcpy(n, m, sizeof n);
        memcpy(n[i], from, sizeof from);
        b[i + 1] = determinant_of(n) / whole;
        b[0] -= b[i + 1];
    }
}

static truth truth_of(const tet *x, const ray *r, double iso) {
    long double at[4], along[4], f = 0.0L;
    truth v = {.margin = INFINITY};
    barycentric(x, r->o, false, at);
    barycentric(x, r->d, true, along);
    for (int i = 0; i < 4; i++) {
        f += at[i] * ((long double)x->f[i] - (long double)iso);
        v.slope += along[i] * ((long double)x->f[i] - (long double)iso);
    }
    v.t = -f / v.slope;
    for (int i = 0; i < 4; i++)
        v.margin = fminl(v.margin, at[i] + v.t * along[i]);
    return v;
}

/* ---- the tets -------------------------------------------------------------------------------- */

typedef struct kind {
    const char *name;
    double offset, size, squeeze; /* of positions; squeeze: of one axis */
    double base, range;           /* of values */
    double far;                   /* of the origin, in sizes */
    double tolerance;             /* of t, in sizes */
    double band;                  /* margins that are let off */
    double flat; /* how far the last vertex is from the oblique plane of the others, its value from
                  * theirs there; 0: anywhere */
} kind;

static const kind kinds[] = {
    {"ordinary", 0.0, 1.0, 1.0, 0.0, 1.0, 3.0, 1e-12, 1e-9, 0.0},
    {"far eye", 0.0, 1.0, 1.0, 0.0, 1.0, 1e6, 1e-7, 1e-7, 0.0},
    {"far place", 1e4, 0.1, 1.0, 5.0, 1.0, 3.0, 1e-9, 1e-8, 0.0},
    {"tiny", 0.0, 1e-30, 1.0, 0.0, 1e-30, 3.0, 1e-12, 1e-9, 0.0},
    {"huge", 0.0, 1e30, 1.0, 0.0, 1e30, 3.0, 1e-12, 1e-9, 0.0},
    {"needle", 0.0, 1.0, 1e-3, 0.0, 1.0, 3.0, 1e-9, 1e-7, 0.0},
    {"large base", 0.0, 1.0, 1.0, 1000.0, 0.01, 3.0, 1e-7, 1e-7, 0.0},
    {"sliver", 0.0, 1.0, 1.0, 0.0, 1.0, 3.0, 1e-7, 1e-7, 1e-3},
};

static float beside(float a, float b, float c, double far) {
    return (float)(0.3 * (double)a + 0.3 * (double)b + 0.4 * (double)c + far * uniform());
}

/* A ray is in it for a moment, so that it must aim at where the isovalue is. */
static void flatten(tet *x, double flat, double aim[3], double *iso) {
    for (int a = 0; a < 3; a++) {
        x->p[3][a] = beside(x->p[0][a], x->p[1][a], x->p[2][a], flat);
        aim[a] = (double)beside(x->p[0][a], x->p[1][a], x->p[2][a], 0.3 * flat);
    }
    x->f[3] = beside(x->f[0], x->f[1], x->f[2], flat);
    *iso = (double)beside(x->f[0], x->f[1], x->f[2], 0.3 * flat);
}

/* A tet, and a ray that goes by it as often as through it. */
static void make(const kind *k, tet *x, ray *r, double *iso) {
    double aim[3] = {0.0, 0.0, 0.0};
    for (int i = 0; i < 4; i++) {
        for (int a = 0; a < 3; a++) {
            const double squeeze = a == 1 ? k->squeeze : 1.0;
            x->p[i][a] = (float)(k->offset + k->size * squeeze * uniform());
            aim[a] += 0.25 * (double)x->p[i][a];
        }
        x->f[i] = (float)(k->base + k->range * uniform());
    }
    *iso = k->base + 0.5 * k->range * uniform();
    if (k->flat > 0.0)
        flatten(x, k->flat, aim, iso);
    double length = 0.0;
    for (int a = 0; a < 3; a++) {
        r->o[a] = k->offset + k->far * k->size * uniform();
        r->d[a] =
            aim[a] +
            0.3 * (k->flat > 0.0 ? k->flat : k->size) * (a == 1 ? k->squeeze : 1.0) * uniform() -
            r->o[a];
        length += r->d[a] / k->size * (r->d[a] / k->size);
    }
    for (int a = 0; a < 3; a++)
        r->d[a] /= sqrt(length) * k->size;
    r->t0 = -INFINITY;
    r->t1 = INFINITY;
}

/* Crossings at a flat angle lose digits, by their nature. */
static double steepness(const tet *x, const truth *v) {
    double g[3];
    if (!tet_gradient(x, g))
        return 0.0;
    return fabs((double)v->slope) / sqrt(g[0] * g[0] + g[1] * g[1] + g[2] * g[2]);
}

/* By the definition. */
static bool is_active(const float f[4], double iso) {
    bool below = false, above = false, finite = true;
    for (int v = 0; v < 4; v++) {
        finite = finite && isfinite(f[v]);
        below = below || (double)f[v] < iso;
        above = above || (double)f[v] >= iso;
    }
    return finite && below && above;
}

static void check_ray(const kind *k, int i, const tet *x, const ray *r, double iso, int counts[3]) {
    const hit before = hit_before_all();
    const truth v = truth_of(x, r, iso);
    const double steep = steepness(x, &v);
    if (fabsl(v.margin) < (long double)k->band || !(steep > 1e-3)) {
        counts[2]++;
        return;
    }
    hit h;
    const bool any = tet_hit(x, r, &iso, 1, 77, &before, &h);
    const bool good =
        any == (v.margin > 0.0L) &&
        (!any || (fabsl((long double)h.t - v.t) <= (long double)(k->tolerance * k->size / steep) &&
                  h.entering == (v.slope > 0.0L) && h.cell == 77 && h.iso == 0));
    if (!good)
        fail_msg("%s %d (seed %d): t %.17g %s, not %.17Lg; margin %Lg", k->name, i, SEED,
                 any ? h.t : (double)NAN, any && h.entering ? "entering" : "", v.t, v.margin);
    counts[any]++;
}

static void hits_by_formula(void **test) {
    (void)test;
    for (size_t k = 0; k < sizeof kinds / sizeof kinds[0]; k++) {
        int counts[3] = {0};
        dice.state = SEED;
        for (int i = 0; i < COUNT; i++) {
            tet x;
            ray r;
            double iso;
            make(&kinds[k], &x, &r, &iso);
            if (is_active(x.f, iso))
                check_ray(&kinds[k], i, &x, &r, iso, counts);
        }
        print_message("%s: %d missed, %d hit, %d let off\n", kinds[k].name, counts[0], counts[1],
                      counts[2]);
        assert_true(counts[0] > COUNT / 20 && counts[1] > COUNT / 20 && counts[2] < COUNT / 10);
    }
}

/* ---- the table ------------------------------------------------------------------------------- */

static const int ends[TET_EDGES][2] = {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}};

static void check_polygon(const tet *x, const isopolygon *g, unsigned inside) {
    double normal[3] = {0.0, 0.0, 0.0}, gradient[3], up = 0.0;
    for (int i = 0; i < g->count; i++) {
        const int j = (i + 1) % g->count;
        const int *a = ends[g->edge[i]], *b = ends[g->edge[j]];
        assert_true((inside >> a[0] & 1) != (inside >> a[1] & 1));
        /* Neighbours lie on a common face: their edges share one vertex. */
        assert_int_equal((a[0] == b[0]) + (a[0] == b[1]) + (a[1] == b[0]) + (a[1] == b[1]), 1);
        for (int k = 0; k < 3; k++) {
            const int l = (k + 1) % 3, m = (k + 2) % 3;
            normal[k] += g->p[i][l] * g->p[j][m] - g->p[i][m] * g->p[j][l];
        }
    }
    assert_true(tet_gradient(x, gradient));
    for (int k = 0; k < 3; k++)
        up += normal[k] * gradient[k];
    assert_true(up > 0.0);
}

static void sixteen_cases(void **test) {
    (void)test;
    dice.state = SEED;
    for (unsigned i = 0; i < 16 * 64; i++) {
        const unsigned inside = i % 16;
        tet x;
        for (int v = 0; v < 4; v++) {
            for (int k = 0; k < 3; k++)
                x.p[v][k] = (float)uniform();
            x.f[v] = (float)(inside >> v & 1 ? field_random_unit(&dice)
                                             : -0.1 - field_random_unit(&dice));
        }
        isopolygon g;
        const bool any = isopolygon_of(&x, 0.0, &g);
        assert_int_equal(any, inside != 0 && inside != 15);
        assert_int_equal(any, is_active(x.f, 0.0));
        if (!any)
            continue;
        const unsigned count = (inside & 1) + (inside >> 1 & 1) + (inside >> 2 & 1) + (inside >> 3);
        assert_int_equal(g.count, count == 2 ? 4 : 3);
        check_polygon(&x, &g, inside);
    }
}

/* Whatever the sizes: a point never leaves the box of its edge. */
static void points_stay_on_edges(void **test) {
    (void)test;
    dice.state = SEED;
    for (int i = 0; i < 4 * COUNT; i++) {
        tet x;
        for (int v = 0; v < 4; v++)
            for (int k = 0; k < 3; k++)
                x.p[v][k] =
                    ldexpf((float)uniform(), (int)field_random_below(&dice, i % 2 ? 100 : 4));
        /* s at, near or far from 1. */
        memcpy(x.f, (float[4]){0, 1, -1, -1}, sizeof x.f);
        x.f[0] = i % 3 ? (float)ldexp(uniform(), -(int)field_random_below(&dice, 60)) : 0.0f;
        isopolygon g;
        const double iso = i % 5 ? 1.0 - ldexp(1.0, -(int)field_random_below(&dice, 54)) : 1.0;
        if (!isopolygon_of(&x, iso, &g))
            continue;
        for (int c = 0; c < g.count; c++)
            for (int k = 0; k < 3; k++) {
                const double a = (double)x.p[ends[g.edge[c]][0]][k];
                const double b = (double)x.p[ends[g.edge[c]][1]][k];
                assert_true(g.p[c][k] >= fmin(a, b) && g.p[c][k] <= fmax(a, b));
            }
    }
}

static const tet unit = {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {0, 0, 0, 0}};

static ray ray_from(double ox, double oy, double oz, double dx, double dy, double dz) {
    return (ray){.o = {ox, oy, oz}, .d = {dx, dy, dz}, .t0 = -INFINITY, .t1 = INFINITY};
}

static void isovalue_at_a_vertex(void **test) {
    (void)test;
    isopolygon g;
    tet x = unit;
    memcpy(x.f, (float[4]){0.3f, 1, 1, 1}, sizeof x.f);
    /* The face itself. */
    assert_true(isopolygon_of(&x, 1.0, &g));
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++)
            assert_true(g.p[i][k] == (double)x.p[ends[g.edge[i]][1]][k]);
    /* A point, an edge: nothing to hit, not even straight through. */
    const hit before = hit_before_all();
    hit h;
    const double iso = 1.0;
    const ray through = ray_from(0.5, 0.5, -1, 0, 0, 1);
    for (int n = 1; n <= 2; n++) {
        memcpy(x.f, (float[4]){0.3f, 1, n == 1 ? 0.5f : 1, 0.2f}, sizeof x.f);
        assert_true(isopolygon_of(&x, 1.0, &g));
        assert_false(tet_hit(&x, &through, &iso, 1, 0, &before, &h));
    }
    /* All inside; the value at the isovalue is inside. */
    memcpy(x.f, (float[4]){1, 2, 3, 4}, sizeof x.f);
    assert_false(isopolygon_of(&x, 1.0, &g));
    assert_true(isopolygon_of(&x, 4.0, &g));
    assert_false(isopolygon_of(&x, 4.0000001, &g));
}

static void no_data(void **test) {
    (void)test;
    const float bad[3] = {NAN, INFINITY, -INFINITY};
    for (int v = 0; v < 4; v++)
        for (int b = 0; b < 3; b++) {
            tet x = unit;
            memcpy(x.f, (float[4]){-1, 1, -1, 1}, sizeof x.f);
            isopolygon g;
            double gradient[3];
            assert_true(isopolygon_of(&x, 0.0, &g));
            x.f[v] = bad[b];
            assert_false(isopolygon_of(&x, 0.0, &g));
            assert_false(tet_gradient(&x, gradient));
        }
    tet largest = unit;
    isopolygon g;
    memcpy(largest.f, (float[4]){FLT_MAX, FLT_MAX, FLT_MAX, -FLT_MAX}, sizeof largest.f);
    assert_true(isopolygon_of(&largest, 0.0, &g));
}

/* ---- order ----------------------------------------------------------------------------------- */

static void hits_in_order(void **test) {
    (void)test;
    tet x = unit;
    memcpy(x.f, (float[4]){0, 0, 0, 8}, sizeof x.f); /* f = 8 z */
    const double isovalues[4] = {4.0, 1.0, 2.0, 1.0};
    const double expected[4] = {0.125, 0.125, 0.25, 0.5};
    const int32_t order[4] = {1, 3, 2, 0};
    ray r = ray_from(0.1, 0.2, 0, 0, 0, 1);
    hit last = hit_before_all(), h;
    for (int i = 0; i < 4; i++) {
        assert_true(tet_hit(&x, &r, isovalues, 4, 5, &last, &h));
        assert_true(h.t == expected[i] && h.iso == order[i] && h.entering && h.cell == 5);
        last = h;
    }
    assert_false(tet_hit(&x, &r, isovalues, 4, 5, &last, &h));
    /* Both ends of the ray belong to it; equal t behind a lower cell, before a higher. */
    r.t0 = r.t1 = 0.25;
    last = hit_before_all();
    assert_true(tet_hit(&x, &r, isovalues, 4, 5, &last, &h) && h.iso == 2);
    assert_true(tet_hit(&x, &r, isovalues, 4, 5, &(hit){0.25, 4, 9, true}, &h));
    assert_false(tet_hit(&x, &r, isovalues, 4, 5, &(hit){0.25, 6, -1, true}, &h));
    r.t0 = nextafter(0.25, 1.0);
    r.t1 = 0.4;
    assert_false(tet_hit(&x, &r, isovalues, 4, 5, &last, &h));
    /* From above. */
    r = ray_from(0.1, 0.2, 1, 0, 0, -1);
    assert_true(tet_hit(&x, &r, isovalues, 4, 5, &last, &h) && h.t == 0.5 && !h.entering);
}

/* ---- what is known about a hit --------------------------------------------------------------- */

static void errors_are_bounded(void **test) {
    (void)test;
    for (size_t k = 0; k < sizeof kinds / sizeof kinds[0]; k++) {
        int hits = 0;
        double worst = 0.0;
        dice.state = SEED;
        for (int i = 0; i < COUNT; i++) {
            tet x;
            ray r;
            double iso, gradient[3], at[3];
            const hit before = hit_before_all();
            hit h;
            make(&kinds[k], &x, &r, &iso);
            if (!tet_hit(&x, &r, &iso, 1, 0, &before, &h) || !tet_gradient(&x, gradient))
                continue;
            const surface_point p = tet_surface(&x, &r, iso, &h);
            long double b[4], f = 0.0L;
            for (int a = 0; a < 3; a++)
                at[a] = r.o[a] + h.t * r.d[a];
            barycentric(&x, at, false, b);
            for (int v = 0; v < 4; v++)
                f += b[v] * ((long double)x.f[v] - (long double)iso);
            if (!(fabsl(f) <= (long double)p.error))
                fail_msg("%s %d (seed %d): f - iso = %Lg, bound %g", kinds[k].name, i, SEED, f,
                         p.error);
            double square = 0.0, up = 0.0;
            for (int a = 0; a < 3; a++) {
                square += (double)(p.normal[a] * p.normal[a]);
                up += (double)p.normal[a] * gradient[a];
                assert_true(p.gradient[a] == gradient[a]);
            }
            assert_true(fabs(square - 1.0) < 1e-6 && up < 0.0 && p.span > 0.0);
            worst = fmax(worst, fabs((double)f) / p.error);
            hits++;
        }
        print_message("%s: %d hits, at most %.2g of the bound\n", kinds[k].name, hits, worst);
        assert_true(hits > COUNT / 20 && worst > 1e-3);
    }
}

static void bounds_are_narrow(void **test) {
    (void)test;
    const hit before = hit_before_all();
    double sum = 0.0;
    int hits = 0;
    dice.state = SEED;
    for (int i = 0; i < COUNT; i++) {
        tet x;
        ray r;
        double iso;
        hit h;
        make(&kinds[0], &x, &r, &iso);
        if (!tet_hit(&x, &r, &iso, 1, 0, &before, &h))
            continue;
        const surface_point p = tet_surface(&x, &r, iso, &h);
        double slope = 0.0;
        for (int a = 0; a < 3; a++)
            slope += p.gradient[a] * r.d[a];
        sum += p.error / fabs(slope) < 1e-12;
        hits++;
    }
    assert_true(sum > 0.95 * hits);
}

static void flat_tets(void **test) {
    (void)test;
    const hit before = hit_before_all();
    const double iso = 0.0;
    tet x = {{{0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}}, {-1, 1, -1, 1}};
    double gradient[3];
    hit h;
    assert_false(tet_gradient(&x, gradient));
    const ray r = ray_from(0.4, 0.55, 3, 0, 0, -1);
    assert_true(tet_hit(&x, &r, &iso, 1, 0, &before, &h) && h.t == 2.0);
    surface_point p = tet_surface(&x, &r, iso, &h);
    assert_true(fabsf(p.normal[2]) == 1.0f && fabs(p.gradient[2]) == 1.0 && p.span == 1.0);
    assert_true(p.error > 0.0 && p.error < 1e-14);
    assert_int_equal(h.entering, p.gradient[2] * r.d[2] > 0.0);
    /* From behind the other way round; with two ids changed over, too, and the gradient goes with
     * it, so that ray and light are on the same side as before. */
    const ray back = ray_from(0.4, 0.55, -3, 0, 0, 1);
    hit other;
    assert_true(tet_hit(&x, &back, &iso, 1, 0, &before, &other) && other.entering == !h.entering);
    int turned = 0;
    for (int i = 0; i < 4; i++)
        for (int k = 0; k < i; k++) {
            tet y = x;
            memcpy(y.p[i], x.p[k], sizeof y.p[i]);
            memcpy(y.p[k], x.p[i], sizeof y.p[k]);
            y.f[i] = x.f[k];
            y.f[k] = x.f[i];
            assert_true(tet_hit(&y, &r, &iso, 1, 0, &before, &other) && other.t == 2.0);
            p = tet_surface(&y, &r, iso, &other);
            assert_int_equal(other.entering, p.gradient[2] * r.d[2] > 0.0);
            turned += other.entering != h.entering;
        }
    assert_int_equal(turned, 6);
    p = tet_surface(&x, &r, iso, &h);
    /* In its plane, and where there is no area at all. */
    const ray beside = ray_from(-1, 0.3, 1, 1, 0, 0);
    assert_false(tet_hit(&x, &beside, &iso, 1, 0, &before, &h));
    for (int i = 0; i < 4; i++)
        x.p[i][0] = x.p[i][1] = 0.5f;
    const ray at = ray_from(0.5, 0.5, 3, 0, 0, -1);
    assert_false(tet_hit(&x, &at, &iso, 1, 0, &before, &h));
    /* Values as far apart as the tet is flat. */
    const tet thin = {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0.3f, 0.3f, 1e-20f}}, {1, 1, 1, -1}};
    const ray down = ray_from(0.31, 0.32, 1, 0, 0, -1);
    assert_true(tet_hit(&thin, &down, &iso, 1, 0, &before, &h) && h.entering);
    assert_true(fabs(h.t - 1.0) < 1e-15);
}

/* ---- bits ------------------------------------------------------------------------------------ */

/* Whatever compiler, flags, CPU: if this changes on purpose, so does what every file of distances
 * holds. */
static void the_same_bits_everywhere(void **test) {
    (void)test;
    const hit before = hit_before_all();
    uint64_t sum = 0;
    for (size_t k = 0; k < sizeof kinds / sizeof kinds[0]; k++) {
        dice.state = SEED;
        for (int i = 0; i < COUNT; i++) {
            tet x;
            ray r;
            double iso;
            hit h;
            make(&kinds[k], &x, &r, &iso);
            if (!tet_hit(&x, &r, &iso, 1, 0, &before, &h))
                continue;
            uint64_t bits;
            memcpy(&bits, &h.t, sizeof bits);
            sum = (sum ^ bits) * UINT64_C(0x9e3779b97f4a7c15);
            sum ^= sum >> 29;
        }
    }
    print_message("sum of bits: 0x%016llx\n", (unsigned long long)sum);
    assert_true(sum == UINT64_C(0x24da51e6b8d21adf));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(sixteen_cases),
        cmocka_unit_test(isovalue_at_a_vertex),
        cmocka_unit_test(no_data),
        cmocka_unit_test(points_stay_on_edges),
        cmocka_unit_test(hits_by_formula),
        cmocka_unit_test(hits_in_order),
        cmocka_unit_test(errors_are_bounded),
        cmocka_unit_test(bounds_are_narrow),
        cmocka_unit_test(flat_tets),
        cmocka_unit_test(the_same_bits_everywhere),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
