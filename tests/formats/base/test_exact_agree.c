/* test_exact_agree.c - the converter, the prober and the resampler against exact sums: which tets
 * are flat or inverted, and which hold a point, on faces, edges and vertices and a bit beside them,
 * of tets of any size and shape. */
/* marks: bits */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "prep/resample/resample.h"
#include "prep/resample/tet_value.h"
#include "tests/support/exact_sum.h"
#include "tests/support/fields.h"
#include "tests/support/fixture.h"
#include "tests/support/mesh_cases.h"
#include "tests/support/scratch.h"

enum { SEED = 11, TETS = 6, MESHES = 12, POINTS = 24 };

typedef float corners[4][3];

static field_random dice;

static double uniform(double lo, double hi) {
    return field_random_in(&dice, lo, hi);
}

static int below(int n) {
    return (int)field_random_below(&dice, n);
}

/* ---- tets ---- */

static void random_tet(corners t) {
    for (int k = 0; k < 12; k++)
        t[k / 3][k % 3] = (float)uniform(-1.0, 1.0);
}

/* A vertex in the plane of the others, but for its rounding. */
static void near_flat(corners t) {
    random_tet(t);
    for (int a = 0; a < 3; a++)
        t[3][a] = (float)(0.25 * (double)t[0][a] + 0.25 * (double)t[1][a] + 0.5 * (double)t[2][a]);
}

/* Small integers: every other one is flat, and of those some are lines or points. */
static void lattice(corners t) {
    const int size = 1 + below(7), flat = below(2);
    for (int k = 0; k < 12; k++)
        t[k / 3][k % 3] = (float)below(size + 1);
    for (int a = 0; a < 3 && flat; a++)
        t[3][a] = t[0][a] + (t[1][a] - t[0][a]) * 3 - (t[2][a] - t[0][a]) * 2;
}

static void near_million(corners t) {
    (below(2) ? near_flat : lattice)(t);
    for (int k = 0; k < 12; k++)
        t[k / 3][k % 3] += 1e6F;
}

static void scale(corners t, float by) {
    (below(2) ? near_flat : lattice)(t);
    for (int k = 0; k < 12; k++)
        t[k / 3][k % 3] *= by;
}

static void huge(corners t) {
    scale(t, 0x1p100F);
}

static void tiny(corners t) {
    scale(t, 0x1p-100F);
}

static void denormal(corners t) {
    static int made;
    /* The first of each mesh gives it an extent that is possible (leaf_place.h). */
    scale(t, made++ % TETS ? 0x1p-147F : 0x1p-117F);
}

static void any_sizes(corners t) {
    for (int k = 0; k < 12; k++)
        t[k / 3][k % 3] = (float)ldexp(uniform(-1.0, 1.0), below(200) - 130);
}

/* Flat, but for one vertex that is 2^-41 to 2^-90 beside the plane: what no double edge can hold,
 * and no sum of 128 bits. */
static void past_integers(corners t) {
    static const float flat[4][3] = {{0, 0, 0}, {1, 2, 3}, {4, 5, 6}, {5, 4, 3}};
    const int turn = below(3);
    for (int k = 0; k < 12; k++)
        t[k / 3][(k + turn) % 3] = flat[k / 3][k % 3];
    t[0][below(3)] = (float)ldexp(below(2) ? 1.0 : -1.0, -41 - below(50));
}

/* ---- the truth ---- */

static void widen(const corners t, double p[4][3]) {
    for (int k = 0; k < 12; k++)
        p[k / 3][k % 3] = (double)t[k / 3][k % 3];
}

static int sign_of(long double x) {
    return (x > 0) - (x < 0);
}

static int true_sign(const corners t) {
    double p[4][3];
    widen(t, p);
    return sign_of(exact_sum_volume(p[1], p[2], p[3], p[0]));
}

static bool truly_holds(const corners t, const double point[3]) {
    const int sign = true_sign(t);
    for (int k = 0; k < 4 && sign != 0; k++) {
        double p[4][3];
        widen(t, p);
        memcpy(p[k], point, sizeof p[k]);
        if (sign_of(exact_sum_volume(p[1], p[2], p[3], p[0])) * sign < 0)
            return false;
    }
    return sign != 0;
}

/* ---- points ---- */

/* In a vertex, an edge, a face or the inside, often exactly, and sometimes a bit beside it. */
static void point_of(const corners t, double point[3]) {
    double weight[4] = {0}, all = 0;
    for (int k = 1 + below(4); k > 0; k--)
        weight[below(4)] += 1 << below(3);
    for (int k = 0; k < 4; k++)
        all += weight[k];
    for (int a = 0; a < 3; a++) {
        point[a] = 0;
        for (int k = 0; k < 4; k++)
            point[a] += weight[k] / all * (double)t[k][a];
        if (below(4) == 0)
            point[a] = nextafter(point[a], below(2) ? HUGE_VAL : -HUGE_VAL);
    }
}

/* ---- the three ---- */

static mem m;

typedef struct tally {
    int flat, inside, outside;
} tally;

static mesh_case mesh_of(void (*make)(corners)) {
    mesh_case c = mesh_cases_soup((size_t)4 * TETS, TETS, SEED);
    c.options.treelet_tets = 4;
    for (uint32_t t = 0; t < TETS; t++) {
        make(c.points + (size_t)4 * t);
        for (uint32_t k = 0; k < 4; k++) {
            c.tets[t][k] = 4 * t + k;
            c.values[4 * t + k] = (float)(k + 1);
        }
    }
    return c;
}

static const float (*tet_of(const mesh_case *c, int t))[3] {
    return (const float(*)[3])c->points + (size_t)4 * (size_t)t;
}

/* The converter's counts. */
static void check_signs(const mesh_case *c, const char *kind, tally *sums) {
    mesh_result r;
    uint64_t count[3] = {0};
    if (mesh_cases_convert(&m, c, "agree.leaf", 0, &r) != ST_OK)
        fail_msg("%s: %s", kind, status_text());
    for (int t = 0; t < TETS; t++)
        count[true_sign(tet_of(c, t)) + 1]++;
    if (r.header.flat != count[1] ||
        r.header.inverted != (count[0] < count[2] ? count[0] : count[2]))
        fail_msg("%s (seed %d): flat %d, not %d; inverted %d, not the less of %d and %d", kind,
                 SEED, (int)r.header.flat, (int)count[1], (int)r.header.inverted, (int)count[0],
                 (int)count[2]);
    sums->flat += (int)count[1];
}

static bool resampler_holds(const corners t, const double point[3]) {
    const float *xyz[4] = {t[0], t[1], t[2], t[3]}, values[4] = {1, 2, 3, 4};
    tet_value v;
    float value;
    tet_value_init(&v, xyz, values);
    return v.sign != 0 && tet_value_at(&v, point, &value);
}

/* Whether a cell of the volume has these corners. */
static bool has_corners(leafcast *volume, uint64_t number, const float (*tet)[3]) {
    leafcast_cell cell = {.size = sizeof cell};
    bool same = true;
    assert_int_equal(leafcast_get_cell(volume, 0, number, &cell), LEAFCAST_OK);
    assert_int_equal(cell.corners, 4);
    for (int i = 0; i < 12; i++)
        same &= cell.position[i / 3][i % 3] == (double)tet[i / 3][i % 3];
    return same;
}

/* A point: which tets hold it to the resampler, and whether the prober finds one of them. */
static void check_point(const mesh_case *c, leafcast *volume, const double point[3],
                        const char *kind, tally *sums) {
    leafcast_sample sample;
    bool any = false, right = false;
    assert_int_equal(leafcast_probe_point(volume, point, &sample), LEAFCAST_OK);
    for (int t = 0; t < TETS; t++) {
        const bool holds = truly_holds(tet_of(c, t), point);
        if (resampler_holds(tet_of(c, t), point) != holds)
            fail_msg("%s (seed %d): to the resampler %a,%a,%a is %s tet %d", kind, SEED, point[0],
                     point[1], point[2], holds ? "not in" : "in", t);
        any |= holds;
        right |= holds && sample.inside && has_corners(volume, sample.cell, tet_of(c, t));
    }
    if (sample.inside != any || (any && !right))
        fail_msg("%s (seed %d): the prober finds %a,%a,%a in %s tet", kind, SEED, point[0],
                 point[1], point[2],
                 !sample.inside ? "no"
                 : any          ? "another"
                                : "a");
    if (any && !(sample.value >= 1.0 - 1e-6 && sample.value <= 4.0 + 1e-6))
        fail_msg("%s (seed %d): the value at %a,%a,%a is %g", kind, SEED, point[0], point[1],
                 point[2], sample.value);
    *(any ? &sums->inside : &sums->outside) += 1;
}

static void check_mesh(void (*make)(corners), const char *kind, tally *sums) {
    mesh_case c = mesh_of(make);
    check_signs(&c, kind, sums);
    const leafcast_options o = {.size = sizeof(leafcast_options), .threads = 1};
    leafcast *volume = fixture_open(scratch_path("agree.leaf"), &o);
    for (int t = 0; t < TETS; t++)
        for (int n = 0; n < POINTS; n++) {
            double point[3];
            point_of(tet_of(&c, t), point);
            check_point(&c, volume, point, kind, sums);
        }
    leafcast_close(volume);
    mesh_cases_free(&c);
}

/* A kind is there for something: flat tets, points inside and beside. */
static void check_kind(void (*make)(corners), const char *kind, int flat) {
    tally sums = {0};
    dice.state = SEED;
    mem_init(&m, 0);
    for (int n = 0; n < MESHES; n++)
        check_mesh(make, kind, &sums);
    print_message("%s: %d of %d tets flat, %d points inside, %d not\n", kind, sums.flat,
                  MESHES * TETS, sums.inside, sums.outside);
    assert_true(sums.flat >= flat && sums.flat < MESHES * TETS);
    assert_true(sums.inside > 50 && sums.outside > 50);
}

static void test_ordinary(void **state) {
    (void)state;
    check_kind(random_tet, "random", 0);
    check_kind(near_flat, "near flat", 0);
    check_kind(lattice, "lattice", MESHES * TETS / 3);
}

static void test_sizes(void **state) {
    (void)state;
    check_kind(near_million, "near a million", MESHES * TETS / 6);
    check_kind(huge, "2^100", MESHES * TETS / 6);
    check_kind(tiny, "2^-100", MESHES * TETS / 6);
    check_kind(denormal, "2^-147", MESHES * TETS / 6);
    check_kind(any_sizes, "any sizes", 0);
}

static void test_past_integers(void **state) {
    (void)state;
    check_kind(past_integers, "past integers", 0);
}

/* ---- a grid's nodes ---- */

typedef struct samples {
    float at[7 * 7 * 7];
    size_t count;
} samples;

static status take(void *ctx, const float *from, size_t count) {
    samples *s = ctx;
    memcpy(s->at + s->count, from, count * sizeof *from);
    s->count += count;
    return ST_OK;
}

/* The whole way: a node has a sample where the prober finds a tet. */
static void test_nodes(void **state) {
    (void)state;
    const resample_grid g = {.dims = {7, 7, 7}, .spacing = {1, 1, 1}};
    const resample_options o = {.memory = 1 << 30, .threads = 1};
    int held = 0;
    dice.state = SEED;
    mem_init(&m, 0);
    for (int n = 0; n < MESHES; n++) {
        mesh_case c = mesh_of(lattice);
        tally sums = {0};
        samples s = {.count = 0};
        resample_result result;
        leaf_file *f;
        check_signs(&c, "nodes", &sums);
        assert_int_equal(leaf_file_open(&m, scratch_path("agree.leaf"), &f), ST_OK);
        assert_int_equal(resample_run(&m, f, &g, &o, NULL, take, &s, &result), ST_OK);
        leaf_file_close(f);
        const leafcast_options one = {.size = sizeof(leafcast_options), .threads = 1};
        leafcast *volume = fixture_open(scratch_path("agree.leaf"), &one);
        for (int i = 0; i < 7 * 7 * 7; i++) {
            const double point[3] = {i % 7, i / 7 % 7, i / 49};
            leafcast_sample sample;
            assert_int_equal(leafcast_probe_point(volume, point, &sample), LEAFCAST_OK);
            assert_int_equal(sample.inside, !isnan(s.at[i]));
            held += sample.inside;
        }
        leafcast_close(volume);
        mesh_cases_free(&c);
    }
    assert_in_range(held, 7 * 7 * 7 / 4, 7 * 7 * 7 * MESHES);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_ordinary),
        cmocka_unit_test(test_sizes),
        cmocka_unit_test(test_past_integers),
        cmocka_unit_test(test_nodes),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
