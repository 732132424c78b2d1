/* test_isopolygon.c - what tiles make of all coordinates, or of many tets, at a time against the
 * kernel's, to the bit: isopolygons, their edges as the eye sees them, normals. Any tets, flat
 * ones, values at the isovalue, beyond floats' middle range.
 */
/* marks: bits */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

#include "tests/support/simd_wide.h"

#include "render/flat/flat_points_template.h"
#include "render/mesh/tet_normals_template.h"
#include "render/mesh/tet_polygons_template.h"
#include "tests/support/fields.h"
#include "tests/support/watched.h"

enum { TETS = SLOW ? 100000 : 400000 };

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
    int any[5] = {0}, flat = 0, doubts = 0;
    for (int i = 0; i < TETS; i++) {
        tet x = any_tet(&r);
        any_values(&r, x.f);
        const double iso = field_random_below(&r, 3) == 0 && isfinite(x.f[0])
                               ? (double)x.f[0]
                               : field_random_in(&r, -0.5, 0.5);
        isopolygon want, got;
        const bool there = isopolygon_of(&x, iso, &want);
        const near_tet near = near_tet_of(&x);
        const polygon_certainty found = isopolygon_near(&near, iso, &got);
        any[there ? want.count : 0]++;
        doubts += found == DOUBTFUL_POLYGON;
        if (found != DOUBTFUL_POLYGON)
            assert_int_equal(found == SURE_POLYGON, there);
        if (!there)
            continue;
        double p[4][3];
        for (int k = 0; k < 12; k++)
            p[k / 3][k % 3] = (double)x.p[k / 3][k % 3];
        flat += exact_orientation((const double(*)[3])p) == 0;
        if (found == DOUBTFUL_POLYGON)
            continue;
        assert_int_equal(got.count, want.count);
        assert_memory_equal(got.edge, want.edge, sizeof got.edge);
        assert_memory_equal(got.p, want.p, sizeof got.p);
    }
    assert_true(any[0] > TETS / 20 && any[3] > TETS / 20 && any[4] > TETS / 20);
    assert_true(flat > TETS / 100);
    /* Few but the flat ones are left to others. */
    assert_true(doubts < flat + TETS / 20);
}

/* A vector of them at a time, each with its isovalue. */
static void test_same_polygons(void **state) {
    (void)state;
    field_random r = {41};
    int any[5] = {0}, unsure = 0;
    for (int i = 0; i < TETS / VD_N; i++) {
        tet x[VD_N];
        tet_columns columns;
        polygon_lanes got;
        double iso[VD_N];
        for (unsigned k = 0; k < VD_N; k++) {
            x[k] = any_tet(&r);
            any_values(&r, x[k].f);
            iso[k] = field_random_below(&r, 3) == 0 && isfinite(x[k].f[0])
                         ? (double)x[k].f[0]
                         : field_random_in(&r, -0.5, 0.5);
            tet_columns_put(&columns, k, &x[k]);
        }
        const unsigned sure = isopolygons_near(&columns, iso, &got);
        for (unsigned k = 0; k < VD_N; k++) {
            isopolygon want;
            const bool there = isopolygon_of(&x[k], iso[k], &want);
            any[there ? want.count : 0]++;
            unsure += !(sure >> k & 1u);
            if (!(sure >> k & 1u))
                continue;
            const isopolygon lane = polygon_lanes_get(&got, k);
            assert_int_equal(lane.count, there ? want.count : 0);
            if (!there)
                continue;
            assert_memory_equal(lane.edge, want.edge, sizeof lane.edge);
            assert_memory_equal(lane.p, want.p, sizeof lane.p);
        }
    }
    assert_true(any[0] > TETS / 20 && any[3] > TETS / 20 && any[4] > TETS / 20);
    assert_true(unsure > TETS / 100 && unsure < TETS / 2);
}

/* An edge of a lane's polygon against exact_near(), for a direction. */
static void compare_edge(const isopolygon *g, int i, int j, const double o[3], const double d[3],
                         const seen_lanes *s, int edge, unsigned lane) {
    const int low = g->edge[i] > g->edge[j] ? j : i;
    const double ones[3] = {1.0, 1.0, 1.0}, error = s->error[edge][lane];
    double a[3], e[3], value = 0.0;
    for (int k = 0; k < 3; k++) {
        a[k] = g->p[low][k] - o[k];
        e[k] = g->p[j][k] - g->p[i][k];
    }
    const exact_estimate want = exact_near(d, a, e);
    for (int k = 0; k < 3; k++)
        value = k ? value + d[k] * s->normal[edge][k][lane] : d[k] * s->normal[edge][k][lane];
    assert_memory_equal(&value, &want.value, sizeof value);
    assert_true(error >= exact_near(ones, a, e).bound);
    assert_true(error <= exact_near(ones, a, e).bound * 1.001);
}

static void test_same_edges(void **state) {
    (void)state;
    static const int ends[EDGES][2] = {{1, 2}, {2, 0}, {0, 1}, {2, 3}, {3, 0}};
    field_random r = {31};
    int edges = 0;
    for (int i = 0; i < TETS / 10 / VD_N; i++) {
        isopolygon g[VD_N];
        polygon_lanes lanes;
        seen_lanes s;
        double o[3], d[3];
        for (int k = 0; k < 3; k++) {
            o[k] = field_random_in(&r, -3.0, 3.0);
            d[k] = field_random_in(&r, -1.0, 1.0);
        }
        for (unsigned k = 0; k < VD_N; k++) {
            tet x;
            do {
                x = any_tet(&r);
                for (int v = 0; v < 4; v++)
                    x.f[v] = (float)field_random_in(&r, -1.0, 1.0);
            } while (!isopolygon_of(&x, 0.0, &g[k]));
            polygon_lanes_put(&lanes, k, &g[k]);
        }
        see_lanes(&lanes, o, true, &s);
        for (unsigned k = 0; k < VD_N; k++)
            for (int e = 0; e < (g[k].count == 4 ? EDGES : EDGE_23); e++, edges++)
                compare_edge(&g[k], ends[e][0], ends[e][1], o, d, &s, e, k);
    }
    assert_true(edges > TETS / 10);
}

static void test_same_normals(void **state) {
    (void)state;
    field_random r = {37};
    int sure = 0, unsure = 0;
    for (int i = 0; i < TETS / VD_N; i++) {
        tet x[VD_N];
        tet_columns columns;
        float got[3][VD_N];
        for (unsigned k = 0; k < VD_N; k++) {
            x[k] = any_tet(&r);
            any_values(&r, x[k].f);
            tet_columns_put(&columns, k, &x[k]);
        }
        const unsigned lanes = tet_normals_of(&columns, got);
        for (unsigned k = 0; k < VD_N; k++) {
            double gradient[3];
            float want[3];
            unsure += !(lanes >> k & 1u);
            if (!(lanes >> k & 1u))
                continue;
            sure++;
            assert_true(tet_gradient(&x[k], gradient));
            tet_normal(&x[k], 0.0, want);
            for (int a = 0; a < 3; a++)
                assert_memory_equal(&got[a][k], &want[a], sizeof want[a]);
        }
    }
    assert_true(sure > TETS / 4 && unsure > TETS / 20);
}

/* A ray from o to a point of the polygon: inside, on an edge, a corner. */
static ray ray_to(const isopolygon *g, const double o[3], field_random *r) {
    ray x = {.t1 = INFINITY};
    double weight[4], sum = 0.0;
    for (int i = 0; i < 4; i++) {
        weight[i] = field_random_below(r, 6) == 0 ? 0.0 : field_random_unit(r);
        sum += weight[i];
    }
    for (int k = 0; k < 3; k++) {
        double at = g->p[0][k];
        for (int i = 0; i < 4 && sum > 0.0; i++)
            at += weight[i] / sum * (g->p[i][k] - g->p[0][k]);
        x.o[k] = o[k];
        x.d[k] = at - o[k];
    }
    return x;
}

/* The errors of rays' hits; one lane in two or so has the tet of the one before it. */
static void test_same_points(void **state) {
    (void)state;
    field_random r = {41};
    int same = 0, shared = 0;
    for (int i = 0; i < TETS / 4; i++) {
        point_columns c;
        flat_facts facts[VD_N];
        isopolygon g;
        ray rays[VD_N];
        hit hits[VD_N];
        double o[3], d[3][VD_N], t[VD_N], error[VD_N];
        unsigned some = 0;
        memset(&c, 0, sizeof c);
        memset(d, 0, sizeof d);
        memset(t, 0, sizeof t);
        for (int k = 0; k < 3; k++)
            o[k] = field_random_in(&r, -3.0, 3.0);
        for (unsigned k = 0, first = 0; k < VD_N; k++) {
            const hit before = hit_before_all();
            if (k == 0 || field_random_below(&r, 2) == 0) {
                tet x = any_tet(&r);
                for (int v = 0; v < 4; v++)
                    x.f[v] = (float)field_random_in(&r, -1.0, 1.0);
                if (!isopolygon_of(&x, 0.0, &g))
                    memset(&g, 0, sizeof g);
                facts[k] = tet_facts_of(&x, 0.0);
                first = k;
            }
            facts[k] = facts[first];
            if (g.count == 0)
                continue;
            rays[k] = ray_to(&g, o, &r);
            if (!flat_polygon_hit(&g, &rays[k], 5, 0, &before, &hits[k]))
                continue;
            some |= 1u << k;
            t[k] = hits[k].t;
            for (int a = 0; a < 3; a++)
                d[a][k] = rays[k].d[a];
        }
        for (unsigned left = some; left;) {
            unsigned as = left & -left;
            const flat_facts *f = &facts[__builtin_ctz(left)];
            for (unsigned k = 0; k < VD_N; k++)
                if (left >> k & 1u && memcmp(&facts[k], f, sizeof *f) == 0)
                    as |= 1u << k;
            point_columns_put(&c, as, f);
            shared += (as & (as - 1)) != 0;
            left &= ~as;
        }
        c.t = d_load(t);
        for (int a = 0; a < 3; a++)
            c.d[a] = d_load(d[a]);
        point_errors(&c, o, error);
        for (unsigned left = some; left; left &= left - 1) {
            const int k = __builtin_ctz(left);
            const surface_point want = flat_point_at(&facts[k], &rays[k], &hits[k]);
            assert_memory_equal(&error[k], &want.error, sizeof error[k]);
            same++;
        }
    }
    assert_true(same > TETS / 4 && shared > 100);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_same_polygon), cmocka_unit_test(test_same_polygons),
        cmocka_unit_test(test_same_edges),   cmocka_unit_test(test_same_normals),
        cmocka_unit_test(test_same_points),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
