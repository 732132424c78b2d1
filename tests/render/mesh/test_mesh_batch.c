/* test_mesh_batch.c - rays of all sorts through meshes in batches: each has the answer of
 * tracer_next() to the bit, whatever goes with it, the ISA, the isovalues, the treelets and which
 * of them are there. */
/* marks: long */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "render/walk/tree_passage.h"
#include "tests/support/batch_stage.h"
#include "tests/support/fixture.h"
#include "tests/support/lab_leaf.h"
#include "tests/support/mesh_batch_wide.h"

#ifdef __SANITIZE_ADDRESS__
enum { CUBES = 4, BATCHES = 6 };
#else
enum { CUBES = 6, BATCHES = 24 };
#endif

enum { ISOVALUES = 3 };

static lab_mesh lab;

static void line_of_lab(const void *of, field_random *random, double o[3], double d[3]) {
    const lab_ray sort = (lab_ray)field_random_below(random, LAB_RAY_KINDS);
    const ref_ray w = lab_mesh_ray(of, sort, random);
    memcpy(o, w.o, sizeof w.o);
    memcpy(d, w.d, sizeof w.d);
}

static void stage_open(batch_stage *s, const char *name, uint32_t treelet_tets, int isovalues,
                       bool smooth) {
    leafcast_surface surfaces[ISOVALUES];
    assert_true(lab_mesh_make(&lab, name, CUBES, 7));
    *s = (batch_stage){.name = name, .wide = mesh_batch_wide, .line = line_of_lab, .lab = &lab};
    for (int a = 0; a < 3; a++)
        s->size[a] = lab.hi[a] - lab.lo[a];
    s->v = fixture_open(lab_leaf_make(&lab, treelet_tets, smooth), NULL);
    for (int i = 0; i < isovalues; i++)
        surfaces[i] = leafcast_surface_default(lab.iso + 0.1 * i * fabs(lab.iso));
    batch_stage_set(s, surfaces, isovalues, smooth);
}

static void stage_close(batch_stage *s) {
    batch_stage_close(s);
    lab_mesh_release(&lab);
}

/* ---- Tests ---- */

static void test_every_mesh(void **state) {
    (void)state;
    static ray_batch b;
    uint64_t rays = 0, hits = 0;
    for (int i = 0; i < lab_mesh_count(); i++) {
        batch_stage s;
        stage_open(&s, lab_mesh_name(i), i % 2 ? 300 : 60, 1 + i % ISOVALUES, i % 4 == 3);
        batch_stage_load(&s, true);
        for (int n = 0; n < BATCHES; n++) {
            batch_stage_fill(&s, &b);
            batch_stage_check(&s, &b, true);
        }
        rays += s.rays;
        hits += s.hits;
        assert_int_equal(s.blocked, 0);
        stage_close(&s);
    }
    print_message("%llu rays, %llu hits\n", (unsigned long long)rays, (unsigned long long)hits);
    assert_true(hits > rays / 8);
}

/* The same results while treelets are absent, and what single rays have left is gone on with. */
static void test_absent_treelets(void **state) {
    (void)state;
    static const char *const names[] = {"sphere", "noise-jittered", "flat", "far", "tangled"};
    static ray_batch b, left;
    uint64_t blocked = 0;
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        batch_stage s;
        stage_open(&s, names[i], 50, 1 + (int)i % ISOVALUES, false);
        for (int n = 0; n < 2 * BATCHES; n++) {
            batch_stage_load(&s, true);
            batch_stage_fill(&s, &b);
            batch_stage_load(&s, false);
            batch_stage_check(&s, &b, false);
            batch_stage_single(&s, &b, &left);
            for (unsigned k = 0; k < left.count; k++)
                if (left.results[k] == TRACE_BLOCKED)
                    b.states[k] = left.states[k];
            batch_stage_load(&s, n % 2 == 0);
            batch_stage_check(&s, &b, n % 2 == 0);
        }
        blocked += s.blocked;
        stage_close(&s);
    }
    print_message("%llu rays waited\n", (unsigned long long)blocked);
    assert_true(blocked > 1000);
}

/* A preview draws what is there. */
static void test_preview(void **state) {
    (void)state;
    static ray_batch b;
    batch_stage s;
    stage_open(&s, "noise", 50, 1, false);
    for (int n = 0; n < BATCHES; n++) {
        s.tr.preview = false;
        batch_stage_load(&s, true);
        batch_stage_fill(&s, &b);
        batch_stage_load(&s, false);
        s.tr.preview = true;
        for (unsigned i = 0; i < b.count; i++)
            b.states[i].any = false;
        batch_stage_check(&s, &b, false);
    }
    stage_close(&s);
}

/* Boxes in boxes begin no earlier, also where t is below 0: so no treelet is left out. */
static void test_passages(void **state) {
    (void)state;
    batch_stage s;
    stage_open(&s, "noise-jittered", 50, 1, false);
    const treelet_tree *tree = s.v->treelets->tree;
    const hit before = hit_before_all();
    for (int n = 0; n < 500 * BATCHES; n++) {
        tree_passages passages;
        tree_passage at = {-INFINITY, 0};
        ray_counters counters = {0};
        uint32_t passed = 0, meets = 0;
        ray r;
        if (!batch_stage_ray(&s, &r))
            continue;
        r.t0 = -INFINITY;
        const box_line slabs = box_line_of(&r);
        for (uint32_t t = 0; t < s.treelets; t++) {
            const float *b = tree->bounds[0][t];
            box_interval in;
            meets += tree->active[0][t] && box_interval_in(&slabs, (double[3]){b[0], b[1], b[2]},
                                                           (double[3]){b[3], b[4], b[5]}, &in);
        }
        tree_passages_begin(&passages, tree, &r, &before, &counters);
        while ((at = tree_passages_next(&passages, at, INFINITY)).t != LEAF_NO_TREELET)
            passed++;
        assert_int_equal(passed, meets);
    }
    stage_close(&s);
}

/* Rays do not meet the isopolygon that they are said to begin on, which they would meet else. */
static void test_origins(void **state) {
    (void)state;
    ray_counters counters = {0};
    int begun = 0, met = 0;
    batch_stage s;
    stage_open(&s, "noise", 300, 2, false);
    batch_stage_load(&s, true);
    for (int i = 0; i < 4000; i++) {
        const hit before = hit_before_all();
        trace_state all = trace_begin(&before), some;
        ray r;
        if (!batch_stage_secondary(&s, &r, &some) || some.origin_iso < 0 ||
            some.after.t > -INFINITY)
            continue;
        all.best = some.best = hit_from(1e-12);
        begun++;
        if (tracer_next(&s.tr, &r, &all, &counters) == TRACE_HIT)
            met += all.best.cell == some.origin && all.best.iso == some.origin_iso;
        if (tracer_next(&s.tr, &r, &some, &counters) == TRACE_HIT)
            assert_false(some.best.cell == some.origin && some.best.iso == some.origin_iso);
    }
    print_message("%d of %d rays would meet it\n", met, begun);
    assert_true(begun > 100 && met > begun / 10);
    stage_close(&s);
}

/* A batch of neighbours visits fewer nodes than its rays do one by one. */
static void test_together(void **state) {
    (void)state;
    static ray_batch b;
    batch_stage s;
    stage_open(&s, "sphere", 300, 1, false);
    batch_stage_load(&s, true);
    b.count = RAY_BATCH;
    for (unsigned i = 0; i < RAY_BATCH; i++) {
        const hit before = hit_before_all();
        const double size = lab.hi[0] - lab.lo[0];
        const double o[3] = {lab.lo[0] - size, lab.lo[1] + size * (0.5 + 0.002 * (double)(i % 16)),
                             lab.lo[2] + size * (0.5 + 0.002 * (double)(i / 16))};
        const double d[3] = {1.0, 0.01, 0.02};
        assert_true(tracer_ray(&s.tr, o, d, 0.0, INFINITY, &b.rays[i]));
        b.states[i] = trace_begin(&before);
    }
    batch_stage_check(&s, &b, true);
    assert_true(batch_stage_together(&s, &b) > 20.0);
    stage_close(&s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_every_mesh), cmocka_unit_test(test_absent_treelets),
        cmocka_unit_test(test_preview),    cmocka_unit_test(test_passages),
        cmocka_unit_test(test_origins),    cmocka_unit_test(test_together),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
