/* test_curvilinear_walk.c - hits, pieces and points of a treelet of a curvilinear grid: what the
 * exact cell says of one cell after the other, to the bit.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "formats/base/vec3.h"
#include "formats/curved/hex_point.h"
#include "render/curved/curved_meet.h"
#include "render/curved/hex_pieces.h"
#include "render/curvilinear/curvilinear_walk.h"
#include "tests/support/curvilinear_lab.h"
#include "tests/support/watched.h"

static mem m;
static curvilinear_lab lab;

static const double values[] = {-0.4, 0.0, 0.35};
static const isovalue_list isos = {3, values};

static bool has(const hexahedron *h, double isovalue) {
    double lo = INFINITY, hi = -INFINITY;
    for (int c = 0; c < HEX_CORNERS; c++) {
        if (!isfinite(h->value[c]))
            return false;
        lo = fmin(lo, h->value[c]);
        hi = fmax(hi, h->value[c]);
    }
    return lo < isovalue && isovalue <= hi;
}

/* What the selection is to say of a cell. */
static bool is_active(const curvilinear_lattice *l, uint32_t cell) {
    const hexahedron h = curvilinear_walk_cell(l, cell);
    bool meets = false;
    for (int i = 0; i < isos.count; i++)
        meets = meets || has(&h, isos.isovalues[i]);
    return meets && curvilinear_lattice_code(l, cell) != HEX_NONE;
}

static int sense_of(const curvilinear_lattice *l, uint32_t cell) {
    switch (curvilinear_lattice_code(l, cell)) {
    case HEX_RIGHT: return 1;
    case HEX_LEFT: return -1;
    default: return 0;
    }
}

/* ---- The lattice ---- */

static void test_lattice(void **state) {
    (void)state;
    const interest in = interest_of_isovalues(isos.isovalues, isos.count);
    for (int n = 0; n < curvilinear_lab_count(); n++) {
        curvilinear_lab_make(&lab, &m, n);
        const curvilinear_lattice *l = &lab.lattice;
        /* but for what each of three blocks is rounded up by */
        assert_in_range(mem_peak(&m), 1, curvilinear_lattice_bytes(l->cells) + 3 * 128);
        uint32_t seen = 0, active = 0, none = 0;
        static bool met[CURVILINEAR_LAB_NODES];
        memset(met, 0, sizeof met);
        curvilinear_lattice_select(&lab.lattice, &in);
        for (uint32_t b = 0; b < l->blocks; b++) {
            const curvilinear_place *p = &l->places[b];
            assert_int_equal(l->tree.active[0][b], l->active[b] != 0);
            for (unsigned bit = 0; bit < 64; bit++) {
                const bool on = l->active[b] >> bit & 1;
                if ((bit & 3) >= p->cells[0] || (bit >> 2 & 3) >= p->cells[1] ||
                    bit >> 4 >= p->cells[2]) {
                    assert_false(on);
                    continue;
                }
                const uint32_t cell = curvilinear_lattice_cell(l, p, bit);
                assert_false(met[cell]);
                met[cell] = true;
                assert_int_equal(on, is_active(l, cell));
                seen++;
                active += on;
                none += curvilinear_lattice_code(l, cell) == HEX_NONE;
            }
        }
        assert_int_equal(seen, lab.count);
        assert_true(active > 0 && (lab.count < 100 || active < seen));
        assert_true(n == 0 || lab.count < 100 || none > 0);
        curvilinear_lab_free(&lab);
        assert_int_equal(mem_used(&m), 0);
        mem_init(&m, 0);
    }
}

/* ---- Hits ---- */

enum { HITS = 4096 };

typedef struct hit_list {
    int count;
    hit of[HITS];
} hit_list;

static int by_hit(const void *a, const void *b) {
    return hit_less(a, b) ? -1 : hit_less(b, a);
}

static void all_hits(const curvilinear_lattice *l, const ray *r, hit_list *out) {
    const sheared_ray sheared = sheared_ray_of(r->o, r->d);
    out->count = 0;
    for (uint32_t c = 0; c < lab.count; c++) {
        if (!is_active(l, c))
            continue;
        const curved_cell cell = {
            .quadratic = false, .hexahedron = curvilinear_walk_cell(l, c), .sense = sense_of(l, c)};
        for (int i = 0; i < isos.count; i++) {
            path_root roots[PATH_ROOTS];
            if (!has(&cell.hexahedron, isos.isovalues[i]))
                continue;
            const int count = curved_meet_roots(&cell, &sheared, isos.isovalues[i], roots, NULL);
            for (int k = 0; k < count; k++)
                if (roots[k].t >= r->t0 && roots[k].t <= r->t1) {
                    assert_true(out->count < HITS);
                    out->of[out->count++] = (hit){roots[k].t, l->first + c, i, roots[k].entering};
                }
        }
    }
    qsort(out->of, (size_t)out->count, sizeof *out->of, by_hit);
}

static void same_hits(const curvilinear_lattice *l, const ray *r, int isa, const hit_list *all) {
    hit after = hit_before_all();
    for (int n = 0; n <= all->count; n++) {
        trace_state s = trace_begin(&after);
        ray_counters counters = {0};
        path_counts counts = {0};
        const bool found =
            curvilinear_walk_hits(l, hex_block_cells[isa], &isos, r, &s, &counters, &counts);
        assert_int_equal(found, n < all->count);
        if (!found)
            return;
        assert_true(s.best.t == all->of[n].t && s.best.cell == all->of[n].cell &&
                    s.best.iso == all->of[n].iso && s.best.entering == all->of[n].entering);
        assert_true(counters.cells > 0);
        /* The value goes the way that the hit says, along the gradient. */
        double along = 0.0;
        for (int a = 0; a < 3; a++)
            along += s.point.gradient[a] * r->d[a];
        assert_true(s.point.error > 0.0 && s.point.span > 0.0);
        const double size = vec3_length(s.point.gradient) * vec3_length(r->d);
        if (sense_of(l, (uint32_t)(s.best.cell - l->first)) != 0 && fabs(along) > 1e-6 * size)
            assert_int_equal(along > 0.0, s.best.entering);
        after = s.best;
    }
}

/* One hit after the other is what all cells have, in order. */
static void test_hits(void **state) {
    enum { RAYS = SLOW ? 30 : 400 };
    (void)state;
    static hit_list all;
    const interest in = interest_of_isovalues(isos.isovalues, isos.count);
    for (int n = 0; n < curvilinear_lab_count(); n++) {
        field_random random = {FIELD_SEED + (uint64_t)n};
        long hits = 0;
        curvilinear_lab_make(&lab, &m, n);
        curvilinear_lattice_select(&lab.lattice, &in);
        for (int i = 0; i < RAYS; i++) {
            const ray r = curvilinear_lab_ray(&lab, &random);
            all_hits(&lab.lattice, &r, &all);
            for (int isa = 0; isa <= (int)cpu_best(); isa++)
                same_hits(&lab.lattice, &r, isa, &all);
            hits += all.count;
        }
        print_message("# %-16s %ld hits of %d rays\n", lab.name, hits, RAYS);
        assert_true(hits > (lab.count < 20 ? 0 : RAYS / 4));
        curvilinear_lab_free(&lab);
    }
}

/* Any hit is one of them, and is looked for no further. */
static void test_any(void **state) {
    enum { RAYS = SLOW ? 50 : 500 };
    (void)state;
    static hit_list all;
    const interest in = interest_of_isovalues(isos.isovalues, isos.count);
    uint64_t cells[2] = {0, 0};
    field_random random = {FIELD_SEED};
    curvilinear_lab_make(&lab, &m, 1);
    curvilinear_lattice_select(&lab.lattice, &in);
    for (int i = 0; i < RAYS; i++) {
        const ray r = curvilinear_lab_ray(&lab, &random);
        const hit before = hit_before_all();
        all_hits(&lab.lattice, &r, &all);
        for (int any = 0; any < 2; any++) {
            trace_state s = trace_begin(&before);
            ray_counters counters = {0};
            s.any = any;
            assert_int_equal(curvilinear_walk_hits(&lab.lattice, hex_block_cells[cpu_best()], &isos,
                                                   &r, &s, &counters, NULL),
                             all.count > 0);
            cells[any] += counters.cells;
            bool found = all.count == 0;
            for (int k = 0; k < all.count; k++)
                found = found || (!hit_less(&all.of[k], &s.best) && !hit_less(&s.best, &all.of[k]));
            assert_true(found);
        }
    }
    assert_true(cells[1] < cells[0]);
    curvilinear_lab_free(&lab);
}

/* ---- Pieces ---- */

typedef struct piece_list {
    int count;
    segment of[HITS];
} piece_list;

static void take(void *ctx, const segment *piece) {
    piece_list *list = ctx;
    assert_true(list->count < HITS);
    list->of[list->count++] = *piece;
}

/* Where the pieces of a cell begin; they lie together. */
static int first_of(const piece_list *list, uint64_t number) {
    int n = 0;
    while (n < list->count && list->of[n].cell != number)
        n++;
    return n;
}

static void test_pieces(void **state) {
    enum { RAYS = SLOW ? 20 : 200 };
    (void)state;
    static piece_list all;
    const interest in = interest_of_isovalues(isos.isovalues, isos.count);
    const double above = 0.125, tolerance = 1e-6;
    const hit before = hit_before_all();
    for (int n = 0; n < curvilinear_lab_count(); n++) {
        field_random random = {FIELD_SEED + (uint64_t)n};
        const curvilinear_lattice *l = &lab.lattice;
        long pieces = 0;
        curvilinear_lab_make(&lab, &m, n);
        curvilinear_lattice_select(&lab.lattice, &in);
        for (int i = 0; i < RAYS; i++) {
            const ray r = curvilinear_lab_ray(&lab, &random);
            const sheared_ray sheared = sheared_ray_of(r.o, r.d);
            ray_counters counters = {0};
            all.count = 0;
            curvilinear_walk_pieces(l, hex_block_cells[cpu_best()], above, tolerance, &r, &before,
                                    INFINITY, take, &all, &counters, NULL);
            int seen = 0;
            for (uint32_t c = 0; c < lab.count; c++) {
                hexahedron h = curvilinear_walk_cell(l, c);
                hex_path path;
                path_piece out[PATH_PIECES];
                for (int k = 0; k < HEX_CORNERS; k++)
                    h.value[k] -= above;
                if (!is_active(l, c) || hex_path_of(&h, sense_of(l, c), &sheared, &path) == 0)
                    continue;
                const int count = hex_pieces(&h, sense_of(l, c), &path, tolerance, out, NULL);
                int at = first_of(&all, l->first + c);
                for (int k = 0; k < count; k++) {
                    const double t0 = fmax(out[k].t[0], r.t0), t1 = fmin(out[k].t[1], r.t1);
                    if (!(t0 < t1))
                        continue;
                    assert_true(at < all.count);
                    const segment *s = &all.of[at++];
                    seen++;
                    assert_true(s->cell == l->first + c && s->t0 == t0 && s->t1 == t1);
                    if (t0 == out[k].t[0] && t1 == out[k].t[1])
                        assert_memory_equal(s->b, out[k].b, sizeof s->b);
                }
            }
            assert_int_equal(seen, all.count);
            pieces += seen;
        }
        assert_true(pieces > (lab.count < 20 ? 0 : RAYS));
        curvilinear_lab_free(&lab);
    }
}

/* ---- Points ---- */

/* A point of a cell, by the cell's own map, has the cell's value there; in a folded cell it is
 * somewhere. Far away there is none. */
static void test_points(void **state) {
    enum { POINTS = SLOW ? 200 : 4000 };
    (void)state;
    for (int n = 0; n < curvilinear_lab_count(); n++) {
        field_random random = {FIELD_SEED + (uint64_t)n};
        const curvilinear_lattice *l = &lab.lattice;
        long found = 0, same = 0;
        curvilinear_lab_make(&lab, &m, n);
        for (int i = 0; i < POINTS; i++) {
            const uint32_t cell = (uint32_t)field_random_below(&random, (long)lab.count);
            const hexahedron h = curvilinear_walk_cell(l, cell);
            double at[3], point[3];
            for (int a = 0; a < 3; a++)
                at[a] = field_random_unit(&random);
            for (int a = 0; a < 3; a++) {
                double p[HEX_CORNERS];
                for (int c = 0; c < HEX_CORNERS; c++)
                    p[c] = h.p[c][a];
                point[a] = hexahedron_at(p, at);
            }
            leafcast_sample s = {.inside = false};
            const bool is_in = curvilinear_walk_point(l, point, &s);
            assert_int_equal(is_in, s.inside);
            found += is_in;
            assert_true(!is_in ||
                        curvilinear_lattice_code(l, (uint32_t)(s.cell - l->first)) != HEX_NONE);
            if (!is_in || s.cell != l->first + cell)
                continue;
            same++;
            if (sense_of(l, cell) != 0 && isfinite(s.value))
                assert_true(fabs(s.value - hexahedron_at(h.value, at)) < 1e-5);
        }
        /* Not in blanked cells; and where cells are folded, others may lie there, too. */
        assert_true(found > POINTS * 9 / 10 && same > found / 2);
        double far[3];
        for (int a = 0; a < 3; a++)
            far[a] = 3.0 * (double)lab.box[1][a] - 2.0 * (double)lab.box[0][a];
        leafcast_sample s = {.inside = false};
        assert_false(curvilinear_walk_point(l, far, &s) || s.inside);
        curvilinear_lab_free(&lab);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_lattice), cmocka_unit_test(test_hits),   cmocka_unit_test(test_any),
        cmocka_unit_test(test_pieces),  cmocka_unit_test(test_points),
    };
    mem_init(&m, 0);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
