/* test_quadratic_tets.c - rays and points in quadratic tets: isosurfaces and pieces against brute
 * force in long double; that nothing leaks or doubles at faces; which tets are folded.
 */
/* marks: long */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "formats/base/vec3.h"
#include "formats/curved/bent_triangle.h"
#include "formats/curved/quadratic_path.h"
#include "render/curved/curved_meet.h"
#include "render/curved/path_pieces.h"
#include "tests/support/quadratic_lab.h"
#include "tests/support/quadratic_truth.h"
#include "tests/support/watched.h"

enum { CELLS = QUADRATIC_LAB_CELLS, ENDS = 2 * PATH_PARTS * CELLS };

static int by_t(const void *a, const void *b) {
    const path_root *x = a, *y = b;
    return (x->t > y->t) - (x->t < y->t);
}

typedef struct tally {
    long sure, roots, several, doubtful, missed, false_ones, folded;
    double worst;
    path_counts counts;
} tally;

static void compare(const quadratic_lab *s, const quadratic_tet *c, const ray *r, bool look_closely,
                    tally *sum) {
    const sheared_ray sheared = sheared_ray_of(r->o, r->d);
    const int sense = quadratic_sense(c);
    quadratic_path path;
    path_root found[PATH_ROOTS];
    quadratic_truth truth;
    (void)quadratic_path_of(c, sense, &sheared, &path);
    sum->folded += sense == 0 && path.count > 0;
    /* The truth takes long to say that there is nothing. */
    if (sense == 0 || (path.count == 0 && !look_closely))
        return;
    assert_int_equal(sense, s->left ? -1 : 1);
    const int count = path.count == 0 ? 0
                                      : path_roots(&path.map, path.part, path.count, false, s->iso,
                                                   found, &sum->counts);
    quadratic_truth_of(c, quadratic_straight_edges(c), s->iso, r->o, r->d, &truth);
    if (truth.doubtful) {
        sum->doubtful++;
        return;
    }
    const curved_cell cell = {.quadratic = true, .tet = *c, .sense = sense};
    path_root quick[PATH_ROOTS];
    assert_int_equal(curved_meet_roots(&cell, &sheared, s->iso, quick, NULL), count);
    for (int k = 0; k < count; k++)
        assert_true(fabs(quick[k].t - found[k].t) <= 1e-13 * s->size);
    sum->sure++;
    sum->roots += truth.count;
    sum->several += truth.count > 1;
    sum->missed += truth.count > count;
    sum->false_ones += count > truth.count;
    qsort(found, (size_t)count, sizeof *found, by_t);
    for (int k = 0; k < count && count == truth.count; k++) {
        sum->worst = fmax(sum->worst, fabs(found[k].t - (double)truth.t[k]) / s->size);
        assert_int_equal(found[k].entering, truth.entering[k]);
    }
}

/* Cell by cell, what the truth is sure of is found, where it is, and nothing else. */
static void test_truth(void **state) {
    enum { RAYS = SLOW ? 200 : 600 };
    (void)state;
    for (int n = 0; n < quadratic_lab_count(); n++) {
        quadratic_lab s;
        field_random random = {FIELD_SEED + (uint64_t)n};
        tally sum = {0};
        quadratic_lab_make(&s, n, FIELD_SEED);
        for (int i = 0; i < RAYS; i++) {
            bool special;
            const ray r = quadratic_lab_ray(&s, &random, &special);
            for (int c = 0; c < CELLS && !special; c++) {
                const quadratic_tet t = quadratic_lab_cell(&s, c, NULL);
                compare(&s, &t, &r, i % 16 == 0, &sum);
            }
        }
        print_message(
            "%-10s %5ld cells, %4ld roots (%3ld cells with several), %2ld doubtful, %3ld "
            "folded; t wrong by %.1g of the mesh; %.2f stretches a part, %ld not proven\n",
            s.name, sum.sure, sum.roots, sum.several, sum.doubtful, sum.folded, sum.worst,
            (double)sum.counts.stretches / (double)sum.counts.paths, (long)sum.counts.doubtful);
        assert_int_equal(sum.missed, 0);
        assert_int_equal(sum.false_ones, 0);
        assert_true(sum.worst < 1e-13);
        assert_true(sum.roots > 100 && (SLOW || sum.several > 0));
        assert_true(sum.doubtful * 100 < sum.sure);
        assert_true(s.may_be_folded || sum.folded == 0);
        assert_true(sum.counts.stretches < 20 * sum.counts.paths);
    }
}

typedef struct face_end {
    double t, value;
} face_end;

static int by_end(const void *a, const void *b) {
    return memcmp(a, b, sizeof(face_end));
}

/* Whether a point of a cell is on the boundary of the mesh: all nodes of a face it lies on are. */
static bool at_boundary(const int nodes[QUADRATIC_NODES][3], const double at[3]) {
    const double share[QUADRATIC_CORNERS] = {0.0, at[0], at[1], at[2]};
    for (int a = 0; a < 3; a++)
        for (int side = 0; side < 2; side++) {
            bool out = true;
            for (int n = 0; n < QUADRATIC_CORNERS; n++) {
                const double own = n ? share[n] : 1.0 - at[0] - at[1] - at[2];
                if (own > 1e-13 && nodes[n][a] != side * (QUADRATIC_LAB_NODES - 1))
                    out = false;
            }
            if (out)
                return true;
        }
    return false;
}

/* What ends at a face within the mesh begins behind it, with the same bits: also where rays go
 * exactly through nodes and along edges, and in folded cells. */
static void test_faces(void **state) {
    enum { RAYS = SLOW ? 100 : 1000 };
    static face_end ends[ENDS];
    (void)state;
    for (int n = 0; n < quadratic_lab_count(); n++) {
        quadratic_lab s;
        field_random random = {FIELD_SEED + (uint64_t)n};
        long special = 0, pairs = 0, alone = 0;
        quadratic_lab_make(&s, n, FIELD_SEED + 1);
        for (int i = 0; i < RAYS; i++) {
            bool is_special;
            const ray r = quadratic_lab_ray(&s, &random, &is_special);
            special += is_special;
            const sheared_ray sheared = sheared_ray_of(r.o, r.d);
            size_t count = 0, k = 0;
            for (int c = 0; c < CELLS; c++) {
                int nodes[QUADRATIC_NODES][3];
                const quadratic_tet t = quadratic_lab_cell(&s, c, nodes);
                quadratic_path path;
                (void)quadratic_path_of(&t, quadratic_sense(&t), &sheared, &path);
                for (int e = 0; e < 2 * path.count; e++) {
                    const path_end *end = &path.part[e / 2].end[e % 2];
                    if (!at_boundary((const int(*)[3])nodes, end->at))
                        ends[count++] = (face_end){end->t, end->value};
                }
            }
            qsort(ends, count, sizeof *ends, by_end);
            while (k < count) {
                const bool pair = k + 1 < count && by_end(&ends[k], &ends[k + 1]) == 0;
                alone += !pair;
                pairs += pair;
                k += pair ? 2 : 1;
            }
        }
        print_message("%-10s %ld ends met in pairs, %ld alone; %ld special rays\n", s.name, pairs,
                      alone, special);
        assert_int_equal(alone, 0);
        assert_true(special > RAYS / 20);
        assert_true(pairs > 2 * RAYS);
    }
}

/* Bernstein's form of a cubic at a share of its length. */
static double cubic_at(const double b[4], double x) {
    const double y = 1.0 - x;
    return y * y * y * b[0] + 3.0 * x * y * y * b[1] + 3.0 * x * x * y * b[2] + x * x * x * b[3];
}

/* The true values along a piece are within its error. */
static void piece_holds(const quadratic_tet *c, const ray *r, const path_end end[2],
                        const path_piece *piece, double tolerance, double *closest) {
    enum { SAMPLES = 7 };
    long double at[3];
    for (int a = 0; a < 3; a++) {
        const double share = (piece->t[0] - end[0].t) / (end[1].t - end[0].t);
        at[a] = end[0].at[a] + share * (end[1].at[a] - end[0].at[a]);
    }
    for (int n = 1; n < SAMPLES; n++) {
        const double x = (double)n / SAMPLES;
        const double now = piece->t[0] + x * (piece->t[1] - piece->t[0]);
        long double truth;
        if (!quadratic_truth_value(c, quadratic_straight_edges(c), r->o, r->d, now, at, &truth))
            continue;
        const double off = fabs(cubic_at(piece->b, x) - (double)truth);
        assert_true(off <= piece->error + 1e-12 * (1.0 + 1.0 / (end[1].t - end[0].t)));
        if (piece->error <= tolerance)
            *closest = fmax(*closest, off / tolerance);
    }
}

/* Pieces cover their part, end to end. */
static void pieces_hold(const quadratic_tet *c, const ray *r, double tolerance, long *parts,
                        long *pieces, path_counts *counts, double *closest) {
    const sheared_ray sheared = sheared_ray_of(r->o, r->d);
    const int sense = quadratic_sense(c);
    quadratic_path path;
    path_piece piece[PATH_PIECES];
    double range[2];
    quadratic_range(c->value, range);
    (void)quadratic_path_of(c, sense, &sheared, &path);
    const int count =
        path_pieces(&path.map, path.part, path.count, sense == 0, range, tolerance, piece, counts);
    int k = 0;
    *parts += path.count;
    *pieces += count;
    for (int i = 0; i < path.count; i++) {
        const path_end *end = path.part[i].end;
        double t = end[0].t, value = end[0].value;
        if (!(end[0].t < end[1].t))
            continue;
        for (; t < end[1].t; k++) {
            assert_true(k < count);
            assert_true(piece[k].t[0] == t && piece[k].b[0] == value);
            t = piece[k].t[1];
            value = piece[k].b[3];
            if (sense != 0)
                piece_holds(c, r, end, &piece[k], tolerance, closest);
        }
        assert_true(t == end[1].t && value == end[1].value);
    }
    assert_int_equal(k, count);
}

static void test_pieces(void **state) {
    enum { RAYS = SLOW ? 20 : 100 };
    static const double tolerances[] = {1e-3, 1e-6, 1e-9};
    (void)state;
    for (int n = 0; n < quadratic_lab_count(); n++)
        for (size_t i = 0; i < sizeof tolerances / sizeof *tolerances; i++) {
            quadratic_lab s;
            field_random random = {FIELD_SEED + (uint64_t)n};
            path_counts counts = {0};
            long parts = 0, pieces = 0;
            double closest = 0.0;
            quadratic_lab_make(&s, n, FIELD_SEED + 3);
            for (int k = 0; k < RAYS; k++) {
                bool special;
                const ray r = quadratic_lab_ray(&s, &random, &special);
                for (int c = 0; c < CELLS && !special; c++) {
                    const quadratic_tet t = quadratic_lab_cell(&s, c, NULL);
                    pieces_hold(&t, &r, tolerances[i], &parts, &pieces, &counts, &closest);
                }
            }
            /* Bounds are no more than some times the error; in straight tets values are quadratic.
             */
            print_message("%-10s %g: %ld parts, %ld pieces, %.3f of the error, %ld not proven\n",
                          s.name, tolerances[i], parts, pieces, closest, (long)counts.doubtful);
            assert_true(parts > 50);
            assert_true(closest < 0.75 && (closest > 0.1 || s.straight || SLOW));
            assert_true(pieces < (i < 2 ? 12 : 64) * parts && (!s.straight || pieces == parts));
            assert_true(i == 2 || counts.doubtful * 10 < (uint64_t)parts);
        }
}

/* The gradient is what differences of the truth say. */
static long gradient_holds(const quadratic_lab *s, const quadratic_tet *c, const double at[3],
                           const double point[3]) {
    const unsigned straight = quadratic_straight_edges(c);
    const double step = 1e-9 * s->size;
    double gradient[3];
    long held = 0;
    if (!quadratic_point_gradient(c, at, gradient))
        return 0;
    for (int a = 0; a < 3; a++) {
        double d[3] = {0.0, 0.0, 0.0};
        long double less, more, near[3] = {at[0], at[1], at[2]};
        d[a] = 1.0;
        if (!quadratic_truth_value(c, straight, point, d, -step, near, &less) ||
            !quadratic_truth_value(c, straight, point, d, step, near, &more))
            continue;
        const double slope = (double)(more - less) / (2.0 * step);
        const double size = fabs(gradient[0]) + fabs(gradient[1]) + fabs(gradient[2]);
        assert_true(fabs(gradient[a] - slope) <= 1e-3 * (1.0 + size));
        held++;
    }
    return held;
}

/* A point inside is in a cell, and the value there is the true one. On faces, edges and nodes, too.
 */
static void test_points(void **state) {
    enum { POINTS = SLOW ? 100 : 400 };
    (void)state;
    for (int n = 0; n < quadratic_lab_count(); n++) {
        quadratic_lab s;
        field_random random = {FIELD_SEED + (uint64_t)n};
        long gradients = 0, several = 0;
        quadratic_lab_make(&s, n, FIELD_SEED + 4);
        for (int i = 0; i < POINTS; i++) {
            int nodes[QUADRATIC_NODES][3], holders = 0;
            double u[3], point[3], there;
            const quadratic_tet in = quadratic_lab_cell(
                &s, (int)field_random_below(&random, QUADRATIC_LAB_CELLS), nodes);
            const bool special = i % 4 == 0;
            u[0] = special ? 0.5 * (double)field_random_below(&random, 2)
                           : 0.9 * field_random_unit(&random);
            u[1] = special ? 0.5 * (double)field_random_below(&random, 2)
                           : (0.95 - u[0]) * field_random_unit(&random);
            u[2] = special ? 0.0 : (0.99 - u[0] - u[1]) * field_random_unit(&random);
            quadratic_lab_at(&in, u, point, &there);
            for (int c = 0; c < CELLS; c++) {
                const quadratic_tet t = quadratic_lab_cell(&s, c, NULL);
                const int sense = quadratic_sense(&t);
                double at[3], value;
                if (!quadratic_point_find(&t, sense, point, at, &value))
                    continue;
                holders++;
                const double none[3] = {0.0, 0.0, 0.0};
                long double near[3] = {at[0], at[1], at[2]}, truth;
                if (sense == 0 || !quadratic_truth_value(&t, quadratic_straight_edges(&t), point,
                                                         none, 0.0, near, &truth))
                    continue;
                assert_true(fabs(value - (double)truth) < 1e-8);
                gradients += special ? 0 : gradient_holds(&s, &t, at, point);
            }
            /* A folded cell at the boundary may reach beyond it. */
            if (quadratic_sense(&in) != 0)
                assert_true(holders >= !at_boundary((const int(*)[3])nodes, u));
            several += holders > 1;
            assert_true(holders < 2 || special || s.may_be_folded);
        }
        assert_true(several < POINTS / 20 || s.may_be_folded);
        assert_true(gradients > POINTS);
    }
}

/* The nodes of a tet in another order of its corners: the same crossings, to the bit. */
static void test_orders(void **state) {
    enum { RAYS = SLOW ? 40 : 200 };
    (void)state;
    for (int n = 0; n < quadratic_lab_count(); n++) {
        quadratic_lab s;
        field_random random = {FIELD_SEED + (uint64_t)n};
        long met = 0;
        quadratic_lab_make(&s, n, FIELD_SEED + 5);
        for (int i = 0; i < RAYS; i++) {
            bool special;
            const ray r = quadratic_lab_ray(&s, &random, &special);
            const sheared_ray sheared = sheared_ray_of(r.o, r.d);
            const quadratic_tet t =
                quadratic_lab_cell(&s, (int)field_random_below(&random, CELLS), NULL);
            quadratic_tet turned;
            int to[QUADRATIC_CORNERS] = {0, 1, 2, 3};
            bool odd = false;
            for (int k = 3; k > 0; k--) {
                const int other = (int)field_random_below(&random, (uint32_t)k + 1), kept = to[k];
                to[k] = to[other];
                to[other] = kept;
                odd ^= other != k;
            }
            for (int k = 0; k < QUADRATIC_NODES; k++) {
                int from = k < QUADRATIC_CORNERS ? to[k] : -1;
                for (int e = 0; e < QUADRATIC_EDGES && k >= QUADRATIC_CORNERS; e++) {
                    const int *mine = quadratic_edge(k - QUADRATIC_CORNERS),
                              *its = quadratic_edge(e);
                    if ((its[0] == to[mine[0]] && its[1] == to[mine[1]]) ||
                        (its[1] == to[mine[0]] && its[0] == to[mine[1]]))
                        from = QUADRATIC_CORNERS + e;
                }
                memcpy(turned.p[k], t.p[from], sizeof t.p[from]);
                turned.value[k] = t.value[from];
            }
            const int sense = quadratic_sense(&t);
            quadratic_path a, b;
            assert_int_equal(quadratic_sense(&turned), odd ? -sense : sense);
            assert_int_equal(quadratic_path_of(&t, sense, &sheared, &a),
                             quadratic_path_of(&turned, odd ? -sense : sense, &sheared, &b));
            for (int k = 0; k < 2 * a.count; k++) {
                const path_end *x = &a.part[k / 2].end[k % 2], *y = &b.part[k / 2].end[k % 2];
                if (sense != 0)
                    assert_true(x->t == y->t && x->value == y->value);
            }
            met += a.count > 0;
        }
        assert_true(met > 3 || SLOW);
    }
}

/* The least determinant of the Jacobian on a lattice of points. */
static double least_det(const quadratic_tet *t) {
    enum { STEPS = 14 };
    double form[3][QUADRATIC_NODES], least = INFINITY;
    for (int a = 0; a < 3; a++) {
        double v[QUADRATIC_NODES];
        for (int n = 0; n < QUADRATIC_NODES; n++)
            v[n] = t->p[n][a];
        quadratic_form(v, quadratic_straight_edges(t), form[a]);
    }
    for (int i = 0; i <= STEPS; i++)
        for (int j = 0; i + j <= STEPS; j++)
            for (int k = 0; i + j + k <= STEPS; k++) {
                const double at[3] = {(double)i / STEPS, (double)j / STEPS, (double)k / STEPS};
                double slope[3][3];
                for (int a = 0; a < 3; a++)
                    quadratic_slope(form[a], at, slope[a]);
                least = fmin(least, vec3_det(slope[0], slope[1], slope[2]));
            }
    return least;
}

/* Bent by chance: what is clearly sound has a sense, though coefficients alone would not tell of
 * all; what is folded anywhere has none. */
static void test_bent_senses(void **state) {
    enum { TETS = SLOW ? 500 : 5000 };
    static const double corner[QUADRATIC_CORNERS][3] = {
        {0.0, 0.0, 0.0}, {1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}};
    field_random random = {FIELD_SEED};
    int sound = 0, folded = 0;
    (void)state;
    for (int i = 0; i < TETS; i++) {
        quadratic_tet t;
        const double most = 0.3 * field_random_unit(&random);
        memset(&t, 0, sizeof t);
        for (int n = 0; n < QUADRATIC_NODES; n++)
            for (int a = 0; a < 3; a++) {
                const int *edge =
                    n < QUADRATIC_CORNERS ? NULL : quadratic_edge(n - QUADRATIC_CORNERS);
                t.p[n][a] = edge ? 0.5 * (corner[edge[0]][a] + corner[edge[1]][a]) : corner[n][a];
                t.p[n][a] += field_random_in(&random, -most, most);
            }
        const double least = least_det(&t);
        if (least > 0.05)
            assert_int_equal(quadratic_sense(&t), 1);
        if (least < 0.0)
            assert_int_equal(quadratic_sense(&t), 0);
        sound += least > 0.05;
        folded += least < 0.0;
    }
    assert_true(sound > TETS / 5 && folded > TETS / 5);
}

static void test_sense(void **state) {
    quadratic_tet t = {.p = {{0.0}, {1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}}};
    (void)state;
    for (int e = 0; e < QUADRATIC_EDGES; e++)
        for (int a = 0; a < 3; a++)
            t.p[4 + e][a] = 0.5 * (t.p[quadratic_edge(e)[0]][a] + t.p[quadratic_edge(e)[1]][a]);
    assert_int_equal(quadratic_straight_edges(&t), 63);
    assert_int_equal(quadratic_sense(&t), 1);
    /* Along the edge 01 the map is 4 x s (1 - s) + s^2: it rises where x is from 1/4 to 3/4. */
    static const struct {
        double x;
        int sense;
    } trials[] = {{0.24, 0}, {0.26, 1}, {0.74, 1}, {0.76, 0}};
    for (size_t i = 0; i < sizeof trials / sizeof *trials; i++) {
        quadratic_tet u = t;
        u.p[4][0] = trials[i].x;
        assert_int_equal(quadratic_sense(&u), trials[i].sense);
        for (int n = 0; n < QUADRATIC_NODES; n++)
            u.p[n][2] *= -1.0;
        assert_int_equal(quadratic_sense(&u), -trials[i].sense);
    }
    /* Flat, and without size. */
    quadratic_tet flat = t;
    for (int n = 0; n < QUADRATIC_NODES; n++)
        flat.p[n][2] = 0.0;
    assert_int_equal(quadratic_sense(&flat), 0);
    memset(flat.p, 0, sizeof flat.p);
    assert_int_equal(quadratic_sense(&flat), 0);
    /* Roundings to floats are no bends. */
    t.p[4][0] += 0x1p-24;
    assert_int_equal(quadratic_straight_edges(&t), 63);
    t.p[4][0] += 0x1p-19;
    assert_int_equal(quadratic_straight_edges(&t), 62);
}

/* A parabola folded over itself, as the ray sees it: two crossings or none, and four. */
static void test_folds(void **state) {
    bent_crossing out[BENT_CROSSINGS];
    (void)state;
    /* x = u, y = v (1 - 2 v) about: coefficients of y are 0 but for the edges to corner 2. */
    for (int side = 0; side < 2; side++) {
        bent_triangle b = {
            .q = {{-1.0, -0.1}, {1.0, -0.1}, {0.0, -0.1}, {0.0, -0.1}, {0.5, 0.4}, {-0.5, 0.4}}};
        for (int i = 0; i < BENT_NODES; i++)
            b.q[i][1] -= side ? 0.2 : 0.0; /* the fold's top is at 0.15 */
        const int count = bent_triangle_cross(&b, out);
        assert_int_equal(count, side ? 0 : 2);
        if (count == 2) {
            assert_int_equal(out[0].sense + out[1].sense, 0);
            for (int k = 0; k < 2; k++) {
                double y[BENT_NODES];
                for (int i = 0; i < BENT_NODES; i++)
                    y[i] = b.q[i][1];
                assert_true(fabs(bent_triangle_at(y, out[k].share)) < 1e-14);
            }
        }
    }
    /* x^2 + y^2-like in both: four crossings. u^2 = 1/16, v^2 = 1/16 about the middle. */
    bent_triangle b = {0};
    const double c = 0.3, e = 0.01; /* (u - c)^2 - e, (v - c)^2 - e */
    for (int k = 0; k < 2; k++) {
        b.q[0][k] = c * c - e;
        b.q[1 + k][k] = (1.0 - c) * (1.0 - c) - e;
        b.q[2 - k][k] = c * c - e;
        b.q[k ? 5 : 3][k] = c * c - c - e;
        b.q[k ? 3 : 5][k] = c * c - e;
        b.q[4][k] = c * c - c - e;
    }
    assert_int_equal(bent_triangle_cross(&b, out), 4);
    int sum = 0;
    for (int i = 0; i < 4; i++) {
        sum += out[i].sense;
        assert_true(fabs(fabs(out[i].share[1] - c) - 0.1) < 1e-14);
        assert_true(fabs(fabs(out[i].share[2] - c) - 0.1) < 1e-14);
    }
    assert_int_equal(sum, 0);
}

/* A face that nearly folds takes many parts to tell its two crossings apart, in some orders of its
 * corners more than in others. */
static void test_strong_bends(void **state) {
    static const double face[BENT_NODES][2] = {{0.0240621, 0.9277928},   {0.0916096, -0.0363157},
                                               {-0.6644740, -0.8394143}, {-0.5824726, 0.3119199},
                                               {0.3086345, -0.3156304},  {0.4858730, 0.2721946}};
    static const int orders[][BENT_CORNERS] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1},
                                               {0, 2, 1}, {2, 1, 0}, {1, 0, 2}};
    (void)state;
    for (size_t n = 0; n < sizeof orders / sizeof *orders; n++) {
        bent_triangle b = {0};
        bent_crossing out[BENT_CROSSINGS];
        for (int k = 0; k < BENT_CORNERS; k++) {
            const int from = orders[n][k > 1 ? 0 : k], to = orders[n][k > 1 ? 2 : k + 1];
            const int edge = from + to == 1 ? 3 : from + to == 3 ? 4 : 5;
            memcpy(b.q[k], face[orders[n][k]], sizeof face[0]);
            memcpy(b.q[BENT_CORNERS + k], face[edge], sizeof face[0]);
        }
        assert_int_equal(bent_triangle_cross(&b, out), 2);
        assert_int_equal(out[0].sense + out[1].sense, 0);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_truth),        cmocka_unit_test(test_faces),
        cmocka_unit_test(test_pieces),       cmocka_unit_test(test_points),
        cmocka_unit_test(test_orders),       cmocka_unit_test(test_sense),
        cmocka_unit_test(test_bent_senses),  cmocka_unit_test(test_folds),
        cmocka_unit_test(test_strong_bends),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
