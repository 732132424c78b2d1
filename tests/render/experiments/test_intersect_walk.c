/* test_intersect_walk.c - rays that walk by a function of their own: by the exact intersector they
 * see what the product sees; by an approximate one the same with every ISA, and other things.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <string.h>

#include "render/experiments/intersect_walk.h"
#include "render/experiments/walk_choices.h"
#include "tests/support/fields.h"
#include "tests/support/fixture.h"
#include "tests/support/pictures.h"

enum { SCENES = 12, KEEP = 4 };

static const char *const NAMES[] = {"waves", "rectilinear", "missing"};

/* Pictures of every scene, by all volumes alike. by: whether approximate intersectors take turns.
 * Returns the pixels with a surface. */
static int draw_scenes(picture_volumes *v, const field *f, bool by) {
    const leafcast_info info = leafcast_describe(v->of[0]);
    field_random r = {5};
    int hits = 0;
    for (int kind = 0; kind < SCENES; kind++) {
        leafcast_scene_experiments e = {
            .size = sizeof e, .intersector = (leafcast_intersector)(1 + kind % LEAFCAST_SCHWARZE)};
        leafcast_scene scene = pictures_scene(kind, &info);
        const leafcast_camera c = pictures_view(v->of[0], kind % PICTURE_VIEWS, &r);
        leafcast_surface s[2] = {leafcast_surface_default(f->iso),
                                 leafcast_surface_default(1.1 * f->iso)};
        for (int k = 0; k < 2; k++)
            s[k].opacity = kind % 4 == 3 ? 0.4f : 1.0f;
        if (by)
            scene.experiments = &e;
        pictures_select(v, s, 1 + kind % 2);
        hits += pictures_alike(v, &scene, &c, f->name);
    }
    return hits;
}

static bool walk_exactly(const walk_scene *scene, const resident_grid *tr, const ray *r,
                         double t_in, double t_out, unsigned octants, const hit *after, hit *best,
                         ray_counters *counters) {
    return intersect_walk(cell_next_hit, scene, tr, r, t_in, t_out, octants, after, best, counters);
}

static const walk_choice exactly = {"exactly", walk_exactly, 0, false};

static void test_exact(void **state) {
    (void)state;
    int hits = 0;
    for (size_t i = 0; i < sizeof NAMES / sizeof *NAMES; i++) {
        field f;
        picture_volumes v = {.count = 0};
        assert_true(field_make(&f, NAMES[i], 40, FIELD_SEED));
        const char *path = fixture_leaf(&f, KEEP, 1, false);
        for (int k = 0; k < 3; k++)
            pictures_open_one(&v, path, k < 2 ? "scalar" : "auto", 2);
        for (int k = 1; k < 3; k++)
            assert_null(walk_choice_use(v.of[k], &exactly));
        hits += draw_scenes(&v, &f, false);
        assert_ptr_equal(walk_choice_use(v.of[1], NULL), &exactly);
        pictures_close(&v);
        field_release(&f);
    }
    assert_true(hits > 1000 * SCENES);
}

static void test_approximate(void **state) {
    (void)state;
    int hits = 0;
    for (size_t i = 0; i < sizeof NAMES / sizeof *NAMES; i++) {
        field f;
        assert_true(field_make(&f, NAMES[i], 40, FIELD_SEED));
        picture_volumes v = pictures_open(fixture_leaf(&f, KEEP, 1, false), 2);
        hits += draw_scenes(&v, &f, true);
        pictures_close(&v);
        field_release(&f);
    }
    assert_true(hits > 1000 * SCENES);
}

/* No two of them draw the same, and which one it is, is the scene's alone. */
static void test_each_draws_its_own(void **state) {
    (void)state;
    enum { ALL = LEAFCAST_SCHWARZE + 1 };
    static picture drawn[ALL], again;
    field f;
    assert_true(field_make(&f, "waves", 40, FIELD_SEED));
    picture_volumes v = {.count = 0};
    pictures_open_one(&v, fixture_leaf(&f, KEEP, 1, false), "auto", 2);
    const leafcast_info info = leafcast_describe(v.of[0]);
    const leafcast_surface s = leafcast_surface_default(f.iso);
    leafcast_scene scene = pictures_scene(0, &info);
    leafcast_stats stats = {.size = sizeof stats};
    field_random r = {7};
    const leafcast_camera c = pictures_view(v.of[0], 0, &r);
    scene.lod = LEAFCAST_LOD_EXACT;
    pictures_select(&v, &s, 1);
    for (int how = 0; how < ALL; how++) {
        scene.experiments = INTERSECTOR((leafcast_intersector)how);
        pictures_draw(v.of[0], &scene, &c, &drawn[how], &stats);
        for (int other = 0; other < how; other++)
            assert_memory_not_equal(drawn[how].z, drawn[other].z, sizeof drawn[how].z);
    }
    scene.experiments = NULL;
    pictures_draw(v.of[0], &scene, &c, &again, &stats);
    assert_memory_equal(again.z, drawn[LEAFCAST_MARMITT].z, sizeof again.z);
    pictures_close(&v);
    field_release(&f);
}

static void test_choices(void **state) {
    (void)state;
    assert_null(intersect_walk_by(LEAFCAST_MARMITT));
    for (int how = LEAFCAST_MARMITT + 1; how <= LEAFCAST_SCHWARZE; how++)
        assert_string_equal(intersect_walk_by((leafcast_intersector)how)->name,
                            intersector_find((leafcast_intersector)how)->name);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_exact),
        cmocka_unit_test(test_approximate),
        cmocka_unit_test(test_each_draws_its_own),
        cmocka_unit_test(test_choices),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
