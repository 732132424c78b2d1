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

#include "render/door/leafcast_volume.h"
#include "render/ray/kind.h"
#include "render/walk/tree_passage.h"
#include "tests/support/fixture.h"
#include "tests/support/lab_leaf.h"
#include "tests/support/mesh_batch_wide.h"

#ifdef __SANITIZE_ADDRESS__
enum { CUBES = 4, BATCHES = 6 };
#else
enum { CUBES = 6, BATCHES = 24 };
#endif

enum { KERNELS_MAX = 5, ISOVALUES = 3 };

typedef struct stage {
    const char *name;
    lab_mesh lab;
    leafcast *v;
    tracer tr;
    const char *kernel_name[KERNELS_MAX];
    ray_kernels kernels[KERNELS_MAX];
    int kernel_count;
    uint32_t treelets;
    uint8_t *walked; /* by single rays */
    void *scratch;
    field_random random;
    uint64_t rays, hits, blocked;
} stage;

/* ---- The stage ---- */

static void find_kernels(stage *s) {
    s->kernel_count = 0;
    for (int isa = 1; isa <= (int)cpu_best(); isa++) {
        s->kernels[s->kernel_count] = ray_kernels_of(s->v->kind, (cpu_isa)isa);
        s->kernel_name[s->kernel_count++] = cpu_isa_name((cpu_isa)isa);
    }
    s->kernels[s->kernel_count] = ray_kernels_of(s->v->kind, CPU_SCALAR);
    s->kernels[s->kernel_count].batch = mesh_batch_wide;
    s->kernel_name[s->kernel_count++] = "wide";
}

static void stage_open(stage *s, const char *name, uint32_t treelet_tets, int isovalues,
                       bool smooth) {
    static leafcast_scene scene;
    leafcast_surface surfaces[ISOVALUES];
    *s = (stage){.name = name, .random = {17}};
    assert_true(lab_mesh_make(&s->lab, name, CUBES, 7));
    s->v = fixture_open(lab_leaf_make(&s->lab, treelet_tets, smooth), NULL);
    for (int i = 0; i < isovalues; i++)
        surfaces[i] = leafcast_surface_default(s->lab.iso + 0.1 * i * fabs(s->lab.iso));
    scene = leafcast_scene_default();
    scene.smooth_normals = smooth;
    assert_int_equal(leafcast_select(s->v, surfaces, isovalues), LEAFCAST_OK);
    volume_show(s->v, 0, 0, surfaces, isovalues);
    assert_int_equal(volume_tracer(s->v, &scene, NULL, &s->tr), ST_OK);
    s->treelets = s->v->file->layout.treelets;
    s->walked = calloc(s->treelets, 1);
    s->scratch = aligned_alloc(64, (kind_batch_scratch(s->v->kind) + 63) / 64 * 64);
    assert_non_null(s->walked);
    assert_non_null(s->scratch);
    find_kernels(s);
}

static void stage_close(stage *s) {
    leafcast_close(s->v);
    lab_mesh_release(&s->lab);
    free(s->walked);
    free(s->scratch);
}

/* Some of the active treelets are there, or all. */
static void load(stage *s, bool all) {
    loader_clear(s->v->treelets);
    loader_set_capacity(s->v->treelets, s->treelets, 0);
    for (uint32_t t = 0; t < s->treelets; t++) {
        const treelet *at;
        if (s->v->treelets->tree->active[0][t] && (all || field_random_below(&s->random, 2)))
            assert_int_equal(volume_treelet(s->v, t, &at), ST_OK);
    }
}

/* ---- Rays ---- */

/* A ray of the laboratory, of some length, cut somehow. */
static bool random_ray(stage *s, ray *r) {
    field_random *random = &s->random;
    const lab_ray sort = (lab_ray)field_random_below(random, LAB_RAY_KINDS);
    ref_ray w = lab_mesh_ray(&s->lab, sort, random);
    double t0 = 0.0, t1 = INFINITY, stretch = 1.0;
    switch (field_random_below(random, 8)) {
    case 0: stretch = 1e-20; break;
    case 1: stretch = 1e20; break;
    case 2: stretch = 3.7; break;
    case 3: t1 = field_random_in(random, 0.0, 2.0); break;
    case 4:
        t0 = field_random_in(random, 0.0, 1.0);
        t1 = t0 + field_random_in(random, 0.0, 1.0);
        break;
    case 5: t0 = -1e300; break;
    default: break;
    }
    for (int a = 0; a < 3; a++)
        w.d[a] *= stretch;
    return tracer_ray(&s->tr, w.o, w.d, t0 / stretch, t1 / stretch, r);
}

/* Beside a ray, a little turned or moved, or not at all. */
static ray neighbour_of(stage *s, const ray *r) {
    ray n = *r;
    const long what = field_random_below(&s->random, 4);
    for (int a = 0; a < 3; a++) {
        const double size = s->lab.hi[a] - s->lab.lo[a];
        if (what & 1)
            n.o[a] += field_random_in(&s->random, -0.02, 0.02) * size;
        if (what & 2)
            n.d[a] *= 1.0 + field_random_in(&s->random, -0.02, 0.02);
    }
    return n;
}

/* From a surface that it meets towards somewhere, as shadows and mirrors begin: behind the
 * surface's own error; or where it is, but not looking at the isopolygon there again; or both. */
static bool secondary_ray(stage *s, ray *r, trace_state *state) {
    const hit before = hit_before_all();
    ray_counters counters = {0};
    double o[3], d[3];
    *state = trace_begin(&before);
    if (!random_ray(s, r) || tracer_next(&s->tr, r, state, &counters) != TRACE_HIT)
        return false;
    double slope = 0.0;
    for (int a = 0; a < 3; a++) {
        o[a] = r->o[a] + state->best.t * r->d[a];
        d[a] = field_random_in(&s->random, -1.0, 1.0);
        slope += state->point.gradient[a] * d[a];
    }
    const double error = state->point.error / fabs(slope), span = state->point.span;
    const hit behind = hit_behind(error <= span ? error : span), surface = state->best;
    const long how = field_random_below(&s->random, 3);
    *state = trace_begin(how == 1 ? &before : &behind);
    if (how > 0) {
        state->origin = surface.cell;
        state->origin_iso = surface.iso;
    }
    return isfinite(o[0] + o[1] + o[2]) && tracer_ray(&s->tr, o, d, 0.0, INFINITY, r);
}

static trace_state random_state(stage *s, const ray *r) {
    hit after = hit_before_all();
    trace_state state = trace_begin(&after);
    ray_counters counters = {0};
    /* Behind some hits, as far as the treelets are there. */
    for (long n = field_random_below(&s->random, 4); n > 1; n--) {
        if (tracer_next(&s->tr, r, &state, &counters) != TRACE_HIT)
            break;
        after = state.best;
        state = trace_begin(&after);
    }
    state = trace_begin(&after);
    if (field_random_below(&s->random, 4) == 0) {
        (void)tracer_next(&s->tr, r, &state, &counters);
        const hit bound = state.best;
        state = trace_begin(&after);
        /* At the next hit, or somewhat before or behind it. */
        if (hit_exists(&bound))
            state.best =
                hit_from(bound.t * (1.0 + 0.1 * (double)(field_random_below(&s->random, 3) - 1)));
    }
    return state;
}

static void fill_batch(stage *s, ray_batch *b) {
    const bool together = field_random_below(&s->random, 2);
    b->count = field_random_below(&s->random, 4)
                   ? RAY_BATCH
                   : 1 + (unsigned)field_random_below(&s->random, RAY_BATCH);
    for (unsigned i = 0; i < b->count; i++) {
        const bool begin_on_surface = field_random_below(&s->random, 3) == 0;
        ray *r = &b->rays[i];
        if (together && i > 0 && i % 64 != 0) {
            *r = neighbour_of(s, &b->rays[i - 1]);
            b->states[i] = random_state(s, r);
        } else if (!begin_on_surface || !secondary_ray(s, r, &b->states[i])) {
            while (!random_ray(s, r))
                ;
            b->states[i] = random_state(s, r);
        }
        b->states[i].any = field_random_below(&s->random, 3) == 0;
    }
}

/* ---- The same answers ---- */

/* Whether the ray has this hit, as one of all that it has. */
static bool has_hit(const stage *s, const ray *r, const trace_state *begun, const hit *h) {
    trace_state state = *begun;
    ray_counters counters = {0};
    state.any = false;
    while (tracer_next(&s->tr, r, &state, &counters) == TRACE_HIT && !hit_is_bound(&state.best)) {
        if (state.best.t == h->t && state.best.iso == h->iso && state.best.entering == h->entering)
            return true;
        const hit behind = state.best;
        state = trace_begin(&behind);
        state.best = begun->best;
    }
    return false;
}

static bool same_hit(const hit *a, const hit *b) {
    return a->t == b->t && a->cell == b->cell && a->iso == b->iso && a->entering == b->entering;
}

static bool same_point(const surface_point *a, const surface_point *b) {
    return memcmp(a->gradient, b->gradient, sizeof a->gradient) == 0 &&
           memcmp(a->normal, b->normal, sizeof a->normal) == 0 &&
           memcmp(&a->error, &b->error, sizeof a->error) == 0 &&
           memcmp(&a->span, &b->span, sizeof a->span) == 0;
}

/* Of a ray that looks for any hit: one that it has; one more treelet may be needed for it alone. */
static bool any_agrees(const stage *s, const ray *r, const trace_state *begun, trace_result want,
                       trace_result got, const trace_state *state, bool all) {
    if (got != TRACE_HIT)
        return got == want;
    if (want == TRACE_MISS || (all && want != TRACE_HIT))
        return false;
    return !all || hit_is_bound(&state->best) || has_hit(s, r, begun, &state->best);
}

static bool agrees(const stage *s, const ray *r, const trace_state *begun, trace_result want,
                   const trace_state *wanted, trace_result got, const trace_state *state,
                   bool all) {
    if (begun->any)
        return any_agrees(s, r, begun, want, got, state, all);
    return want == got && same_hit(&wanted->best, &state->best) &&
           same_point(&wanted->point, &state->point) && wanted->t_from == state->t_from &&
           wanted->blocked == state->blocked && wanted->provisional == state->provisional;
}

static void clear_touched(const stage *s) {
    for (uint32_t t = 0; t < s->treelets; t++)
        atomic_store(&s->tr.touched[t], 0);
}

static void trace_single(stage *s, const ray_batch *begun, ray_batch *want) {
    ray_counters counters = {0};
    *want = *begun;
    clear_touched(s);
    for (unsigned i = 0; i < want->count; i++) {
        ray_batch_single(&s->tr, want, i, &counters);
        s->rays++;
        s->hits += want->results[i] == TRACE_HIT;
        s->blocked += want->results[i] == TRACE_BLOCKED;
    }
}

/* Every ray, of which none looks for just any hit: what it walked alone was walked. */
static void check_touched(const stage *s, const ray_batch *begun) {
    for (unsigned i = 0; i < begun->count; i++)
        if (begun->states[i].any)
            return;
    for (uint32_t t = 0; t < s->treelets; t++)
        assert_true(!s->walked[t] || atomic_load(&s->tr.touched[t]));
}

static void fail_answer(const stage *s, int kernel, const ray_batch *begun, unsigned i,
                        const ray_batch *want, const ray_batch *got) {
    const ray *r = &begun->rays[i];
    const hit *after = &begun->states[i].after, *best = &begun->states[i].best;
    const hit *wanted = &want->states[i].best, *found = &got->states[i].best;
    fail_msg("%s, %s, ray %u of %u: %d at %.17g, tet %llu, not %d at %.17g, tet %llu; from %.17g "
             "%.17g %.17g along %.17g %.17g %.17g, t %g to %g, behind %.17g, before %.17g, any %d",
             s->name, s->kernel_name[kernel], i, begun->count, got->results[i], found->t,
             (unsigned long long)found->cell, want->results[i], wanted->t,
             (unsigned long long)wanted->cell, r->o[0], r->o[1], r->o[2], r->d[0], r->d[1], r->d[2],
             r->t0, r->t1, after->t, best->t, begun->states[i].any);
}

static void check_batch(stage *s, const ray_batch *begun, bool all) {
    static ray_batch want, got;
    trace_single(s, begun, &want);
    for (uint32_t t = 0; t < s->treelets; t++)
        s->walked[t] = atomic_load(&s->tr.touched[t]);
    for (int k = 0; k < s->kernel_count; k++) {
        ray_counters counters = {0};
        got = *begun;
        clear_touched(s);
        memset(s->scratch, 0xff, kind_batch_scratch(s->v->kind));
        s->tr.kernels = &s->kernels[k];
        ray_batch_next(&s->tr, &got, s->scratch, &counters);
        check_touched(s, begun);
        for (unsigned i = 0; i < begun->count; i++)
            if (!agrees(s, &begun->rays[i], &begun->states[i], want.results[i], &want.states[i],
                        got.results[i], &got.states[i], all))
                fail_answer(s, k, begun, i, &want, &got);
    }
}

/* ---- Tests ---- */

static void test_every_mesh(void **state) {
    (void)state;
    static ray_batch b;
    uint64_t rays = 0, hits = 0;
    for (int i = 0; i < lab_mesh_count(); i++) {
        stage s;
        stage_open(&s, lab_mesh_name(i), i % 2 ? 300 : 60, 1 + i % ISOVALUES, i % 4 == 3);
        load(&s, true);
        for (int n = 0; n < BATCHES; n++) {
            fill_batch(&s, &b);
            check_batch(&s, &b, true);
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
        stage s;
        stage_open(&s, names[i], 50, 1 + (int)i % ISOVALUES, false);
        for (int n = 0; n < 2 * BATCHES; n++) {
            load(&s, true);
            fill_batch(&s, &b);
            load(&s, false);
            check_batch(&s, &b, false);
            trace_single(&s, &b, &left);
            for (unsigned k = 0; k < left.count; k++)
                if (left.results[k] == TRACE_BLOCKED)
                    b.states[k] = left.states[k];
            load(&s, n % 2 == 0);
            check_batch(&s, &b, n % 2 == 0);
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
    stage s;
    stage_open(&s, "noise", 50, 1, false);
    for (int n = 0; n < BATCHES; n++) {
        s.tr.preview = false;
        load(&s, true);
        fill_batch(&s, &b);
        load(&s, false);
        s.tr.preview = true;
        for (unsigned i = 0; i < b.count; i++)
            b.states[i].any = false;
        check_batch(&s, &b, false);
    }
    stage_close(&s);
}

/* Boxes in boxes begin no earlier, also where t is below 0: so no treelet is left out. */
static void test_passages(void **state) {
    (void)state;
    stage s;
    stage_open(&s, "noise-jittered", 50, 1, false);
    const treelet_tree *tree = s.v->treelets->tree;
    const hit before = hit_before_all();
    for (int n = 0; n < 500 * BATCHES; n++) {
        tree_passages passages;
        tree_passage at = {-INFINITY, 0};
        ray_counters counters = {0};
        uint32_t passed = 0, meets = 0;
        ray r;
        if (!random_ray(&s, &r))
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
    stage s;
    stage_open(&s, "noise", 300, 2, false);
    load(&s, true);
    for (int i = 0; i < 4000; i++) {
        const hit before = hit_before_all();
        trace_state all = trace_begin(&before), some;
        ray r;
        if (!secondary_ray(&s, &r, &some) || some.origin_iso < 0 || some.after.t > -INFINITY)
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
    stage s;
    stage_open(&s, "sphere", 300, 1, false);
    load(&s, true);
    b.count = RAY_BATCH;
    for (unsigned i = 0; i < RAY_BATCH; i++) {
        const hit before = hit_before_all();
        const double size = s.lab.hi[0] - s.lab.lo[0];
        const double o[3] = {s.lab.lo[0] - size,
                             s.lab.lo[1] + size * (0.5 + 0.002 * (double)(i % 16)),
                             s.lab.lo[2] + size * (0.5 + 0.002 * (double)(i / 16))};
        const double d[3] = {1.0, 0.01, 0.02};
        assert_true(tracer_ray(&s.tr, o, d, 0.0, INFINITY, &b.rays[i]));
        b.states[i] = trace_begin(&before);
    }
    check_batch(&s, &b, true);
    for (int k = 0; k < s.kernel_count; k++) {
        ray_counters single = {0}, batch = {0};
        static ray_batch own;
        own = b;
        s.tr.kernels = &s.kernels[k];
        ray_batch_next(&s.tr, &own, s.scratch, &batch);
        own = b;
        for (unsigned i = 0; i < RAY_BATCH; i++)
            ray_batch_single(&s.tr, &own, i, &single);
        assert_true(batch.nodes * 20 < single.nodes);
    }
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
