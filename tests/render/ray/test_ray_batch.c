/* test_ray_batch.c - rays in batches have the answers of rays one by one, to the bit: every kind of
 * geometry and every ISA, whatever the rays of a batch have in common, wherever they begin and
 * end, and however few treelets are there.
 */
/* marks: long */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "formats/base/cpu.h"
#include "render/ray/kind.h"
#include "tests/support/fixture.h"
#include "tests/support/grid_batch_wide.h"
#include "tests/support/lab_leaf.h"
#include "tests/support/pictures.h"
#include "tests/support/ray_stage.h"

#ifdef __SANITIZE_ADDRESS__
enum { BATCHES = 4, SCENES = 4 };
#else
enum { BATCHES = 40, SCENES = 36 };
#endif

/* ---- What is traced: a kind is a row ---- */

typedef struct source {
    field f;
    ref_volume world;
    lab_mesh mesh;
    const char *path, *name;
    double iso;
} source;

typedef struct source_row {
    const char *name;
    int (*count)(void);
    void (*make)(source *s, int index);
    void (*release)(source *s);
    ref_ray (*aim)(const source *s, field_random *r); /* seeks trouble; world space */
    batch_fn wide;      /* the kernel of AVX-512 in plain C, or NULL */
    bool marks_exactly; /* the treelets that rays walk; else, as far as boxes of all rays tell */
} source_row;

static void grid_make(source *s, int index) {
    s->name = field_name(index);
    assert_true(field_make(&s->f, s->name, 37, FIELD_SEED));
    s->world = field_volume(&s->f);
    s->path = fixture_leaf(&s->f, 4, index % 3 > 0, false);
    s->iso = s->f.iso;
}

static void grid_release(source *s) {
    field_release(&s->f);
}

static ref_ray grid_aim(const source *s, field_random *r) {
    switch (field_random_below(r, 6)) {
    case 0: return field_exact_ray(&s->world, r);
    case 1: return field_aimed_ray(&s->world, r, 20);
    case 2: return field_aimed_ray(&s->world, r, -1);
    case 3: return field_random_ray(&s->world, r, 200);
    case 4: return field_random_ray(&s->world, r, 20);
    default: return field_random_ray(&s->world, r, -1);
    }
}

static void mesh_make(source *s, int index) {
    s->name = lab_mesh_name(index);
    assert_true(lab_mesh_make(&s->mesh, s->name, 6, FIELD_SEED));
    s->path = lab_leaf_make(&s->mesh, 60, index % 2);
    s->iso = s->mesh.iso;
}

static void mesh_release(source *s) {
    lab_mesh_release(&s->mesh);
}

static ref_ray mesh_aim(const source *s, field_random *r) {
    return lab_mesh_ray(&s->mesh, (lab_ray)field_random_below(r, LAB_RAY_KINDS), r);
}

static const source_row rows[] = {
    {"grid", field_count, grid_make, grid_release, grid_aim, grid_batch_trace_wide, true},
    {"mesh", lab_mesh_count, mesh_make, mesh_release, mesh_aim, NULL, false},
};

/* ---- A volume, and the rays that it is asked about ---- */

typedef struct stage {
    const source_row *row;
    source from;
    leafcast *v;
    tracer tr;
    leafcast_info info;
    ray_kernels with[8];
    int kernel_count;
    void *scratch;
    field_random random;
    size_t rays, hits, blocked;
} stage;

static void stage_open(stage *s, const source_row *row, int index) {
    *s = (stage){.row = row, .random = {(uint64_t)index + 1}};
    row->make(&s->from, index);
    s->v = fixture_open(s->from.path, NULL);
    s->info = leafcast_describe(s->v);
    for (int isa = 0; isa <= (int)cpu_best(); isa++)
        s->with[s->kernel_count++] = ray_kernels_of(s->v->kind, (cpu_isa)isa);
    if (row->wide) {
        s->with[s->kernel_count] = s->with[0];
        s->with[s->kernel_count++].batch = row->wide;
    }
    s->scratch = aligned_alloc(64, (kind_batch_scratch(s->v->kind) + 127) / 64 * 64);
    assert_non_null(s->scratch);
}

static void stage_close(stage *s) {
    print_message("# %s %s: %zu rays, %zu hits, %zu blocked\n", s->row->name, s->from.name, s->rays,
                  s->hits, s->blocked);
    free(s->scratch);
    leafcast_close(s->v);
    s->row->release(&s->from);
}

/* So many surfaces from now on, seen by this scene. */
static void stage_show(stage *s, int count, const leafcast_scene *scene) {
    leafcast_surface surfaces[3];
    camera c;
    const leafcast_camera view = leafcast_standard_view(s->v, 1.5, 40, 40);
    for (int i = 0; i < count; i++)
        surfaces[i] = leafcast_surface_default(s->from.iso + 0.1 * i * fabs(s->from.iso));
    assert_int_equal(leafcast_select(s->v, surfaces, count), LEAFCAST_OK);
    volume_show(s->v, 0, 0, surfaces, count);
    assert_int_equal(camera_init(&c, &view), ST_OK);
    assert_int_equal(volume_tracer(s->v, scene, &c, &s->tr), ST_OK);
}

static double unit(stage *s) {
    return field_random_unit(&s->random);
}

static bool one_in(stage *s, long of) {
    return field_random_below(&s->random, of) == 0;
}

/* ---- Batches ---- */

typedef enum bundle { INCOHERENT, BEAM, FAN, PARALLEL, MIXED, BUNDLES } bundle;

/* A ray that has that in common with the first. */
static ref_ray ray_like(stage *s, const ref_ray *first, bundle how) {
    ref_ray r = *first;
    const double width = 0.3 * unit(s) * unit(s);
    if (how == INCOHERENT || (how == MIXED && one_in(s, 3)))
        return s->row->aim(&s->from, &s->random);
    for (int a = 0; a < 3; a++) {
        const double extent = width * (s->info.bounds[1][a] - s->info.bounds[0][a]);
        const double from = extent * (unit(s) - 0.5), to = extent * (unit(s) - 0.5);
        if (how != FAN)
            r.o[a] += from;
        if (how != PARALLEL)
            r.d[a] += to;
    }
    return r;
}

/* What is asked about it. */
static trace_state question(stage *s) {
    hit after = hit_before_all();
    if (one_in(s, 4))
        after = hit_behind(2.0 * unit(s) - 0.5);
    trace_state state = trace_begin(&after);
    state.any = one_in(s, 3);
    if (one_in(s, 5))
        state.best = hit_from(1.5 * unit(s));
    return state;
}

static void add_ray(stage *s, ray_batch *b, const ref_ray *r) {
    const bool cut = one_in(s, 4);
    const double t0 = cut ? 1.5 * unit(s) - 0.5 : 0.0;
    if (tracer_ray(&s->tr, r->o, r->d, t0, cut && one_in(s, 2) ? t0 + unit(s) : INFINITY,
                   &b->rays[b->count]))
        b->states[b->count++] = question(s);
}

static void fill(stage *s, ray_batch *b, bundle how) {
    const ref_ray first = s->row->aim(&s->from, &s->random);
    const unsigned most =
        one_in(s, 4) ? 1 + (unsigned)field_random_below(&s->random, RAY_BATCH) : RAY_BATCH;
    b->count = 0;
    for (unsigned i = 0; i < most; i++) {
        const ref_ray r = ray_like(s, &first, how);
        add_ray(s, b, &r);
    }
}

/* Rays that start where those have hit something: towards a light, or on behind it. */
static void fill_behind(stage *s, const ray_batch *of, ray_batch *b) {
    double light[3], at[3], to[3];
    b->count = 0;
    for (int a = 0; a < 3; a++)
        light[a] = s->info.bounds[0][a] +
                   (3.0 * unit(s) - 1.0) * (s->info.bounds[1][a] - s->info.bounds[0][a]);
    for (unsigned i = 0; i < of->count; i++) {
        const trace_state *found = &of->states[i];
        const ray *r = &of->rays[i];
        double slope = 0.0, grid[3];
        if (of->results[i] != TRACE_HIT || found->any || hit_is_bound(&found->best))
            continue;
        if (one_in(s, 3)) {
            b->rays[b->count] = *r;
            b->states[b->count++] = trace_begin(&found->best);
            continue;
        }
        for (int a = 0; a < 3; a++)
            grid[a] = r->o[a] + found->best.t * r->d[a];
        affine_point_to_world(&s->tr.space, grid, at);
        for (int a = 0; a < 3; a++) {
            to[a] = light[a] - at[a];
            slope += to[a] * found->point.gradient[a];
        }
        const double error = found->point.error / fabs(slope);
        const hit start = hit_behind(error < 1.0 ? error : 1.0);
        if (!tracer_ray(&s->tr, at, to, 0.0, 1.0, &b->rays[b->count]))
            continue;
        b->states[b->count] = trace_begin(&start);
        b->states[b->count++].any = one_in(s, 2);
    }
}

/* ---- The judgement ---- */

static bool same_double(double a, double b) {
    return memcmp(&a, &b, sizeof a) == 0;
}

static bool same_hit(const hit *a, const hit *b) {
    return same_double(a->t, b->t) && a->cell == b->cell && a->iso == b->iso &&
           a->entering == b->entering;
}

static bool same_point(const surface_point *a, const surface_point *b) {
    return memcmp(a->gradient, b->gradient, sizeof a->gradient) == 0 &&
           same_double(a->error, b->error) && same_double(a->span, b->span) &&
           memcmp(a->normal, b->normal, sizeof a->normal) == 0;
}

static bool same_answer(const ray_batch *a, const ray_batch *b, unsigned i) {
    const trace_state *x = &a->states[i], *y = &b->states[i];
    /* Any hit: a batch may find it behind what single rays wait for. */
    if (x->any && a->results[i] == TRACE_BLOCKED && b->results[i] == TRACE_HIT)
        return !hit_is_bound(&y->best);
    if (a->results[i] != b->results[i] || x->provisional != y->provisional)
        return false;
    if (x->any && a->results[i] != TRACE_BLOCKED)
        return hit_is_bound(&x->best) == hit_is_bound(&y->best);
    return same_hit(&x->best, &y->best) && same_point(&x->point, &y->point) &&
           same_double(x->t_from, y->t_from) && x->blocked == y->blocked;
}

static void clear_touched(const stage *s) {
    for (uint32_t t = 0; t < s->v->file->layout.treelets; t++)
        atomic_store(&s->tr.touched[t], 0);
}

static void trace_single(const stage *s, ray_batch *b) {
    ray_counters counters = {0};
    clear_touched(s);
    for (unsigned i = 0; i < b->count; i++)
        ray_batch_single(&s->tr, b, i, &counters);
}

static void tell_difference(const stage *s, const ray_batch *want, const ray_batch *got, unsigned i,
                            int number, int k) {
    const trace_state *x = &want->states[i], *y = &got->states[i];
    const ray *r = &want->rays[i];
    print_message("%s %s, batch %d, kernel %d %s: ray %u of %u\n", s->row->name, s->from.name,
                  number, k, cpu_isa_name(s->with[k].isa), i, want->count);
    print_message("o %a %a %a d %a %a %a t %a %a after %a any %d\n", r->o[0], r->o[1], r->o[2],
                  r->d[0], r->d[1], r->d[2], r->t0, r->t1, x->after.t, x->any);
    print_message(
        "single %d: t %.17g cell %llu iso %d, from %g; batch %d: t %.17g cell %llu iso %d, "
        "from %g\n",
        (int)want->results[i], x->best.t, (unsigned long long)x->best.cell, x->best.iso, x->t_from,
        (int)got->results[i], y->best.t, (unsigned long long)y->best.cell, y->best.iso, y->t_from);
}

/* All kernels' answers to *b, which are then in it; and the same treelets count as visible. */
static void judge(stage *s, ray_batch *b, int number) {
    static ray_batch want, got;
    static uint8_t touched[1 << 16];
    const uint32_t treelets = s->v->file->layout.treelets;
    assert_true(treelets <= sizeof touched);
    if (b->count == 0)
        return;
    want = *b;
    trace_single(s, &want);
    for (uint32_t t = 0; t < treelets; t++)
        touched[t] = atomic_load(&s->tr.touched[t]);
    for (int k = 0; k < s->kernel_count; k++) {
        ray_counters counters = {0};
        got = *b;
        clear_touched(s);
        memset(s->scratch, 0xa5, kind_batch_scratch(s->v->kind));
        s->tr.kernels = &s->with[k];
        ray_batch_next(&s->tr, &got, s->scratch, &counters);
        for (unsigned i = 0; i < b->count; i++) {
            if (!same_answer(&want, &got, i))
                tell_difference(s, &want, &got, i, number, k);
            assert_true(same_answer(&want, &got, i));
        }
        for (uint32_t t = 0; t < treelets && s->row->marks_exactly; t++)
            assert_int_equal(touched[t], atomic_load(&s->tr.touched[t]));
    }
    *b = want;
    for (unsigned i = 0; i < b->count; i++) {
        s->hits += b->results[i] == TRACE_HIT;
        s->blocked += b->results[i] == TRACE_BLOCKED;
    }
    s->rays += b->count;
}

static void judge_some(stage *s, int batches) {
    static ray_batch b, behind;
    for (int i = 0; i < batches; i++) {
        fill(s, &b, (bundle)(i % BUNDLES));
        judge(s, &b, i);
        fill_behind(s, &b, &behind);
        judge(s, &behind, i);
    }
}

/* ---- The tests ---- */

static void check_all(const source_row *row) {
    size_t rays = 0, hits = 0;
    const leafcast_scene scene = leafcast_scene_default();
    for (int i = 0; i < row->count(); i++) {
        stage s;
        stage_open(&s, row, i);
        for (int count = 1; count <= 3; count += 2) {
            stage_show(&s, count, &scene);
            ray_stage_admit(s.v, &s.random, 0);
            judge_some(&s, BATCHES);
            assert_int_equal(s.blocked, 0);
        }
        rays += s.rays;
        hits += s.hits;
        stage_close(&s);
    }
    print_message("%s: %zu rays, %zu hits\n", row->name, rays, hits);
    assert_true(rays > 2000 * (size_t)BATCHES && hits > rays / 10);
}

static void test_every_field(void **state) {
    (void)state;
    check_all(&rows[0]);
}

static void test_every_mesh(void **state) {
    (void)state;
    check_all(&rows[1]);
}

/* Clips, levels, previews. */
static void test_every_scene(void **state) {
    (void)state;
    for (int i = 0; i < SCENES; i++) {
        stage s;
        stage_open(&s, &rows[0], i % field_count());
        leafcast_scene scene = pictures_scene(i, &s.info);
        stage_show(&s, 1 + i % 3, &scene);
        ray_stage_admit(s.v, &s.random, 0);
        judge_some(&s, BATCHES / 4);
        scene.preview = true;
        stage_show(&s, 1 + i % 3, &scene);
        ray_stage_admit(s.v, &s.random, 3);
        judge_some(&s, BATCHES / 8);
        stage_close(&s);
    }
}

/* Where they are blocked, what they have found by then, and how they go on from there. */
static void test_absent_treelets(void **state) {
    (void)state;
    static ray_batch b;
    const leafcast_scene scene = leafcast_scene_default();
    for (size_t k = 0; k < sizeof rows / sizeof *rows; k++) {
        size_t blocked = 0;
        for (int i = 0; i < rows[k].count(); i += 3) {
            stage s;
            stage_open(&s, &rows[k], i);
            stage_show(&s, 1, &scene);
            for (int round = 0; round < BATCHES / 4; round++) {
                ray_stage_admit(s.v, &s.random, 1 + round % 7);
                fill(&s, &b, (bundle)(round % BUNDLES));
                judge(&s, &b, round);
                ray_stage_admit(s.v, &s.random, 2);
                judge(&s, &b, round);
            }
            blocked += s.blocked;
            stage_close(&s);
        }
        assert_true(blocked > 100);
    }
}

/* ---- leafcast.h ---- */

enum { OWN_RAYS = 2000 };

typedef struct own_answers {
    leafcast_ray_hit hits[OWN_RAYS];
    uint8_t occluded[OWN_RAYS];
} own_answers;

static void assert_same_answers(const own_answers *a, const own_answers *b) {
    assert_memory_equal(a->occluded, b->occluded, sizeof a->occluded);
    for (int i = 0; i < OWN_RAYS; i++) {
        const leafcast_ray_hit *x = &a->hits[i], *y = &b->hits[i];
        assert_true(same_double(x->t, y->t) && same_double(x->error_bound, y->error_bound) &&
                    same_double(x->isovalue, y->isovalue) && x->cell == y->cell &&
                    x->volume == y->volume && x->surface == y->surface &&
                    x->entering == y->entering &&
                    memcmp(x->normal, y->normal, sizeof x->normal) == 0);
    }
}

static void ask(const source *s, const leafcast_options *o, const leafcast_ray *rays, size_t count,
                own_answers *out) {
    const leafcast_scene scene = leafcast_scene_default();
    const leafcast_surface surfaces[2] = {leafcast_surface_default(s->iso),
                                          leafcast_surface_default(s->iso * 1.1)};
    leafcast *v = fixture_open(s->path, o);
    memset(out, 0, sizeof *out);
    assert_int_equal(leafcast_select(v, surfaces, 2), LEAFCAST_OK);
    assert_int_equal(leafcast_occluded_rays(v, &scene, rays, count, out->occluded), LEAFCAST_OK);
    assert_int_equal(leafcast_trace_rays(v, &scene, rays, count, out->hits), LEAFCAST_OK);
    /* Once more, now that treelets are there. */
    own_answers *again = calloc(1, sizeof *again);
    assert_non_null(again);
    assert_int_equal(leafcast_occluded_rays(v, &scene, rays, count, again->occluded), LEAFCAST_OK);
    assert_int_equal(leafcast_trace_rays(v, &scene, rays, count, again->hits), LEAFCAST_OK);
    assert_same_answers(again, out);
    free(again);
    leafcast_close(v);
}

/* A caller's rays, however many: the same answers by every kernel, any threads, few treelets. */
static void test_own_rays(void **state) {
    (void)state;
    static own_answers want, got;
    static leafcast_ray rays[OWN_RAYS];
    static const size_t counts[] = {1, 15, 16, 17, 255, 257, OWN_RAYS};
    for (size_t k = 0; k < sizeof rows / sizeof *rows; k++) {
        source s = {.name = NULL};
        field_random random = {FIELD_SEED};
        rows[k].make(&s, 6);
        for (int i = 0; i < OWN_RAYS; i++) {
            const ref_ray r = rows[k].aim(&s, &random);
            rays[i] = (leafcast_ray){.t1 = i % 5 ? INFINITY : 1.0};
            memcpy(rays[i].origin, r.o, sizeof r.o);
            memcpy(rays[i].direction, r.d, sizeof r.d);
        }
        for (size_t c = 0; c < sizeof counts / sizeof *counts; c++) {
            leafcast_options o = {.size = sizeof(leafcast_options), .isa = "scalar", .threads = 1};
            ask(&s, &o, rays, counts[c], &want);
            for (int isa = 1; isa <= (int)cpu_best(); isa++) {
                o = (leafcast_options){.size = sizeof(leafcast_options),
                                       .isa = cpu_isa_name((cpu_isa)isa),
                                       .threads = 2,
                                       .experiments = EXPERIMENTS(.treelet_limit = isa % 2 * 3)};
                ask(&s, &o, rays, counts[c], &got);
                assert_same_answers(&got, &want);
            }
        }
        rows[k].release(&s);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_every_field), cmocka_unit_test(test_every_mesh),
        cmocka_unit_test(test_every_scene), cmocka_unit_test(test_absent_treelets),
        cmocka_unit_test(test_own_rays),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
