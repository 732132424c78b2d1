/* test_play.c - series of grids that play: whichever step comes after which, and whatever was
 * expected instead, each picture is that of a file of its step alone, and what was expected is not
 * read again.
 */
/* marks: threads */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "render/door/leafcast_volume.h"
#include "tests/support/fields.h"
#include "tests/support/leaf_files.h"
#include "tests/support/pictures.h"
#include "tests/support/scratch.h"

enum { STEPS = 5, N = 60, ROUNDS = WATCHED ? 12 : 30 };

/* A ball that moves along x and gets larger, of values from 0 to 250. Nothing changes at the other
 * end. */
static uint8_t *samples_of(int step) {
    uint8_t *v = malloc((size_t)N * N * N);
    for (int z = 0; z < N; z++)
        for (int y = 0; y < N; y++)
            for (int x = 0; x < N; x++) {
                const int dx = x - 16 - 3 * step, dy = y - 30, dz = z - 30;
                const int d = dx * dx + dy * dy + dz * dz - 20 * step;
                v[x + N * (y + N * z)] = (uint8_t)(d > 1000 ? 0 : 250 - (d > 0 ? d / 4 : 0));
            }
    return v;
}

typedef struct stage {
    char series[256], alone[STEPS][256];
    picture want[2][STEPS]; /* of the isosurface, of the medium */
    leafcast_camera view;
} stage;

static const double ISO = 120;

static leafcast_scene scene_of(bool medium) {
    static const leafcast_transfer_point points[2] = {{60, {1, 0.5, 0.2}, 0},
                                                      {250, {0.2, 0.5, 1}, 0.2}};
    static const leafcast_medium filled = {points, 2};
    leafcast_scene scene = leafcast_scene_default();
    scene.media = medium ? &filled : NULL;
    scene.media_count = medium;
    return scene;
}

static leafcast *open_at(const char *path, const leafcast_options *o) {
    const leafcast_surface surface = leafcast_surface_default(ISO);
    leafcast *v;
    assert_int_equal(leafcast_open(path, o, &v), LEAFCAST_OK);
    assert_int_equal(leafcast_select(v, &surface, 1), LEAFCAST_OK);
    return v;
}

static void make_files(stage *s, leaf_codec codec) {
    leaf_case c = leaf_files_case(N, N, N, SAMPLE_U8);
    const char *paths[STEPS];
    c.options.file.codec = codec;
    c.options.file.zstd_level = 1;
    for (int step = 0; step < STEPS; step++) {
        char name[32];
        uint8_t *samples = samples_of(step);
        snprintf(name, sizeof name, "step%d.bin", step);
        paths[step] = strdup(scratch_write(name, samples, (size_t)N * N * N));
        c.samples = samples;
        snprintf(name, sizeof name, "alone%d.leaf", step);
        snprintf(s->alone[step], sizeof s->alone[step], "%s", leaf_files_make(&c, name));
        free(samples);
    }
    const grid_series of = {.of = {.paths = paths, .sets = {1, STEPS, NULL, NULL, NULL}},
                            .hints = {.dims = {N, N, N}, .type = SAMPLE_U8}};
    snprintf(s->series, sizeof s->series, "%s", leaf_files_series(&of, &c.options, "play.leaf"));
    for (int step = 0; step < STEPS; step++)
        free((void *)(uintptr_t)paths[step]);
}

static stage *stage_make(leaf_codec codec) {
    const leafcast_options o = {.size = sizeof o, .threads = 2};
    stage *s = calloc(1, sizeof *s);
    make_files(s, codec);
    s->view = (leafcast_camera){.size = sizeof s->view,
                                .eye = {2.5 * N, 1.7 * N, 2.1 * N},
                                .look_at = {N / 2.0, N / 2.0, N / 2.0},
                                .up = {0, 0, 1},
                                .fov = 30,
                                .width = PICTURE_WIDTH,
                                .height = PICTURE_HEIGHT};
    for (int step = 0; step < STEPS; step++) {
        leafcast *v = open_at(s->alone[step], &o);
        for (int medium = 0; medium < 2; medium++) {
            const leafcast_scene scene = scene_of(medium);
            pictures_draw(v, &scene, &s->view, &s->want[medium][step], NULL);
        }
        leafcast_close(v);
    }
    return s;
}

static void check(const stage *s, const picture *p, int medium, uint32_t step) {
    for (int i = 0; i < PICTURE_PIXELS; i++)
        if (!pictures_same_pixel(p, &s->want[medium][step], i))
            fail_msg("step %u, medium %d: pixel %d", step, medium, i);
}

/* The next step in one of four orders: forward, backward, at random, to and fro. */
static uint32_t next_of(int order, int round, field_random *r) {
    const int at = round % (2 * STEPS - 2);
    switch (order) {
    case 0: return (uint32_t)(round % STEPS);
    case 1: return (uint32_t)(STEPS - 1 - round % STEPS);
    case 2: return (uint32_t)field_random_below(r, STEPS);
    default: return (uint32_t)(at < STEPS ? at : 2 * STEPS - 2 - at);
    }
}

/* Play in some order; each third time another step is expected than the one that comes. */
static void play(const stage *s, const leafcast_options *o, int order) {
    leafcast *v = open_at(s->series, o);
    field_random r = {FIELD_SEED};
    picture *p = malloc(sizeof *p);
    uint32_t step = next_of(order, 0, &r);
    for (int round = 0; round < ROUNDS; round++) {
        const uint32_t next = next_of(order, round + 1, &r);
        const int medium = round / 7 % 2;
        const leafcast_scene scene = scene_of(medium);
        leafcast_stats stats = {.size = sizeof stats};
        assert_int_equal(leafcast_select_set(v, 0, step), LEAFCAST_OK);
        assert_int_equal(leafcast_expect_set(v, 0, round % 3 ? next : (next + 1) % STEPS),
                         LEAFCAST_OK);
        pictures_draw(v, &scene, &s->view, p, &stats);
        check(s, p, medium, step);
        if (o->memory)
            assert_in_range(stats.bytes_peak, 1, o->memory);
        if (round % 2)
            nanosleep(&(struct timespec){0, 500000}, NULL);
        step = next;
    }
    free(p);
    leafcast_close(v);
}

/* The smallest budget that does, for one thread or two. */
static uint64_t least_memory(const stage *s, leafcast_options o) {
    const leafcast_scene scene = scene_of(true);
    picture *p = malloc(sizeof *p);
    leafcast_image image = {
        .size = sizeof image, .r = p->rgba[0], .g = p->rgba[1], .b = p->rgba[2]};
    uint64_t memory = 1 << 20;
    for (bool fits = false; !fits; memory += fits ? 0 : 1 << 18) {
        leafcast *v;
        o.memory = memory;
        fits = leafcast_open(s->series, &o, &v) == LEAFCAST_OK;
        if (fits) {
            fits = leafcast_check_room(v, &scene, &s->view, &image, sizeof *p) == LEAFCAST_OK;
            leafcast_close(v);
        }
    }
    free(p);
    return memory + (1 << 18);
}

static void test_orders(void **state) {
    (void)state;
    for (int codec = LEAF_CODEC_RAW; codec <= LEAF_CODEC_ZSTD; codec++) {
        stage *s = stage_make((leaf_codec)codec);
        leafcast_options o = {.size = sizeof o, .threads = 2};
        const uint64_t least = least_memory(s, o);
        /* Any order has all the threads that the others have: one of each codec. */
        const int first = WATCHED_THREADS ? 2 + codec : 0, end = WATCHED_THREADS ? first + 1 : 4;
        for (int order = first; order < end; order++) {
            for (int backend = LEAFCAST_BACKEND_MAPPED; backend <= LEAFCAST_BACKEND_ARENA;
                 backend++) {
                o.backend = (leafcast_backend)backend;
                o.memory = 0;
                play(s, &o, order);
                o.memory = least + (uint64_t)order * 200000;
                play(s, &o, order);
            }
        }
        free(s);
    }
}

/* Draw a step; another one is expected. Returns the treelets that were read for it, and *ever: all
 * bytes ever read. */
static uint64_t draw(const stage *s, leafcast *v, uint32_t step, uint32_t next, uint64_t *ever) {
    const leafcast_scene scene = scene_of(false);
    leafcast_stats stats = {.size = sizeof stats};
    picture *p = malloc(sizeof *p);
    assert_int_equal(leafcast_select_set(v, 0, step), LEAFCAST_OK);
    assert_int_equal(leafcast_expect_set(v, 0, next), LEAFCAST_OK);
    pictures_draw(v, &scene, &s->view, p, &stats);
    check(s, p, 0, step);
    *ever = stats.bytes_read_ever;
    free(p);
    return stats.treelets_loaded;
}

/* What is expected is there when its picture is drawn; it was read before, and counted. */
static void test_expected(void **state) {
    (void)state;
    stage *s = stage_make(LEAF_CODEC_RAW);
    const leafcast_options o = {.size = sizeof o, .threads = 2, .backend = LEAFCAST_BACKEND_ARENA};
    leafcast *plain = open_at(s->series, &o), *v = open_at(s->series, &o);
    uint64_t before, after, ever;
    (void)draw(s, plain, 0, 0, &ever);
    const uint64_t alone = draw(s, plain, 1, 1, &ever);
    assert_true(alone > 3);
    (void)draw(s, v, 0, 1, &before);
    uint64_t early = 0;
    for (int i = 0; i < 10000 && early == 0; i++) {
        nanosleep(&(struct timespec){0, 1000000}, NULL);
        early = loader_statistics(v->treelets).early;
    }
    const uint64_t read = draw(s, v, 1, 1, &after);
    early = loader_statistics(v->treelets).early;
    assert_in_range(early, 1, alone);
    assert_int_equal(read, alone); /* they count in their picture */
    assert_true(after > before);
    /* Nothing is expected any more. */
    nanosleep(&(struct timespec){0, 5000000}, NULL);
    assert_int_equal(loader_statistics(v->treelets).early, early);
    assert_int_equal(leafcast_expect_set(v, 0, STEPS), LEAFCAST_USAGE);
    assert_int_equal(leafcast_expect_set(v, 1, 0), LEAFCAST_USAGE);
    leafcast_close(plain);
    leafcast_close(v);
    free(s);
}

/* What is in memory of each step: all that was seen of the one that was drawn, and of those that
 * are the same; some of those before; not all of others. */
static void test_mapped(void **state) {
    (void)state;
    for (int codec = WATCHED_THREADS ? LEAF_CODEC_ZSTD : LEAF_CODEC_RAW; codec <= LEAF_CODEC_ZSTD;
         codec++) {
        stage *s = stage_make((leaf_codec)codec);
        leaf_case c = leaf_files_case(N, N, N, SAMPLE_U8);
        c.options.file.codec = (leaf_codec)codec;
        const int of[STEPS] = {0, 2, 0, 4, 2}; /* so that some are the same as earlier ones */
        const char *paths[STEPS];
        for (int step = 0; step < STEPS; step++) {
            char name[32];
            uint8_t *samples = samples_of(of[step]);
            snprintf(name, sizeof name, "again%d.bin", step);
            paths[step] = strdup(scratch_write(name, samples, (size_t)N * N * N));
            free(samples);
        }
        const grid_series series = {.of = {.paths = paths, .sets = {1, STEPS, NULL, NULL, NULL}},
                                    .hints = {.dims = {N, N, N}, .type = SAMPLE_U8}};
        c.options.force = true;
        leafcast *v = open_at(leaf_files_series(&series, &c.options, "again.leaf"), NULL);
        const leafcast_scene scene = scene_of(false);
        const uint32_t order[] = {2, 0, 4, 1, 3, 0, 1, 2, 3, 4};
        bool drawn[STEPS] = {false};
        leafcast_holding map[STEPS];
        picture *p = malloc(sizeof *p);
        for (size_t i = 0; i < sizeof order / sizeof *order; i++) {
            const uint32_t step = order[i];
            leafcast_stats stats = {.size = sizeof stats};
            assert_int_equal(leafcast_select_set(v, 0, step), LEAFCAST_OK);
            pictures_draw(v, &scene, &s->view, p, &stats);
            check(s, p, 0, (uint32_t)of[step]);
            drawn[of[step]] = true;
            assert_int_equal(leafcast_map_steps(v, 0, STEPS, map), LEAFCAST_OK);
            for (int k = 0; k < STEPS; k++) {
                if (of[k] == of[step])
                    assert_int_equal(map[k].resident, map[k].wanted);
                else if (!drawn[of[k]])
                    assert_true(map[k].resident < map[k].wanted);
                else
                    assert_true(map[k].resident > 0);
            }
            assert_true(map[step].wanted > 3 && map[0].wanted != map[3].wanted);
        }
        assert_int_equal(leafcast_map_steps(v, 0, 0, map), LEAFCAST_USAGE);
        assert_int_equal(leafcast_map_steps(v, 0, STEPS + 1, map), LEAFCAST_USAGE);
        free(p);
        leafcast_close(v);
        for (int step = 0; step < STEPS; step++)
            free((void *)(uintptr_t)paths[step]);
        free(s);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_orders),
        cmocka_unit_test(test_expected),
        cmocka_unit_test(test_mapped),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
