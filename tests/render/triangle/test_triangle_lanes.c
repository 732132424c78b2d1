/* test_triangle_lanes.c - what tiles make of many triangles at a time against the kernel's, to the
 * bit: polygons by the ranks of their corners, normals, the points of hits. Any triangles, flat
 * ones, points that coincide in some coordinates or all.
 */
/* marks: bits */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

#include "tests/support/simd_wide.h"

#include "render/triangle/triangle_facts_template.h"
#include "render/triangle/triangle_turn_template.h"
#include "tests/support/fields.h"
#include "tests/support/watched.h"

enum { TRIANGLES = (SLOW ? 20000 : 100000) / 16 * 16 };

/* A treelet's triangles, each with vertices of its own in some order. */
typedef struct some_triangles {
    float p[3][3 * VF_N];
    uint16_t rows[VF_N][3];
    triangle_blocks blocks;
} some_triangles;

static float any_coordinate(field_random *r, double size, double away, bool lattice) {
    const double at = lattice ? (double)field_random_below(r, 3) - 1.0 : field_random_in(r, -1, 1);
    return field_random_below(r, 16) == 0 ? -0.0f : (float)(size * (at + away));
}

static void any_triangles(some_triangles *t, field_random *r) {
    static const double sizes[] = {1.0, 1e-30, 1e30, 3e38, 1e-44, 1e-3};
    memset(t, 0, sizeof *t);
    for (unsigned k = 0; k < VF_N; k++) {
        const double size = sizes[field_random_below(r, 6)];
        const double away = size < 1e30 && field_random_below(r, 4) == 0 ? 1e6 : 0.0;
        const bool lattice = field_random_below(r, 2) == 0;
        const unsigned turn = (unsigned)field_random_below(r, 3);
        for (unsigned i = 0; i < 3; i++) {
            t->rows[k][i] = (uint16_t)(3 * k + (i + turn) % 3);
            for (int a = 0; a < 3; a++)
                t->p[a][t->rows[k][i]] = any_coordinate(r, size, away, lattice);
        }
    }
    for (int a = 0; a < 3; a++)
        t->blocks.p[a] = t->p[a];
    t->blocks.rows = (const uint16_t(*)[3])t->rows;
}

static triangle triangle_of(const some_triangles *t, unsigned k) {
    triangle x = {.smooth = false};
    for (int i = 0; i < 3; i++)
        for (int a = 0; a < 3; a++)
            x.p[i][a] = t->p[a][t->rows[k][i]];
    return x;
}

static void test_same_polygons(void **state) {
    (void)state;
    field_random r = {43};
    int ties = 0, first[3] = {0};
    for (int i = 0; i < TRIANGLES; i += VF_N) {
        some_triangles t;
        turned_triangles turned;
        uint32_t vertex[3][VF_N];
        vf corner[3][3];
        any_triangles(&t, &r);
        for (unsigned k = 0; k < VF_N; k++)
            for (int v = 0; v < 3; v++)
                vertex[v][k] = t.rows[k][v];
        turn_triangles(&t.blocks, (const uint32_t(*)[VF_N])vertex, corner, &turned);
        for (unsigned k = 0; k < VF_N; k++) {
            const triangle x = triangle_of(&t, k);
            polygon_lanes lanes;
            flat_polygon want;
            triangle_polygon(&x, &want);
            memset(&lanes, 0xff, sizeof lanes);
            turned_put(&turned, k, &lanes, k % VD_N);
            const flat_polygon got = polygon_lanes_get(&lanes, k % VD_N);
            assert_int_equal(got.count, want.count);
            assert_memory_equal(got.edge, want.edge, sizeof want.edge);
            assert_memory_equal(got.p, want.p, sizeof want.p);
            for (int v = 0; v < 3; v++)
                for (int a = 0; a < 3; a++)
                    assert_memory_equal(&((const float *)&corner[v][a])[k], &x.p[v][a],
                                        sizeof(float));
            first[turned.first[k]]++;
            ties += want.edge[0] == want.edge[1] || want.edge[1] == want.edge[2];
        }
    }
    for (int v = 0; v < 3; v++)
        assert_true(first[v] > TRIANGLES / 8);
    assert_true(ties > TRIANGLES / 50);
}

static void assert_same(const double got[VD_N], unsigned lane, double want) {
    assert_memory_equal(&got[lane], &want, sizeof want);
}

/* The lanes of columns, as they are stored. */
typedef struct stored_facts {
    double at[3][VD_N], gradient[3][VD_N], error[3][VD_N], slack[VD_N], span[VD_N];
} stored_facts;

static void store_facts(const triangle_columns *c, const point_columns *f, stored_facts *to) {
    for (int a = 0; a < 3; a++) {
        d_store(to->at[a], f->at[a]);
        d_store(to->gradient[a], f->gradient[a]);
        d_store(to->error[a], f->error[a]);
    }
    d_store(to->slack, f->slack);
    d_store(to->span, triangle_spans(c));
}

static void test_same_facts(void **state) {
    (void)state;
    field_random r = {47};
    int none = 0;
    for (int i = 0; i < TRIANGLES; i += VF_N) {
        some_triangles t;
        any_triangles(&t, &r);
        for (unsigned at = 0; at < VF_N; at += VD_N) {
            triangle_columns c;
            point_columns facts;
            stored_facts got;
            for (unsigned k = 0; k < VD_N; k++)
                triangle_columns_put(&c, k, &t.blocks, at + k);
            triangle_facts(&c, &facts);
            store_facts(&c, &facts, &got);
            for (unsigned k = 0; k < VD_N; k++) {
                const triangle x = triangle_of(&t, at + k);
                const flat_facts want = triangle_flat_facts(&x);
                for (int a = 0; a < 3; a++) {
                    assert_same(got.at[a], k, want.at[a]);
                    assert_same(got.gradient[a], k, want.point.gradient[a]);
                    assert_same(got.error[a], k, want.error[a]);
                }
                assert_same(got.slack, k, want.slack);
                assert_same(got.span, k, want.point.span);
                none += want.error[0] == 0.0;
            }
        }
    }
    assert_true(none > TRIANGLES / 100 && none < TRIANGLES / 2);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_same_polygons),
                                       cmocka_unit_test(test_same_facts)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
