/* test_scene_hosts.c - pictures by the host's threads: instead of the library's own, and many that
 * call it at once. */
/* marks: threads */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <math.h>
#include <pthread.h>

#include "tests/support/scene_stage.h"

/* The host's threads: one after the other, on this one. */
static void run_in_turn(void *host, int count, void (*work)(void *arg, int index), void *arg) {
    ++*(int *)host;
    for (int i = count; i-- > 0;)
        work(arg, i);
}

static void host_threads_draw_the_same(void **state) {
    const scene_stage *s = *state;
    static picture truth_of, other;
    const leafcast_camera c = scene_stage_view(68);
    int runs = 0;
    const leafcast_options o = {.size = sizeof o, .threads = 5, .run = run_in_turn, .host = &runs};
    scene_pair v;
    scene_stage_open(&v, s, NULL, 0);
    leafcast_scene scene = scene_stage_lit(&v);
    pictures_draw(v.volume[0], &scene, &c, &truth_of, NULL);
    scene_stage_close(&v);
    scene_stage_open(&v, s, &o, 1);
    scene = scene_stage_lit(&v);
    pictures_draw(v.volume[0], &scene, &c, &other, NULL);
    scene_stage_same(&truth_of, &other);
    assert_true(runs > 0);
    scene_stage_close(&v);
}

/* ---- Several threads of the host's ---- */

enum { THREADS = 8, PICTURES = 3 };

typedef struct guest {
    const scene_stage *s;
    leafcast *volume; /* of all; NULL: its own */
    double isovalue;
    double z[PICTURE_PIXELS];
} guest;

static void *draw_as_guest(void *arg) {
    guest *g = arg;
    leafcast *v = g->volume;
    const leafcast_options o = {.size = sizeof o, .threads = 2};
    const leafcast_surface surface = leafcast_surface_default(g->isovalue);
    const leafcast_camera c = scene_stage_view(68);
    const leafcast_image image = {.size = sizeof image, .z = g->z};
    leafcast_scene scene = leafcast_scene_default();
    if (!v && leafcast_open(g->s->grid_path, &o, &v))
        return NULL;
    const leafcast_shown shown = {v, 0, 0, &surface, 1, 0.0, NULL, NULL, NULL};
    scene.volumes = &shown;
    scene.volume_count = 1;
    for (int i = 0; i < PICTURES; i++)
        if (leafcast_trace(v, &scene, &c, &image, NULL, NULL, NULL))
            g->z[0] = NAN;
    if (!g->volume)
        leafcast_close(v);
    return g;
}

/* own: each with a volume; else some on one, each with an isovalue of its own. */
static void host_many(const scene_stage *s, int threads, bool own) {
    static guest guests[THREADS], alone;
    pthread_t thread[THREADS];
    leafcast *one = NULL;
    if (!own)
        assert_int_equal(leafcast_open(s->grid_path, NULL, &one), LEAFCAST_OK);
    for (int i = 0; i < threads; i++) {
        guests[i] = (guest){.s = s, .volume = one, .isovalue = 0.4 + 0.1 * i};
        assert_int_equal(pthread_create(&thread[i], NULL, draw_as_guest, &guests[i]), 0);
    }
    for (int i = 0; i < threads; i++) {
        void *ended;
        pthread_join(thread[i], &ended);
        assert_non_null(ended);
    }
    leafcast_close(one);
    for (int i = 0; i < threads; i++) {
        alone = (guest){.s = s, .isovalue = guests[i].isovalue};
        assert_non_null(draw_as_guest(&alone));
        assert_memory_equal(alone.z, guests[i].z, sizeof alone.z);
    }
}

static void eight_threads_draw_a_volume_each(void **state) {
    host_many(*state, THREADS, true);
}

static void four_threads_draw_one_volume(void **state) {
    host_many(*state, 4, false);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(host_threads_draw_the_same),
        cmocka_unit_test(eight_threads_draw_a_volume_each),
        cmocka_unit_test(four_threads_draw_one_volume),
    };
    return cmocka_run_group_tests(tests, scene_stage_set, scene_stage_clear);
}
