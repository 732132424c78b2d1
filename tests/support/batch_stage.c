#include "tests/support/batch_stage.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- The stage ---- */

static void find_kernels(batch_stage *s) {
    s->kernel_count = 0;
    for (int isa = 1; isa <= (int)cpu_best(); isa++) {
        s->kernels[s->kernel_count] = ray_kernels_of(s->v->kind, (cpu_isa)isa);
        s->kernel_name[s->kernel_count++] = cpu_isa_name((cpu_isa)isa);
    }
    s->kernels[s->kernel_count] = ray_kernels_of(s->v->kind, CPU_SCALAR);
    s->kernels[s->kernel_count].batch = s->wide;
    s->kernel_name[s->kernel_count++] = "wide";
}

void batch_stage_set(batch_stage *s, const leafcast_surface surfaces[], int count, bool smooth) {
    s->random = (field_random){17};
    s->scene = leafcast_scene_default();
    s->scene.smooth_normals = smooth;
    assert_int_equal(leafcast_select(s->v, surfaces, count), LEAFCAST_OK);
    volume_show(s->v, 0, 0, surfaces, count);
    assert_int_equal(volume_tracer(s->v, &s->scene, NULL, &s->tr), ST_OK);
    s->treelets = s->v->file->layout.treelets;
    s->walked = calloc(s->treelets, 1);
    s->scratch = aligned_alloc(64, (kind_batch_scratch(s->v->kind) + 63) / 64 * 64);
    assert_non_null(s->walked);
    assert_non_null(s->scratch);
    find_kernels(s);
}

void batch_stage_close(batch_stage *s) {
    leafcast_close(s->v);
    free(s->walked);
    free(s->scratch);
}

/* Some of the active treelets are there, or all. */
void batch_stage_load(batch_stage *s, bool all) {
    loader_clear(s->v->treelets);
    loader_set_capacity(s->v->treelets, s->treelets, 0);
    for (uint32_t t = 0; t < s->treelets; t++) {
        const treelet *at;
        if (s->v->treelets->tree->active[0][t] && (all || field_random_below(&s->random, 2)))
            assert_int_equal(volume_treelet(s->v, t, &at), ST_OK);
    }
}

/* ---- Rays ---- */

/* A line, of some length, cut somehow. */
bool batch_stage_ray(batch_stage *s, ray *r) {
    field_random *random = &s->random;
    double o[3], d[3];
    double t0 = 0.0, t1 = INFINITY, stretch = 1.0;
    s->line(s->lab, random, o, d);
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
        d[a] *= stretch;
    return tracer_ray(&s->tr, o, d, t0 / stretch, t1 / stretch, r);
}

/* Beside a ray, a little turned or moved, or not at all. */
static ray neighbour_of(batch_stage *s, const ray *r) {
    ray n = *r;
    const long what = field_random_below(&s->random, 4);
    for (int a = 0; a < 3; a++) {
        if (what & 1)
            n.o[a] += field_random_in(&s->random, -0.02, 0.02) * s->size[a];
        if (what & 2)
            n.d[a] *= 1.0 + field_random_in(&s->random, -0.02, 0.02);
    }
    return n;
}

/* From a surface that it meets towards somewhere, as shadows and mirrors begin: behind the
 * surface's own error; or where it is, but not looking at the polygon there again; or both. */
bool batch_stage_secondary(batch_stage *s, ray *r, trace_state *state) {
    const hit before = hit_before_all();
    ray_counters counters = {0};
    double o[3], d[3];
    *state = trace_begin(&before);
    if (!batch_stage_ray(s, r) || tracer_next(&s->tr, r, state, &counters) != TRACE_HIT)
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

static trace_state random_state(batch_stage *s, const ray *r) {
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

void batch_stage_fill(batch_stage *s, ray_batch *b) {
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
        } else if (!begin_on_surface || !batch_stage_secondary(s, r, &b->states[i])) {
            while (!batch_stage_ray(s, r))
                ;
            b->states[i] = random_state(s, r);
        }
        b->states[i].any = field_random_below(&s->random, 3) == 0;
    }
}

/* ---- The same answers ---- */

/* Whether the ray has this hit, as one of all that it has. */
static bool has_hit(const batch_stage *s, const ray *r, const trace_state *begun, const hit *h) {
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
static bool any_agrees(const batch_stage *s, const ray *r, const trace_state *begun,
                       trace_result want, trace_result got, const trace_state *state, bool all) {
    if (got != TRACE_HIT)
        return got == want;
    if (want == TRACE_MISS || (all && want != TRACE_HIT))
        return false;
    return !all || hit_is_bound(&state->best) || has_hit(s, r, begun, &state->best);
}

static bool agrees(const batch_stage *s, const ray *r, const trace_state *begun, trace_result want,
                   const trace_state *wanted, trace_result got, const trace_state *state,
                   bool all) {
    if (begun->any)
        return any_agrees(s, r, begun, want, got, state, all);
    return want == got && same_hit(&wanted->best, &state->best) &&
           same_point(&wanted->point, &state->point) && wanted->t_from == state->t_from &&
           wanted->blocked == state->blocked && wanted->provisional == state->provisional;
}

static void clear_touched(const batch_stage *s) {
    for (uint32_t t = 0; t < s->treelets; t++)
        atomic_store(&s->tr.touched[t], 0);
}

void batch_stage_single(batch_stage *s, const ray_batch *begun, ray_batch *want) {
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
static void check_touched(const batch_stage *s, const ray_batch *begun) {
    for (unsigned i = 0; i < begun->count; i++)
        if (begun->states[i].any)
            return;
    for (uint32_t t = 0; t < s->treelets; t++)
        assert_true(!s->walked[t] || atomic_load(&s->tr.touched[t]));
}

static void fail_answer(const batch_stage *s, int kernel, const ray_batch *begun, unsigned i,
                        const ray_batch *want, const ray_batch *got) {
    const ray *r = &begun->rays[i];
    const hit *after = &begun->states[i].after, *best = &begun->states[i].best;
    const hit *wanted = &want->states[i].best, *found = &got->states[i].best;
    fail_msg("%s, %s, ray %u of %u: %d at %.17g, cell %llu, not %d at %.17g, cell %llu; from %.17g "
             "%.17g %.17g along %.17g %.17g %.17g, t %g to %g, behind %.17g, before %.17g, any %d",
             s->name, s->kernel_name[kernel], i, begun->count, got->results[i], found->t,
             (unsigned long long)found->cell, want->results[i], wanted->t,
             (unsigned long long)wanted->cell, r->o[0], r->o[1], r->o[2], r->d[0], r->d[1], r->d[2],
             r->t0, r->t1, after->t, best->t, begun->states[i].any);
}

void batch_stage_check(batch_stage *s, const ray_batch *begun, bool all) {
    static ray_batch want, got;
    batch_stage_single(s, begun, &want);
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

double batch_stage_together(batch_stage *s, const ray_batch *b) {
    double least = INFINITY;
    for (int k = 0; k < s->kernel_count; k++) {
        ray_counters single = {0}, batch = {0};
        static ray_batch own;
        own = *b;
        s->tr.kernels = &s->kernels[k];
        ray_batch_next(&s->tr, &own, s->scratch, &batch);
        own = *b;
        for (unsigned i = 0; i < RAY_BATCH; i++)
            ray_batch_single(&s->tr, &own, i, &single);
        least = fmin(least, (double)single.nodes / (double)batch.nodes);
    }
    return least;
}
