/* test_frame.c - how a frame's threads share what there is to do: no round ends while treelets
 * come, few records and few slots suffice, a frame can be drawn in slices, and a tile takes no
 * lock.
 */
/* marks: threads */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <dlfcn.h>
#include <limits.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>

#include "formats/base/clock.h"
#include "formats/base/fault.h"
#include "render/door/leafcast_device.h"
#include "render/door/leafcast_volume.h"
#include "render/frame/ray_records.h"
#include "render/ray/kind.h"
#include "render/surface/surface_integrator.h"
#include "tests/support/fixture.h"
#include "tests/support/mesh_leaves.h"

enum { SIDE = 72, PIXELS = SIDE * SIDE, SLOW_US = 300 };

/* ---- Locks that are taken, counted where nobody else watches them ---- */

#if !defined __SANITIZE_THREAD__ && !defined __SANITIZE_ADDRESS__
#define COUNTS_LOCKS 1
typedef int lock_fn(pthread_mutex_t *);

static atomic_ulong locks;
static _Atomic(lock_fn *) system_lock;

int pthread_mutex_lock(pthread_mutex_t *m) {
    lock_fn *lock = atomic_load(&system_lock);
    if (!lock) {
        void *found = dlsym(RTLD_NEXT, "pthread_mutex_lock");
        memcpy(&lock, &found, sizeof lock);
        atomic_store(&system_lock, lock);
    }
    atomic_fetch_add(&locks, 1);
    return lock(m);
}
#endif

/* ---- Pictures ---- */

typedef struct shot {
    double z[PIXELS];
    float r[PIXELS];
} shot;

typedef struct subject {
    const char *path;
    double iso, other;
} subject;

static subject grid_subject(void) {
    static const char *path;
    field f;
    if (!path) {
        assert_true(field_make(&f, "noise-u8", 48, FIELD_SEED));
        path = fixture_leaf(&f, 4, 1, false);
        field_release(&f);
    }
    return (subject){path, 120.5, 90.0};
}

static subject mesh_subject(void) {
    static const char *path;
    if (!path) {
        mesh_case c = mesh_leaves_cube(9, 1, 1, FIELD_SEED, 0);
        path = mesh_leaves_make(&c, "frame.leaf");
        mesh_leaves_release(&c);
    }
    return (subject){path, 0.05, -0.2};
}

static leafcast_scene lit_scene(void) {
    leafcast_scene scene = leafcast_scene_default();
    scene.light_count = 1;
    scene.lights[0] = (leafcast_light){.vector = {1, 0.4, 0.8}, .rgb = {1, 1, 1}};
    scene.shadows = true;
    return scene;
}

static leafcast *open_volume(const subject *s, int threads, uint32_t slots) {
    return fixture_open(s->path,
                        &(leafcast_options){.size = sizeof(leafcast_options),
                                            .threads = threads,
                                            .experiments = EXPERIMENTS(.treelet_limit = slots)});
}

static void choose(leafcast *v, double iso) {
    const leafcast_surface surface = leafcast_surface_default(iso);
    assert_int_equal(leafcast_select(v, &surface, 1), LEAFCAST_OK);
}

static leafcast_status draw(leafcast *v, double distance, shot *out, leafcast_stats *stats) {
    const leafcast_scene scene = lit_scene();
    const leafcast_camera view = leafcast_standard_view(v, distance, SIDE, SIDE);
    const leafcast_image image = {.size = sizeof image, .z = out->z, .r = out->r};
    return leafcast_trace(v, &scene, &view, &image, stats, NULL, NULL);
}

/* What all others must be: one thread, everything resident after the first treelets' waiting. */
static shot *reference(const subject *s) {
    shot *out = calloc(1, sizeof *out);
    leafcast *v = open_volume(s, 1, 0);
    assert_non_null(out);
    choose(v, s->iso);
    assert_int_equal(draw(v, 1.1, out, NULL), LEAFCAST_OK);
    leafcast_close(v);
    return out;
}

static const int crowds[] = {1, 3, 16};
enum { CROWDS = 3 };

/* Where nothing has to give way, all is one round, however long reads take; where treelets take
 * turns, it is the same picture. */
static void check_slow_reads(const subject *s) {
    static const uint32_t limits[] = {0, 1, 2, 7};
    shot *want = reference(s), *got = calloc(1, sizeof *got);
    for (int c = 0; c < CROWDS; c++)
        for (int k = 0; k < 4; k++) {
            leafcast *v = open_volume(s, crowds[c], limits[k]);
            leafcast_stats cold = {.size = sizeof cold}, warm = {.size = sizeof warm};
            choose(v, s->iso);
            fault_delay(FAULT_READ, limits[k] ? SLOW_US / 10 : SLOW_US);
            assert_int_equal(draw(v, 1.1, got, &cold), LEAFCAST_OK);
            fault_delay(FAULT_READ, 0);
            assert_memory_equal(got, want, sizeof *got);
            assert_true(cold.treelets_loaded > 10);
            assert_true(limits[k] || cold.passes == 1);
            assert_true(limits[k] != 1 || cold.passes > 10);
            assert_int_equal(draw(v, 1.1, got, &warm), LEAFCAST_OK);
            assert_memory_equal(got, want, sizeof *got);
            assert_true(limits[k] || warm.passes == 1);
            leafcast_close(v);
        }
    free(got);
    free(want);
}

static void test_slow_reads(void **state) {
    (void)state;
    const subject on_grid = grid_subject(), on_mesh = mesh_subject();
    check_slow_reads(&on_grid);
    check_slow_reads(&on_mesh);
}

/* A read that fails ends the frame for all threads; the next frame is whole. */
static void test_failing_reads(void **state) {
    (void)state;
    static const uint32_t limits[] = {0, 3};
    const subject s = grid_subject();
    shot *want = reference(&s), *got = calloc(1, sizeof *got);
    for (int k = 0; k < 2; k++)
        for (long at = 1; at < 10; at += 4) {
            leafcast *v = open_volume(&s, 16, limits[k]);
            choose(v, s.iso);
            fault_delay(FAULT_READ, SLOW_US);
            fault_arm(FAULT_READ, at);
            assert_int_equal(draw(v, 1.1, got, NULL), LEAFCAST_IO);
            assert_true(fault_fired(FAULT_READ));
            fault_arm(FAULT_READ, 0);
            fault_delay(FAULT_READ, 0);
            assert_int_equal(draw(v, 1.1, got, NULL), LEAFCAST_OK);
            assert_memory_equal(got, want, sizeof *got);
            leafcast_close(v);
        }
    free(got);
    free(want);
}

/* ---- Frames by hand: the fewest records, slices ---- */

typedef struct stage {
    leafcast *v;
    leafcast_scene scene;
    tracer tr;
    const tracer *coarse; /* none */
    int32_t first_id;
    surface_look look;
    projection projection;
    frame f;
} stage;

static void stage_select(stage *s, double iso) {
    const leafcast_surface surface = leafcast_surface_default(iso);
    volume_show(s->v, 0, 0, &surface, 1);
    loader_forget_failures(s->v->treelets);
}

/* Records as few, or twice as many, as can be. */
static void stage_open(stage *s, const subject *of, int threads, uint32_t slots, shot *into) {
    *s = (stage){.v = open_volume(of, threads, 0), .scene = lit_scene()};
    choose(s->v, of->iso);
    stage_select(s, of->iso);
    const leafcast_camera view = leafcast_standard_view(s->v, 1.1, SIDE, SIDE);
    s->look =
        (surface_look){.scene = &s->scene,
                       .surfaces = (const leafcast_surface(*)[LEAFCAST_SURFACES_MAX])s->v->surfaces,
                       .first_id = &s->first_id};
    s->f = (frame){.m = s->v->m,
                   .threads = s->v->device->threads,
                   .tracer = &s->tr,
                   .volumes = 1,
                   .stand_ins = &s->coarse,
                   .integrator = &surface_integrator,
                   .look = &s->look,
                   .isa = s->v->kernels.isa,
                   .width = SIDE,
                   .height = SIDE,
                   .image = {.size = sizeof(leafcast_image), .z = into->z, .r = into->r},
                   .stride = SIDE};
    assert_int_equal(camera_init(&s->f.camera, &view), ST_OK);
    assert_int_equal(volume_tracer(s->v, &s->scene, &s->f.camera, &s->tr), ST_OK);
    s->f.records_max = frame_records_min(&s->f) * (1 + slots % 2);
    s->f.scratch = mem_alloc(s->v->m, (size_t)threads * frame_scratch_bytes(&s->f));
    assert_non_null(s->f.scratch);
    loader_set_capacity(s->v->treelets, slots, 0);
    if (s->v->kernels.tile) {
        assert_int_equal(s->v->kind->tiles->project(s->v, &s->f.camera, &s->projection), ST_OK);
        s->f.projection = s->projection.usable ? &s->projection : NULL;
    }
}

static void stage_close(stage *s) {
    projection_release(&s->projection);
    mem_free(s->v->m, s->f.scratch);
    leafcast_close(s->v);
}

/* The fewest records, few slots: it ends, and is the same picture. */
static void check_scarcity(const subject *of, bool tiles) {
    shot *want = reference(of), *got = calloc(1, sizeof *got);
    for (int c = 0; c < CROWDS; c++)
        for (uint32_t slots = 1; slots < 4; slots++) {
            stage s;
            ray_counters counters = {0};
            memset(got, 0, sizeof *got);
            stage_open(&s, of, crowds[c], slots, got);
            if (!tiles)
                s.f.projection = NULL;
            const size_t before = mem_used(s.f.m);
            assert_int_equal(frame_render(&s.f, &counters), ST_OK);
            assert_memory_equal(got, want, sizeof *got);
            assert_true(mem_used(s.f.m) <= before + slots * loader_slot_bytes(s.v->treelets));
            stage_close(&s);
        }
    free(got);
    free(want);
}

static void test_scarcity(void **state) {
    (void)state;
    const subject on_grid = grid_subject(), on_mesh = mesh_subject();
    check_scarcity(&on_grid, true);
    check_scarcity(&on_grid, false);
    check_scarcity(&on_mesh, true);
}

/* In the smallest slices, with another frame between them on the same loader. */
static void check_slices(const subject *of, int threads, uint32_t slots, bool between) {
    shot *want = reference(of), *got = calloc(1, sizeof *got), *other = calloc(1, sizeof *other);
    stage s;
    drawing *d = NULL;
    bool done = false;
    int calls = 0;
    stage_open(&s, of, threads, slots, got);
    assert_int_equal(frame_begin(&s.f, &d), ST_OK);
    for (; !done; calls++) {
        assert_true(calls < 100000);
        assert_int_equal(frame_advance(d, 0.0, &done), ST_OK);
        if (!done && between && calls % 16 == 3) {
            choose(s.v, of->other);
            assert_int_equal(draw(s.v, 1.6, other, NULL), LEAFCAST_OK);
            stage_select(&s, of->iso);
            loader_set_capacity(s.v->treelets, slots, 0);
        }
    }
    frame_end(d, NULL);
    assert_true(threads > 1 || calls > 10); /* many threads do much in a slice */
    assert_memory_equal(got, want, sizeof *got);
    stage_close(&s);
    free(other);
    free(got);
    free(want);
}

static void test_slices(void **state) {
    (void)state;
    const subject on_grid = grid_subject(), on_mesh = mesh_subject();
    for (int c = 0; c < CROWDS; c++) {
        check_slices(&on_grid, crowds[c], 400, false);
        check_slices(&on_grid, crowds[c], 3, true);
        check_slices(&on_mesh, crowds[c], 9, true);
    }
}

/* Whoever cancels gets everything back. */
static void test_cancel(void **state) {
    (void)state;
    const subject on_grid = grid_subject();
    shot *got = calloc(1, sizeof *got);
    for (int c = 0; c < CROWDS; c++) {
        stage s;
        drawing *d = NULL;
        bool done = false;
        atomic_bool cancel = false;
        stage_open(&s, &on_grid, crowds[c], 3, got);
        s.f.cancel = &cancel;
        assert_int_equal(frame_begin(&s.f, &d), ST_OK);
        assert_int_equal(frame_advance(d, 0.0, &done), ST_OK);
        assert_false(done);
        atomic_store(&cancel, true);
        assert_int_equal(frame_advance(d, clock_seconds() + 1000.0, &done), ST_STOPPED);
        assert_false(done);
        frame_end(d, NULL);
        stage_close(&s);
    }
    free(got);
}

/* ---- Locks ---- */

/* What a warm frame locks does not depend on its tiles. */
static void test_tiles_without_locks(void **state) {
    (void)state;
#ifdef COUNTS_LOCKS
    const subject subjects[] = {grid_subject(), mesh_subject()};
    static double z[512 * 512];
    for (int i = 0; i < 2; i++) {
        leafcast *v = open_volume(&subjects[i], 1, 0);
        const leafcast_scene scene = leafcast_scene_default();
        const leafcast_surface surface = leafcast_surface_default(subjects[i].iso);
        const leafcast_image image = {.size = sizeof image, .z = z};
        unsigned long taken[3] = {0, ULONG_MAX, ULONG_MAX};
        assert_int_equal(leafcast_select(v, &surface, 1), LEAFCAST_OK);
        /* Of several warm frames the least: a thread that has read may still be on its way to
         * sleep. */
        for (int k = 0; k < 9; k++) {
            const int frame_kind = k == 0 ? 0 : 1 + k % 2;
            const uint32_t side = frame_kind == 2 ? 96 : 512;
            const leafcast_camera view = leafcast_standard_view(v, 1.1, side, side);
            const unsigned long before = atomic_load(&locks);
            assert_int_equal(leafcast_trace(v, &scene, &view, &image, NULL, NULL, NULL),
                             LEAFCAST_OK);
            const unsigned long now = atomic_load(&locks) - before;
            taken[frame_kind] =
                frame_kind == 0 || now < taken[frame_kind] ? now : taken[frame_kind];
        }
        assert_true(taken[0] > taken[1]); /* treelets came */
        assert_int_equal(taken[1], taken[2]);
        leafcast_close(v);
    }
#else
    skip();
#endif
}

/* ---- Records ---- */

enum { TAKERS = 6, NEED = 100, MOST = TAKERS * NEED };

typedef struct taker {
    ray_records *all;
    ray_reserve own;
    atomic_uchar *used; /* a record */
    atomic_int *wrong, *failed;
    uint32_t held[MOST], count;
    field_random r;
} taker;

static void take_some(taker *x) {
    if (!ray_records_promise(x->all, &x->own, NEED)) {
        atomic_fetch_add(x->failed, 1);
        (void)ray_records_keep(x->all, &x->own, 0);
        return;
    }
    for (uint64_t n = field_random_below(&x->r, NEED + 1); n > 0; n--) {
        uint32_t i = MOST;
        if (ray_records_take(x->all, &x->own, &i) != ST_OK || i >= MOST ||
            atomic_exchange(&x->used[i], 1)) {
            atomic_fetch_add(x->wrong, 1);
            return;
        }
        x->held[x->count++] = i;
    }
}

static void give_some(taker *x, uint64_t n) {
    for (; n > 0 && x->count > 0; n--) {
        const uint32_t i = x->held[--x->count];
        atomic_store(&x->used[i], 0);
        ray_records_give(x->all, &x->own, i);
    }
    if (field_random_below(&x->r, 2))
        (void)ray_records_keep(x->all, &x->own, NEED);
}

static status take_and_give(void *ctx, size_t index, int worker) {
    taker *x = (taker *)ctx + index;
    (void)worker;
    for (int i = 0; i < 3000; i++) {
        take_some(x);
        give_some(x, field_random_below(&x->r, NEED));
    }
    give_some(x, MOST);
    (void)ray_records_keep(x->all, &x->own, 0);
    return ST_OK;
}

/* As few as suffice for all at once: what was promised is there, nobody gets what another has, and
 * in the end all are there again. */
static void test_records(void **state) {
    (void)state;
    static taker takers[TAKERS];
    static atomic_uchar used[MOST];
    atomic_int wrong = 0, failed = 0;
    mem m;
    pool *threads;
    ray_records all;
    ray_reserve last = {0};
    mem_init(&m, 0);
    assert_int_equal(pool_create(&m, TAKERS, &threads), ST_OK);
    assert_int_equal(ray_records_init(&all, &m, sizeof(ray_record), MOST), ST_OK);
    for (int i = 0; i < TAKERS; i++)
        takers[i] = (taker){.all = &all,
                            .used = used,
                            .wrong = &wrong,
                            .failed = &failed,
                            .r = {FIELD_SEED + (uint64_t)i}};
    assert_int_equal(pool_run(threads, TAKERS, take_and_give, takers), ST_OK);
    assert_int_equal(atomic_load(&wrong), 0);
    assert_int_equal(ray_records_unpromised(&all), MOST);
    assert_false(ray_records_promise(&all, &last, MOST + 1));
    assert_true(ray_records_promise(&all, &last, MOST));
    for (uint32_t i = 0, r = 0; i < MOST; i++) {
        assert_int_equal(ray_records_take(&all, &last, &r), ST_OK);
        assert_int_equal(atomic_exchange(&used[r], 1), 0);
    }
    assert_int_equal(last.promised, 0);
    ray_records_release(&all);
    pool_destroy(threads);
    assert_int_equal(mem_used(&m), 0);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_records),    cmocka_unit_test(test_tiles_without_locks),
        cmocka_unit_test(test_slow_reads), cmocka_unit_test(test_failing_reads),
        cmocka_unit_test(test_scarcity),   cmocka_unit_test(test_slices),
        cmocka_unit_test(test_cancel)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
