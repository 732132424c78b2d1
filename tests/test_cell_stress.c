/* test_cell_stress.c - the scalar cell kernel against the reference, on hostile ray-cells and small
 * blocks of cells.
 *
 *   test_cell_stress                   LEAFCAST_STRESS (20000) ray-cells of each case
 *   test_cell_stress CASE SEED INDEX   one ray-cell, with both answers
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "render/cell_kernel.h"
#include "tests/support/fields.h"
#include "tests/support/ray_cells.h"
#include "tests/support/ref_judge.h"
#include "tests/support/reference.h"

enum {
    SEED = 20,
    DEFAULT_COUNT = 20000,
    SHOWN = 3,     /* faults printed of a case */
    SAMPLED = 16,  /* one ray in so many is asked whether it grazes, besides those that differ */
    ROOTS_MAX = 64 /* along a ray through a block */
};

/* ---- one cell ---- */

static ray kernel_ray(const double o[3], const double d[3]) {
    ray r = {.t0 = 0, .t1 = INFINITY};
    for (int a = 0; a < 3; a++) {
        r.o[a] = o[a];
        r.d[a] = d[a] == 0 ? 0 : d[a];
    }
    return r;
}

static cell_box kernel_box(const double lo[3], const double hi[3]) {
    cell_box box;
    for (int a = 0; a < 3; a++) {
        box.lo[a] = lo[a];
        box.hi[a] = hi[a];
        box.inv[a] = 1 / (hi[a] - lo[a]);
        box.last[a] = true;
    }
    return box;
}

/* Roots as the kernel lists them, and the side before the first one. */
static int kernel_roots(const cell_visit *visit, const float samples[8], double iso, double t[3],
                        bool *inside) {
    double b[4], s[3];
    if (!cell_cubic(visit, samples, iso, b))
        return 0;
    int count = cell_roots(b, s);
    for (int i = 0; i < count; i++)
        t[i] = cell_root_t(visit, s[i]);
    *inside = b[0] >= 0;
    return count;
}

/* cell_next_hit(), resumed from hit to hit, must list the same roots; of equal t one. */
static void check_resume(const ray *r, const cell_visit *visit, const float samples[8], double iso,
                         const double *t, int count, bool inside) {
    hit at = hit_before_all(), next;
    for (int i = 0; i < count; i++, inside = !inside) {
        if (i > 0 && t[i] == t[i - 1])
            continue;
        assert_true(cell_next_hit(r, visit, samples, iso, 2, 77, &at, &next));
        assert_true(next.t == t[i] && next.cell == 77 && next.iso == 2 && next.entering == !inside);
        /* From a hit of another isovalue at the same place this one is still to come, or is past.
         */
        hit other = next, again;
        other.iso = 1;
        assert_true(cell_next_hit(r, visit, samples, iso, 2, 77, &other, &again) &&
                    again.t == t[i]);
        other.iso = 3;
        assert_true(!cell_next_hit(r, visit, samples, iso, 2, 77, &other, &again) ||
                    again.t > t[i]);
        at = next;
    }
    assert_false(cell_next_hit(r, visit, samples, iso, 2, 77, &at, &next));
}

typedef struct answer {
    ref_hit truth[REF_CELL_ROOTS_MAX];
    double t[3];
    int truth_count, count;
    bool visited, inside;
} answer;

static answer answer_of(const ray_cell *c) {
    answer a = {.inside = false};
    a.truth_count = ref_cell_roots(c->o, c->d, c->lo, c->hi, c->samples, c->iso, a.truth);
    ray r = kernel_ray(c->o, c->d);
    cell_box box = kernel_box(c->lo, c->hi);
    cell_visit visit;
    a.visited = cell_visit_of(&r, &box, &visit);
    if (a.visited) {
        a.count = kernel_roots(&visit, c->samples, c->iso, a.t, &a.inside);
        check_resume(&r, &visit, c->samples, c->iso, a.t, a.count, a.inside);
    }
    return a;
}

static bool differs(const answer *a) {
    bool differ = a->count != a->truth_count;
    for (int i = 0; !differ && i < a->count; i++)
        differ =
            !(fabs(a->t[i] - a->truth[i].t) * a->truth[i].cells_per_t <= REF_GRAZING_CHANGE / 2);
    return differ;
}

static ref_verdict judge_cell(ref_tally *tally, const ray_cell *c, uint64_t index) {
    answer a = answer_of(c);
    bool ask = index % SAMPLED == 0 || differs(&a);
    bool grazing = ask && ref_cell_grazing(c->o, c->d, c->lo, c->hi, c->samples, c->iso,
                                           REF_GRAZING_SHIFT, REF_GRAZING_CHANGE);
    if (!grazing && a.count == a.truth_count)
        for (int i = 0; i < a.count; i++)
            assert_int_equal(a.truth[i].from_inside, a.inside == (i % 2 == 0));
    return ref_judge_roots(tally, a.truth, a.truth_count, a.t, a.count, grazing);
}

static void show_cell(const ray_cell *c) {
    answer a = answer_of(c);
    fprintf(stderr, "o  %.17g %.17g %.17g\nd  %.17g %.17g %.17g\n", c->o[0], c->o[1], c->o[2],
            c->d[0], c->d[1], c->d[2]);
    fprintf(stderr, "lo %.17g %.17g %.17g\nhi %.17g %.17g %.17g\n", c->lo[0], c->lo[1], c->lo[2],
            c->hi[0], c->hi[1], c->hi[2]);
    for (int n = 0; n < 8; n++)
        fprintf(stderr, "%s%.9g%s", n ? " " : "samples ", (double)c->samples[n],
                n == 7 ? "\n" : "");
    fprintf(stderr, "iso %.17g, visited %d, grazing %d\n", c->iso, a.visited,
            ref_cell_grazing(c->o, c->d, c->lo, c->hi, c->samples, c->iso, REF_GRAZING_SHIFT,
                             REF_GRAZING_CHANGE));
    for (int i = 0; i < a.truth_count; i++)
        fprintf(stderr, "truth  %.17g\n", a.truth[i].t);
    for (int i = 0; i < a.count; i++)
        fprintf(stderr, "kernel %.17g\n", a.t[i]);
}

static uint64_t stress_count(void) {
    const char *text = getenv("LEAFCAST_STRESS");
    return text ? strtoull(text, NULL, 10) : DEFAULT_COUNT;
}

static void every_case_agrees(void **state) {
    (void)state;
    uint64_t count = stress_count(), faults = 0;
    fprintf(stderr, "seed %d, %llu of each\n", SEED, (unsigned long long)count);
    ref_tally_heading(stderr, "case");
    for (int which = 0; which < ray_cell_case_count(); which++) {
        ref_tally tally = {0};
        uint64_t shown = 0;
        for (uint64_t i = 0; i < count; i++) {
            ray_cell c;
            ray_cell_make(which, SEED, i, &c);
            ref_verdict verdict = judge_cell(&tally, &c, i);
            if (verdict != REF_SAME && verdict != REF_GRAZING && shown++ < SHOWN)
                fprintf(stderr, "%s; rerun: test_cell_stress %s %d %llu\n",
                        ref_verdict_name(verdict), ray_cell_case_name(which), SEED,
                        (unsigned long long)i);
        }
        ref_tally_row(stderr, ray_cell_case_name(which), &tally);
        faults += ref_tally_faults(&tally);
        if (faults && getenv("LEAFCAST_STRESS_STOP"))
            exit(1);
    }
    if (faults)
        fail_msg("%llu faults", (unsigned long long)faults);
}

/* ---- blocks of cells: what one cell leaves, the next one takes up ---- */

typedef struct block {
    field f;
    ref_volume v;
    long cells[3];
} block;

static void block_make(block *b, const char *name, uint64_t seed) {
    assert_true(field_make(&b->f, name, 4, seed));
    b->v = field_volume(&b->f);
    memset(b->v.to_world, 0, sizeof b->v.to_world);
    for (int a = 0; a < 3; a++) {
        b->v.to_world[a][a] = 1;
        b->cells[a] = b->f.dims[a] - 1;
    }
}

static cell_box block_cell(const block *b, long index, float samples[8]) {
    long at[3] = {index % b->cells[0], index / b->cells[0] % b->cells[1],
                  index / b->cells[0] / b->cells[1]};
    double lo[3], hi[3];
    for (int a = 0; a < 3; a++) {
        lo[a] = b->f.axis[a] ? b->f.axis[a][at[a]] : (double)at[a];
        hi[a] = b->f.axis[a] ? b->f.axis[a][at[a] + 1] : (double)(at[a] + 1);
    }
    for (int n = 0; n < 8; n++)
        samples[n] =
            b->f.samples[at[0] + (n & 1) +
                         b->f.dims[0] * (at[1] + (n >> 1 & 1) + b->f.dims[1] * (at[2] + (n >> 2)))];
    cell_box box = kernel_box(lo, hi);
    for (int a = 0; a < 3; a++)
        box.last[a] = at[a] == b->cells[a] - 1;
    return box;
}

static int by_t(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Where all 4 samples of a face lie on one side, so does every point of it: the cell behind it may
 * hold no surface. */
static void check_faces(const double at[3], const float samples[8], double iso, double value) {
    for (int a = 0; a < 3; a++) {
        if (at[a] != 0 && at[a] != 1)
            continue;
        int inside = 0;
        for (int n = 0; n < 8; n++)
            inside += (n >> a & 1) == (int)at[a] && (double)samples[n] >= iso;
        assert_true(inside != 4 || value >= 0);
        assert_true(inside != 0 || value < 0);
    }
}

/* Roots of the kernel in all cells of the block that it visits, in order. */
static int block_roots(const block *b, const ray *r, double *t) {
    int count = 0;
    for (long i = 0; i < b->cells[0] * b->cells[1] * b->cells[2]; i++) {
        float samples[8];
        double roots[3];
        bool inside;
        cell_visit visit;
        cell_box box = block_cell(b, i, samples);
        if (!cell_visit_of(r, &box, &visit))
            continue;
        double cubic[4];
        if (cell_cubic(&visit, samples, b->f.iso, cubic)) {
            check_faces(visit.in, samples, b->f.iso, cubic[0]);
            check_faces(visit.out, samples, b->f.iso, cubic[3]);
        }
        int n = kernel_roots(&visit, samples, b->f.iso, roots, &inside);
        for (int k = 0; k < n && count < ROOTS_MAX; k++)
            t[count++] = roots[k];
    }
    qsort(t, (size_t)count, sizeof t[0], by_t);
    return count;
}

/* The kernel visits the very cells that the reference walks through, zero-length visits too; and
 * both cells at a face see the same value there, to the bit. */
static void check_walk(const block *b, const ray *r, const ref_visit *walk, size_t length) {
    long visited = 0;
    float samples[8];
    cell_visit visit;
    for (long i = 0; i < b->cells[0] * b->cells[1] * b->cells[2]; i++) {
        cell_box box = block_cell(b, i, samples);
        visited += cell_visit_of(r, &box, &visit) && visit.t_out > 0;
    }
    double exit_value = NAN;
    for (size_t i = 0; i < length; i++) {
        if (walk[i].t_out == 0) /* begun on a plane and gone at once: nothing to see */
            continue;
        visited--;
        cell_box box = block_cell(b, (long)walk[i].cell, samples);
        assert_true(cell_visit_of(r, &box, &visit));
        double cubic[4] = {NAN, NAN, NAN, NAN};
        bool active = cell_cubic(&visit, samples, b->f.iso, cubic);
        if (active && !isnan(exit_value))
            assert_true(cubic[0] == exit_value);
        exit_value = active ? cubic[3] : NAN;
    }
    assert_int_equal(visited, 0);
}

/* Whether the number of surfaces hangs on the last bits: a ray that passes the surface's edge,
 * within rounding. */
static bool on_the_edge(const block *b, const ref_ray *line, size_t truth) {
    ref_hit hits[ROOTS_MAX];
    double less = b->f.iso * (1 - 1e-14), more = b->f.iso * (1 + 1e-14);
    return ref_trace(&b->v, line, &less, 1, NULL, hits, ROOTS_MAX) != truth ||
           ref_trace(&b->v, line, &more, 1, NULL, hits, ROOTS_MAX) != truth;
}

static ref_verdict judge_block(ref_tally *tally, const block *b, const ref_ray *line, bool aimed,
                               uint64_t index) {
    ref_visit walk[64];
    ref_hit hits[ROOTS_MAX];
    double t[ROOTS_MAX];
    ray r = kernel_ray(line->o, line->d);
    if (!aimed) { /* aimed at a grid point, planes are crossed in an order that depends on the last
                     bit */
        size_t length = ref_visits(&b->v, line, NULL, walk, 64);
        assert_true(length <= 64);
        check_walk(b, &r, walk, length);
    }
    size_t truth = ref_trace(&b->v, line, &b->f.iso, 1, NULL, hits, ROOTS_MAX);
    assert_true(truth < ROOTS_MAX);
    int count = block_roots(b, &r, t);
    bool ask = index % SAMPLED == 0 || count != (int)truth;
    for (int i = 0; !ask && i < count; i++)
        ask = fabs(t[i] - hits[i].t) * hits[i].cells_per_t > REF_GRAZING_CHANGE / 2;
    bool grazing = ask && (ref_grazing(&b->v, line, &b->f.iso, 1, NULL, ROOTS_MAX) ||
                           (aimed && on_the_edge(b, line, truth)));
    return ref_judge_roots(tally, hits, (int)truth, t, count, grazing);
}

/* Random rays, rays aimed at grid points, and exact lines in planes, along edges and through
 * vertices; from outside and from inside. */
static ref_ray block_ray(const block *b, field_random *r, uint64_t i, bool *aimed) {
    double margin = i & 1 ? 4 : -0.2;
    int kind = b->f.axis[0] ? 0 : (int)(i >> 1 & 3);
    *aimed = kind == 1;
    if (kind < 2)
        return *aimed ? field_aimed_ray(&b->v, r, margin) : field_random_ray(&b->v, r, margin);
    ref_ray line = field_exact_ray(&b->v, r);
    for (int a = 0; margin < 0 && a < 3; a++)
        line.o[a] += 64 * line.d[a]; /* begin on the grid */
    return line;
}

static void blocks_agree(void **state) {
    (void)state;
    const char *const names[] = {"noise-f32", "noise-u8", "plateau",    "terraces",
                                 "checker",   "waves",    "rectilinear"};
    uint64_t count = stress_count() / 10, faults = 0;
    ref_tally_heading(stderr, "block of cells");
    for (size_t n = 0; n < sizeof names / sizeof names[0]; n++) {
        block b;
        ref_tally tally = {0};
        field_random r = {SEED + n};
        block_make(&b, names[n], SEED + n);
        for (uint64_t i = 0; i < count; i++) {
            bool aimed;
            ref_ray line = block_ray(&b, &r, i, &aimed);
            ref_verdict verdict = judge_block(&tally, &b, &line, aimed, i);
            if (verdict != REF_SAME && verdict != REF_GRAZING)
                fprintf(stderr, "%s: %s, ray %llu\n", ref_verdict_name(verdict), names[n],
                        (unsigned long long)i);
        }
        ref_tally_row(stderr, names[n], &tally);
        faults += ref_tally_faults(&tally);
        field_release(&b.f);
    }
    if (faults)
        fail_msg("%llu faults", (unsigned long long)faults);
}

/* Rays that pass grid points to within rounding, among samples that are mostly the isovalue. */
static void faces_of_one_side_keep_it(void **state) {
    (void)state;
    const char *const names[] = {"plateau", "terraces"};
    for (size_t n = 0; n < sizeof names / sizeof names[0]; n++) {
        block b;
        field_random r = {SEED + n};
        block_make(&b, names[n], SEED + n);
        for (uint64_t i = 0; i < 2 * stress_count(); i++) {
            ref_ray line = field_aimed_ray(&b.v, &r, i & 1 ? 4 : -0.2);
            ray k = kernel_ray(line.o, line.d);
            double t[ROOTS_MAX];
            block_roots(&b, &k, t);
        }
        field_release(&b.f);
    }
}

int main(int argc, char **argv) {
    if (argc == 4 && ray_cell_case(argv[1]) >= 0) {
        ray_cell c;
        ray_cell_make(ray_cell_case(argv[1]), strtoull(argv[2], NULL, 10),
                      strtoull(argv[3], NULL, 10), &c);
        show_cell(&c);
        return 0;
    }
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_case_agrees),
        cmocka_unit_test(blocks_agree),
        cmocka_unit_test(faces_of_one_side_keep_it),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
