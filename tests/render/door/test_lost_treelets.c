/* test_lost_treelets.c - treelets that cannot be read: pixels without a mark are exact, those with
 * one are not far off, and nobody who does not allow it goes without. */
/* marks: threads */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "formats/leaf/leaf_file.h"
#include "render/door/leafcast_volume.h"
#include "tests/support/fixture.h"
#include "tests/support/leaf_parts.h"
#include "tests/support/pictures.h"
#include "tests/support/scratch.h"

enum { NODES = 60, CELLS_LOG2 = 4, SPARED = 3 };

typedef struct stage {
    leafcast *whole, *broken;
    leafcast_camera view;
    leafcast_scene scene;
    char path[2][256];
} stage;

static double iso;

/* Damage all treelets of level 0 but each third, and a half of those of level 1. */
static void damage_most(const char *path) {
    mem m;
    leaf_file *f;
    mem_init(&m, 0);
    assert_int_equal(leaf_file_open(&m, path, &f), ST_OK);
    const leaf_layout *layout = &f->layout;
    for (uint32_t t = 0; t < layout->treelets; t++)
        if (f->sizes[t] &&
            (layout->level_of[t] == 0 ? t % SPARED > 0 : layout->level_of[t] == 1 && t % 2))
            leaf_parts_damage(path, f->offsets[t] + f->sizes[t] / 2);
    leaf_file_close(f);
}

static void select_iso(const stage *s, double value) {
    const leafcast_surface surface = leafcast_surface_default(value);
    assert_int_equal(leafcast_select(s->whole, &surface, 1), LEAFCAST_OK);
    assert_int_equal(leafcast_select(s->broken, &surface, 1), LEAFCAST_OK);
}

static void stage_open(stage *s, const char *name) {
    field f;
    const leafcast_options o = {.size = sizeof o, .threads = 3};
    assert_true(field_make(&f, name, NODES, FIELD_SEED));
    iso = f.iso;
    for (int i = 0; i < 2; i++) {
        const char *made = fixture_leaf(&f, CELLS_LOG2, 1, false);
        snprintf(s->path[i], sizeof s->path[i], "%s", scratch_path(i ? "lost.leaf" : "all.leaf"));
        assert_int_equal(rename(made, s->path[i]), 0);
    }
    field_release(&f);
    damage_most(s->path[1]);
    s->whole = fixture_open(s->path[0], &o);
    s->broken = fixture_open(s->path[1], &o);
    s->scene = leafcast_scene_default();
    s->view = (leafcast_camera){.size = sizeof s->view,
                                .eye = {2.5 * NODES, 1.7 * NODES, 2.1 * NODES},
                                .look_at = {NODES / 2.0, NODES / 2.0, NODES / 2.0},
                                .up = {0, 0, 1},
                                .fov = 30,
                                .width = PICTURE_WIDTH,
                                .height = PICTURE_HEIGHT};
    select_iso(s, iso);
}

static void stage_close(stage *s) {
    leafcast_close(s->whole);
    leafcast_close(s->broken);
}

static leafcast_status draw(leafcast *v, const stage *s, leafcast_stats *stats) {
    static float r[PICTURE_PIXELS];
    leafcast_image image = {.size = sizeof image, .r = r};
    return leafcast_trace(v, &s->scene, &s->view, &image, stats, NULL, NULL);
}

/* An isovalue that smoothed levels do not have: nothing stands in. 0: the field's own. */
typedef struct subject {
    const char *name;
    double iso;
    bool smooth; /* coarser levels are near */
} subject;

static void check_pixels(stage *s, const subject *x) {
    static picture exact, got;
    leafcast_stats stats = {.size = sizeof stats};
    uint64_t marked = 0;
    int off = 0, near = 0;
    s->scene.allow_missing = false;
    pictures_draw(s->whole, &s->scene, &s->view, &exact, NULL);
    s->scene.allow_missing = true;
    pictures_draw(s->broken, &s->scene, &s->view, &got, &stats);
    for (int i = 0; i < PICTURE_PIXELS; i++) {
        const bool same = pictures_same_pixel(&got, &exact, i);
        marked += got.provisional[i];
        off += !same;
        near += !same && fabs(got.z[i] - exact.z[i]) < 4.0;
        if (!same && !got.provisional[i])
            fail_msg("%s, %d samples, pixel %d: not marked, and not exact: %g, expected %g",
                     x->name, s->scene.samples, i, got.z[i], exact.z[i]);
    }
    assert_true(stats.treelets_lost > 0 && strstr(stats.lost_why, "checksum"));
    assert_int_equal(marked, stats.provisional_pixels);
    assert_true(off > PICTURE_PIXELS / 40);
    if (x->smooth && s->scene.samples < 2)
        assert_true(near > off * 3 / 4);
}

static void test_pixels(void **state) {
    static const subject subjects[] = {
        {"sphere", 0, true}, {"waves", 0, false}, {"noise-u8", 0, false}, {"noise-u8", 215, false}};
    (void)state;
    for (size_t n = 0; n < sizeof subjects / sizeof *subjects; n++) {
        stage s;
        stage_open(&s, subjects[n].name);
        if (subjects[n].iso > 0)
            select_iso(&s, subjects[n].iso);
        check_pixels(&s, &subjects[n]);
        s.scene.samples = 4;
        check_pixels(&s, &subjects[n]);
        stage_close(&s);
    }
}

/* Which treelets are found to be lost first is chance; the picture is not. */
static void test_the_same(void **state) {
    static picture first, again;
    const subject one = {"waves", 0, false};
    stage s;
    (void)state;
    stage_open(&s, one.name);
    s.scene.allow_missing = true;
    pictures_draw(s.broken, &s.scene, &s.view, &first, NULL);
    for (int i = 0; i < (WATCHED ? 5 : 40); i++) {
        leafcast *other = fixture_open(
            s.path[1], &(leafcast_options){.size = sizeof(leafcast_options), .threads = 1 + i % 8});
        const leafcast_surface surface = leafcast_surface_default(iso);
        assert_int_equal(leafcast_select(other, &surface, 1), LEAFCAST_OK);
        pictures_draw(other, &s.scene, &s.view, &again, NULL);
        assert_memory_equal(&first, &again, sizeof first);
        leafcast_close(other);
    }
    stage_close(&s);
}

/* After a picture that goes without, whoever does not allow it finds the fault again, and waits for
 * nothing that does not come. */
static void test_others_want_all(void **state) {
    static leafcast_ray rays[PICTURE_PIXELS];
    static leafcast_ray_hit hits[PICTURE_PIXELS];
    leafcast_stats stats = {.size = sizeof stats};
    leafcast_hit probed[4];
    int refused = 0, found;
    stage s;
    (void)state;
    stage_open(&s, "sphere");
    for (int i = 0; i < PICTURE_PIXELS; i++) {
        leafcast_pixel_ray(&s.view, i % PICTURE_WIDTH + 0.5, i / PICTURE_WIDTH + 0.5,
                           rays[i].origin, rays[i].direction);
        rays[i].t1 = INFINITY;
    }
    for (int round = 0; round < 2; round++) {
        s.scene.allow_missing = true;
        assert_int_equal(draw(s.broken, &s, &stats), LEAFCAST_OK);
        assert_true(stats.treelets_lost > 0 && stats.lost_why);
        const uint64_t lost = stats.treelets_lost;
        assert_int_equal(leafcast_trace_rays(s.broken, &s.scene, rays, PICTURE_PIXELS, hits),
                         LEAFCAST_CORRUPT);
        assert_int_equal(draw(s.broken, &s, &stats), LEAFCAST_OK);
        assert_int_equal(stats.treelets_lost, lost);
        for (int i = 0; i < PICTURE_PIXELS; i++)
            refused += leafcast_probe_ray(s.broken, &s.scene, rays[i].origin, rays[i].direction,
                                          probed, 4, &found) == LEAFCAST_CORRUPT;
        assert_true(refused > PICTURE_PIXELS / 40);
        assert_int_equal(draw(s.broken, &s, &stats), LEAFCAST_OK);
        s.scene.allow_missing = false;
        assert_int_equal(draw(s.broken, &s, &stats), LEAFCAST_CORRUPT);
        s.scene.preview = s.scene.allow_missing = true;
        assert_int_equal(draw(s.whole, &s, &stats), LEAFCAST_OK);
        s.scene.preview = false;
    }
    s.scene.allow_missing = true;
    assert_int_equal(draw(s.whole, &s, &stats), LEAFCAST_OK);
    assert_true(stats.treelets_lost == 0 && !stats.lost_why && stats.provisional_pixels == 0);
    stage_close(&s);
}

static void test_refused(void **state) {
    static const leafcast_project extremes[] = {LEAFCAST_PROJECT_MAX, LEAFCAST_PROJECT_MIN};
    leafcast_stats stats = {.size = sizeof stats};
    stage s;
    (void)state;
    stage_open(&s, "sphere");
    s.scene.allow_missing = true;
    for (int i = 0; i < 2; i++) {
        s.scene.project = extremes[i];
        assert_int_equal(draw(s.whole, &s, &stats), LEAFCAST_USAGE);
    }
    s.scene.project = LEAFCAST_PROJECT_NONE;
    s.scene.caps = true;
    assert_int_equal(draw(s.whole, &s, &stats), LEAFCAST_USAGE);
    s.scene.caps = false;
    s.scene.project = LEAFCAST_PROJECT_MEAN;
    assert_int_equal(draw(s.whole, &s, &stats), LEAFCAST_OK);
    stage_close(&s);
}

/* What is asked for may turn out to be lost while others are sent away. */
static void test_admit(void **state) {
    stage s;
    (void)state;
    stage_open(&s, "sphere");
    loader *l = s.broken->treelets;
    uint32_t bad = 0;
    while (!l->own[bad] || l->file->layout.level_of[bad] > 0 || bad % SPARED == 0)
        bad++;
    for (int i = 0; i < 500; i++) {
        loader_request request = {bad, 0};
        loader_forget_failures(l);
        loader_tolerate(l);
        loader_want(l, &request, 1);
        if (i % 2)
            assert_int_equal(loader_settle(l), ST_OK);
        assert_int_equal(loader_admit(l, &request, 1), ST_OK);
        assert_true(loader_is_lost(l, bad) && !loader_lookup(l, bad));
    }
    loader_forget_failures(l);
    loader_request request = {bad, 0};
    assert_int_equal(loader_admit(l, &request, 1), ST_CORRUPT);
    stage_close(&s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_pixels),          cmocka_unit_test(test_the_same),
        cmocka_unit_test(test_others_want_all), cmocka_unit_test(test_refused),
        cmocka_unit_test(test_admit),
    };
    alarm(WATCHED ? 600 : 60); /* who waits for ever ends */
    return cmocka_run_group_tests(tests, NULL, NULL);
}
