/* test_path_roots.c - rays and points in trilinear cells: isosurfaces and pieces against brute
 * force in long double; that nothing leaks or doubles at faces; that bounds hold; which cells are
 * folded.
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
#include "formats/curved/patch.h"
#include "formats/curved/path_stretch.h"
#include "render/curved/hex_pieces.h"
#include "render/curved/hex_roots.h"
#include "tests/support/hex_lab.h"
#include "tests/support/hex_truth.h"
#include "tests/support/watched.h"

enum { CELLS = HEX_LAB_CELLS * HEX_LAB_CELLS * HEX_LAB_CELLS, ENDS = 2 * PATH_PARTS * CELLS };

static void place_of(int c, int at[3]) {
    at[0] = c % HEX_LAB_CELLS;
    at[1] = c / HEX_LAB_CELLS % HEX_LAB_CELLS;
    at[2] = c / (HEX_LAB_CELLS * HEX_LAB_CELLS);
}

static hexahedron cell_of(const hex_lab *s, int c) {
    int at[3];
    place_of(c, at);
    return hex_lab_cell(s, at);
}

static int by_t(const void *a, const void *b) {
    const path_root *x = a, *y = b;
    return (x->t > y->t) - (x->t < y->t);
}

/* Cell by cell, what the truth is sure of is found, where it is, and nothing else. */
static void test_truth(void **state) {
    enum { RAYS = SLOW ? 200 : 400 };
    (void)state;
    for (int n = 0; n < hex_lab_count(); n++) {
        hex_lab s;
        field_random random = {FIELD_SEED + (uint64_t)n};
        path_counts counts = {0};
        long sure = 0, roots = 0, several = 0, doubtful = 0, missed = 0, false_ones = 0, folded = 0;
        double worst = 0.0;
        hex_lab_make(&s, n, FIELD_SEED);
        for (int i = 0; i < RAYS; i++) {
            bool special;
            const ray r = hex_lab_ray(&s, &random, &special);
            if (special)
                continue;
            const sheared_ray sheared = sheared_ray_of(r.o, r.d);
            for (int c = 0; c < CELLS; c++) {
                const hexahedron h = cell_of(&s, c);
                const int sense = hexahedron_sense(h.p);
                hex_path path;
                path_root found[PATH_ROOTS];
                hex_truth truth;
                (void)hex_path_of(&h, sense, &sheared, &path);
                folded += sense == 0 && path.count > 0;
                /* The truth takes long to say that there is nothing. */
                if (sense == 0 || (path.count == 0 && i % 16 != 0))
                    continue;
                const int count = hex_roots(&h, sense, &path, s.iso, found, &counts);
                hex_truth_of(h.p, h.value, s.iso, r.o, r.d, &truth);
                if (truth.doubtful) {
                    doubtful++;
                    continue;
                }
                sure++;
                roots += truth.count;
                several += truth.count > 1;
                missed += truth.count > count;
                false_ones += count > truth.count;
                qsort(found, (size_t)count, sizeof *found, by_t);
                for (int k = 0; k < count && count == truth.count; k++) {
                    worst = fmax(worst, fabs(found[k].t - (double)truth.t[k]) / s.size);
                    assert_int_equal(found[k].entering, truth.entering[k]);
                }
            }
        }
        print_message(
            "%-10s %5ld cells, %4ld roots (%3ld cells with several), %2ld doubtful, %3ld folded; "
            "t wrong by %.1g of the grid; %.2f stretches a part, %ld not proven\n",
            s.name, sure, roots, several, doubtful, folded, worst,
            (double)counts.stretches / (double)counts.paths, (long)counts.doubtful);
        assert_int_equal(missed, 0);
        assert_int_equal(false_ones, 0);
        assert_true(worst < 1e-13);
        assert_true(roots > 100 && (SLOW || several > 0));
        assert_true(doubtful * 200 < sure);
        assert_true(s.may_be_folded || folded == 0);
        assert_true(counts.stretches < 20 * counts.paths);
    }
}

typedef struct face_end {
    double t, value;
} face_end;

static int by_end(const void *a, const void *b) {
    return memcmp(a, b, sizeof(face_end));
}

/* Whether a point of a cell is on the boundary of all cells. */
static bool at_boundary(const hex_lab *s, int c, const double at[3]) {
    int place[3];
    bool found = false;
    place_of(c, place);
    for (int a = s->closed; a < 3; a++)
        found = found || (at[a] == 0.0 && place[a] == 0) ||
                (at[a] == 1.0 && place[a] == HEX_LAB_CELLS - 1);
    return found;
}

/* What ends at a face within the grid begins behind it, with the same bits: also where rays go
 * exactly through nodes and along edges, and in folded cells. */
static void test_faces(void **state) {
    enum { RAYS = SLOW ? 50 : 300 };
    static face_end ends[ENDS];
    (void)state;
    for (int n = 0; n < hex_lab_count(); n++) {
        hex_lab s;
        field_random random = {FIELD_SEED + (uint64_t)n};
        long special = 0, pairs = 0;
        hex_lab_make(&s, n, FIELD_SEED + 1);
        for (int i = 0; i < RAYS; i++) {
            bool is_special;
            const ray r = hex_lab_ray(&s, &random, &is_special);
            special += is_special;
            const sheared_ray sheared = sheared_ray_of(r.o, r.d);
            size_t count = 0;
            for (int c = 0; c < CELLS; c++) {
                const hexahedron h = cell_of(&s, c);
                hex_path path;
                (void)hex_path_of(&h, hexahedron_sense(h.p), &sheared, &path);
                for (int k = 0; k < 2 * path.count; k++) {
                    const path_end *e = &path.part[k / 2].end[k % 2];
                    if (!at_boundary(&s, c, e->at))
                        ends[count++] = (face_end){e->t, e->value};
                }
            }
            qsort(ends, count, sizeof *ends, by_end);
            /* A ray through a corner at the boundary may have that end counted as one of it. */
            size_t alone = 0, k = 0;
            while (k < count) {
                const bool pair = k + 1 < count && by_end(&ends[k], &ends[k + 1]) == 0;
                alone += !pair;
                pairs += pair;
                k += pair ? 2 : 1;
            }
            assert_int_equal(alone, 0);
        }
        assert_true(special > RAYS / 20);
        assert_true(pairs > 2 * RAYS);
    }
}

/* The whole of a ray's first part in a cell, as one stretch if that is proven. */
static void bounds_hold(const hex_lab *s, int c, const sheared_ray *r, long *looked, long *proven) {
    enum { SAMPLES = 9 };
    const hexahedron h = cell_of(s, c);
    const int sense = hexahedron_sense(h.p);
    hex_path path;
    path_stretch x;
    bool located;
    if (sense == 0 || hex_path_of(&h, sense, r, &path) == 0)
        return;
    const path_end *end = path.part[0].end;
    curved_map map = {.form = &form_trilinear};
    for (int a = 0; a < 3; a++)
        memcpy(map.q[a], path.q[a], sizeof path.q[a]);
    ++*looked;
    if (!path_stretch_of(&map, &end[0], &end[1], &x, &located))
        return;
    ++*proven;
    double error, before = end[0].value, at[3] = {end[0].at[0], end[0].at[1], end[0].at[2]};
    const double slope = path_stretch_slope(&x, h.value, &error);
    const double step = (end[1].t - end[0].t) / SAMPLES;
    for (int k = 1; k <= SAMPLES; k++) {
        assert_true(path_stretch_locate(&map, end[0].t + k * step, at));
        const double value = hexahedron_at(h.value, at);
        assert_true(fabs((value - before) / step - slope) <= error + 1e-12 * (1.0 + 1.0 / step));
        before = value;
        for (int a = 0; a < 3; a++)
            assert_true(fabs(at[a] - x.at[a]) <= x.reach[a] + 1e-12);
    }
}

/* The parameters stay in a stretch's reach, and slopes within its bounds. */
static void test_bounds(void **state) {
    enum { RAYS = SLOW ? 50 : 100 };
    (void)state;
    for (int n = 0; n < hex_lab_count(); n++) {
        hex_lab s;
        field_random random = {FIELD_SEED + (uint64_t)n};
        long proven = 0, looked = 0;
        hex_lab_make(&s, n, FIELD_SEED + 2);
        for (int i = 0; i < RAYS; i++) {
            bool special;
            const ray r = hex_lab_ray(&s, &random, &special);
            if (special)
                continue;
            const sheared_ray sheared = sheared_ray_of(r.o, r.d);
            for (int c = 0; c < CELLS; c++)
                bounds_hold(&s, c, &sheared, &looked, &proven);
        }
        assert_true(looked > 100);
        assert_true(proven > looked / 4);
    }
}

/* Bernstein's form of a cubic at a share of its length. */
static double cubic_at(const double b[4], double x) {
    const double y = 1.0 - x;
    return y * y * y * b[0] + 3.0 * x * y * y * b[1] + 3.0 * x * x * y * b[2] + x * x * x * b[3];
}

/* Pieces cover their part, end to end, and the true value is within their error. */
static void pieces_hold(const hex_lab *s, int c, const ray *r, double tolerance, long *parts,
                        long *pieces, path_counts *counts, double *closest) {
    enum { SAMPLES = 7 };
    const hexahedron h = cell_of(s, c);
    const sheared_ray sheared = sheared_ray_of(r->o, r->d);
    const int sense = hexahedron_sense(h.p);
    hex_path path;
    path_piece piece[PATH_PIECES];
    (void)hex_path_of(&h, sense, &sheared, &path);
    const int count = hex_pieces(&h, sense, &path, tolerance, piece, counts);
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
            long double at[3];
            for (int a = 0; a < 3; a++) {
                const double share = (piece[k].t[0] - end[0].t) / (end[1].t - end[0].t);
                at[a] = end[0].at[a] + share * (end[1].at[a] - end[0].at[a]);
            }
            for (int n = 1; n < SAMPLES && sense != 0; n++) {
                const double x = (double)n / SAMPLES;
                const double now = piece[k].t[0] + x * (piece[k].t[1] - piece[k].t[0]);
                long double truth;
                if (!hex_truth_value(h.p, h.value, r->o, r->d, now, at, &truth))
                    continue;
                const double off = fabs(cubic_at(piece[k].b, x) - (double)truth);
                assert_true(off <= piece[k].error + 1e-12 * (1.0 + 1.0 / (end[1].t - end[0].t)));
                if (piece[k].error <= tolerance)
                    *closest = fmax(*closest, off / tolerance);
            }
        }
        assert_true(t == end[1].t && value == end[1].value);
    }
    assert_int_equal(k, count);
}

static void test_pieces(void **state) {
    enum { RAYS = SLOW ? 20 : 60 };
    static const double tolerances[] = {1e-3, 1e-6, 1e-9};
    (void)state;
    for (int n = 0; n < hex_lab_count(); n++)
        for (size_t i = 0; i < sizeof tolerances / sizeof *tolerances; i++) {
            hex_lab s;
            field_random random = {FIELD_SEED + (uint64_t)n};
            path_counts counts = {0};
            long parts = 0, pieces = 0;
            double closest = 0.0;
            hex_lab_make(&s, n, FIELD_SEED + 3);
            for (int k = 0; k < RAYS; k++) {
                bool special;
                const ray r = hex_lab_ray(&s, &random, &special);
                if (special)
                    continue;
                for (int c = 0; c < CELLS; c++)
                    pieces_hold(&s, c, &r, tolerances[i], &parts, &pieces, &counts, &closest);
            }
            /* Bounds are no more than some times the error; a regular grid's values are cubics. */
            assert_true(parts > 50);
            assert_true(closest < 0.75 && (closest > 0.1 || s.regular));
            assert_true(pieces < (i < 2 ? 12 : 64) * parts && (!s.regular || pieces == parts));
            assert_true(i == 2 || counts.doubtful * 10 < (uint64_t)parts);
        }
}

/* A point is in one cell, or in none, and the value there is the true one; the gradient is what
 * differences say. On faces, edges and nodes, too. */
static void test_points(void **state) {
    enum { POINTS = SLOW ? 100 : 400 };
    (void)state;
    for (int n = 0; n < hex_lab_count(); n++) {
        hex_lab s;
        field_random random = {FIELD_SEED + (uint64_t)n};
        long gradients = 0, several = 0;
        hex_lab_make(&s, n, FIELD_SEED + 4);
        for (int i = 0; i < POINTS; i++) {
            int place[3], holders = 0;
            double u[3], point[3];
            bool inside = true;
            for (int a = 0; a < 3; a++) {
                place[a] = (int)field_random_below(&random, HEX_LAB_CELLS);
                u[a] = i % 4 == 0 ? 0.5 * (double)field_random_below(&random, 3)
                                  : field_random_unit(&random);
                inside = inside && (u[a] > 0.0 || place[a] > 0) &&
                         (u[a] < 1.0 || place[a] < HEX_LAB_CELLS - 1);
            }
            const hexahedron in = hex_lab_cell(&s, place);
            for (int a = 0; a < 3; a++) {
                double p[HEX_CORNERS];
                for (int c = 0; c < HEX_CORNERS; c++)
                    p[c] = in.p[c][a];
                point[a] = hexahedron_at(p, u);
            }
            for (int c = 0; c < CELLS; c++) {
                const hexahedron h = cell_of(&s, c);
                const int sense = hexahedron_sense(h.p);
                double at[3], value, gradient[3];
                if (!hex_point_find(&h, sense, point, at, &value))
                    continue;
                holders++;
                long double near[3] = {at[0], at[1], at[2]}, truth;
                const double none[3] = {0.0, 0.0, 0.0};
                if (sense == 0 || !hex_truth_value(h.p, h.value, point, none, 0.0, near, &truth))
                    continue;
                assert_true(fabs(value - (double)truth) < 1e-8);
                if (i % 4 == 0 || !hex_point_gradient(&h, at, gradient))
                    continue;
                for (int a = 0; a < 3; a++) {
                    double d[3] = {0.0, 0.0, 0.0};
                    long double less, more;
                    const double step = 1e-9 * s.size;
                    d[a] = 1.0;
                    if (!hex_truth_value(h.p, h.value, point, d, -step, near, &less) ||
                        !hex_truth_value(h.p, h.value, point, d, step, near, &more))
                        continue;
                    const double slope = (double)(more - less) / (2.0 * step);
                    const double size = fabs(gradient[0]) + fabs(gradient[1]) + fabs(gradient[2]);
                    assert_true(fabs(gradient[a] - slope) <= 1e-3 * (1.0 + size));
                    gradients++;
                }
            }
            assert_true(holders >= inside);
            if (holders > 1) { /* where the axis touches a face at the point */
                assert_in_range(holders, 2, 3);
                assert_int_equal(i % 4, 0);
                several++;
            }
        }
        assert_true(several < POINTS / 50);
        assert_true(gradients > POINTS);
    }
}

static void test_sense(void **state) {
    double p[HEX_CORNERS][3], q[HEX_CORNERS][3];
    (void)state;
    for (int c = 0; c < HEX_CORNERS; c++)
        for (int a = 0; a < 3; a++)
            p[c][a] = (double)(c >> a & 1);
    assert_int_equal(hexahedron_sense(p), 1);
    memcpy(q, p, sizeof q);
    for (int c = 0; c < HEX_CORNERS; c++)
        q[c][1] = -p[c][1];
    assert_int_equal(hexahedron_sense(q), -1);
    /* A collapsed edge, a collapsed face, a flat cell, a cell without size. */
    memcpy(q, p, sizeof q);
    memcpy(q[1], q[0], sizeof q[1]);
    assert_int_equal(hexahedron_sense(q), 1);
    for (int c = 2; c < 4; c++)
        memcpy(q[c], q[0], sizeof q[c]);
    assert_int_equal(hexahedron_sense(q), 1);
    memcpy(q, p, sizeof q);
    for (int c = 0; c < HEX_CORNERS; c++)
        q[c][2] = 0.0;
    assert_int_equal(hexahedron_sense(q), 0);
    memset(q, 0, sizeof q);
    assert_int_equal(hexahedron_sense(q), 0);
    /* Folded: two corners changed places; a corner pushed through the opposite face; all but. */
    memcpy(q, p, sizeof q);
    memcpy(q[7], p[6], sizeof q[7]);
    memcpy(q[6], p[7], sizeof q[6]);
    assert_int_equal(hexahedron_sense(q), 0);
    memcpy(q, p, sizeof q);
    for (int a = 0; a < 3; a++)
        q[7][a] = -0.1;
    assert_int_equal(hexahedron_sense(q), 0);
    /* At that corner the determinant is 3 x - 2. */
    for (int a = 0; a < 3; a++)
        q[7][a] = 0.66;
    assert_int_equal(hexahedron_sense(q), 0);
    for (int a = 0; a < 3; a++)
        q[7][a] = 0.67;
    assert_int_equal(hexahedron_sense(q), 1);
    /* Bent so much that a coefficient is below 0, but not the determinant. */
    static const double bent[HEX_CORNERS][3] = {
        {0.0, 0.25, -0.25}, {0.75, -0.25, 0.5}, {0.5, 1.5, 0.25},    {1.25, 1.5, 0.25},
        {0.5, -0.5, 1.0},   {1.0, 0.5, 0.75},   {-0.25, 1.25, 0.75}, {1.0, 1.5, 1.5}};
    assert_int_equal(hexahedron_sense(bent), 1);
}

/* A cell whose parameters are renamed and turned about: the same crossings, to the bit. */
static void test_orders(void **state) {
    enum { RAYS = SLOW ? 40 : 200 };
    (void)state;
    for (int n = 0; n < hex_lab_count(); n++) {
        hex_lab s;
        field_random random = {FIELD_SEED + (uint64_t)n};
        long met = 0;
        hex_lab_make(&s, n, FIELD_SEED + 5);
        for (int i = 0; i < RAYS; i++) {
            bool special;
            const ray r = hex_lab_ray(&s, &random, &special);
            const sheared_ray sheared = sheared_ray_of(r.o, r.d);
            const int flips = (int)field_random_below(&random, 8);
            const int first = (int)field_random_below(&random, 3);
            const int step = 1 + (int)field_random_below(&random, 2);
            for (int c = 0; c < CELLS; c++) {
                const hexahedron h = cell_of(&s, c);
                const int sense = hexahedron_sense(h.p);
                hexahedron other;
                hex_path path[2];
                face_end ends[2][2 * PATH_PARTS];
                for (int k = 0; k < HEX_CORNERS; k++) {
                    int from = 0;
                    for (int a = 0; a < 3; a++)
                        from |= ((k ^ flips) >> a & 1) << (first + a * step) % 3;
                    memcpy(other.p[k], h.p[from], sizeof other.p[k]);
                    other.value[k] = h.value[from];
                }
                const int turned = hexahedron_sense(other.p);
                assert_int_equal(abs(turned), abs(sense));
                (void)hex_path_of(&h, sense, &sheared, &path[0]);
                (void)hex_path_of(&other, turned, &sheared, &path[1]);
                assert_int_equal(path[0].count, path[1].count);
                for (int k = 0; k < 2; k++) {
                    for (int e = 0; e < 2 * path[k].count; e++) {
                        const path_end *end = &path[k].part[e / 2].end[e % 2];
                        ends[k][e] = (face_end){end->t, end->value};
                    }
                    qsort(ends[k], (size_t)(2 * path[k].count), sizeof *ends[k], by_end);
                }
                met += path[0].count;
                assert_memory_equal(ends[0], ends[1],
                                    (size_t)(2 * path[0].count) * sizeof(face_end));
            }
        }
        assert_true(met > RAYS);
    }
}

/* A ray that is beside an edge by less than a product of doubles can tell. */
static void test_exact_sides(void **state) {
    const double e = 0x1p-30;
    /* The edge from the first to the second corner turns by -e^2, then by e^2. */
    const double out[4][3] = {{1.0 + e, -1.0}, {-1.0, 1.0 - e}, {-1.0, -4.0}, {-4.0, -1.0}};
    const double in[4][3] = {{1.0, -1.0 + e}, {-1.0 - e, 1.0}, {-1.0, -4.0}, {-4.0, -1.0}};
    patch_crossing found[PATCH_CROSSINGS];
    (void)state;
    assert_int_equal(patch_cross(out, found), 0);
    assert_int_equal(patch_cross(in, found), 1);
    assert_true(fabs(found[0].at[0] - 0.5) < 1e-6 && found[0].at[1] < 1e-6);
}

/* Rays along lines of a patch, through its corners and in its edges: where a crossing is said to
 * be, the ray is. */
static void test_rulings(void **state) {
    enum { CELLS_TRIED = SLOW ? 20000 : 200000 };
    field_random r = {FIELD_SEED};
    long ends = 0, off = 0;
    (void)state;
    for (int n = 0; n < CELLS_TRIED; n++) {
        hexahedron h;
        ray along = {.t0 = -INFINITY, .t1 = INFINITY};
        for (int c = 0; c < HEX_CORNERS; c++)
            for (int a = 0; a < 3; a++)
                h.p[c][a] = 4.0 * (c >> a & 1) + 0.5 * (double)(field_random_below(&r, 5) - 2);
        for (int c = 0; c < HEX_CORNERS; c++)
            h.value[c] = h.p[c][1];
        for (int a = 0; a < 3; a++)
            along.d[a] = (double)(field_random_below(&r, 3) - 1);
        if (along.d[0] == 0.0 && along.d[1] == 0.0 && along.d[2] == 0.0)
            continue;
        for (int a = 0; a < 3; a++)
            along.o[a] = 0.5 * (double)(field_random_below(&r, 13) - 2) - 10.0 * along.d[a];
        const int sense = hexahedron_sense(h.p);
        const sheared_ray sheared = sheared_ray_of(along.o, along.d);
        hex_path path;
        if (sense == 0)
            continue;
        (void)hex_path_of(&h, sense, &sheared, &path);
        for (int k = 0; k < 2 * path.count; k++) {
            const path_end *e = &path.part[k / 2].end[k % 2];
            double far = fabs(e->value - (along.o[1] + e->t * along.d[1]));
            for (int a = 0; a < 3; a++) {
                double p[HEX_CORNERS];
                for (int c = 0; c < HEX_CORNERS; c++)
                    p[c] = h.p[c][a];
                far = fmax(far, fabs(hexahedron_at(p, e->at) - (along.o[a] + e->t * along.d[a])));
            }
            ends++;
            off += far > 1e-6;
        }
    }
    assert_true(ends > CELLS_TRIED / 2);
    assert_int_equal(off, 0);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_truth),  cmocka_unit_test(test_faces),
        cmocka_unit_test(test_bounds), cmocka_unit_test(test_pieces),
        cmocka_unit_test(test_points), cmocka_unit_test(test_sense),
        cmocka_unit_test(test_orders), cmocka_unit_test(test_exact_sides),
        cmocka_unit_test(test_rulings)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
