/* test_small_stack.c - everything a volume can be asked for, on a thread with a stack of 128 KiB,
 * of which less than 64 KiB may ever be touched: tiles, packets, single rays, shadows,
 * transparency, previews, probes, by every ISA.
 */
/* marks: long */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <pthread.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/support/fixture.h"
#include "tests/support/mesh_leaves.h"
#include "tests/support/watched.h"

#if defined __SANITIZE_ADDRESS__ || defined __SANITIZE_THREAD__ || !defined __OPTIMIZE__
enum { STACK = 4 << 20, DEEPEST = 4 << 20 }; /* frames are larger there */
#else
enum { STACK = 128 << 10, DEEPEST = 64 << 10 };
#endif

enum { SIDE = WATCHED ? 24 : 72, SEED = 3, UNTOUCHED = 0xa5 };

typedef struct task {
    const char *path, *isa;
    double iso;
    bool mesh;
    leafcast_experiments experiments;
    /* Out: */
    int pictures;
    char error[256];
    double z[SIDE * SIDE];
} task;

/* What pictures are made of, a bit each. */
enum { SHADOWS = 1, LAYERS = 2, PREVIEW = 4, ANALYTIC = 8, SMOOTH = 16, SWEEP = 32, LAST = 64 };

static leafcast_status picture(task *t, leafcast *v, unsigned how) {
    leafcast_scene scene = leafcast_scene_default();
    const leafcast_camera camera = leafcast_standard_view(v, 1.4, SIDE, SIDE);
    const leafcast_image image = {.size = sizeof(leafcast_image), .z = t->z};
    leafcast_surface surfaces[2] = {leafcast_surface_default(t->iso),
                                    leafcast_surface_default(t->iso * 1.1)};
    surfaces[0].opacity = how & LAYERS ? 0.4f : 1.0f;
    scene.light_count = 1;
    scene.lights[0] = (leafcast_light){.vector = {1, 2, 3}, .rgb = {1, 1, 1}};
    scene.shadows = how & SHADOWS;
    scene.preview = how & PREVIEW;
    scene.analytic_normals = how & ANALYTIC;
    scene.smooth_normals = how & SMOOTH && t->mesh;
    scene.sweep = how & SWEEP;
    scene.shading = LEAFCAST_SHADING_PHONG;
    leafcast_status st = leafcast_select(v, surfaces, how & LAYERS ? 2 : 1);
    if (st == LEAFCAST_OK)
        st = leafcast_trace(v, &scene, &camera, &image, NULL, NULL, NULL);
    t->pictures += st == LEAFCAST_OK;
    return st;
}

static leafcast_status probes(const task *t, leafcast *v) {
    const leafcast_scene scene = leafcast_scene_default();
    const leafcast_camera camera = leafcast_standard_view(v, 1.4, SIDE, SIDE);
    leafcast_hit hits[8];
    leafcast_sample sample;
    double origin[3], direction[3], point[3] = {0.5, 0.5, 0.5}, value[16 * 16];
    const double *middle = camera.look_at, plane[4] = {1, 1, 1, -middle[0] - middle[1] - middle[2]};
    int count = 0;
    (void)t;
    leafcast_pixel_ray(&camera, SIDE / 2, SIDE / 2, origin, direction);
    leafcast_status st = leafcast_probe_ray(v, &scene, origin, direction, hits, 8, &count);
    if (st == LEAFCAST_OK)
        st = leafcast_probe_point(v, point, &sample);
    leafcast_slice_pixels s = {.size = sizeof s};
    if (st == LEAFCAST_OK)
        st = leafcast_plane_slice(v, plane, &s);
    s.width = s.height = 16;
    return st == LEAFCAST_OK ? leafcast_sample_slice(v, &s, value, NULL, NULL, NULL) : st;
}

static void *work(void *arg) {
    task *t = arg;
    leafcast *v = NULL;
    const leafcast_options o = {.size = sizeof(leafcast_options),
                                .threads = 1,
                                .isa = t->isa,
                                .experiments = &t->experiments};
    leafcast_status st = leafcast_open(t->path, &o, &v);
    for (unsigned how = 0; how < LAST && st == LEAFCAST_OK; how++)
        st = picture(t, v, how);
    if (st == LEAFCAST_OK)
        st = probes(t, v);
    if (st == LEAFCAST_OK)
        st = picture(t, v, 0);
    if (st != LEAFCAST_OK && st != LEAFCAST_USAGE)
        snprintf(t->error, sizeof t->error, "%s", leafcast_error_text());
    leafcast_close(v);
    return NULL;
}

/* Bytes of its stack that a thread of this task touches. */
static size_t depth_of(task *t) {
    pthread_attr_t attr;
    pthread_t thread;
    unsigned char *stack = aligned_alloc(1 << 16, STACK);
    size_t left = 0;
    assert_non_null(stack);
    memset(stack, UNTOUCHED, STACK);
    assert_int_equal(pthread_attr_init(&attr), 0);
    assert_int_equal(pthread_attr_setstack(&attr, stack, STACK), 0);
    assert_int_equal(pthread_create(&thread, &attr, work, t), 0);
    assert_int_equal(pthread_join(thread, NULL), 0);
    pthread_attr_destroy(&attr);
    while (left < STACK && stack[left] == UNTOUCHED)
        left++;
    free(stack);
    return STACK - left;
}

/* By every ISA there is; the last picture is the same. */
static void check_task(task t, const char *name) {
    static const char *const isas[] = {"scalar", "sse42", "avx2", "avx512"};
    static double first[SIDE * SIDE];
    for (int i = 0; i < 4; i++) {
        t.isa = isas[i];
        t.pictures = 0;
        const size_t depth = depth_of(&t);
        if (t.error[0])
            fail_msg("%s, %s: %s", name, t.isa, t.error);
        if (t.pictures == 0) /* not on this CPU */
            continue;
        assert_int_equal(t.pictures, LAST + 1);
        print_message("# %s, %s: %zu bytes of stack\n", name, t.isa, depth);
        assert_true(depth <= DEEPEST);
        if (i == 0)
            memcpy(first, t.z, sizeof first);
        assert_memory_equal(first, t.z, sizeof first);
    }
}

static void check_grid(const char *field_of, bool compressed) {
    field f;
    assert_true(field_make(&f, field_of, 50, FIELD_SEED));
    const task t = {.path = fixture_leaf(&f, 4, 1, compressed),
                    .iso = f.iso,
                    .experiments = {.size = sizeof(leafcast_experiments), .treelet_limit = 5}};
    check_task(t, field_of);
    field_release(&f);
}

static void test_grid(void **state) {
    (void)state;
    check_grid("sphere", false);
    check_grid("waves", true);
}

static void test_mesh(void **state) {
    (void)state;
    static const int packets[] = {0, 2, 16};
    mesh_case c = mesh_leaves_cube(10, 1, 1, SEED, 0);
    mesh_leaves_extend(&c, SEED);
    c.mesh.treelet_tets = 400;
    task t = {.path = mesh_leaves_make(&c, "stack.leaf"),
              .iso = 0.25,
              .mesh = true,
              .experiments = {.size = sizeof(leafcast_experiments)}};
    mesh_leaves_release(&c);
    for (int i = 0; i < 3; i++) {
        char name[64];
        t.experiments.packets = packets[i];
        snprintf(name, sizeof name, "mesh, packets %d", packets[i]);
        t.experiments.isopolygons = LEAFCAST_ISOPOLYGONS_ONTHEFLY;
        t.experiments.treelet_limit = 3;
        check_task(t, name);
    }
    t.experiments.packets = 0;
    t.experiments.isopolygons = LEAFCAST_ISOPOLYGONS_CACHE;
    t.experiments.treelet_limit = 0;
    check_task(t, "mesh, kept polygons");
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_grid), cmocka_unit_test(test_mesh)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
