/* test_between.c - times between the steps of a grid or mesh: pictures and values are those of a
 * file with the samples, and points, that the test makes of both steps, and what brute force sees
 * in them.
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

#include "formats/base/cpu.h"
#include "tests/support/between_mesh.h"
#include "tests/support/fields.h"
#include "tests/support/hex_judge.h"

/* Of hexahedra, extremes are proven to within a share of the file's range of values (hex_walk.h),
 * which is another one of the samples alone: distances may differ, where values hardly do. Returns
 * the pixels that show something. */
static int check_near(const picture *is, const picture *want, const char *what) {
    int hits = 0;
    for (int i = 0; i < PICTURE_PIXELS; i++) {
        const double off = is->z[i] == want->z[i] ? 0.0 : fabs(is->z[i] - want->z[i]);
        hits += isfinite(want->z[i]) != 0;
        if (!(off <= 1e-2))
            fail_msg("%s: pixel %d: t %.17g, expected %.17g", what, i, is->z[i], want->z[i]);
        for (int c = 0; c < 4; c++)
            assert_true(fabs((double)(is->rgba[c][i] - want->rgba[c][i])) <= 1e-4);
    }
    return hits;
}

/* All looks at a moment are those of the samples alone. */
static void check_looks(const between_lab *s, leafcast *v, leafcast *alone, const char *what) {
    static picture want, is;
    for (int look = 0; look < LOOKS; look++) {
        const leafcast_scene scene = between_lab_scene(s, look);
        pictures_draw(alone, &scene, &s->view, &want, NULL);
        pictures_draw(v, &scene, &s->view, &is, NULL);
        char which[100];
        snprintf(which, sizeof which, "%s, look %d", what, look);
        const bool near = scene.project != LEAFCAST_PROJECT_NONE && s->of.cells != BETWEEN_TETS;
        const int shown = (near ? check_near : between_lab_same)(&is, &want, which);
        assert_in_range(shown, s->of.small ? 0 : 20, PICTURE_PIXELS);
    }
}

static ref_tally judge_grid(const float *samples, const ref_camera *look, double iso,
                            const double *depth, int every) {
    static const double unit[3] = {1, 1, 1}, zero[3] = {0, 0, 0};
    const ref_volume truth = ref_volume_regular((long[3]){BETWEEN_SIDE, BETWEEN_SIDE, BETWEEN_SIDE},
                                                samples, unit, zero);
    ref_tally tally = {0};
    ref_compare(&tally, &truth, look, &iso, 1, NULL, depth, every, "test_between", stdout);
    return tally;
}

/* Cells are as the volume tells them: check_cells(). */
static void judge_hexes(const between_lab *s, leafcast *v) {
    leafcast_camera view = s->view;
    hex_tally tally = {0};
    hex_judge truth;
    view.width /= WATCHED ? 2 : 4;
    view.height /= WATCHED ? 2 : 4;
    hex_judge_open(&truth, v);
    assert_true(hex_judge_picture(&truth, v, s->iso, &view, &tally));
    assert_true(tally.surfaces > 5);
    hex_judge_release(&truth);
}

/* Brute force agrees with the first look, outside the grazing band. */
static void judge(const between_lab *s, leafcast *v, const float *samples) {
    static picture is;
    if (WATCHED_THREADS) /* it has none */
        return;
    if (s->of.cells != BETWEEN_TETS) {
        judge_hexes(s, v);
        return;
    }
    const leafcast_scene scene = between_lab_scene(s, SURFACE);
    ref_camera look = {.fov = s->view.fov, .width = PICTURE_WIDTH, .height = PICTURE_HEIGHT};
    memcpy(look.eye, s->view.eye, sizeof look.eye);
    memcpy(look.look_at, s->view.look_at, sizeof look.look_at);
    memcpy(look.up, s->view.up, sizeof look.up);
    pictures_draw(v, &scene, &s->view, &is, NULL);
    const ref_tally tally = (s->of.mesh ? between_mesh_judge : judge_grid)(samples, &look, s->iso,
                                                                           is.z, WATCHED ? 11 : 3);
    assert_true(tally.hits > (WATCHED ? 2 : 20) || s->of.small);
    assert_int_equal(ref_tally_faults(&tally), 0);
}

/* Values at points are those of the samples alone; of a grid, at nodes, the samples. */
static void check_points(const between_lab *s, leafcast *v, leafcast *alone, const float *samples) {
    enum { POINTS = 64 };
    double points[POINTS][3];
    leafcast_sample got[POINTS], want[POINTS];
    field_random r = {FIELD_SEED};
    int inside = 0;
    for (int i = 0; i < POINTS; i++)
        for (int a = 0; a < 3; a++)
            points[i][a] = s->of.mesh ? field_random_in(&r, 0, BETWEEN_SIDE - 1)
                                      : (double)field_random_below(&r, BETWEEN_SIDE);
    between_lab_fine(leafcast_sample_points(v, (const double(*)[3])points, POINTS, got));
    between_lab_fine(leafcast_sample_points(alone, (const double(*)[3])points, POINTS, want));
    for (int i = 0; i < POINTS; i++) {
        const double *at = points[i];
        leafcast_sample probed;
        between_lab_fine(leafcast_probe_point(v, at, &probed));
        assert_memory_equal(&probed.value, &got[i].value, sizeof probed.value);
        assert_int_equal(got[i].inside, want[i].inside);
        inside += got[i].inside;
        if (isnan(got[i].value))
            assert_true((s->of.non_finite > 0 || !got[i].inside) && isnan(want[i].value));
        else
            assert_true(got[i].value == want[i].value);
        if (!s->of.mesh && !isnan(got[i].value))
            assert_true(
                got[i].value ==
                (double)samples[(int)(at[0] + BETWEEN_SIDE * (at[1] + BETWEEN_SIDE * at[2]))]);
    }
    assert_true(inside > POINTS / 2);
}

/* Values and places of cells of all levels are blends of those of both steps. */
static void check_cells(leafcast *v, leafcast *steps, uint32_t step, double share) {
    const uint32_t levels = leafcast_describe(v).levels;
    for (uint32_t level = 0; level < levels; level++)
        for (uint64_t cell = 0; cell < 40; cell++) {
            leafcast_cell c[3] = {{.size = sizeof *c}, {.size = sizeof *c}, {.size = sizeof *c}};
            const uint64_t number = level > 0 && level == levels - 1 ? cell : cell * 17 + 5;
            between_lab_fine(leafcast_get_cell(v, level, number, &c[2]));
            for (uint32_t k = 0; k < 2; k++) {
                between_lab_fine(leafcast_select_set(steps, 0, step + k));
                between_lab_fine(leafcast_get_cell(steps, level, number, &c[k]));
            }
            assert_int_equal(c[2].corners, c[0].corners && c[1].corners ? c[0].corners : 0);
            for (int i = 0; i < c[2].corners; i++) {
                const double want =
                    (double)between_lab_mix((float)c[0].value[i], (float)c[1].value[i], share);
                assert_true(c[2].value[i] == want || (isnan(want) && isnan(c[2].value[i])));
                for (int a = 0; a < 3; a++)
                    assert_true(c[2].position[i][a] ==
                                (double)between_lab_mix((float)c[0].position[i][a],
                                                        (float)c[1].position[i][a], share));
            }
        }
}

/* ---- Moments ---- */

static void check_kind(const between_kind *of, const leafcast_options *o, uint32_t only) {
    const leafcast_options two = {.size = sizeof two, .threads = 2};
    between_lab *s = between_lab_make(of);
    leafcast *v = between_lab_open(s->series, o, s->iso),
             *steps = between_lab_open(s->series, NULL, s->iso);
    for (uint32_t step = 0; step + 1 < BETWEEN_STEPS; step++)
        for (uint32_t i = 0; i < BETWEEN_SHARES; i++) {
            char what[80];
            if ((step + i) % BETWEEN_STEPS != only)
                continue;
            float *samples = between_lab_blend(s, step, between_shares[i]);
            snprintf(what, sizeof what, "type %d, codec %d, step %u + %g", of->type, of->codec,
                     step, between_shares[i]);
            between_lab_fine(leafcast_select_between(v, 0, step, between_shares[i]));
            leafcast *alone = between_lab_open(between_lab_alone(s, samples), &two, s->iso);
            check_looks(s, v, alone, what);
            judge(s, v, samples);
            check_points(s, v, alone, samples);
            check_cells(v, steps, step, between_shares[i]);
            leafcast_close(alone);
            free(samples);
        }
    leafcast_close(v);
    leafcast_close(steps);
    between_lab_free(s);
}

static void test_kinds(void **state) {
    (void)state;
    /* Grids and meshes that rest and move have all the threads that the others have. */
    for (uint32_t i = WATCHED_THREADS ? 4 : 0; i < BETWEEN_KINDS; i += WATCHED_THREADS ? 3 : 1) {
        const leafcast_options o = {.size = sizeof o,
                                    .threads = WATCHED_THREADS ? 3 : 1 + (int)i % 3,
                                    .backend = (leafcast_backend)(i % 3),
                                    .isa = i == 4 ? "scalar" : NULL};
        /* Where every access is watched, and of hexahedra, which the tests of their kernels look
         * at, a few moments of each kind, not the same ones. */
        const bool few = WATCHED || between_kinds[i].cells != BETWEEN_TETS;
        for (uint32_t only = few ? i % BETWEEN_STEPS : i / 2 % 2; only < BETWEEN_STEPS;
             only += few ? BETWEEN_STEPS : 2)
            check_kind(&between_kinds[i], &o, only);
    }
}

/* A grid, and meshes that move, with values that are not finite. */
static const between_kind *const strange[] = {&between_kinds[4], &between_kinds[BETWEEN_HEXES - 1],
                                              &between_kinds[BETWEEN_KINDS - 1]};

/* The same bits by any kernel. */
static void check_kernels(const between_kind *of) {
    static picture want, is;
    between_lab *s = between_lab_make(of);
    const leafcast_scene scene = between_lab_scene(s, SHADOWS);
    for (int isa = 0; isa <= (int)cpu_best(); isa++) {
        const leafcast_options o = {.size = sizeof o, .isa = cpu_isa_name((cpu_isa)isa)};
        leafcast *v = between_lab_open(s->series, &o, s->iso);
        between_lab_fine(leafcast_select_between(v, 0, 1, 0.3));
        pictures_draw(v, &scene, &s->view, isa ? &is : &want, NULL);
        if (isa)
            (void)between_lab_same(&is, &want, cpu_isa_name((cpu_isa)isa));
        leafcast_close(v);
    }
    between_lab_free(s);
}

static void test_kernels(void **state) {
    (void)state;
    skip_under_thread();
    for (int i = 0; i < 3; i++)
        check_kernels(strange[i]);
}

/* ---- Media ---- */

/* A medium is within its bound of that of the samples alone. */
static void check_medium(const between_kind *of) {
    static const leafcast_transfer_point points[2] = {{-0.9, {1, 0.5, 0.2}, 0},
                                                      {2, {0.2, 0.5, 1}, 0.3}};
    static const leafcast_medium medium = {points, 2};
    static picture want, is;
    between_lab *s = between_lab_make(of);
    leafcast_scene scene = leafcast_scene_default();
    scene.media = &medium;
    scene.media_count = 1;
    scene.error = 1e-4;
    float *samples = between_lab_blend(s, 0, 0.3);
    leafcast *v = between_lab_open(s->series, NULL, s->iso);
    leafcast *one = between_lab_open(between_lab_alone(s, samples), NULL, s->iso);
    between_lab_fine(leafcast_select_between(v, 0, 0, 0.3));
    pictures_draw(v, &scene, &s->view, &is, NULL);
    pictures_draw(one, &scene, &s->view, &want, NULL);
    for (int i = 0; i < PICTURE_PIXELS; i++)
        for (int c = 0; c < 4; c++)
            assert_true(fabs((double)(is.rgba[c][i] - want.rgba[c][i])) <= 2.001e-4);
    leafcast_close(v);
    leafcast_close(one);
    free(samples);
    between_lab_free(s);
}

static void test_media(void **state) {
    (void)state;
    for (int i = WATCHED_THREADS ? 1 : 0; i < 3; i++)
        check_medium(strange[i]);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_kinds),
        cmocka_unit_test(test_kernels),
        cmocka_unit_test(test_media),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
