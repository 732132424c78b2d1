/* test_between_frames.c - times between the steps of a grid or mesh: what is read and when,
 * budgets, frames by turns, previews, the directory, wrong times, damage.
 */
/* marks: threads */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "formats/leaf/deviation.h"
#include "formats/leaf/leaf_between.h"
#include "formats/leaf/leaf_geometry.h"
#include "render/door/leafcast_volume.h"
#include "render/leafcast_experimental.h"
#include "tests/support/between_lab.h"
#include "tests/support/fields.h"
#include "tests/support/scratch.h"

/* Threads meet in grids as they do in meshes, but that these have two payloads a treelet and step:
 * where races are looked for, most tests are of a mesh whose points move. */
enum { WITH_GRIDS = !WATCHED_THREADS };

/* ---- What is read ---- */

static leafcast_stats draw(const between_lab *s, leafcast *v, uint32_t step, double share) {
    static picture p;
    leafcast_stats stats = {.size = sizeof stats};
    const leafcast_scene scene = between_lab_scene(s, SURFACE);
    between_lab_fine(leafcast_select_between(v, 0, step, share));
    pictures_draw(v, &scene, &s->view, &p, &stats);
    return stats;
}

/* Each of the two steps once; another time between them nothing; the next two the step that is not
 * there. What is the same in both counts once. */
static void test_reading(void **state) {
    static const int kinds[] = {
        0, 5, BETWEEN_GRIDS, BETWEEN_GRIDS + 1, BETWEEN_HEXES, BETWEEN_HEXES + 1};
    (void)state;
    for (size_t i = !WITH_GRIDS; i < sizeof kinds / sizeof *kinds; i += 2 - WITH_GRIDS) {
        between_lab *s = between_lab_make(&between_kinds[kinds[i]]);
        const leafcast_options o = {.size = sizeof o, .threads = 2};
        leafcast *plain = between_lab_open(s->series, &o, s->iso),
                 *v = between_lab_open(s->series, &o, s->iso);
        uint64_t alone = 0;
        for (uint32_t step = 0; step < 2; step++)
            alone += draw(s, plain, step, 0).bytes_read;
        const leafcast_stats first = draw(s, v, 0, 0.25), second = draw(s, v, 0, 0.75);
        assert_in_range(first.treelets_loaded, 3, first.treelets_active);
        assert_true(first.treelets_active < first.treelets_total);
        assert_in_range(first.bytes_read, alone * 9 / 10, alone * 11 / 10);
        assert_true(second.bytes_read_ever > 0);
        /* Rays may see other treelets; those that they saw are not read again. */
        assert_true(second.bytes_read < first.bytes_read / 2);
        assert_int_equal(draw(s, v, 0, 0.25).bytes_read, 0);
        assert_int_equal(draw(s, v, 0, 0.3).treelets_loaded, 0);
        const leafcast_stats next = draw(s, v, 1, 0.5);
        assert_true(next.bytes_read > 0);
        assert_true(next.bytes_read < first.bytes_read * 3 / 4);
        /* Of steps 2 and 3 all treelets but those around one sample are the same. */
        leafcast *single = between_lab_open(s->series, &o, s->iso),
                 *other = between_lab_open(s->series, &o, s->iso);
        const uint64_t one = draw(s, single, 2, 0).bytes_read,
                       both = draw(s, other, 2, 0.5).bytes_read;
        assert_true(both > 0);
        assert_true(both < one + one / 2 + 3 * one / 8);
        assert_true(draw(s, other, 2, 0.5).bytes_read == 0);
        /* So these need not be loaded again for step 3; of tets they are, and where they move. */
        const uint64_t active = draw(s, single, 2, 0).treelets_active,
                       again = draw(s, single, 3, 0).treelets_loaded;
        if (!s->of.mesh || (s->of.cells != BETWEEN_TETS && !s->of.moves))
            assert_true(again <= active / 2);
        leafcast_close(single);
        leafcast_close(other);
        leafcast_close(plain);
        leafcast_close(v);
        between_lab_free(s);
    }
}

/* How much of each step is in memory is told behind a picture of a time between, too: by what its
 * rays saw, and its isovalue. Only of steps that were drawn themselves anything is. */
static void test_map(void **state) {
    (void)state;
    skip_under_thread();
    between_lab *s = between_lab_make(&between_kinds[0]);
    leafcast *v = between_lab_open(s->series, NULL, s->iso + 40);
    const leafcast_surface surface = leafcast_surface_default(s->iso);
    leafcast_holding map[BETWEEN_STEPS], steps[BETWEEN_STEPS];
    between_lab_fine(leafcast_select_between(v, 0, 1, 0.5));
    between_lab_fine(leafcast_select(v, &surface, 1));
    (void)draw(s, v, 1, 0.5);
    between_lab_fine(leafcast_map_steps(v, 0, BETWEEN_STEPS, map));
    for (int step = 0; step < BETWEEN_STEPS; step++)
        assert_true(map[step].wanted > 0 && map[step].resident == 0);
    leafcast *plain = between_lab_open(s->series, NULL, s->iso);
    (void)draw(s, plain, 1, 0);
    between_lab_fine(leafcast_map_steps(plain, 0, BETWEEN_STEPS, steps));
    /* Rays see much the same treelets; half a step further, some more or less. */
    assert_true(map[1].wanted * 4 >= steps[1].wanted * 3 &&
                map[1].wanted * 3 <= steps[1].wanted * 4);
    assert_int_equal(steps[1].resident, steps[1].wanted);
    const leafcast_stats step = draw(s, v, 1, 0);
    assert_int_equal(step.treelets_active, draw(s, plain, 1, 0).treelets_active);
    assert_true(step.treelets_loaded > 0);
    (void)draw(s, v, 0, 0.5);
    between_lab_fine(leafcast_map_steps(v, 0, BETWEEN_STEPS, map));
    assert_true(map[1].resident > 0 && map[1].wanted > 0);
    leafcast_close(plain);
    leafcast_close(v);
    between_lab_free(s);
}

/* What the loader of a volume's own moments has read early; of none, nothing. */
static uint64_t early_of(const leafcast *v) {
    return v ? loader_statistics(v->treelets).early : 0;
}

/* The same, once nothing has come for a while. */
static uint64_t settled(const leafcast *v) {
    uint64_t early = early_of(v);
    for (int quiet = 0; quiet < 20; quiet++) {
        nanosleep(&(struct timespec){0, 1000000}, NULL);
        quiet = early_of(v) == early ? quiet : 0;
        early = early_of(v);
    }
    return early;
}

/* A time between the next two steps that is expected is read once a picture is complete: of the
 * step that is there nothing. It counts in its own picture. */
static void test_expected(void **state) {
    (void)state;
    between_lab *s = between_lab_make(&between_kinds[5]);
    const leafcast_options o = {.size = sizeof o, .threads = 2};
    leafcast *plain = between_lab_open(s->series, &o, s->iso),
             *v = between_lab_open(s->series, &o, s->iso);
    for (uint32_t step = 0; step < 4; step++) /* as many sets as there are, and one anew */
        (void)draw(s, plain, step, 0.5);
    const leafcast_stats alone = draw(s, plain, 4, 0.5);
    assert_true(alone.treelets_loaded > 3);
    for (uint32_t step = 0; step < 4; step++) {
        const uint64_t before = settled(v->between);
        between_lab_fine(leafcast_expect_between(v, 0, step + 1, 0.5));
        (void)draw(s, v, step, 0.25);
        (void)draw(s, v, step, 0.75);
        uint64_t early = early_of(v->between);
        for (int i = 0; i < 10000 && step != 1 && early == before; i++) {
            between_lab_fine(leafcast_expect_between(v, 0, step + 1, 0.5));
            (void)draw(s, v, step, 0.5);
            nanosleep(&(struct timespec){0, 1000000}, NULL);
            early = early_of(v->between);
        }
        assert_true(early > before || step == 1); /* steps 2 and 3 are mostly the same */
    }
    const leafcast_stats next = draw(s, v, 4, 0.5);
    assert_true(next.treelets_loaded <= alone.treelets_loaded);
    assert_true(draw(s, v, 4, 0.5).bytes_read_ever == next.bytes_read_ever);
    between_lab_refused(leafcast_expect_between(v, 0, BETWEEN_STEPS - 1, 0.5), LEAFCAST_USAGE,
                        "no next one");
    between_lab_refused(leafcast_expect_between(v, 0, 0, 1), LEAFCAST_USAGE, "below 1");
    leafcast_close(plain);
    leafcast_close(v);
    between_lab_free(s);
}

/* Draw a moment again and again until nothing more is read for the loader of other moments. Returns
 * how many treelets were. */
static uint64_t read_behind(const between_lab *s, leafcast *v, uint32_t step, double share,
                            const leafcast *other) {
    const uint64_t before = early_of(other);
    uint64_t early, last = before;
    for (int i = 0; i < 2000; i++, last = early) {
        (void)draw(s, v, step, share);
        early = settled(other);
        if (early == last && early > before)
            break;
    }
    return last - before;
}

/* Between steps, at a step and between steps again, as movies go: what of the step is expected is
 * read behind pictures of the time before, and what of the time behind it, behind the step's. */
static void check_landing(const between_kind *of) {
    between_lab *s = between_lab_make(of);
    const leafcast_options o = {.size = sizeof o, .threads = 2};
    const leafcast_surface surface = leafcast_surface_default(s->iso);
    leafcast *v = between_lab_open(s->series, &o, s->iso + 40);
    (void)draw(s, v, 4, 0.5); /* so that there is a volume of times between; it shows this: */
    between_lab_fine(leafcast_select(v, &surface, 1));
    (void)draw(s, v, 0, 0.75);
    between_lab_fine(leafcast_expect_set(v, 0, 1));
    const uint64_t step = read_behind(s, v, 0, 0.75, v);
    const leafcast_stats landed = draw(s, v, 1, 0);
    assert_in_range(step, landed.treelets_loaded * 3 / 4, landed.treelets_loaded * 5 / 4);
    assert_true(step > 3);
    between_lab_fine(leafcast_expect_between(v, 0, 1, 0.25));
    const uint64_t time = read_behind(s, v, 1, 0, v->between);
    const uint64_t before = loader_statistics(v->between->treelets).bytes_read_ever;
    const leafcast_stats on = draw(s, v, 1, 0.25);
    assert_in_range(time, on.treelets_loaded * 3 / 4, on.treelets_loaded * 5 / 4);
    assert_true(time > 3 && on.bytes_read_ever - before < on.bytes_read / 4);
    /* Nothing is expected any more. */
    assert_false(loader_is_expecting(v->treelets) || loader_is_expecting(v->between->treelets));
    leafcast_close(v);
    between_lab_free(s);
}

static void test_landing(void **state) {
    (void)state;
    if (WITH_GRIDS) {
        check_landing(&between_kinds[0]);
        check_landing(&between_kinds[5]);
    }
    check_landing(&between_kinds[BETWEEN_GRIDS]);
    check_landing(&between_kinds[BETWEEN_HEXES + 1]);
}

/* Within a budget only what belongs to the picture is read. */
static void test_landing_within(void **state) {
    (void)state;
    between_lab *s = between_lab_make(&between_kinds[BETWEEN_GRIDS]);
    const leafcast_options o = {.size = sizeof o, .threads = 2, .memory = 64 << 20};
    leafcast *v = between_lab_open(s->series, &o, s->iso);
    (void)draw(s, v, 1, 0);
    (void)draw(s, v, 0, 0.75);
    between_lab_fine(leafcast_expect_set(v, 0, 2));
    for (int i = 0; i < 5; i++) {
        (void)draw(s, v, 0, 0.75);
        nanosleep(&(struct timespec){0, 3000000}, NULL);
    }
    assert_int_equal(early_of(v), 0);
    leafcast_close(v);
    between_lab_free(s);
}

/* Played forward, backward and at random, at the same shares or others, each picture is that of a
 * volume that has seen no other. */
static void test_playing(void **state) {
    static picture want[BETWEEN_STEPS - 1][2], is;
    static const int kinds[] = {0,
                                4,
                                BETWEEN_GRIDS + 1,
                                BETWEEN_GRIDS + 2,
                                BETWEEN_HEXES + 1,
                                BETWEEN_HEXES + 2,
                                BETWEEN_HEXES + 3};
    (void)state;
    /* A grid, a mesh and hexahedra have all the threads that the others have. */
    for (size_t k = 0; k < sizeof kinds / sizeof *kinds; k += WATCHED_THREADS ? 2 : 1) {
        between_lab *s = between_lab_make(&between_kinds[kinds[k]]);
        const leafcast_scene scene = between_lab_scene(s, SHADOWS);
        field_random r = {FIELD_SEED};
        for (uint32_t i = 0; i < 2 * (BETWEEN_STEPS - 1); i++) {
            leafcast *fresh = between_lab_open(s->series, NULL, s->iso);
            between_lab_fine(leafcast_select_between(fresh, 0, i / 2, i % 2 ? 0.5 : 0.25));
            pictures_draw(fresh, &scene, &s->view, &want[i / 2][i % 2], NULL);
            leafcast_close(fresh);
        }
        leafcast *v = between_lab_open(s->series, NULL, s->iso);
        for (int round = 0; round < (WATCHED_THREADS ? 25 : 40); round++) {
            const int last = BETWEEN_STEPS - 2, at = round % (2 * last);
            const int step = round > 20  ? (int)field_random_below(&r, last + 1)
                             : at < last ? at
                                         : 2 * last - at;
            const int half = round > 20 ? (int)field_random_below(&r, 2) : round > 10;
            const uint32_t next = (uint32_t)field_random_below(&r, last + 1);
            between_lab_fine(leafcast_select_between(v, 0, (uint32_t)step, half ? 0.5 : 0.25));
            if (round % 3)
                between_lab_fine(leafcast_expect_between(v, 0, next, round % 2 ? 0.5 : 0.25));
            pictures_draw(v, &scene, &s->view, &is, NULL);
            if (round % 2)
                nanosleep(&(struct timespec){0, 500000}, NULL);
            assert_true(between_lab_same(&is, &want[step][half], "played") > 20);
        }
        leafcast_close(v);
        between_lab_free(s);
    }
}

/* No share of the way is the step itself, drawn as ever; so is a step behind a time between. */
static void check_steps(const between_kind *of) {
    static picture want, is;
    between_lab *s = between_lab_make(of);
    leafcast *plain = between_lab_open(s->series, NULL, s->iso),
             *v = between_lab_open(s->series, NULL, s->iso);
    const leafcast_scene scene = between_lab_scene(s, SHADOWS);
    for (uint32_t step = 0; step < BETWEEN_STEPS; step++) {
        between_lab_fine(leafcast_select_set(plain, 0, step));
        between_lab_fine(leafcast_select_between(v, 0, step, 0));
        pictures_draw(plain, &scene, &s->view, &want, NULL);
        pictures_draw(v, &scene, &s->view, &is, NULL);
        assert_true(between_lab_same(&is, &want, "a step") > 20);
        (void)draw(s, v, step < BETWEEN_STEPS - 1 ? step : 0, 0.5);
    }
    leafcast_close(plain);
    leafcast_close(v);
    between_lab_free(s);
}

static void test_steps(void **state) {
    (void)state;
    if (WITH_GRIDS) {
        check_steps(&between_kinds[0]);
        check_steps(&between_kinds[BETWEEN_GRIDS]);
    }
    check_steps(&between_kinds[BETWEEN_GRIDS + 1]);
    check_steps(&between_kinds[BETWEEN_HEXES + 3]);
}

/* ---- Budgets, frames ---- */

static void check_budgets(const between_kind *of) {
    static picture want, is;
    between_lab *s = between_lab_make(of);
    const leafcast_scene scene = between_lab_scene(s, SHADOWS);
    leafcast *plain = between_lab_open(s->series, NULL, s->iso);
    between_lab_fine(leafcast_select_between(plain, 0, 3, 0.3));
    pictures_draw(plain, &scene, &s->view, &want, NULL);
    int refusals = 0, drawn = 0;
    for (uint64_t memory = 1 << 20; drawn < 3; memory += WATCHED ? 500000 : 100000) {
        const leafcast_options o = {.size = sizeof o, .threads = 2, .memory = memory};
        leafcast *v = NULL;
        if (leafcast_open(s->series, &o, &v) != LEAFCAST_OK) {
            refusals++;
            continue;
        }
        const leafcast_surface surface = leafcast_surface_default(s->iso);
        const leafcast_image image = {.size = sizeof image,
                                      .r = is.rgba[0],
                                      .g = is.rgba[1],
                                      .b = is.rgba[2],
                                      .a = is.rgba[3],
                                      .z = is.z,
                                      .normal = {is.normal[0], is.normal[1], is.normal[2]},
                                      .id = is.id};
        leafcast_stats stats = {.size = sizeof stats};
        between_lab_fine(leafcast_select(v, &surface, 1));
        between_lab_fine(leafcast_select_between(v, 0, 3, 0.3));
        const leafcast_status st = leafcast_trace(v, &scene, &s->view, &image, &stats, NULL, NULL);
        if (st == LEAFCAST_OK) {
            (void)between_lab_same(&is, &want, "a small budget");
            assert_in_range(stats.bytes_peak, 1, memory);
            drawn++;
        } else {
            assert_int_equal(st, LEAFCAST_NOMEM);
            refusals++;
        }
        leafcast_close(v);
    }
    assert_true(refusals > 0);
    /* One treelet at a time. */
    const leafcast_options few = {.size = sizeof few,
                                  .threads = 2,
                                  .experiments = &(leafcast_experiments){
                                      .size = sizeof(leafcast_experiments), .treelet_limit = 1}};
    leafcast *v = between_lab_open(s->series, &few, s->iso);
    between_lab_fine(leafcast_select_between(v, 0, 3, 0.3));
    pictures_draw(v, &scene, &s->view, &is, NULL);
    (void)between_lab_same(&is, &want, "one treelet");
    leafcast_close(v);
    leafcast_close(plain);
    between_lab_free(s);
}

static void test_budgets(void **state) {
    (void)state;
    if (WITH_GRIDS) {
        check_budgets(&between_kinds[4]);
        check_budgets(&between_kinds[BETWEEN_GRIDS]);
    }
    check_budgets(&between_kinds[BETWEEN_GRIDS + 3]);
    check_budgets(&between_kinds[BETWEEN_HEXES + 3]);
}

/* Frames at many times that go on by turns: each has its own time to its end. */
static void check_turns(const between_kind *of) {
    enum { FRAMES = 7 };
    static picture want[FRAMES], is[FRAMES];
    between_lab *s = between_lab_make(of);
    leafcast *v = between_lab_open(s->series, NULL, s->iso);
    leafcast_frame *frame[FRAMES];
    const leafcast_surface surface = leafcast_surface_default(s->iso);
    leafcast_shown shown[FRAMES];
    leafcast_scene scene[FRAMES];
    bool done[FRAMES] = {false}, all = false;
    for (int i = 0; i < FRAMES; i++) {
        shown[i] = (leafcast_shown){.volume = v,
                                    .step = (uint32_t)(i * 2 % (BETWEEN_STEPS - 1)),
                                    .surfaces = &surface,
                                    .count = 1,
                                    .between = i == 3 ? 0 : 0.125 * (i + 1)};
        scene[i] = between_lab_scene(s, SHADOWS);
        scene[i].volumes = &shown[i];
        scene[i].volume_count = 1;
        pictures_draw(v, &scene[i], &s->view, &want[i], NULL);
    }
    for (int i = 0; i < FRAMES; i++) {
        picture *p = &is[i];
        const leafcast_image image = {.size = sizeof image,
                                      .r = p->rgba[0],
                                      .g = p->rgba[1],
                                      .b = p->rgba[2],
                                      .a = p->rgba[3],
                                      .z = p->z,
                                      .normal = {p->normal[0], p->normal[1], p->normal[2]},
                                      .id = p->id};
        between_lab_fine(leafcast_frame_begin(v, &scene[i], &s->view, &image, &frame[i]));
    }
    while (!all) {
        all = true;
        for (int i = 0; i < FRAMES; i++) {
            if (!done[i])
                between_lab_fine(leafcast_frame_advance(frame[i], 0, &done[i], NULL));
            all &= done[i];
        }
    }
    for (int i = 0; i < FRAMES; i++) {
        leafcast_frame_end(frame[i]);
        assert_true(between_lab_same(&is[i], &want[i], "by turns") > 20);
    }
    leafcast_close(v);
    between_lab_free(s);
}

static void test_turns(void **state) {
    (void)state;
    if (WITH_GRIDS) {
        check_turns(&between_kinds[0]);
        check_turns(&between_kinds[BETWEEN_GRIDS]);
    }
    check_turns(&between_kinds[BETWEEN_GRIDS + 1]);
    check_turns(&between_kinds[BETWEEN_HEXES + 1]);
}

/* What a preview does not mark is exact; some of it is marked at first, and in the end nothing. */
static void check_previews(const between_kind *of) {
    static picture want, is;
    between_lab *s = between_lab_make(of);
    leafcast *v = between_lab_open(s->series, NULL, s->iso),
             *plain = between_lab_open(s->series, NULL, s->iso);
    leafcast_scene scene = between_lab_scene(s, SURFACE);
    between_lab_fine(leafcast_select_between(plain, 0, 0, 0.3));
    pictures_draw(plain, &scene, &s->view, &want, NULL);
    between_lab_fine(leafcast_select_between(v, 0, 0, 0.3));
    scene.preview = true;
    int marked = PICTURE_PIXELS;
    for (int round = 0; round < 100 && marked > 0; round++) {
        marked = 0;
        pictures_draw(v, &scene, &s->view, &is, NULL);
        for (int i = 0; i < PICTURE_PIXELS; i++) {
            marked += is.provisional[i];
            if (!is.provisional[i])
                assert_true(is.z[i] == want.z[i]);
        }
    }
    assert_int_equal(marked, 0);
    leafcast_close(plain);
    leafcast_close(v);
    between_lab_free(s);
}

static void test_previews(void **state) {
    (void)state;
    if (WITH_GRIDS)
        check_previews(&between_kinds[0]);
    check_previews(&between_kinds[BETWEEN_GRIDS + 1]);
}

/* ---- The directory ---- */

/* Coarse levels are no further from level 0 than deviations say, at any point of some slices. */
static void check_deviations(const between_lab *s, leaf_file *f, const leaf_moment *at) {
    enum { SIDE = WATCHED ? 45 : 90 };
    static double fine_value[SIDE * SIDE], value[SIDE * SIDE];
    const leaf_layout *l = &f->layout;
    const uint32_t set = leaf_between_select(f, at);
    leafcast *v = between_lab_open(s->series, NULL, s->iso);
    int compared = 0;
    between_lab_fine(leafcast_select_between(v, 0, at->step, at->share));
    for (uint32_t level = 1; level < l->sampled; level++)
        for (int z = 0; z < 5; z++) {
            leafcast_slice_pixels p = {
                .size = sizeof p, .width = SIDE, .height = SIDE, .origin = {0, 0, 8.3 * z}};
            p.u[0] = p.v[1] = BETWEEN_SIDE - 1;
            between_lab_fine(leafcast_sample_slice(v, &p, fine_value, NULL, NULL, NULL));
            p.level = level;
            between_lab_fine(leafcast_sample_slice(v, &p, value, NULL, NULL, NULL));
            for (int i = 0; i < SIDE * SIDE; i++) {
                const double where[3] = {(i % SIDE + 0.5) / SIDE * (BETWEEN_SIDE - 1),
                                         (i / SIDE + 0.5) / SIDE * (BETWEEN_SIDE - 1), 8.3 * z};
                uint32_t cell[3], place[3];
                for (int a = 0; a < 3; a++) {
                    cell[a] = (uint32_t)where[a] >> level;
                    place[a] = cell[a] >> l->cells_log2;
                    cell[a] -= place[a] << l->cells_log2;
                }
                const uint32_t t = leaf_layout_find(l, level, place);
                const double most =
                    deviation_value(f->deviations[deviation_at(l, set, t) +
                                                  deviation_brick(l, cell[0], cell[1], cell[2])]);
                if (isnan(fine_value[i]) || isnan(value[i]))
                    continue;
                compared += most < (double)INFINITY;
                if (!(fabs(fine_value[i] - value[i]) <= most * (1 + 1e-9)))
                    fail_msg("type %d, step %u, level %u at %g,%g,%g: off by %g, expected %g or "
                             "less",
                             s->of.type, at->step, level, where[0], where[1], where[2],
                             fabs(fine_value[i] - value[i]), most);
            }
        }
    assert_true(compared > 0);
    leafcast_close(v);
}

/* A set's ranges hold all samples of the file that has these alone. */
static void check_ranges(const leaf_file *f, uint32_t set, const leaf_file *one) {
    assert_int_equal(one->layout.treelets, f->layout.treelets);
    for (uint32_t t = 0; t < one->layout.treelets; t++) {
        const uint32_t p = leaf_layout_samples(&f->layout, set, t);
        const float *own = one->own[t];
        assert_true(f->flags[p] >= one->flags[t]);
        if (one->layout.level_of[t] == 0 && own[0] <= own[1])
            assert_true(f->own[p][0] <= own[0] && own[1] <= f->own[p][1]);
        assert_true(f->ranges[p][0] <= f->own[p][0] && f->own[p][1] <= f->ranges[p][1]);
    }
}

/* The same of all treelets together, and of their boxes: where points move, that file's treelets
 * have other tets. */
static void check_hull(const leaf_file *f, uint32_t set, const leaf_file *one) {
    const leaf_file *of[2] = {f, one};
    double lo[2][4], hi[2][4];
    for (int i = 0; i < 2; i++)
        for (uint32_t t = 0; t < of[i]->layout.treelets; t++) {
            const uint32_t at = i ? 0 : set;
            const float *own = of[i]->own[leaf_layout_samples(&of[i]->layout, at, t)];
            float(*boxes)[6] = of[i]->geometry->section(of[i], LEAF_SECTION_BOUNDS);
            const float *box = boxes[leaf_layout_bounds(&of[i]->layout, at, t)];
            for (int a = 0; a < 4; a++) {
                const double least = (double)(a < 3 ? box[a] : own[0]);
                const double most = (double)(a < 3 ? box[a + 3] : own[1]);
                lo[i][a] = t ? fmin(lo[i][a], least) : least;
                hi[i][a] = t ? fmax(hi[i][a], most) : most;
            }
        }
    for (int a = 0; a < 4; a++) {
        assert_true(lo[0][a] <= lo[1][a] && hi[1][a] <= hi[0][a]);
        assert_true(hi[0][a] - lo[0][a] <= 1.1 * (hi[1][a] - lo[1][a]));
    }
}

static void test_directory(void **state) {
    (void)state;
    skip_under_thread();
    for (uint32_t i = 0; i < BETWEEN_KINDS; i++) {
        between_lab *s = between_lab_make(&between_kinds[i]);
        mem m;
        leaf_file *below = NULL, *f = NULL, *one = NULL;
        mem_init(&m, 0);
        assert_int_equal(leaf_file_open(&m, s->series, &below), ST_OK);
        assert_int_equal(leaf_between_open(&m, below, CPU_SCALAR, &f), ST_OK);
        for (uint32_t step = 0; step + 1 < BETWEEN_STEPS; step++) {
            const leaf_moment at = {0, step, between_shares[step]};
            float *samples = between_lab_blend(s, step, at.share);
            const uint32_t set = leaf_between_select(f, &at), n = f->layout.treelets;
            assert_int_equal(leaf_file_open(&m, between_lab_alone(s, samples), &one), ST_OK);
            if (s->of.moves)
                check_hull(f, set, one);
            else
                check_ranges(f, set, one);
            assert_int_equal(n, below->layout.treelets);
            if (f->deviations)
                check_deviations(s, f, &at);
            leaf_file_close(one);
            free(samples);
        }
        assert_int_equal(f->versions[s->of.moves], 2); /* more pairs of steps than sets */
        leaf_file_close(f);
        leaf_file_close(below);
        assert_int_equal(mem_used(&m), 0);
        between_lab_free(s);
    }
}

/* ---- Times ---- */

static void test_times(void **state) {
    (void)state;
    between_lab *s = between_lab_make(&between_kinds[0]);
    leafcast *v = between_lab_open(s->series, NULL, s->iso);
    uint32_t step = 9;
    double share = 9;
    for (uint32_t i = 0; i < BETWEEN_STEPS; i++) {
        between_lab_fine(leafcast_find_time(v, between_times[i], &step, &share));
        assert_int_equal(step, i);
        assert_true(share == 0);
    }
    between_lab_fine(leafcast_find_time(v, 4, &step, &share));
    assert_int_equal(step, 2);
    assert_true(share == 0.25);
    between_lab_fine(leafcast_find_time(v, nextafter(1e6, 0), &step, &share));
    assert_int_equal(step, 3);
    assert_true(share < 1 && share > 0.999);
    between_lab_fine(
        leafcast_find_time(v, nextafter(1, 0), &step, &share)); /* the share rounds to 1 */
    assert_int_equal(step, 1);
    assert_true(share == 0);
    between_lab_refused(leafcast_find_time(v, -3.5, &step, &share), LEAFCAST_USAGE,
                        "times from -3 to 2e+06");
    between_lab_refused(leafcast_find_time(v, 3e6, &step, &share), LEAFCAST_USAGE,
                        "times from -3 to 2e+06");
    between_lab_refused(leafcast_find_time(v, NAN, &step, &share), LEAFCAST_USAGE, "times from");
    between_lab_refused(leafcast_select_between(v, 0, BETWEEN_STEPS - 1, 0.5), LEAFCAST_USAGE,
                        "there is no next one");
    between_lab_refused(leafcast_select_between(v, 0, BETWEEN_STEPS, 0.5), LEAFCAST_USAGE,
                        "6 steps");
    between_lab_refused(leafcast_select_between(v, 1, 0, 0.5), LEAFCAST_USAGE, "1 fields");
    between_lab_refused(leafcast_select_between(v, 0, 0, 1), LEAFCAST_USAGE,
                        "between is 1: 0 to below 1");
    between_lab_refused(leafcast_select_between(v, 0, 0, -1e-300), LEAFCAST_USAGE, "between");
    between_lab_refused(leafcast_select_between(v, 0, 0, NAN), LEAFCAST_USAGE, "between");
    leafcast_close(v);
    between_lab_free(s);
}

/* ---- Damage ---- */

/* Bytes of the second step alone are wrong: that is told, by the name of the file; the time between
 * the two steps before is drawn. */
static void check_damage(const between_kind *of) {
    static picture p;
    between_lab *s = between_lab_make(of);
    mem m;
    leaf_file *f = NULL;
    size_t size;
    mem_init(&m, 0);
    assert_int_equal(leaf_file_open(&m, s->series, &f), ST_OK);
    char *bytes = scratch_read(s->series, &size);
    for (uint32_t t = 0; t < f->layout.treelets; t++) {
        const uint32_t at = s->of.mesh ? leaf_layout_values(&f->layout, 4, t)
                                       : leaf_layout_samples(&f->layout, 4, t);
        if (leaf_file_is_home(f, at))
            bytes[f->offsets[at] + 1000] ^= 1;
    }
    leaf_file_close(f);
    leafcast *v = between_lab_open(scratch_write("damaged.leaf", bytes, size), NULL, s->iso);
    leafcast_scene scene = between_lab_scene(s, SURFACE);
    const leafcast_image image = {.size = sizeof image, .z = p.z};
    (void)draw(s, v, 2, 0.5);
    between_lab_fine(leafcast_select_between(v, 0, 3, 0.5));
    between_lab_refused(leafcast_trace(v, &scene, &s->view, &image, NULL, NULL, NULL),
                        LEAFCAST_CORRUPT, "damaged.leaf");
    (void)draw(s, v, 2, 0.25);
    (void)scratch_write("damaged.leaf", bytes, size / 2);
    between_lab_refused(leafcast_trace(v, &scene, &s->view, &image, NULL, NULL, NULL),
                        LEAFCAST_CORRUPT, "damaged.leaf");
    leafcast_close(v);
    free(bytes);
    between_lab_free(s);
}

static void test_damage(void **state) {
    (void)state;
    if (WITH_GRIDS) {
        check_damage(&between_kinds[1]);
        check_damage(&between_kinds[BETWEEN_GRIDS]);
    }
    check_damage(&between_kinds[BETWEEN_GRIDS + 3]);
    check_damage(&between_kinds[BETWEEN_HEXES]);
    check_damage(&between_kinds[BETWEEN_HEXES + 3]);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_reading),        cmocka_unit_test(test_map),
        cmocka_unit_test(test_expected),       cmocka_unit_test(test_landing),
        cmocka_unit_test(test_landing_within), cmocka_unit_test(test_playing),
        cmocka_unit_test(test_steps),          cmocka_unit_test(test_budgets),
        cmocka_unit_test(test_turns),          cmocka_unit_test(test_previews),
        cmocka_unit_test(test_directory),      cmocka_unit_test(test_times),
        cmocka_unit_test(test_damage),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
