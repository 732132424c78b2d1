/* test_tet_watertight.c - no ray slips between tets: rays exactly through vertices, along edges and
 * faces, through the corners of isopolygons, with isovalues at vertices, plateaus, flat tets.
 *
 * A mesh here is a list of tets with their vertices in ascending order of ids; a ray is held
 * against every one of them.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "render/mesh/tet_kernel.h"
#include "tests/support/fields.h"

enum { SEED = 11, SIDE_MAX = 6, TETS_MAX = 6 * SIDE_MAX * SIDE_MAX * SIDE_MAX, HITS_MAX = 4096 };

static field_random dice;

typedef struct lab {
    tet tets[TETS_MAX];
    int count;
    double iso;
    isopolygon polygons[TETS_MAX]; /* count 0: none */
    hit hits[HITS_MAX];            /* of the last ray */
    int raw, single;               /* all of them; doubles left out: the first [single] */
} lab;

static lab it;

/* ---- meshes ---------------------------------------------------------------------------------- */

typedef struct node {
    float p[3], f;
} node;

/* Six tets a cube, along the paths from its lowest to its highest corner; nodes: (side + 1)^3. */
static void kuhn(const node *nodes, int side) {
    static const int paths[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2},
                                    {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
    it.count = 0;
    for (int c = 0; c < side * side * side; c++)
        for (int k = 0; k < 6; k++) {
            int at[3] = {c % side, c / side % side, c / side / side};
            tet *x = &it.tets[it.count++];
            for (int v = 0; v < 4; v++) {
                /* Along a path ids ascend. */
                const node *n = &nodes[at[0] + (side + 1) * (at[1] + (side + 1) * at[2])];
                memcpy(x->p[v], n->p, sizeof n->p);
                x->f[v] = n->f;
                if (v < 3)
                    at[paths[k][v]]++;
            }
        }
}

/* ---- rays ------------------------------------------------------------------------------------ */

static int compare_hits(const void *a, const void *b) {
    return hit_less(a, b) ? -1 : hit_less(b, a);
}

static void choose(double iso) {
    it.iso = iso;
    for (int i = 0; i < it.count; i++)
        if (!isopolygon_of(&it.tets[i], iso, &it.polygons[i]))
            it.polygons[i].count = 0;
}

static void shoot(const ray *r) {
    it.raw = it.single = 0;
    for (int i = 0; i < it.count; i++) {
        hit after = hit_before_all(), h;
        while (it.polygons[i].count > 0 &&
               flat_polygon_hit(&it.polygons[i], r, (uint64_t)i, 0, &after, &h)) {
            assert_true(hit_less(&after, &h));
            assert_true(it.raw < HITS_MAX);
            it.hits[it.raw++] = after = h;
        }
    }
    qsort(it.hits, (size_t)it.raw, sizeof it.hits[0], compare_hits);
    for (int i = 0; i < it.raw; i++) {
        bool again = false;
        for (int j = it.single - 1; j >= 0 && it.hits[j].t == it.hits[i].t; j--)
            again |= flat_polygon_double(&it.hits[j], &it.hits[i]);
        if (!again)
            it.hits[it.single++] = it.hits[i];
    }
}

static ray ray_of(double ox, double oy, double oz, double dx, double dy, double dz) {
    return (ray){.o = {ox, oy, oz}, .d = {dx, dy, dz}, .t0 = 0.0, .t1 = INFINITY};
}

/* ---- surfaces that are crossed once ---------------------------------------------------------- */

enum { GRAPH = 4 };

/* f grows along z everywhere: a line along z crosses once, exactly. */
static void make_graph(bool shifted, double offset) {
    node nodes[(GRAPH + 1) * (GRAPH + 1) * (GRAPH + 1)];
    for (int i = 0; i < (GRAPH + 1) * (GRAPH + 1) * (GRAPH + 1); i++) {
        const int at[3] = {i % (GRAPH + 1), i / (GRAPH + 1) % (GRAPH + 1),
                           i / (GRAPH + 1) / (GRAPH + 1)};
        node *n = &nodes[i];
        for (int k = 0; k < 3; k++) {
            const bool inner = at[k] > 0 && at[k] < GRAPH;
            n->p[k] = (float)(offset + at[k] +
                              (shifted && inner ? field_random_in(&dice, -0.05, 0.05) : 0.0));
        }
        n->f = (float)(8 * at[2] + (shifted ? 0 : field_random_below(&dice, 7) - 3));
    }
    kuhn(nodes, GRAPH);
    double g[3];
    for (int i = 0; i < it.count; i++)
        assert_true(tet_gradient(&it.tets[i], g) && g[2] > 0.0);
}

/* Along z through (x, y), up and down. */
static int check_once(double x, double y, double offset) {
    const double lo = offset - 3.0, hi = offset + GRAPH + 3.0;
    for (int up = 0; up < 2; up++) {
        const ray r = ray_of(x, y, up ? lo : hi, 0, 0, up ? 1 : -1);
        shoot(&r);
        if (it.single != 1 || it.hits[0].entering != up)
            fail_msg(
                "ray at %.17g, %.17g, iso %g, offset %g (seed %d): %d hits, %d of them doubles", x,
                y, it.iso, offset, SEED, it.raw, it.raw - it.single);
    }
    return it.raw;
}

static void every_ray_crosses_once(void **test) {
    (void)test;
    const double isovalues[6] = {15, 16, 16.5, 17, 12, 20};
    const double offsets[3] = {0.0, 1000.0, -65536.0};
    int rays = 0, doubles = 0;
    dice.state = SEED;
    for (int round = 0; round < 12; round++) {
        const double offset = offsets[round % 3];
        make_graph(round % 2, offset);
        choose(isovalues[round / 2]);
        /* Through vertices, along edges and faces, and between. */
        for (int i = 0; i <= 16 * 16; i++, rays++)
            doubles += check_once(offset + 0.25 * (i % 17), offset + 0.25 * (i / 17.0), offset) > 1;
        for (int i = 0; i < 17 * 17; i++, rays++)
            doubles +=
                check_once(offset + 0.25 * (i % 17), offset + 0.25 * (int)(i / 17), offset) > 1;
        /* Through the corners of all isopolygons, and points on their edges. */
        for (int i = 0; i < it.count; i++) {
            const isopolygon *g = &it.polygons[i];
            for (int k = 0; k < g->count; k++, rays += 2) {
                const double *p = g->p[k], *q = g->p[(k + 1) % g->count];
                const int at = check_once(p[0], p[1], offset);
                doubles += at > 1;
                check_once(0.5 * p[0] + 0.5 * q[0], 0.5 * p[1] + 0.5 * q[1], offset);
            }
        }
    }
    print_message("%d rays, %d of them through edges or corners\n", rays, doubles);
    assert_true(doubles > rays / 4);
}

/* Exactly through vertices that lie at the isovalue, aslant: no sum there is without rounding, and
 * still all tets around agree. */
static void check_aslant(const float vertex[3]) {
    ray r = ray_of(0, 0, 0, 0, 0, 1);
    for (int k = 0; k < 2; k++)
        r.d[k] = 0x1p-20 * (double)(field_random_below(&dice, 1 << 17) - (1 << 16));
    for (int k = 0; k < 3; k++)
        r.o[k] = (double)vertex[k] - 5.0 * r.d[k]; /* exact */
    shoot(&r);
    if (it.single != 1 || it.raw < 3 || it.hits[0].t != 5.0)
        fail_msg("aslant through %a %a %a along %a %a (seed %d): %d hits, %d of them doubles",
                 (double)vertex[0], (double)vertex[1], (double)vertex[2], r.d[0], r.d[1], SEED,
                 it.raw, it.raw - it.single);
}

static void rays_aslant_through_vertices(void **test) {
    (void)test;
    const double offsets[3] = {0.0, 1000.0, -65536.0};
    int rays = 0;
    dice.state = SEED;
    for (int round = 0; round < 9; round++) {
        const double offset = offsets[round / 3];
        make_graph(true, offset);
        choose(8.0 * (1 + round % 3)); /* a layer of nodes */
        for (int i = 0; i < it.count; i++)
            for (int v = 0; v < 4; v++) {
                const float *p = it.tets[i].p[v];
                bool inner = (double)it.tets[i].f[v] == it.iso;
                for (int k = 0; k < 2; k++)
                    inner &= (double)p[k] > offset + 0.5 && (double)p[k] < offset + GRAPH - 0.5;
                for (int n = 0; inner && n < 4; n++, rays++)
                    check_aslant(p);
            }
    }
    assert_true(rays > 1000);
}

/* ---- closed surfaces of any shape ------------------------------------------------------------ */

/* Small whole numbers inside, all outside at the ends: closed surfaces, with plateaus. */
static void make_closed(int side, bool shifted) {
    node nodes[(SIDE_MAX + 1) * (SIDE_MAX + 1) * (SIDE_MAX + 1)];
    const int n = side + 1;
    for (int i = 0; i < n * n * n; i++) {
        const int at[3] = {i % n, i / n % n, i / n / n};
        bool inner = true;
        for (int k = 0; k < 3; k++)
            inner &= at[k] > 0 && at[k] < side;
        for (int k = 0; k < 3; k++)
            nodes[i].p[k] =
                (float)(at[k] + (shifted && inner ? field_random_in(&dice, -0.1, 0.1) : 0));
        nodes[i].f = inner ? (float)(field_random_below(&dice, 5) - 2) : -3.0f;
    }
    kuhn(nodes, side);
}

/* A ray in general position sees surfaces close: in, out, in, out. Sheets without thickness (faces
 * at the isovalue, less on both sides) do so at once, in any order. */
static void check_parity(const ray *r) {
    shoot(r);
    int within = 0;
    bool good = true;
    for (int i = 0; i < it.single; i++) {
        within += it.hits[i].entering ? 1 : -1;
        if (i + 1 == it.single || it.hits[i + 1].t - it.hits[i].t > 1e-9)
            good = good && (within == 0 || within == 1);
    }
    if (!good || within != 0)
        fail_msg("ray from %a %a %a along %a %a %a, iso %g (seed %d): %d hits that do not close",
                 r->o[0], r->o[1], r->o[2], r->d[0], r->d[1], r->d[2], it.iso, SEED, it.single);
}

/* Where rays beside it all hit, this one does, too, and no later than they. */
static bool check_no_gap(const ray *r) {
    enum { BESIDE = 8 };
    double latest = 0.0;
    bool all = true;
    for (int i = 0; i < BESIDE && all; i++) {
        ray beside = *r;
        for (int k = 0; k < 3; k++)
            beside.o[k] += field_random_in(&dice, -1e-9, 1e-9);
        check_parity(&beside);
        all = it.single > 0;
        if (all)
            latest = fmax(latest, it.hits[0].t);
    }
    if (!all)
        return false;
    shoot(r);
    if (it.single == 0 || it.hits[0].t > latest + 1e-6)
        fail_msg("ray from %a %a %a along %a %a %a, iso %g (seed %d): through a gap", r->o[0],
                 r->o[1], r->o[2], r->d[0], r->d[1], r->d[2], it.iso, SEED);
    return true;
}

/* Towards a lattice point, the middle of an edge, face or cube, often along an axis or diagonal. */
static ray lattice_ray(int side) {
    ray r = ray_of(0, 0, 0, 0, 0, 0);
    do
        for (int k = 0; k < 3; k++)
            r.d[k] = (double)(field_random_below(&dice, 5) - 2);
    while (r.d[0] == 0.0 && r.d[1] == 0.0 && r.d[2] == 0.0);
    for (int k = 0; k < 3; k++)
        r.o[k] = 0.5 * (double)field_random_below(&dice, 2 * side + 1) - 16.0 * r.d[k];
    return r;
}

static void closed_surfaces(void **test) {
    (void)test;
    const double isovalues[6] = {-2, -1, 0, 0.5, 1, 2};
    int sound = 0, rays = 0;
    dice.state = SEED;
    for (int round = 0; round < 36; round++) {
        const int side = 3 + round % 4;
        make_closed(side, round / 6 % 3 == 2);
        choose(isovalues[round % 6]);
        for (int i = 0; i < 60; i++, rays++) {
            const ray r = lattice_ray(side);
            sound += check_no_gap(&r);
        }
    }
    print_message("%d of %d rays where all beside them hit\n", sound, rays);
    assert_true(sound > rays / 5);
}

static void rays_at_random(void **test) {
    (void)test;
    int hits = 0;
    dice.state = SEED;
    for (int round = 0; round < 24; round++) {
        const int side = 3 + round % 4;
        make_closed(side, round % 2);
        choose(0.5 * (round % 5) - 1.0);
        for (int i = 0; i < 400; i++) {
            ray r = ray_of(-20, -20, -20, 0, 0, 0);
            for (int k = 0; k < 3; k++) {
                r.o[k] = field_random_in(&dice, -20, 20);
                r.d[k] = field_random_in(&dice, 0, side) - r.o[k];
            }
            r.t0 = -INFINITY;
            check_parity(&r);
            hits += it.single;
        }
    }
    assert_true(hits > 1000);
}

/* ---- fans, flat tets ------------------------------------------------------------------------- */

/* Tets around an edge from (0, 0, 0) to (0, 0, 1), at the angles of whole points, f = z or about
 * it: the surface is a fan around a point of the edge. */
static void fan_around_an_edge(void **test) {
    (void)test;
    static const int ring[8][2] = {{5, 0},  {3, 4},   {0, 5},  {-4, 3},
                                   {-5, 0}, {-3, -4}, {0, -5}, {4, -3}};
    dice.state = SEED;
    for (int round = 0; round < 200; round++) {
        const int n = 3 + round % 6;
        it.count = 0;
        double iso = round % 3 == 0 ? 0.5 : field_random_in(&dice, 0.4, 0.6);
        float low = 0.0f;
        if (round % 3 == 1) /* a vertex at the isovalue */
            iso = (double)(low = (float)iso);
        for (int i = 0; i < n; i++) {
            const int *a = ring[i * 8 / n], *b = ring[(i + 1) % n * 8 / n];
            const bool last =
                i == n - 1; /* ids: axis, then around: the last tet begins at point 0 */
            const int *first = last ? b : a, *second = last ? a : b;
            const float rise[2] = {(float)(first[0] % 3) * 0.1f, (float)(second[0] % 3) * 0.1f};
            it.tets[it.count++] = (tet){{{0, 0, 0},
                                         {0, 0, 1},
                                         {(float)first[0], (float)first[1], 0},
                                         {(float)second[0], (float)second[1], 0}},
                                        {low, 1, low + rise[0] - 0.3f, low + rise[1] - 0.3f}};
        }
        choose(iso);
        /* Along the edge, and through its point from all around. */
        const double z = (double)low < it.iso ? (it.iso - (double)low) / (1.0 - (double)low) : 0.0;
        const ray along = ray_of(0, 0, -1, 0, 0, 1);
        shoot(&along);
        assert_int_equal(it.single, 1);
        assert_int_equal(it.raw, n);
        assert_true(it.hits[0].entering);
        for (int i = 0; i < 8; i++) {
            const ray r = ray_of(-0.125 * ring[i][0], -0.125 * ring[i][1], z - 2,
                                 0.0625 * ring[i][0], 0.0625 * ring[i][1], 1);
            shoot(&r);
            assert_true(it.single >= 1);
        }
    }
}

/* A square whose diagonals differ above and below, so a flat tet between: without its polygon there
 * would be a gap. */
static void make_square(float up[3], float down[3]) {
    static const int ids[5][4] = {
        {0, 1, 2, 4}, {0, 2, 3, 4}, {0, 1, 3, 5}, {1, 2, 3, 5}, {0, 1, 2, 3}};
    static const float square[4][3] = {{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {0, 4, 0}};
    float p[6][3], f[6];
    for (int k = 0; k < 3; k++) {
        up[k] = k < 2 ? (float)field_random_in(&dice, 0.01, 3.99) : 3.0f;
        down[k] = k < 2 ? (float)field_random_in(&dice, 0.01, 3.99) : -3.0f;
    }
    memcpy(p, square, sizeof square);
    memcpy(p[4], up, sizeof p[4]);
    memcpy(p[5], down, sizeof p[5]);
    for (int v = 0; v < 6; v++)
        f[v] = (float)(v < 4 ? field_random_below(&dice, 5) - 2
                             : 2 * field_random_below(&dice, 2) - 1);
    it.count = 5;
    for (int i = 0; i < 5; i++)
        for (int v = 0; v < 4; v++) {
            memcpy(it.tets[i].p[v], p[ids[i][v]], sizeof p[0]);
            it.tets[i].f[v] = f[ids[i][v]];
        }
}

static void flat_tet_between(void **test) {
    (void)test;
    int through_flat = 0;
    dice.state = SEED;
    for (int round = 0; round < 20000; round++) {
        float up[3], down[3];
        make_square(up, down);
        choose(round % 2 ? 0.0 : 0.25);
        /* From apex to apex, whose sides are known. */
        ray r = ray_of(0, 0, 0, 0, 0, 0);
        for (int k = 0; k < 3; k++) {
            r.o[k] = (double)up[k];
            r.d[k] = (double)down[k] - r.o[k];
        }
        r.t0 = 1e-9;
        r.t1 = 1.0 - 1e-9;
        shoot(&r);
        const bool change =
            ((double)it.tets[0].f[3] >= it.iso) != ((double)it.tets[2].f[3] >= it.iso);
        /* With a face of the square at the isovalue two crossings of it may count as one. */
        if (it.iso != 0.0 ? it.single % 2 != change : change && it.single == 0)
            fail_msg("round %d (seed %d): %d hits", round, SEED, it.single);
        for (int i = 0; i < it.raw; i++)
            through_flat += it.hits[i].cell == 4;
    }
    print_message("%d rays through a flat tet's polygon\n", through_flat);
    assert_true(through_flat > 500);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_ray_crosses_once), cmocka_unit_test(rays_aslant_through_vertices),
        cmocka_unit_test(closed_surfaces),        cmocka_unit_test(rays_at_random),
        cmocka_unit_test(fan_around_an_edge),     cmocka_unit_test(flat_tet_between),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
