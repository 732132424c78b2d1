/* test_mesh_chain.c - from tet to tet through their faces a ray meets the same pieces, to the bit,
 * as down the tree: hostile meshes, hostile rays, treelets of any size, any budget.
 */
/* marks: bits, long */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "tests/support/fixture.h"
#include "tests/support/lab_leaf.h"
#include "tests/support/watched.h"

enum { PIECES = 4096, RAYS = SLOW ? 24 : 60, SIDE = 24 };

static leafcast *open_with(const char *path, bool neighbours, uint32_t treelets) {
    const leafcast_experiments e = {.size = sizeof e, .treelet_limit = treelets};
    const leafcast_options o = {
        .size = sizeof o, .threads = 2, .experiments = &e, .neighbours = neighbours};
    return fixture_open(path, &o);
}

/* ---- Rays ---- */

static int pieces_of(leafcast *v, const leafcast_scene *scene, const ref_ray *r,
                     leafcast_segment out[PIECES]) {
    int count = 0;
    if (leafcast_probe_segments(v, scene, r->o, r->d, out, PIECES, &count) != LEAFCAST_OK)
        fail_msg("%s", leafcast_error_text());
    return count;
}

static bool same_piece(const leafcast_segment *a, const leafcast_segment *b) {
    return memcmp(&a->t0, &b->t0, sizeof a->t0) == 0 && memcmp(&a->t1, &b->t1, sizeof a->t1) == 0 &&
           memcmp(a->control, b->control, 2 * sizeof *a->control) == 0 && a->cell == b->cell;
}

/* Returns how many pieces there were. */
static size_t check_rays(leafcast *const v[2], const lab_mesh *lab, const leafcast_scene *scene,
                         field_random *random) {
    static leafcast_segment want[PIECES], got[PIECES];
    size_t found = 0;
    for (int i = 0; i < RAYS; i++) {
        const lab_ray kind = (lab_ray)(i % LAB_RAY_KINDS);
        const ref_ray r = lab_mesh_ray(lab, kind, random);
        const int count = pieces_of(v[0], scene, &r, want), other = pieces_of(v[1], scene, &r, got);
        bool same = count == other && count < PIECES;
        for (int k = 0; k < count && same; k++)
            same = same_piece(&want[k], &got[k]);
        if (!same)
            fail_msg("%s, %s ray %d: %d pieces by faces, %d by the tree", lab->name,
                     lab_ray_name(kind), i, other, count);
        found += (size_t)count;
    }
    return found;
}

static void check_mesh(const char *name, int n, uint32_t tets) {
    lab_mesh lab;
    field_random random = {.state = tets};
    assert_true(lab_mesh_make(&lab, name, n, FIELD_SEED));
    const char *path = lab_leaf_make(&lab, tets, false);
    leafcast *const v[2] = {open_with(path, false, 0), open_with(path, true, 0)};
    leafcast_scene scene = leafcast_scene_default();
    size_t found = check_rays(v, &lab, &scene, &random);
    scene.clip_box = true;
    for (int a = 0; a < 3; a++) {
        scene.clip_min[a] = 0.7 * lab.lo[a] + 0.3 * lab.hi[a];
        scene.clip_max[a] = 0.2 * lab.lo[a] + 0.8 * lab.hi[a];
    }
    (void)check_rays(v, &lab, &scene, &random);
    print_message("# %s, treelets of %u: %zu pieces\n", name, tets, found);
    assert_true(found > 0 || strcmp(name, "flat") == 0);
    leafcast_close(v[0]);
    leafcast_close(v[1]);
    lab_mesh_release(&lab);
}

static void test_rays(void **state) {
    (void)state;
    for (int i = 0; i < lab_mesh_count(); i++) {
        check_mesh(lab_mesh_name(i), 5, 4096);
        check_mesh(lab_mesh_name(i), 5, 24);
    }
}

/* ---- Pictures ---- */

typedef struct shot {
    double rgba[SIDE * SIDE][4], value[SIDE * SIDE];
    leafcast_stats stats;
} shot;

static void draw(leafcast *v, const leafcast_scene *scene, bool projected, shot *s) {
    const leafcast_camera c = leafcast_standard_view(v, 1.4, SIDE, SIDE);
    const leafcast_image image = {
        .size = sizeof image, .rgba = &s->rgba[0][0], .value = projected ? s->value : NULL};
    memset(s, 0, sizeof *s);
    s->stats.size = sizeof s->stats;
    if (leafcast_trace(v, scene, &c, &image, &s->stats, NULL, NULL) != LEAFCAST_OK)
        fail_msg("%s", leafcast_error_text());
}

/* Another step moves vertices, another interest makes masks anew: neighbours go with it. */
static void check_pictures(leafcast *const v[2], const double range[2]) {
    static shot want, got;
    const leafcast_transfer_point points[] = {{range[0], {1, 0.5F, 0}, 0.0},
                                              {0.5 * range[0] + 0.5 * range[1], {0, 1, 0}, 0.4},
                                              {range[1], {0, 0.5F, 1}, 1.0}};
    for (int i = 0; i < 4; i++) {
        const leafcast_medium medium = {points + i % 2, 2};
        leafcast_scene scene = leafcast_scene_default();
        scene.media = &medium;
        scene.media_count = 1;
        scene.project = i < 2 ? LEAFCAST_PROJECT_NONE : LEAFCAST_PROJECT_MEAN;
        draw(v[0], &scene, i >= 2, &want);
        draw(v[1], &scene, i >= 2, &got);
        assert_memory_equal(want.rgba, got.rgba, sizeof want.rgba);
        assert_memory_equal(want.value, got.value, sizeof want.value);
        assert_true(want.stats.passed_tets == 0 && got.stats.passed_tets > 0);
        /* Three tests a tet at most, and two at least, but for the last of a chain. */
        assert_true(got.stats.edge_tests <= 3 * got.stats.passed_tets &&
                    got.stats.edge_tests >= 2 * got.stats.passed_tets);
    }
}

static void test_pictures(void **state) {
    (void)state;
    static const char *const names[] = {"sphere", "plateau", "holes"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        for (uint32_t limit = 0; limit < 5; limit += 4) {
            lab_mesh lab;
            double range[2];
            assert_true(lab_mesh_make(&lab, names[i], 6, FIELD_SEED));
            const char *path = lab_leaf_make(&lab, 60, i == 1);
            leafcast *const v[2] = {open_with(path, false, 0), open_with(path, true, limit)};
            assert_int_equal(leafcast_range(v[0], 0, 0, range), LEAFCAST_OK);
            check_pictures(v, range);
            leafcast_close(v[0]);
            leafcast_close(v[1]);
            lab_mesh_release(&lab);
        }
}

/* What they take is in the budget; kept isopolygons have no room beside them. */
static void test_options(void **state) {
    (void)state;
    lab_mesh lab;
    leafcast *none = NULL;
    static shot s;
    const leafcast_experiments kept = {.size = sizeof kept,
                                       .isopolygons = LEAFCAST_ISOPOLYGONS_CACHE};
    assert_true(lab_mesh_make(&lab, "sphere", 8, FIELD_SEED));
    const char *path = lab_leaf_make(&lab, 200, false);
    const leafcast_options both = {.size = sizeof both, .experiments = &kept, .neighbours = true};
    assert_int_equal(leafcast_open(path, &both, &none), LEAFCAST_USAGE);
    uint64_t resident[2];
    leafcast_scene scene = leafcast_scene_default();
    scene.project = LEAFCAST_PROJECT_MEAN;
    for (int i = 0; i < 2; i++) {
        leafcast *v = open_with(path, i, 0);
        draw(v, &scene, true, &s);
        resident[i] = s.stats.bytes_resident;
        leafcast_close(v);
    }
    assert_true(resident[1] > resident[0] + 16 * lab.tet_count / 2);
    lab_mesh_release(&lab);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_rays), cmocka_unit_test(test_pictures),
                                       cmocka_unit_test(test_options)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
