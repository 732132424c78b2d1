/* test_tet_batch.c - every version of the many-rays kernel that this CPU has against
 * flat_polygon_hit(), to the bit: rays at random and on lattices, of one origin and of many, behind
 * given hits, with any polygons in any order. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "render/mesh/tet_batch.h"
#include "tests/support/fields.h"
#include "tests/support/tet_batch_wide.h"

enum { SEED = 23, TETS = 150, ISOS = 2, ROUNDS = 16 };

static field_random dice;

/* The versions to be tried: those of this CPU, and the one of AVX-512 in plain C. */
static int versions(void) {
    return (int)cpu_best() + 2;
}

static tet_batch_fn version(int v, const char **name) {
    const bool wide = v > (int)cpu_best();
    *name = wide ? "wide" : cpu_isa_name((cpu_isa)v);
    return wide ? tet_batch_wide : tet_batch_kernels[(cpu_isa)v];
}

/* ---- what is tried --------------------------------------------------------------------------- */

typedef struct scene {
    isopolygon polygons[TETS * ISOS]; /* number: tet * ISOS + iso; count 0: none */
    ray rays[FLAT_RAYS];
    hit after[FLAT_RAYS];
    int count; /* rays */
    bool one_origin, lattice;
} scene;

static scene it;

static double place(double size) {
    return it.lattice ? (double)field_random_below(&dice, 5) - 2.0
                      : field_random_in(&dice, -size, size);
}

static void make_polygons(void) {
    const double isovalues[ISOS] = {0.0, it.lattice ? 1.0 : 0.3};
    for (int i = 0; i < TETS; i++) {
        tet x;
        for (int v = 0; v < 4; v++) {
            for (int k = 0; k < 3; k++)
                x.p[v][k] = (float)place(2.0);
            x.f[v] = (float)(it.lattice ? (double)field_random_below(&dice, 5) - 2.0
                                        : field_random_in(&dice, -1.0, 1.0));
        }
        for (int j = 0; j < ISOS; j++)
            if (!isopolygon_of(&x, isovalues[j], &it.polygons[i * ISOS + j]))
                it.polygons[i * ISOS + j].count = 0;
    }
}

static void make_rays(void) {
    const double eye[3] = {place(9.0) - 4.0, place(9.0), place(9.0)};
    it.count = 1 + (int)field_random_below(&dice, FLAT_RAYS);
    for (int i = 0; i < it.count; i++) {
        ray *r = &it.rays[i];
        double sum = 0.0;
        *r = (ray){.t0 = 0.0, .t1 = field_random_below(&dice, 4) ? (double)INFINITY : 1.0};
        while (sum == 0.0)
            for (int k = 0; k < 3; k++) {
                r->o[k] = it.one_origin ? eye[k] : place(4.0) - (it.lattice ? 4.0 : 0.0);
                r->d[k] = place(1.5) - (it.lattice ? 0.0 : r->o[k]);
                sum += fabs(r->d[k]);
            }
        it.after[i] = hit_before_all();
    }
}

/* ---- the truth ------------------------------------------------------------------------------- */

/* The least hit behind another, tet after tet. */
static hit truth_of(const ray *r, const hit *after) {
    hit best = hit_none(), h;
    const hit behind = {after->t, UINT64_MAX, after->iso, after->entering};
    for (int i = 0; i < TETS * ISOS; i++) {
        hit last = hit_before_all();
        while (it.polygons[i].count > 0 &&
               flat_polygon_hit(&it.polygons[i], r, (uint64_t)(i / ISOS), i % ISOS, &last, &h)) {
            if (flat_polygon_less(&behind, &h) && flat_polygon_less(&h, &best))
                best = h;
            last = h;
        }
    }
    return best;
}

static bool same(const hit *a, const hit *b) {
    return memcmp(&a->t, &b->t, sizeof a->t) == 0 && a->cell == b->cell && a->iso == b->iso &&
           a->entering == b->entering;
}

/* ---- the comparison -------------------------------------------------------------------------- */

/* All polygons, from a random one on; rays in two parts. */
static void run(tet_batch_fn batch, flat_rays *rays, int first, int middle, int end) {
    rays->one_origin = it.one_origin;
    for (int i = 0; i < FLAT_RAYS; i++)
        flat_rays_clear(rays, i);
    for (int i = 0; i < it.count; i++)
        flat_rays_put(rays, i, &it.rays[i], &it.after[i]);
    const int start = (int)field_random_below(&dice, TETS * ISOS);
    for (int n = 0; n < TETS * ISOS; n++) {
        const int i = (start + 7 * n) % (TETS * ISOS); /* 7 and 300 have no divisor in common */
        if (it.polygons[i].count == 0)
            continue;
        batch(&it.polygons[i], (uint64_t)(i / ISOS), i % ISOS, TET_UNKNOWN, rays, first, middle);
        batch(&it.polygons[i], (uint64_t)(i / ISOS), i % ISOS, TET_UNKNOWN, rays, middle, end);
    }
}

static void compare(const flat_rays *rays, const hit *expected, const char *name, int round,
                    int first, int end) {
    for (int i = 0; i < FLAT_RAYS; i++) {
        const hit none = hit_none();
        const hit *want = i >= first && i < end ? &expected[i] : &none;
        if (!same(&rays->best[i], want))
            fail_msg("%s, round %d (seed %d), ray %d: %a in %d (iso %d, %d), not %a in %d (%d, %d)",
                     name, round, SEED, i, rays->best[i].t, (int)rays->best[i].cell,
                     rays->best[i].iso, rays->best[i].entering, want->t, (int)want->cell, want->iso,
                     want->entering);
    }
}

/* Layer after layer: each round's hits are what the next one's lie behind. */
static int check_layers(int round) {
    static flat_rays rays;
    hit expected[FLAT_RAYS];
    int hits = 0;
    for (int layer = 0; layer < 3; layer++) {
        for (int i = 0; i < it.count; i++) {
            expected[i] = truth_of(&it.rays[i], &it.after[i]);
            hits += hit_exists(&expected[i]);
        }
        for (int v = 0; v < versions(); v++) {
            const char *name;
            const tet_batch_fn batch = version(v, &name);
            int end = (int)field_random_below(&dice, it.count + 1);
            const int first = (int)field_random_below(&dice, end + 1);
            run(batch, &rays, 0, first, it.count);
            compare(&rays, expected, name, round, 0, it.count);
            run(batch, &rays, first, first, end);
            compare(&rays, expected, name, round, first, end);
        }
        for (int i = 0; i < it.count; i++)
            if (hit_exists(&expected[i]))
                it.after[i] = expected[i];
    }
    return hits;
}

static void check(bool lattice, bool one_origin) {
    int hits = 0, rays = 0;
    dice.state = SEED;
    it.lattice = lattice;
    it.one_origin = one_origin;
    for (int round = 0; round < ROUNDS; round++) {
        make_polygons();
        make_rays();
        hits += check_layers(round);
        rays += it.count;
    }
    print_message("%d rays, %d hits\n", rays, hits);
    assert_true(hits > (lattice ? rays / 10 : rays));
}

static void rays_of_one_origin(void **test) {
    (void)test;
    check(false, true);
}

static void rays_of_any_origin(void **test) {
    (void)test;
    check(false, false);
}

/* Through vertices and along edges all the time: mostly for the scalar truth, from any lane. */
static void rays_on_a_lattice(void **test) {
    (void)test;
    check(true, true);
    check(true, false);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rays_of_one_origin),
        cmocka_unit_test(rays_of_any_origin),
        cmocka_unit_test(rays_on_a_lattice),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
