/* test_coarse_preview.c - previews of meshes, of tets or of whole cells, and of curvilinear grids,
 * with a coarse grid: where treelets are there the exact picture to the bit, elsewhere that of the
 * grid, marked; the exact one once all have come.
 */
/* marks: threads, long */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "formats/base/fault.h"
#include "formats/leaf/coarse_pair.h"
#include "formats/leaf/leaf_between.h"
#include "formats/leaf/leaf_unpacker.h"
#include "prep/mesh/mesh_series.h"
#include "tests/support/coarse_hexes.h"
#include "tests/support/coarse_subjects.h"
#include "tests/support/fixture.h"
#include "tests/support/mesh_cases.h"
#include "tests/support/pictures.h"
#include "tests/support/scratch.h"
#include "tests/support/watched.h"

enum { FRAMES_MAX = 20000, READ_US = 1000 };
#define ISO_VALUE 0.4
static const double ISO = ISO_VALUE;
static mem m;

/* What a test is of. Tests that go for tets alone are about what all have in common. */
static subject subjects[] = {TETS, LATTICE, THINNED, WHOLE_CELLS};
#define OF_EACH(test)                                                                             \
    cmocka_unit_test_prestate(test, &subjects[0]), cmocka_unit_test_prestate(test, &subjects[1]), \
        cmocka_unit_test_prestate(test, &subjects[2]),                                            \
        cmocka_unit_test_prestate(test, &subjects[3])

static leafcast *open_with(const char *name, const char *isa, uint32_t treelet_limit) {
    const leafcast_options o = {.size = sizeof(leafcast_options),
                                .isa = isa,
                                .threads = 2,
                                .experiments = EXPERIMENTS(.treelet_limit = treelet_limit)};
    return fixture_open(scratch_path(name), &o);
}

static void select_one(leafcast *v, double iso) {
    const leafcast_surface s = leafcast_surface_default(iso);
    assert_int_equal(leafcast_select(v, &s, 1), LEAFCAST_OK);
}

/* Each pixel is the exact one, or marked and the grid's; gridded NULL: not looked at. Returns how
 * many are marked. */
static uint64_t check_picture(const picture *got, const picture *exact, const picture *gridded) {
    uint64_t marked = 0;
    for (int i = 0; i < PICTURE_PIXELS; i++) {
        marked += got->provisional[i];
        if (!got->provisional[i] && !pictures_same_pixel(got, exact, i))
            fail_msg("pixel %d: not marked, and not exact: %g, expected %g", i, got->z[i],
                     exact->z[i]);
        if (got->provisional[i] && gridded && !pictures_same_pixel(got, gridded, i))
            fail_msg("pixel %d: marked, and not the grid's: %g, expected %g", i, got->z[i],
                     gridded->z[i]);
    }
    return marked;
}

static void draw_exact(const char *name, const leafcast_scene *scene, const leafcast_camera *view,
                       double iso, picture *p) {
    leafcast_stats stats = {.size = sizeof stats};
    leafcast *v = open_with(name, "scalar", 0);
    select_one(v, iso);
    pictures_draw(v, scene, view, p, &stats);
    leafcast_close(v);
}

/* Whether what is marked is the grid's in full. */
static bool grid_has_come(const picture *got, const picture *gridded) {
    for (int i = 0; i < PICTURE_PIXELS; i++)
        if (got->provisional[i] && !pictures_same_pixel(got, gridded, i))
            return false;
    return true;
}

/* Threads that read get so many milliseconds. */
static void pause_for(long ms) {
    const struct timespec moment = {ms / 1000, ms % 1000 * 1000000};
    nanosleep(&moment, NULL);
}

/* Two frames: what the first one wants of the grid comes between them, however long a read takes.
 * On a busy machine that may need longer: tried again with more time. */
static void draw_until_come(const char *isa, const leafcast_scene *scene,
                            const leafcast_camera *view, const picture *exact,
                            const picture *gridded, picture *got, leafcast_stats *stats) {
    bool come = false;
    fault_delay(FAULT_READ, READ_US);
    for (long ms = 16; !come; ms *= 2) {
        leafcast *v = open_with("mesh.leaf", isa, 2);
        assert_true(ms < 20000);
        select_one(v, ISO);
        pictures_draw(v, scene, view, got, stats);
        (void)check_picture(got, exact, NULL);
        pause_for(ms);
        pictures_draw(v, scene, view, got, stats);
        come = grid_has_come(got, gridded);
        leafcast_close(v);
    }
    fault_delay(FAULT_READ, 0);
}

static const char *const ISAS[] = {"scalar", NULL};

static void test_becomes_exact(void **state) {
    const subject of = *(const subject *)*state;
    static picture exact, got;
    coarse_subjects_make(&m, of, "mesh.leaf", NULL, true);
    leafcast_scene scene = leafcast_scene_default();
    for (size_t i = 0; i < sizeof ISAS / sizeof *ISAS; i++) {
        leafcast *v = open_with("mesh.leaf", ISAS[i], 0);
        const leafcast_camera view = leafcast_standard_view(v, 1.3, PICTURE_WIDTH, PICTURE_HEIGHT);
        for (int k = 0; k < 3; k++) { /* another surface, and back */
            const double iso = ISO + 0.5 * (k % 2);
            scene.preview = false;
            draw_exact("mesh.leaf", &scene, &view, iso, &exact);
            select_one(v, iso);
            scene.preview = true;
            uint64_t marked = 1;
            for (int n = 0; n < FRAMES_MAX && marked; n++) {
                leafcast_stats stats = {.size = sizeof stats};
                pictures_draw(v, &scene, &view, &got, &stats);
                marked = check_picture(&got, &exact, NULL);
                assert_int_equal(marked, stats.provisional_pixels);
            }
            assert_int_equal(marked, 0);
        }
        leafcast_close(v);
    }
}

/* Of 2 treelets at a time most are absent: the picture is the grid's, once that has come. */
static void test_is_the_grid(void **state) {
    const subject of = *(const subject *)*state;
    static picture exact, gridded, got;
    coarse_subjects_make(&m, of, "mesh.leaf", "part.leaf", true);
    leafcast_scene scene = leafcast_scene_default();
    for (int kind = 0; kind < 4; kind += WATCHED_THREADS ? 3 : 1) {
        leafcast *any = open_with("mesh.leaf", NULL, 0);
        const leafcast_camera view =
            leafcast_standard_view(any, kind < 2 ? 1.3 : 0.7, PICTURE_WIDTH, PICTURE_HEIGHT);
        leafcast_stats stats = {.size = sizeof(leafcast_stats)};
        leafcast_close(any);
        scene.preview = false;
        draw_exact("mesh.leaf", &scene, &view, ISO, &exact);
        draw_exact("part.leaf", &scene, &view, ISO, &gridded);
        scene.preview = true;
        draw_until_come(ISAS[kind % 2], &scene, &view, &exact, &gridded, &got, &stats);
        const uint64_t marked = check_picture(&got, &exact, &gridded);
        assert_int_equal(marked, stats.provisional_pixels);
        assert_true(marked > PICTURE_PIXELS / 4);
        /* The grid's surface is nearly the mesh's. */
        int hits = 0, near = 0;
        for (int i = 0; i < PICTURE_PIXELS; i++)
            if (got.provisional[i] && isfinite(exact.z[i])) {
                hits++;
                near += fabs(got.z[i] - exact.z[i]) < 0.5;
            }
        assert_true(hits > PICTURE_PIXELS / 8 && near > hits * 9 / 10);
    }
}

/* Transparent layers, shadows: what is not marked is exact. */
static void test_scenes(void **state) {
    const subject of = *(const subject *)*state;
    static picture exact, got;
    coarse_subjects_make(&m, of, "mesh.leaf", NULL, true);
    field_random r = {5};
    for (int kind = 0; kind < 12; kind += WATCHED_THREADS ? 5 : 1) {
        leafcast *v = open_with("mesh.leaf", ISAS[kind % 2], kind % 3 ? 8 : 0), *w;
        const leafcast_info info = leafcast_describe(v);
        leafcast_scene scene = pictures_scene(kind, &info);
        scene.lod = LEAFCAST_LOD_EXACT;
        const leafcast_camera view = pictures_view(v, kind % PICTURE_VIEWS, &r);
        leafcast_surface s[2] = {leafcast_surface_default(ISO), leafcast_surface_default(ISO + 1)};
        s[0].opacity = kind % 2 ? 0.5F : 1.0F;
        leafcast_stats stats = {.size = sizeof stats};
        w = open_with("mesh.leaf", "scalar", 0);
        scene.preview = false;
        assert_int_equal(leafcast_select(w, s, 2), LEAFCAST_OK);
        pictures_draw(w, &scene, &view, &exact, &stats);
        scene.preview = true;
        assert_int_equal(leafcast_select(v, s, 2), LEAFCAST_OK);
        for (int n = 0; n < 5; n++) {
            pictures_draw(v, &scene, &view, &got, &stats);
            assert_int_equal(check_picture(&got, &exact, NULL), stats.provisional_pixels);
        }
        leafcast_close(w);
        leafcast_close(v);
    }
}

/* ---- levels ---- */

/* All planes that a picture of anything has. */
typedef struct all_planes {
    float rgba[4][PICTURE_PIXELS];
    double value[PICTURE_PIXELS], error[PICTURE_PIXELS];
    uint8_t provisional[PICTURE_PIXELS];
} all_planes;

static leafcast_stats draw_all(leafcast *v, const leafcast_scene *scene,
                               const leafcast_camera *view, all_planes *p) {
    leafcast_stats stats = {.size = sizeof stats};
    const leafcast_image image = {.size = sizeof image,
                                  .r = p->rgba[0],
                                  .g = p->rgba[1],
                                  .b = p->rgba[2],
                                  .a = p->rgba[3],
                                  .value = p->value,
                                  .error = p->error,
                                  .provisional = p->provisional};
    if (leafcast_trace(v, scene, view, &image, &stats, NULL, NULL) != LEAFCAST_OK)
        fail_msg("%s", leafcast_error_text());
    return stats;
}

/* How values look is the mesh's: shading and shades of grey are others in the grid alone. Cells'
 * values are made from differences to one that is the mesh's, too: their last bits differ. */
static bool same_planes(const leafcast_scene *scene, const all_planes *a, const all_planes *b,
                        subject of) {
    const bool coloured = !scene->shade_media && scene->project == LEAFCAST_PROJECT_NONE;
    bool same = of == THINNED || memcmp(a->value, b->value, sizeof a->value) == 0;
    for (int i = 0; i < PICTURE_PIXELS; i++)
        same &= isnan(b->value[i]) ? isnan(a->value[i]) : fabs(a->value[i] - b->value[i]) <= 1e-13;
    for (int c = coloured ? 0 : 3; c < 4; c++)
        same &= memcmp(a->rgba[c], b->rgba[c], sizeof a->rgba[c]) == 0;
    return same;
}

enum { SCENES = 5 };

static leafcast_scene scene_of(int which) {
    static const leafcast_transfer_point points[] = {
        {0.1, {0.2F, 0.4F, 1.0F}, 0.0}, {0.5, {1.0F, 0.8F, 0.2F}, 0.05}, {0.9, {1, 1, 1}, 0.3}};
    static const leafcast_medium medium = {points, 3};
    leafcast_scene scene = leafcast_scene_default();
    if (which == 1 || which == 2) {
        scene.media = &medium;
        scene.media_count = 1;
        scene.shade_media = which == 2;
    }
    scene.project = which == 3   ? LEAFCAST_PROJECT_MAX
                    : which == 4 ? LEAFCAST_PROJECT_MEAN
                                 : LEAFCAST_PROJECT_NONE;
    return scene;
}

/* A file that has the coarse level of another one, and which of its levels that is. */
typedef struct level_file {
    const char *name;
    uint32_t level;
} level_file;

/* What is thinned has one level, and those of the grid inside it. */
static level_file level_of(subject of, uint32_t level) {
    if (of == THINNED && level > 0)
        return (level_file){"inner.leaf", level - 1};
    return (level_file){"part.leaf", level};
}

/* Level n of the mesh is level n - 1 of its grid, whatever is shown, to the bit; none of it is said
 * to be exact, and a medium's colours are within the bound that is given. */
static void test_levels(void **state) {
    const subject of = *(const subject *)*state;
    static all_planes got, gridded, exact;
    coarse_subjects_make(&m, of, "mesh.leaf", "part.leaf", true);
    if (of == THINNED)
        coarse_subjects_take_part(&m, "part.leaf", 0, "inner.leaf");
    leafcast *tets = open_with("mesh.leaf", NULL, 0);
    const uint32_t levels = of == THINNED ? 3 : 2;
    select_one(tets, ISO);
    for (int k = 0; k < SCENES * (int)levels * (WATCHED ? 1 : 2); k += WATCHED_THREADS ? 3 : 1) {
        const uint32_t level = (uint32_t)(k / SCENES) % levels;
        leafcast *v = open_with("mesh.leaf", ISAS[k % 2], 0);
        const level_file where = level_of(of, level);
        leafcast *alone = open_with(where.name, "scalar", 0);
        assert_int_equal(leafcast_describe(v).preview_levels, 1 + levels);
        assert_int_equal(leafcast_describe(v).levels, 1);
        const leafcast_camera view = leafcast_standard_view(v, 1.3, PICTURE_WIDTH, PICTURE_HEIGHT);
        leafcast_scene scene = scene_of(k % SCENES);
        select_one(v, ISO);
        select_one(alone, ISO);
        (void)draw_all(tets, &scene, &view, &exact);
        scene.lod = LEAFCAST_LOD_LEVEL;
        scene.lod_level = where.level;
        (void)draw_all(alone, &scene, &view, &gridded);
        scene.preview = true;
        scene.lod_level = level + 1;
        leafcast_stats stats = {.size = sizeof(leafcast_stats)};
        for (int n = 0; n < FRAMES_MAX && (n == 0 || !same_planes(&scene, &got, &gridded, of));
             n++) {
            pause_for(n ? 2 : 0);
            stats = draw_all(v, &scene, &view, &got);
        }
        if (!same_planes(&scene, &got, &gridded, of))
            fail_msg("scene %d, level %u: not the grid's", k % SCENES, level + 1);
        assert_int_equal(stats.provisional_pixels, PICTURE_PIXELS);
        for (int i = 0; i < PICTURE_PIXELS; i++) {
            assert_int_equal(got.provisional[i], 1);
            for (int c = 0; c < 4 && scene.media_count > 0; c++)
                if (!(fabs((double)got.rgba[c][i] - (double)exact.rgba[c][i]) <= got.error[i]))
                    fail_msg("pixel %d: %g, truly %g, said to be within %g", i,
                             (double)got.rgba[c][i], (double)exact.rgba[c][i], got.error[i]);
        }
        leafcast_close(alone);
        leafcast_close(v);
    }
    leafcast_close(tets);
}

/* What has no coarse grid has no levels, unless with others; nor has a picture that is no preview.
 */
static void test_no_levels(void **state) {
    const subject of = *(const subject *)*state;
    static all_planes p;
    coarse_subjects_make(&m, of, "mesh.leaf", NULL, true);
    coarse_subjects_make(&m, of, "plain.leaf", NULL, false);
    for (int i = 0; i < 2; i++) {
        leafcast *v = open_with(i ? "plain.leaf" : "mesh.leaf", NULL, 0);
        const leafcast_camera view = leafcast_standard_view(v, 1.3, PICTURE_WIDTH, PICTURE_HEIGHT);
        leafcast_scene scene = scene_of(3);
        const leafcast_image image = {.size = sizeof image, .value = p.value};
        scene.lod = LEAFCAST_LOD_LEVEL;
        scene.lod_level = 1;
        scene.preview = i;
        assert_int_equal(leafcast_trace(v, &scene, &view, &image, NULL, NULL, NULL),
                         LEAFCAST_USAGE);
        assert_non_null(strstr(leafcast_error_text(), "no coarse levels"));
        assert_int_equal(leafcast_describe(v).preview_levels, i ? 1 : of == THINNED ? 4 : 3);
        const leafcast_shown two[2] = {{.volume = v}, {.volume = v}};
        scene.volumes = two;
        scene.volume_count = 2;
        assert_int_equal(leafcast_trace(v, &scene, &view, &image, NULL, NULL, NULL),
                         i ? LEAFCAST_OK : LEAFCAST_USAGE);
        leafcast_close(v);
    }
}

/* ---- steps ---- */

enum { STEPS = 3 };

/* The mesh at a step: higher values each time, and in the last one the points are elsewhere if it
 * moves. */
static const char *write_step(const mesh_case *c, bool moves, uint32_t step, const char *name) {
    const char *path = scratch_path(name);
    FILE *f = fopen(path, "wb");
    assert_non_null(f);
    fprintf(f, "LEAFCAST MESH 1\nname: moved\nfield: wave\npoints: %zu\ntets: %zu\n\n",
            c->point_count, c->tet_count);
    for (size_t i = 0; i < c->point_count; i++) {
        float at[3];
        for (int a = 0; a < 3; a++)
            at[a] = c->points[i][a] * (moves && step + 1 == STEPS ? 0.75F : 1.0F);
        assert_int_equal(fwrite(at, sizeof at, 1, f), 1);
    }
    for (size_t i = 0; i < c->point_count; i++) {
        const float value = c->values[i] + 0.3F * (float)step;
        assert_int_equal(fwrite(&value, sizeof value, 1, f), 1);
    }
    assert_int_equal(fwrite(c->tets, sizeof *c->tets, c->tet_count, f), c->tet_count);
    assert_int_equal(fclose(f), 0);
    return path;
}

static void make_series_as(const char *name, bool moves, leaf_codec codec, uint32_t dims) {
    mesh_case c = mesh_cases_kuhn(SUBJECT_CELLS, SUBJECT_CELLS, SUBJECT_CELLS);
    const char *paths[STEPS];
    for (uint32_t s = 0; s < STEPS; s++) {
        char step[16];
        (void)snprintf(step, sizeof step, "%u.mesh", s);
        paths[s] = write_step(&c, moves, s, step);
    }
    const mesh_series series = {.of = {.paths = paths, .sets = {.fields = 1, .steps = STEPS}}};
    const mesh_hints hints = {0};
    mesh_input *first = NULL;
    mesh_result r;
    c.options.treelet_tets = 400;
    c.options.coarse = true;
    c.options.coarse_dims = dims;
    c.options.file.codec = codec;
    c.options.file.zstd_level = 1;
    c.options.series = &series;
    status st = mesh_input_open(&m, paths[0], &hints, &first);
    if (st == ST_OK)
        st = mesh_convert_run(&m, first, scratch_path(name), &c.options, NULL, &r);
    if (st != ST_OK)
        fail_msg("%s", status_text());
    mesh_input_close(first);
    mesh_cases_free(&c);
}

static void make_series(const char *name, bool moves) {
    make_series_as(name, moves, LEAF_CODEC_RAW, 37);
}

static void make_thinned_series(const char *name) {
    coarse_hexes c = coarse_hexes_of(false, SUBJECT_CELLS, 0);
    c.steps = STEPS;
    assert_int_equal(coarse_hexes_convert(&m, &c, name), ST_OK);
}

/* Each step has a grid of its own, there and back: few treelets at a time leave most to it, with
 * all of them the picture becomes exact. So it is between two steps, so
 * near to one of them that each sample is that one's. Grids that are no samples are not blended. */
static void check_steps(double share, subject of, bool moves) {
    static const uint32_t order[] = {0, 2, 1, 1, 2, 0};
    const size_t count = WATCHED_THREADS ? 3 : sizeof order / sizeof *order;
    static picture exact, gridded, got;
    if (of == THINNED)
        make_thinned_series("series.leaf");
    else
        make_series("series.leaf", moves);
    for (int kind = 0; kind < 2; kind++) {
        uint64_t most = 0;
        leafcast *v = open_with("series.leaf", NULL, kind ? 0 : 2);
        leafcast *w = open_with("series.leaf", "scalar", 0);
        const leafcast_camera view = leafcast_standard_view(v, 1.3, PICTURE_WIDTH, PICTURE_HEIGHT);
        leafcast_scene scene = leafcast_scene_default();
        select_one(v, ISO);
        select_one(w, ISO);
        for (size_t k = 0; k < count; k++) {
            leafcast_stats stats = {.size = sizeof(leafcast_stats)};
            const uint32_t nearest = order[k] + (share > 0.5);
            if (share > 0 && order[k] + 1 == STEPS)
                continue;
            coarse_subjects_take_part(&m, "series.leaf", nearest, "part.leaf");
            scene.preview = false;
            assert_int_equal(of == THINNED ? leafcast_select_between(w, 0, order[k], share)
                                           : leafcast_select_set(w, 0, nearest),
                             LEAFCAST_OK);
            pictures_draw(w, &scene, &view, &exact, &stats);
            draw_exact("part.leaf", &scene, &view, ISO, &gridded);
            scene.preview = true;
            assert_int_equal(leafcast_select_between(v, 0, order[k], share), LEAFCAST_OK);
            uint64_t marked = 1;
            for (int n = 0; n < FRAMES_MAX && marked; n++) {
                if (n > 0 && !kind && grid_has_come(&got, &gridded))
                    break;
                pause_for(n ? 2 : 0);
                pictures_draw(v, &scene, &view, &got, &stats);
                marked = check_picture(&got, &exact, NULL);
                assert_int_equal(marked, stats.provisional_pixels);
            }
            (void)check_picture(&got, &exact, &gridded);
            most = marked > most ? marked : most;
            assert_true(kind ? marked == 0 : marked > 0);
        }
        assert_true(kind || most > PICTURE_PIXELS / 8);
        leafcast_close(w);
        leafcast_close(v);
    }
}

static void test_steps(void **state) {
    (void)state;
    check_steps(0, TETS, true);
    check_steps(1e-300, TETS, true);
    if (WATCHED_THREADS) /* points that rest, and the other end, have the same threads */
        return;
    check_steps(1e-300, TETS, false);
    for (int moves = 0; moves < 2; moves++)
        check_steps(1 - 0x1p-53, TETS, moves);
    check_steps(0.3, THINNED, false);
    check_steps(0.7, THINNED, false);
}

/* ---- between two steps ---- */

static void *load_payload(leaf_file *f, leaf_unpacker *u, uint32_t p) {
    void *payload = mem_alloc(&m, leaf_layout_payload_bytes(&f->layout, p));
    assert_non_null(payload);
    assert_int_equal(leaf_file_load(f, p, u, payload), ST_OK);
    return payload;
}

/* The samples between are blends of those of both grids, in every treelet. */
static void check_samples(leaf_codec codec, uint32_t dims) {
    make_series_as("series.leaf", true, codec, dims);
    leaf_file *f = NULL, *pair = NULL, *between = NULL, *of[2] = {NULL};
    leaf_unpacker *u[3] = {NULL};
    assert_int_equal(leaf_file_open(&m, scratch_path("series.leaf"), &f), ST_OK);
    assert_int_equal(coarse_pair_open(&m, f, 1, &pair), ST_OK);
    assert_false(coarse_pair_has(f, STEPS - 1));
    assert_int_equal(leaf_between_open(&m, pair, CPU_SCALAR, &between), ST_OK);
    between->owns_below = true;
    const leaf_moment at = {0, 0, 0.3};
    const uint32_t set = leaf_between_select(between, &at);
    int different = 0;
    assert_int_equal(leaf_unpacker_create(&m, between, &u[2]), ST_OK);
    for (uint32_t i = 0; i < 2; i++) {
        assert_int_equal(leaf_file_open_coarse(&m, f, 1 + i, &of[i]), ST_OK);
        assert_int_equal(leaf_unpacker_create(&m, of[i], &u[i]), ST_OK);
    }
    for (uint32_t t = 0; t < of[0]->layout.treelets; t++) {
        const leaf_payload shape = leaf_layout_payload(&of[0]->layout, t);
        const uint32_t p = leaf_layout_samples(&between->layout, set, t);
        char *one[3] = {load_payload(of[0], u[0], t), load_payload(of[1], u[1], t),
                        load_payload(between, u[2], p)};
        leaf_between_make(between, p, NULL, one[2]);
        const float *sample[3];
        for (int i = 0; i < 3; i++)
            sample[i] = (const float *)(const void *)(one[i] + shape.samples_at);
        for (uint32_t i = 0; i < shape.samples[0] * shape.samples[1] * shape.samples[2]; i++) {
            const volatile double first = (1 - 0.3) * (double)sample[0][i];
            const volatile double second = 0.3 * (double)sample[1][i], sum = first + second;
            assert_true(sample[2][i] == (float)sum || (isnan(sample[2][i]) && isnan(sum)));
            different += sample[0][i] < sample[1][i];
        }
        for (int i = 0; i < 3; i++)
            mem_free(&m, one[i]);
    }
    assert_true(different > 100);
    for (int i = 0; i < 3; i++)
        leaf_unpacker_destroy(u[i]);
    leaf_file_close(of[0]);
    leaf_file_close(of[1]);
    leaf_file_close(between);
    leaf_file_close(f);
    assert_int_equal(mem_used(&m), 0);
}

/* Grids of several treelets, and of one. */
static void test_samples_between(void **state) {
    (void)state;
    skip_under_thread();
    for (int codec = LEAF_CODEC_RAW; codec <= LEAF_CODEC_ZSTD; codec++) {
        check_samples((leaf_codec)codec, 37);
        check_samples((leaf_codec)codec, 20);
    }
}

static leafcast_frame *begin_level(leafcast *v, uint32_t step, all_planes *p) {
    static const leafcast_surface surface = {ISO_VALUE, {1, 1, 1}, 1, 0, 0};
    const leafcast_shown shown = {.volume = v, .step = step, .surfaces = &surface, .count = 1};
    const leafcast_camera view = leafcast_standard_view(v, 1.3, PICTURE_WIDTH, PICTURE_HEIGHT);
    const leafcast_image image = {.size = sizeof image,
                                  .r = p->rgba[0],
                                  .g = p->rgba[1],
                                  .b = p->rgba[2],
                                  .a = p->rgba[3],
                                  .provisional = p->provisional};
    leafcast_scene scene = leafcast_scene_default();
    leafcast_frame *frame = NULL;
    scene.volumes = &shown;
    scene.volume_count = 1;
    scene.preview = true;
    scene.lod = LEAFCAST_LOD_LEVEL;
    scene.lod_level = 2;
    assert_int_equal(leafcast_frame_begin(v, &scene, &view, &image, &frame), LEAFCAST_OK);
    return frame;
}

static uint64_t finish(leafcast_frame *frame) {
    leafcast_stats stats = {.size = sizeof stats};
    bool done = false;
    while (!done)
        assert_int_equal(leafcast_frame_advance(frame, 0.0, &done, &stats), LEAFCAST_OK);
    leafcast_frame_end(frame);
    return stats.provisional_pixels;
}

/* Two frames of two steps in turns: the grid of the first one stays, and the other draws tets, as
 * far as they are there, until it has ended. */
static void test_steps_in_turns(void **state) {
    (void)state;
    static all_planes alone, first, second;
    make_series("series.leaf", true);
    leafcast *v = open_with("series.leaf", NULL, 0);
    bool done;
    for (int n = 0; n < 20; n++) /* all that is read has been read */
        assert_int_equal(finish(begin_level(v, 0, &alone)), PICTURE_PIXELS);
    leafcast_frame *one = begin_level(v, 0, &first);
    assert_int_equal(leafcast_frame_advance(one, 0.0, &done, NULL), LEAFCAST_OK);
    leafcast_frame *two = begin_level(v, 1, &second);
    assert_int_equal(leafcast_frame_advance(two, 0.0, &done, NULL), LEAFCAST_OK);
    assert_int_equal(finish(one), PICTURE_PIXELS);
    assert_true(finish(two) < PICTURE_PIXELS);
    for (int c = 0; c < 4; c++)
        assert_memory_equal(first.rgba[c], alone.rgba[c], sizeof first.rgba[c]);
    assert_int_equal(finish(begin_level(v, 1, &second)), PICTURE_PIXELS);
    leafcast_close(v);
}

/* ---- what may go wrong ---- */

static leafcast_status try_draw_at(leafcast *v, bool preview, uint32_t level,
                                   leafcast_status *room) {
    static picture p;
    leafcast_scene scene = leafcast_scene_default();
    scene.preview = preview;
    scene.lod = level > 0 ? LEAFCAST_LOD_LEVEL : LEAFCAST_LOD_EXACT;
    scene.lod_level = level;
    const leafcast_camera view = leafcast_standard_view(v, 1.3, PICTURE_WIDTH, PICTURE_HEIGHT);
    const leafcast_image image = {
        .size = sizeof(leafcast_image), .z = p.z, .provisional = p.provisional};
    if (room)
        *room = leafcast_check_room(v, &scene, &view, &image, 0);
    return leafcast_trace(v, &scene, &view, &image, NULL, NULL, NULL);
}

static leafcast_status try_draw(leafcast *v, bool preview) {
    return try_draw_at(v, preview, 0, NULL);
}

/* Damage in the grid is told by previews alone. */
static void test_damage(void **state) {
    (void)state;
    coarse_subjects_make(&m, TETS, "mesh.leaf", NULL, true);
    leaf_file *f = NULL, *coarse = NULL;
    assert_int_equal(leaf_file_open(&m, scratch_path("mesh.leaf"), &f), ST_OK);
    assert_int_equal(leaf_file_open_coarse(&m, f, 0, &coarse), ST_OK);
    const uint64_t start = f->coarse[0].offset;
    const uint64_t places[] = {start + 100, start + LEAF_HEADER_BYTES, start + coarse->offsets[0]};
    leaf_file_close(coarse);
    leaf_file_close(f);
    size_t size;
    char *bytes = scratch_read(scratch_path("mesh.leaf"), &size);
    for (size_t i = 0; i < sizeof places / sizeof *places; i++) {
        bytes[places[i]] ^= 1;
        (void)scratch_write("bad.leaf", bytes, size);
        bytes[places[i]] ^= 1;
        leafcast *v = open_with("bad.leaf", NULL, 0);
        select_one(v, ISO);
        assert_int_equal(try_draw(v, false), LEAFCAST_OK);
        assert_int_equal(try_draw(v, true), LEAFCAST_CORRUPT);
        assert_non_null(strstr(leafcast_error_text(), "from byte"));
        assert_int_equal(try_draw(v, false), LEAFCAST_OK);
        leafcast_close(v);
    }
    free(bytes);
}

/* It is known before whether there is room. */
static leafcast_status try_draw_checked(leafcast *v, bool preview, uint32_t level) {
    leafcast_status room;
    const leafcast_status st = try_draw_at(v, preview, level, &room);
    assert_int_equal(room, st);
    return st;
}

/* A budget that draws the exact picture draws a preview, with the grid or without, whatever came
 * before, and the exact picture again. */
static void test_memory(void **state) {
    const subject of = *(const subject *)*state;
    coarse_subjects_make(&m, of, "mesh.leaf", NULL, true);
    int enough = 0;
    for (uint64_t memory = 256 << 10; memory < 64 << 20; memory += memory / (WATCHED ? 2 : 24)) {
        const leafcast_options o = {
            .size = sizeof(leafcast_options), .threads = 2, .memory = memory};
        leafcast *v = NULL;
        leafcast_status exact = LEAFCAST_NOMEM;
        for (uint32_t first = 0; first < 2; first++) {
            if (leafcast_open(scratch_path("mesh.leaf"), &o, &v) != LEAFCAST_OK)
                continue;
            select_one(v, ISO);
            const leafcast_status before = try_draw_checked(v, first, first);
            assert_true(before == LEAFCAST_OK || before == LEAFCAST_NOMEM);
            exact = first ? exact : before;
            assert_int_equal(before, exact);
            for (uint32_t n = first; n < (WATCHED ? 2 : 6) + first; n++) {
                assert_int_equal(try_draw_checked(v, true, n % 2), exact);
                assert_int_equal(try_draw_checked(v, false, 0), exact);
            }
            leafcast_close(v);
        }
        enough += exact == LEAFCAST_OK;
    }
    assert_true(enough > 3);
}

int main(void) {
    mem_init(&m, 0);
    const struct CMUnitTest tests[] = {
        OF_EACH(test_becomes_exact),
        OF_EACH(test_is_the_grid),
        OF_EACH(test_scenes),
        cmocka_unit_test(test_damage),
        OF_EACH(test_memory),
        cmocka_unit_test(test_steps),
        cmocka_unit_test(test_samples_between),
        OF_EACH(test_levels),
        OF_EACH(test_no_levels),
        cmocka_unit_test(test_steps_in_turns),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
