/* test_cell_batch.c - every SIMD version of the cell kernel that this CPU has against the scalar
 * functions, to the bit, on random and hostile ray-cells.
 *
 *   LEAFCAST_BATCHES=N   batches of each case instead of 40
 */
#include <float.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "render/grid/cell_batch.h"
#include "render/grid/cell_kernel.h"
#include "tests/support/cell_batch_wide.h"
#include "tests/support/fields.h"
#include "tests/support/ray_cells.h"

enum { SEED = 31, DEFAULT_BATCHES = 40, ISOS_MAX = CELL_BATCH };

/* Ray-cells as the scalar functions take them. */
typedef struct ray_cells {
    ray r[CELL_BATCH];
    cell_box box[CELL_BATCH];
    float samples[CELL_BATCH][8];
    double isovalues[CELL_BATCH]; /* each one's own */
} ray_cells;

/* The versions to be tried: those of this CPU, and the one of AVX-512 in plain C. */
static int versions(void) {
    return (int)cpu_best() + 2;
}

static cell_batch_fn version(int v, const char **name) {
    const bool wide = v > (int)cpu_best();
    *name = wide ? "wide" : cpu_isa_name((cpu_isa)v);
    return wide ? cell_batch_wide : cell_batch_kernels[(cpu_isa)v];
}

static cell_roots_fn roots_version(int v) {
    return v > (int)cpu_best() ? cell_roots_wide : cell_roots_kernels[(cpu_isa)v];
}

static int batches(void) {
    const char *given = getenv("LEAFCAST_BATCHES");
    return given ? atoi(given) : DEFAULT_BATCHES;
}

/* The SIMD version's input; what lies behind `lanes` is not a number, or looks like any other. */
static void batch_of(const ray_cells *c, int lanes, cell_batch *b) {
    memset(b, 0xff, sizeof *b);
    for (int k = 0; k < (lanes & 1 ? CELL_BATCH : lanes); k++) {
        const int from = k % lanes;
        const ray *r = &c->r[from];
        b->t0[k] = r->t0;
        b->t1[k] = r->t1;
        for (int a = 0; a < 3; a++) {
            b->d[a][k] = r->d[a] != 0.0 ? r->d[a] : CELL_ALONG;
            b->lo[a][k] = c->box[from].lo[a] - r->o[a];
            b->hi[a][k] = c->box[from].hi[a] - r->o[a];
            b->inv[a][k] = c->box[from].inv[a];
        }
        for (int i = 0; i < 8; i++)
            b->samples[i][k] = c->samples[from][i];
    }
}

/* What the contract says: the visit, then each isovalue's first hit, of these the first. */
static void truth_of(const ray_cells *c, int lanes, const double *isovalues, int count,
                     cell_batch_hits *out) {
    memset(out, 0, sizeof *out);
    for (int k = 0; k < lanes; k++) {
        cell_visit visit;
        if (!cell_visit_of(&c->r[k], &c->box[k], &visit))
            continue;
        for (int i = 0; i < count; i++) {
            const uint32_t bit = 1u << k;
            const hit start = hit_before_all();
            hit h;
            if (!cell_next_hit(&c->r[k], &visit, c->samples[k], isovalues[i], i, 99, &start, &h) ||
                (out->found & bit && h.t >= out->t[k]))
                continue;
            out->found |= bit;
            out->t[k] = h.t;
            out->iso[k] = i;
            out->entering = (out->entering & ~bit) | (h.entering ? bit : 0);
            out->at_exit = (out->at_exit & ~bit) | (h.t == visit.t_out ? bit : 0);
        }
    }
}

static void assert_same(const cell_batch_hits *x, const cell_batch_hits *truth, const char *isa,
                        const char *what, int index) {
    bool same =
        x->found == truth->found && x->entering == truth->entering && x->at_exit == truth->at_exit;
    int lane = 0;
    for (int k = 0; same && k < CELL_BATCH; k++)
        if (truth->found >> k & 1u) {
            lane = k;
            same =
                x->iso[k] == truth->iso[k] && memcmp(&x->t[k], &truth->t[k], sizeof x->t[k]) == 0;
        }
    if (!same)
        fail_msg("%s: %s, batch %d: found %x entering %x at exit %x, not %x %x %x; lane %d: "
                 "t %a iso %d, not %a %d",
                 isa, what, index, x->found, x->entering, x->at_exit, truth->found, truth->entering,
                 truth->at_exit, lane, x->t[lane], x->iso[lane], truth->t[lane], truth->iso[lane]);
}

static int several; /* lanes with more than one root, in all */

/* All roots of a lane are what cell_next_hit() finds one behind the other; an extremum that touches
 * is two roots, and one hit. */
static void assert_roots(const ray_cells *c, int k, double iso, const cell_batch_roots *roots,
                         const char *name) {
    hit last = hit_before_all(), h;
    cell_visit visit = {0};
    int count = 0;
    const bool visited = cell_visit_of(&c->r[k], &c->box[k], &visit);
    for (int n = 0; n < CELL_ROOTS_MAX && roots->found[n] >> k & 1u; n++) {
        assert_true(visited);
        if (count > 0 && roots->t[n][k] <= last.t)
            continue;
        if (!cell_next_hit(&c->r[k], &visit, c->samples[k], iso, 0, 99, &last, &h))
            fail_msg("%s: root %d at %a is none", name, n, roots->t[n][k]);
        assert_memory_equal(&h.t, &roots->t[n][k], sizeof h.t);
        assert_int_equal(h.entering, roots->entering[n] >> k & 1u);
        assert_int_equal(h.t == visit.t_out, roots->at_exit[n] >> k & 1u);
        last = h;
        count++;
    }
    if (visited && cell_next_hit(&c->r[k], &visit, c->samples[k], iso, 0, 99, &last, &h))
        fail_msg("%s: %d roots, but there is one at %a", name, count, h.t);
    several += count > 1;
}

static void check_roots(const ray_cells *c, const cell_batch *b, int lanes, double iso) {
    for (int v = 0; v < versions(); v++) {
        const char *name;
        cell_batch_roots roots;
        memset(&roots, 0xff, sizeof roots);
        (void)version(v, &name);
        roots_version(v)(b, lanes, iso, &roots);
        for (int k = 0; k < lanes; k++)
            assert_roots(c, k, iso, &roots, name);
        for (int n = 0; n < CELL_ROOTS_MAX; n++)
            assert_int_equal((uint64_t)roots.found[n] >> lanes, 0);
    }
}

/* All versions; how many lanes were found. */
static int check(const ray_cells *c, int lanes, const double *isovalues, int count,
                 const char *what, int index) {
    cell_batch b;
    cell_batch_hits truth, hits;
    batch_of(c, lanes, &b);
    for (int i = 0; i < count; i++)
        check_roots(c, &b, lanes, isovalues[i]);
    truth_of(c, lanes, isovalues, count, &truth);
    for (int v = 0; v < versions(); v++) {
        const char *name;
        memset(&hits, 0xff, sizeof hits);
        version(v, &name)(&b, lanes, isovalues, count, &hits);
        assert_same(&hits, &truth, name, what, index);
    }
    return __builtin_popcount(truth.found);
}

/* ---- ray-cells ---- */

static double power_of_ten(field_random *r, double lo, double hi) {
    return exp(log(10.0) * field_random_in(r, lo, hi));
}

/* No direction component may be 0: those become small ones. */
static double moving(double d, field_random *r) {
    if (d != 0.0)
        return d;
    return (field_random_below(r, 2) ? 1 : -1) *
           power_of_ten(r, field_random_below(r, 2) ? -300 : -20, -3);
}

/* Now and then a ray begins or ends in the cell, or at one of its planes. */
static void limit(ray *r, const cell_box *box, field_random *random) {
    for (int end = 0; end < 2; end++) {
        const int a = (int)field_random_below(random, 3);
        const double at =
            ((field_random_below(random, 2) ? box->lo[a] : box->hi[a]) - r->o[a]) / r->d[a];
        const double t =
            field_random_below(random, 2) ? at : at * field_random_in(random, 0.9, 1.1);
        if (field_random_below(random, 6) == 0 && t >= 0) {
            r->t0 = end ? r->t0 : t;
            r->t1 = end ? t : r->t1;
        }
    }
}

static void make_lane(int which, uint64_t seed, uint64_t index, int lane, ray_cells *c) {
    field_random random = {seed ^ index * 977};
    ray_cell one;
    ray_cell_make(which, seed, index, &one);
    ray *r = &c->r[lane];
    cell_box *box = &c->box[lane];
    *r = (ray){.t0 = 0, .t1 = INFINITY};
    for (int a = 0; a < 3; a++) {
        r->o[a] = one.o[a];
        r->d[a] = moving(one.d[a], &random);
        box->lo[a] = one.lo[a];
        box->hi[a] = one.hi[a];
        box->inv[a] = 1 / (one.hi[a] - one.lo[a]);
        box->last[a] = true;
    }
    limit(r, box, &random);
    memcpy(c->samples[lane], one.samples, sizeof one.samples);
    c->isovalues[lane] = one.iso;
}

/* ---- tests ---- */

static void every_case_is_the_same_bits(void **state) {
    (void)state;
    print_message("# up to %s\n", cpu_isa_name(cpu_best()));
    for (int which = 0; which < ray_cell_case_count(); which++) {
        const char *name = ray_cell_case_name(which);
        int found = 0;
        for (int n = 0; n < batches(); n++) {
            ray_cells c;
            const int lanes = 1 + (n * 7 + CELL_BATCH - 1) % CELL_BATCH;
            for (int k = 0; k < lanes; k++)
                make_lane(which, SEED, (uint64_t)(CELL_BATCH * n + k), k, &c);
            /* Each lane's own isovalue alone, then all of them together. */
            for (int k = 0; k < lanes; k++)
                found += check(&c, lanes, &c.isovalues[k], 1, name, n);
            check(&c, lanes, c.isovalues, lanes, name, n);
        }
        assert_true(found > 0 || strcmp(name, "constant") == 0);
    }
}

/* Hits in all lanes and in next to none, of cells as they come from a picture. */
static void full_batches_are_the_same_bits(void **state) {
    (void)state;
    field_random random = {SEED};
    int full = 0;
    for (int n = 0; n < 25 * batches(); n++) {
        ray_cells c;
        const double spread = power_of_ten(&random, -3, 0.5);
        for (int k = 0; k < CELL_BATCH; k++) {
            make_lane(0, SEED + 1, (uint64_t)(CELL_BATCH * n + k), k, &c);
            for (int a = 0; a < 3; a++) {
                c.r[k].d[a] = a == 2 ? 1 : field_random_in(&random, -0.3, 0.3);
                c.r[k].o[a] = c.box[k].lo[a] + 0.5 - 5 * c.r[k].d[a];
            }
            c.r[k].t0 = 0;
            c.r[k].t1 = INFINITY;
            for (int i = 0; i < 8; i++)
                c.samples[k][i] =
                    (float)((i >> 2) - 0.5 + spread * field_random_in(&random, -1, 1));
        }
        const double isovalues[2] = {0.0, field_random_in(&random, -0.4, 0.4)};
        full += check(&c, CELL_BATCH, isovalues, 2, "full", n) == CELL_BATCH;
    }
    assert_true(full > 2 * batches());
}

/* Rays that pass a corner of the cell to within rounding, where coordinates come out beyond it. */
static void corners_are_the_same_bits(void **state) {
    (void)state;
    field_random random = {SEED + 7};
    int found = 0;
    for (int n = 0; n < 25 * batches(); n++) {
        ray_cells c;
        for (int k = 0; k < CELL_BATCH; k++) {
            make_lane(0, SEED + 8, (uint64_t)(CELL_BATCH * n + k), k, &c);
            const long corner = field_random_below(&random, 8);
            const double pace = field_random_in(&random, 0.1, 0.9);
            for (int a = 0; a < 3; a++) {
                const double at = corner >> a & 1 ? c.box[k].hi[a] : c.box[k].lo[a];
                c.r[k].d[a] = (at - c.r[k].o[a]) * pace;
            }
            c.r[k].t0 = 0;
            c.r[k].t1 = INFINITY;
        }
        found += check(&c, CELL_BATCH, c.isovalues, CELL_BATCH, "corners", n);
    }
    assert_true(found > batches());
}

/* Visits of cell corners so small that the cubic's values leave what is ordinary, down to 0. */
static void vanishing_visits_are_the_same_bits(void **state) {
    (void)state;
    field_random random = {SEED + 2};
    int found = 0;
    for (int n = 0; n < 25 * batches(); n++) {
        ray_cells c;
        memset(&c, 0, sizeof c);
        for (int k = 0; k < CELL_BATCH; k++) {
            const double size =
                power_of_ten(&random, field_random_below(&random, 2) ? -320 : -150, 0);
            for (int a = 0; a < 3; a++) {
                c.r[k].d[a] = field_random_in(&random, 0.1, 1);
                c.box[k].lo[a] = -size * field_random_unit(&random);
                c.box[k].hi[a] = c.box[k].lo[a] + 1;
                c.box[k].inv[a] = 1;
            }
            c.r[k].t1 = size;
            for (int i = 0; i < 8; i++)
                c.samples[k][i] = (float)(field_random_below(&random, 3) - 1);
            c.samples[k][0] = field_random_below(&random, 4) ? 0.0f : c.samples[k][0];
        }
        const double iso = field_random_below(&random, 2) ? 0.0 : 1e-300;
        found += check(&c, CELL_BATCH, &iso, 1, "vanishing", n);
    }
    assert_true(found > 0);
}

/* A ray that goes along one or two axes' planes; it is beside the cell now and then. */
static void level(ray *r, const cell_box *box, field_random *random) {
    const int kept = (int)field_random_below(random, 3);
    const int gone = (kept + 1 + (int)field_random_below(random, 2)) % 3;
    const bool both = field_random_below(random, 4) == 0;
    for (int a = 0; a < 3; a++) {
        const double size = box->hi[a] - box->lo[a];
        if (a == kept || (a != gone && !both))
            continue;
        r->d[a] = 0.0;
        r->o[a] = box->lo[a] + size * field_random_in(random, -0.02, 1.02);
        if (field_random_below(random, 8) == 0)
            r->o[a] = box->lo[a] + size * (field_random_below(random, 2) ? 1e-15 : 1 - 1e-15);
    }
}

/* Whether the batch may have it: see CELL_ALONG. */
static bool is_along(const ray *r, const cell_box *box) {
    bool along = true;
    for (int a = 0; a < 3; a++)
        along &= r->d[a] != 0.0 || (fabs(box->lo[a] - r->o[a]) >= CELL_ALONG_NEAR &&
                                    fabs(box->hi[a] - r->o[a]) >= CELL_ALONG_NEAR);
    return along;
}

/* What stands for a component of 0 has its answers, wherever the ray begins and ends. */
static void rays_along_planes_are_the_same_bits(void **state) {
    (void)state;
    field_random random = {SEED + 9};
    int found = 0, lanes = 0;
    for (int n = 0; n < 25 * batches(); n++) {
        ray_cells c;
        for (int k = 0; k < CELL_BATCH; k++) {
            do {
                const double begin = field_random_in(&random, -3, 0);
                make_lane(0, SEED + 10, (uint64_t)(CELL_BATCH * n + k), k, &c);
                c.r[k].t0 = field_random_below(&random, 4) ? begin : -INFINITY;
                level(&c.r[k], &c.box[k], &random);
            } while (!is_along(&c.r[k], &c.box[k]));
            lanes++;
        }
        found += check(&c, CELL_BATCH, c.isovalues, CELL_BATCH, "along", n);
    }
    assert_true(found > lanes / 10);
}

/* A ray that leaves the cell where it enters it or, with entry = leaves, where it begins. There it
 * meets the isosurface of 1, by rounding alone: at the entry, f may be a bit less. */
static void touch(field_random *random, int entry, int leaves, int k, ray_cells *c) {
    ray *r = &c->r[k];
    cell_box *box = &c->box[k];
    memset(r, 0, sizeof *r);
    for (int a = 0; a < 3; a++) {
        r->d[a] = field_random_in(random, 1e-4, 1e-3);
        box->lo[a] = -8;
        box->hi[a] = 8;
    }
    r->d[leaves] = field_random_in(random, 0.1, 1);
    box->hi[leaves] = field_random_in(random, 1, 9);
    box->lo[leaves] = box->hi[leaves] - field_random_in(random, 0.5, 2);
    const double t = box->hi[leaves] / r->d[leaves];
    if (entry == leaves) {
        r->t0 = t;
    } else {
        r->d[entry] = 1;
        box->lo[entry] = t;
        box->hi[entry] = t + 1;
    }
    r->t1 = INFINITY;
    for (int a = 0; a < 3; a++)
        box->inv[a] = 1 / (box->hi[a] - box->lo[a]);
    for (int i = 0; i < 8; i++)
        c->samples[k][i] = (float)(i >> leaves & 1);
}

static void visits_without_length_are_the_same_bits(void **state) {
    (void)state;
    field_random random = {SEED + 11};
    const double iso = 1;
    int found = 0;
    for (int n = 0; n < 25 * batches(); n++) {
        ray_cells c;
        for (int k = 0; k < CELL_BATCH; k++)
            touch(&random, (int)field_random_below(&random, 3), (int)field_random_below(&random, 3),
                  k, &c);
        found += check(&c, CELL_BATCH, &iso, 1, "without length", n);
    }
    assert_true(found > batches());
}

/* A lane says the same whatever stands beside it and wherever it stands. */
static void lanes_do_not_see_each_other(void **state) {
    (void)state;
    field_random random = {SEED + 3};
    int moved = 0;
    for (int n = 0; n < 25 * batches(); n++) {
        ray_cells c, other;
        for (int k = 0; k < CELL_BATCH; k++) {
            const int kind[2] = {(int)field_random_below(&random, ray_cell_case_count()),
                                 (int)field_random_below(&random, ray_cell_case_count())};
            make_lane(kind[0], SEED + 4, (uint64_t)(CELL_BATCH * n + k), k, &c);
            make_lane(kind[1], SEED + 5, (uint64_t)(CELL_BATCH * n + k), k, &other);
        }
        const int from = (int)field_random_below(&random, CELL_BATCH),
                  to = (int)field_random_below(&random, CELL_BATCH);
        const int lanes = to + 1 + (int)field_random_below(&random, CELL_BATCH - to);
        const double iso = c.isovalues[from];
        other.r[to] = c.r[from];
        other.box[to] = c.box[from];
        memcpy(other.samples[to], c.samples[from], sizeof c.samples[from]);
        cell_batch b, moved_b;
        batch_of(&c, CELL_BATCH, &b);
        batch_of(&other, lanes, &moved_b);
        for (int v = 0; v < versions(); v++) {
            cell_batch_hits here, there;
            const char *name;
            version(v, &name)(&b, CELL_BATCH, &iso, 1, &here);
            version(v, &name)(&moved_b, lanes, &iso, 1, &there);
            assert_int_equal(here.found >> from & 1u, there.found >> to & 1u);
            assert_int_equal(there.found >> lanes, 0);
            if (!(here.found >> from & 1u))
                continue;
            assert_memory_equal(&here.t[from], &there.t[to], sizeof here.t[from]);
            assert_int_equal(here.entering >> from & 1u, there.entering >> to & 1u);
            assert_int_equal(here.at_exit >> from & 1u, there.at_exit >> to & 1u);
            moved++;
        }
    }
    assert_true(moved > batches());
}

/* f at s, from its control values, and how steep it is there. */
static long double value_at(const double b[4], long double s, long double *slope) {
    const long double r = 1 - s;
    const long double x[3] = {r * b[0] + s * b[1], r * b[1] + s * b[2], r * b[2] + s * b[3]};
    const long double y[2] = {r * x[0] + s * x[1], r * x[1] + s * x[2]};
    *slope = 3 * (y[1] - y[0]);
    return r * y[0] + s * y[1];
}

/* The search stops when nothing is left to gain: f is zero to within its own rounding errors, and
 * those of s. */
static void roots_are_right_to_the_last_bits(void **state) {
    (void)state;
    field_random random = {SEED + 6};
    int judged = 0;
    for (int n = 0; n < 5000 * batches(); n++) {
        const bool steep = field_random_below(&random, 2);
        double b[4], roots[3], largest = 0;
        for (int i = 0; i < 4; i++) {
            b[i] = field_random_in(&random, -1, 1) * (steep ? power_of_ten(&random, -4, 0) : 1);
            largest = fmax(largest, fabs(b[i]));
        }
        const int count = cell_roots(b, roots);
        for (int i = 0; i < count; i++) {
            long double slope;
            const long double f = value_at(b, roots[i], &slope);
            if (i > 0 && roots[i] == roots[i - 1])
                continue; /* a touch */
            if (fabsl(f) > 40 * DBL_EPSILON * largest + 2 * DBL_EPSILON * fabsl(slope))
                fail_msg("%a %a %a %a: root %a, f %Lg", b[0], b[1], b[2], b[3], roots[i], f);
            judged++;
        }
    }
    assert_true(judged > 1000 * batches());
}

/* Of all the tests before. */
static void many_cells_have_several_roots(void **state) {
    (void)state;
    print_message("%d lanes with several roots\n", several);
    assert_true(several > 1000);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_case_is_the_same_bits),
        cmocka_unit_test(full_batches_are_the_same_bits),
        cmocka_unit_test(corners_are_the_same_bits),
        cmocka_unit_test(vanishing_visits_are_the_same_bits),
        cmocka_unit_test(rays_along_planes_are_the_same_bits),
        cmocka_unit_test(visits_without_length_are_the_same_bits),
        cmocka_unit_test(lanes_do_not_see_each_other),
        cmocka_unit_test(roots_are_right_to_the_last_bits),
        cmocka_unit_test(many_cells_have_several_roots),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
