/* test_hex_shapes.c - rays and points in wedges, pyramids and tets as hexahedra that collapse,
 * mixed with hexahedra: nothing leaks or doubles where they meet; isosurfaces are where brute force
 * and barycentric coordinates say; values are those of each shape's own functions.
 */
/* marks: long */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "formats/curved/hex_point.h"
#include "render/curved/curved_meet.h"
#include "tests/support/cell_mix.h"
#include "tests/support/hex_truth.h"
#include "tests/support/watched.h"

enum { TURNS = 48, ENDS = 2 * PATH_PARTS * CELL_MIX_CELLS };

static cell_mix mix;

typedef struct face_end {
    double t, value;
    bool outside; /* on the mesh's boundary */
} face_end;

static bool same_end(const face_end *a, const face_end *b) {
    return memcmp(&a->t, &b->t, sizeof a->t) == 0 &&
           memcmp(&a->value, &b->value, sizeof a->value) == 0;
}

static int by_end(const void *a, const void *b) {
    const face_end *x = a, *y = b;
    return x->t != y->t ? (x->t > y->t) - (x->t < y->t)
                        : (x->value > y->value) - (x->value < y->value);
}

/* How far an end's parameters are from where the ray is there, and from the value. */
static double off_by(const hexahedron *h, const ray *r, const path_end *e) {
    double most = fabs(hexahedron_at(h->value, e->at) - e->value);
    for (int a = 0; a < 3; a++) {
        double p[HEX_CORNERS];
        for (int c = 0; c < HEX_CORNERS; c++)
            p[c] = h->p[c][a];
        most = fmax(most, fabs(hexahedron_at(p, e->at) - (r->o[a] + e->t * r->d[a])));
    }
    return most;
}

/* What ends at a face within the mesh begins behind it, with the same bits, wherever either cell
 * collapses. */
static void test_faces(void **state) {
    enum { RAYS = SLOW ? 30 : 600 };
    static face_end ends[ENDS];
    (void)state;
    for (int n = 0; n < hex_lab_count(); n++) {
        field_random random = {FIELD_SEED + (uint64_t)n};
        long pairs = 0;
        double off = 0.0;
        cell_mix_make(&mix, n, FIELD_SEED);
        for (int i = 0; i < RAYS; i++) {
            bool special;
            const ray r = hex_lab_ray(&mix.lab, &random, &special);
            const sheared_ray sheared = sheared_ray_of(r.o, r.d);
            size_t count = 0;
            for (int c = 0; c < mix.count; c++) {
                const int turn = (int)field_random_below(&random, TURNS);
                const hexahedron h = cell_mix_hexahedron(&mix.cell[c], turn);
                hex_path path;
                (void)hex_path_of(&h, hexahedron_sense(h.p), &sheared, &path);
                for (int k = 0; k < 2 * path.count; k++) {
                    const path_end *e = &path.part[k / 2].end[k % 2];
                    if (!special)
                        off = fmax(off, off_by(&h, &r, e));
                    ends[count++] =
                        (face_end){e->t, e->value, cell_mix_outside(&mix.cell[c], turn, e->at)};
                }
            }
            qsort(ends, count, sizeof *ends, by_end);
            long alone = 0;
            for (size_t k = 0, next; k < count; k = next) {
                bool outside = false;
                for (next = k; next < count && same_end(&ends[k], &ends[next]); next++)
                    outside = outside || ends[next].outside;
                alone += (next - k) % 2 == 1 && !outside;
                pairs += (long)((next - k) / 2);
            }
            assert_int_equal(alone, 0);
        }
        print_message("%-10s %ld pairs, their parameters wrong by %.1g\n", mix.lab.name, pairs,
                      off);
        assert_true(pairs > 2 * RAYS);
        assert_true(off < 1e-12);
    }
}

/* Where a ray meets the isosurface of a tet, whose value is linear in space. False: too close to a
 * face or to a ray along the surface to tell. */
static bool tet_truth(const cell_mix_cell *c, double iso, const ray *r, hex_truth *out) {
    long double e[3][3], o[3], d[3], lambda[2][4];
    for (int k = 0; k < 3; k++)
        for (int a = 0; a < 3; a++)
            e[k][a] = (long double)c->p[k + 1][a] - (long double)c->p[0][a];
    for (int a = 0; a < 3; a++) {
        o[a] = (long double)r->o[a] - (long double)c->p[0][a];
        d[a] = (long double)r->d[a];
    }
    const long double *x[2] = {o, d};
    for (int which = 0; which < 2; which++) {
        long double det = 0, sum = 0;
        for (int k = 0; k < 3; k++) {
            const long double *f = e[(k + 1) % 3], *g = e[(k + 2) % 3];
            long double own = 0;
            lambda[which][k + 1] = 0;
            for (int a = 0; a < 3; a++) {
                const int b = (a + 1) % 3, z = (a + 2) % 3;
                const long double across = f[b] * g[z] - f[z] * g[b];
                lambda[which][k + 1] += across * x[which][a];
                own += across * e[k][a];
            }
            det = own;
            lambda[which][k + 1] /= det;
            sum += lambda[which][k + 1];
        }
        lambda[which][0] = (which == 0 ? 1.0L : 0.0L) - sum;
        if (fabsl(det) < 1e-18L)
            return false;
    }
    long double value = 0, slope = 0, size = 0, least = 1;
    for (int k = 0; k < 4; k++) {
        value += lambda[0][k] * (long double)c->value[k];
        slope += lambda[1][k] * (long double)c->value[k];
        size += fabsl(lambda[1][k]);
    }
    if (fabsl(slope) <= 1e-7L * size)
        return false;
    const long double t = ((long double)iso - value) / slope;
    for (int k = 0; k < 4; k++)
        least = fminl(least, lambda[0][k] + t * lambda[1][k]);
    out->count = least > 0;
    out->t[0] = t;
    out->entering[0] = slope > 0;
    return fabsl(least) > 1e-8L;
}

static int by_t(const void *a, const void *b) {
    const path_root *x = a, *y = b;
    return (x->t > y->t) - (x->t < y->t);
}

typedef struct tally {
    long sure, roots, doubtful, missed, false_ones;
    double worst;
} tally;

static void compare(const cell_mix_cell *c, const hexahedron *h, int sense, const ray *r,
                    tally *out, path_counts *counts) {
    const sheared_ray sheared = sheared_ray_of(r->o, r->d);
    path_root found[PATH_ROOTS];
    hex_truth truth = {.count = 0};
    const curved_cell cell = {.quadratic = false, .hexahedron = *h, .sense = sense};
    const int count = curved_meet_roots(&cell, &sheared, mix.lab.iso, found, counts);
    if (c->shape == CELL_TET)
        truth.doubtful = !tet_truth(c, mix.lab.iso, r, &truth);
    else
        hex_truth_of(h->p, h->value, mix.lab.iso, r->o, r->d, &truth);
    if (truth.doubtful) {
        out->doubtful++;
        return;
    }
    out->sure++;
    out->roots += truth.count;
    out->missed += truth.count > count;
    out->false_ones += count > truth.count;
    qsort(found, (size_t)count, sizeof *found, by_t);
    for (int k = 0; k < count && count == truth.count; k++) {
        out->worst = fmax(out->worst, fabs(found[k].t - (double)truth.t[k]) / mix.lab.size);
        assert_int_equal(found[k].entering, truth.entering[k]);
    }
}

static void test_truth(void **state) {
    enum { RAYS = SLOW ? 30 : 400 };
    static const char *const names[CELL_SHAPES] = {"hexahedra", "wedges", "pyramids",
                                                   "",          "tets",   ""};
    (void)state;
    for (int n = 0; n < hex_lab_count(); n++) {
        field_random random = {FIELD_SEED + (uint64_t)n};
        tally of[CELL_SHAPES] = {{0}};
        path_counts counts = {0};
        cell_mix_make(&mix, n, FIELD_SEED + 1);
        for (int i = 0; i < RAYS; i++) {
            bool special;
            const ray r = hex_lab_ray(&mix.lab, &random, &special);
            const sheared_ray sheared = sheared_ray_of(r.o, r.d);
            for (int c = 0; c < mix.count && !special; c++) {
                const hexahedron h = cell_mix_hexahedron(&mix.cell[c], (i + c) % TURNS);
                const int sense = hexahedron_sense(h.p);
                hex_path path;
                /* The truth takes long to say that there is nothing. */
                if (sense != 0 && (hex_path_of(&h, sense, &sheared, &path) > 0 || i % 16 == 0))
                    compare(&mix.cell[c], &h, sense, &r, &of[mix.cell[c].shape], &counts);
            }
        }
        for (int k = 0; k < CELL_SHAPES; k++) {
            if (!names[k][0])
                continue;
            print_message("%-10s %-9s %5ld rays in cells, %4ld roots, %3ld doubtful; %ld missed, "
                          "%ld false; t "
                          "wrong by %.1g of the mesh\n",
                          mix.lab.name, names[k], of[k].sure, of[k].roots, of[k].doubtful,
                          of[k].missed, of[k].false_ones, of[k].worst);
        }
        print_message("%.2f stretches a part, %ld not proven\n",
                      (double)counts.stretches / (double)counts.paths, (long)counts.doubtful);
        for (int k = 0; k < CELL_SHAPES; k++) {
            assert_int_equal(of[k].missed, 0);
            assert_int_equal(of[k].false_ones, 0);
            assert_true(of[k].worst < 1e-12);
            assert_true(!names[k][0] || of[k].sure > 50);
            assert_true(of[k].doubtful * 50 <= of[k].sure);
        }
    }
}

/* The shape functions of its vertices at parameters in [0, 1]^3: no hexahedron. */
static void shares_of(cell_shape shape, const double u[3], long double share[HEX_CORNERS]) {
    const long double r = (long double)u[0], s = (long double)u[1], t = (long double)u[2];
    long double sum = 0;
    switch (shape) {
    case CELL_TET:
        share[1] = r;
        share[2] = s * (1 - r);
        share[3] = t * (1 - r) * (1 - s);
        share[0] = 1 - share[1] - share[2] - share[3];
        return;
    case CELL_WEDGE:
        for (int k = 0; k < 2; k++) {
            const long double end = k == 0 ? 1 - t : t;
            share[3 * k + 1] = r * end;
            share[3 * k + 2] = s * (1 - r) * end;
            share[3 * k] = end - share[3 * k + 1] - share[3 * k + 2];
        }
        return;
    case CELL_PYRAMID:
    case CELL_HEXAHEDRON:
        for (int k = 0; k < 4; k++) {
            share[k] = (k == 1 || k == 2 ? r : 1 - r) * (k >= 2 ? s : 1 - s);
            share[k + 4] = share[k] * t;
            share[k] *= 1 - t;
            sum += share[k + 4];
        }
        if (shape == CELL_PYRAMID)
            share[4] = sum;
        return;
    default: fail_msg("no shape functions of %d", (int)shape);
    }
}

/* A point in a cell is found there, with the value of the shape's own functions. */
static void test_values(void **state) {
    enum { POINTS = SLOW ? 6 : 20 };
    (void)state;
    for (int n = 0; n < hex_lab_count(); n++) {
        field_random random = {FIELD_SEED + (uint64_t)n};
        long found[CELL_SHAPES] = {0}, tried[CELL_SHAPES] = {0};
        double worst = 0.0;
        cell_mix_make(&mix, n, FIELD_SEED + 2);
        for (int i = 0; i < POINTS * mix.count; i++) {
            const cell_mix_cell *c = &mix.cell[i % mix.count];
            const hexahedron h = cell_mix_hexahedron(c, (int)field_random_below(&random, TURNS));
            const int sense = hexahedron_sense(h.p);
            long double share[HEX_CORNERS], p[3] = {0, 0, 0}, want = 0;
            double u[3], point[3], at[3], value;
            for (int a = 0; a < 3; a++)
                u[a] = field_random_in(&random, 0.05, 0.95);
            shares_of(c->shape, u, share);
            for (int k = 0; k < cell_shape_vertices(c->shape); k++) {
                want += share[k] * (long double)c->value[k];
                for (int a = 0; a < 3; a++)
                    p[a] += share[k] * (long double)c->p[k][a];
            }
            for (int a = 0; a < 3; a++)
                point[a] = (double)p[a];
            if (sense == 0)
                continue;
            tried[c->shape]++;
            if (!hex_point_find(&h, sense, point, at, &value))
                continue;
            found[c->shape]++;
            worst = fmax(worst, fabs(value - (double)want));
        }
        print_message("%-10s values wrong by %.1g\n", mix.lab.name, worst);
        for (int k = 0; k < CELL_SHAPES; k++)
            assert_int_equal(found[k], tried[k]);
        assert_true(tried[CELL_TET] > 50 && tried[CELL_WEDGE] > 50 && tried[CELL_PYRAMID] > 50);
        assert_true(worst < 1e-7); /* the thinnest cells of "pie": 8e-9 */
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_faces), cmocka_unit_test(test_truth),
                                       cmocka_unit_test(test_values)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
