/* test_mesh_preview.c - previews of meshes with a coarse grid: where treelets are there the exact
 * picture to the bit, elsewhere that of the grid, marked; the exact one once all have come.
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

#include "formats/leaf/leaf_file.h"
#include "prep/mesh/mesh_series.h"
#include "tests/support/fixture.h"
#include "tests/support/mesh_cases.h"
#include "tests/support/pictures.h"
#include "tests/support/scratch.h"

enum { CELLS = 20, FRAMES_MAX = 20000 };
static const double ISO = 0.4;
static mem m;

/* The coarse grid of a set, as a file of its own. */
static void take_part(const char *name, uint32_t set, const char *part_name) {
    leaf_file *f = NULL;
    size_t size;
    char *bytes = scratch_read(scratch_path(name), &size);
    assert_int_equal(leaf_file_open(&m, scratch_path(name), &f), ST_OK);
    const leaf_part part = f->mesh->coarse[set];
    (void)scratch_write(part_name, bytes + part.offset, (size_t)part.bytes);
    leaf_file_close(f);
    free(bytes);
}

/* A mesh with a coarse grid, and the grid as a file of its own. */
static void make(const char *name, const char *part_name, bool coarse) {
    mesh_case c = mesh_cases_kuhn(CELLS, CELLS, CELLS);
    mesh_result r;
    c.options.treelet_tets = 400;
    c.options.coarse = coarse;
    c.options.coarse_dims = 37;
    if (mesh_cases_convert(&m, &c, name, 0, &r) != ST_OK)
        fail_msg("%s", status_text());
    m.limit = 0;
    mesh_cases_free(&c);
    if (part_name)
        take_part(name, 0, part_name);
}

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

static bool same_pixel(const picture *a, const picture *b, int i) {
    bool same = memcmp(&a->z[i], &b->z[i], sizeof a->z[i]) == 0 && a->id[i] == b->id[i];
    for (int c = 0; c < 4; c++)
        same &= memcmp(&a->rgba[c][i], &b->rgba[c][i], sizeof a->rgba[c][i]) == 0;
    for (int c = 0; c < 3; c++)
        same &= memcmp(&a->normal[c][i], &b->normal[c][i], sizeof a->normal[c][i]) == 0;
    return same;
}

/* Each pixel is the exact one, or marked and the grid's; gridded NULL: not looked at. Returns how
 * many are marked. */
static uint64_t check_picture(const picture *got, const picture *exact, const picture *gridded) {
    uint64_t marked = 0;
    for (int i = 0; i < PICTURE_PIXELS; i++) {
        marked += got->provisional[i];
        if (!got->provisional[i] && !same_pixel(got, exact, i))
            fail_msg("pixel %d: not marked, and not exact: %g, expected %g", i, got->z[i],
                     exact->z[i]);
        if (got->provisional[i] && gridded && !same_pixel(got, gridded, i))
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

/* Whether what is marked is the grid's in full. Until then threads that read get a moment: on a
 * busy machine they may need many. */
static bool grid_has_come(const picture *got, const picture *gridded) {
    const struct timespec moment = {.tv_nsec = 2000000};
    for (int i = 0; i < PICTURE_PIXELS; i++)
        if (got->provisional[i] && !same_pixel(got, gridded, i)) {
            nanosleep(&moment, NULL);
            return false;
        }
    return true;
}

static const char *const ISAS[] = {"scalar", NULL};

static void test_becomes_exact(void **state) {
    (void)state;
    static picture exact, got;
    make("mesh.leaf", NULL, true);
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
    (void)state;
    static picture exact, gridded, got;
    make("mesh.leaf", "part.leaf", true);
    leafcast_scene scene = leafcast_scene_default();
    for (int kind = 0; kind < 4; kind++) {
        leafcast *v = open_with("mesh.leaf", ISAS[kind % 2], 2);
        const leafcast_camera view =
            leafcast_standard_view(v, kind < 2 ? 1.3 : 0.7, PICTURE_WIDTH, PICTURE_HEIGHT);
        scene.preview = false;
        draw_exact("mesh.leaf", &scene, &view, ISO, &exact);
        draw_exact("part.leaf", &scene, &view, ISO, &gridded);
        scene.preview = true;
        select_one(v, ISO);
        leafcast_stats stats = {.size = sizeof(leafcast_stats)};
        for (int n = 0; n < FRAMES_MAX && (n == 0 || !grid_has_come(&got, &gridded)); n++) {
            pictures_draw(v, &scene, &view, &got, &stats);
            (void)check_picture(&got, &exact, NULL);
        }
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
        assert_true(hits > 500 && near > hits * 9 / 10);
        leafcast_close(v);
    }
}

/* Transparent layers, shadows: what is not marked is exact. */
static void test_scenes(void **state) {
    (void)state;
    static picture exact, got;
    make("mesh.leaf", NULL, true);
    field_random r = {5};
    for (int kind = 0; kind < 12; kind++) {
        leafcast *v = open_with("mesh.leaf", ISAS[kind % 2], kind % 3 ? 8 : 0), *w;
        const leafcast_info info = leafcast_describe(v);
        leafcast_scene scene = pictures_scene(kind, &info);
        scene.experiments = NULL;
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

/* ---- steps ---- */

enum { STEPS = 3 };

/* The mesh at a step: higher values each time, and in the last one the points are elsewhere. */
static const char *write_step(const mesh_case *c, uint32_t step, const char *name) {
    const char *path = scratch_path(name);
    FILE *f = fopen(path, "wb");
    assert_non_null(f);
    fprintf(f, "LEAFCAST MESH 1\nname: moved\nfield: wave\npoints: %zu\ntets: %zu\n\n",
            c->point_count, c->tet_count);
    for (size_t i = 0; i < c->point_count; i++) {
        float at[3];
        for (int a = 0; a < 3; a++)
            at[a] = c->points[i][a] * (step + 1 == STEPS ? 0.75F : 1.0F);
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

static void make_series(const char *name) {
    mesh_case c = mesh_cases_kuhn(CELLS, CELLS, CELLS);
    const char *paths[STEPS];
    for (uint32_t s = 0; s < STEPS; s++) {
        char step[16];
        (void)snprintf(step, sizeof step, "%u.mesh", s);
        paths[s] = write_step(&c, s, step);
    }
    const mesh_series series = {.paths = paths, .steps = STEPS, .fields = 1};
    const mesh_hints hints = {0};
    mesh_input *first = NULL;
    mesh_result r;
    c.options.treelet_tets = 400;
    c.options.coarse = true;
    c.options.coarse_dims = 37;
    c.options.series = &series;
    status st = mesh_input_open(&m, paths[0], &hints, &first);
    if (st == ST_OK)
        st = mesh_convert_run(&m, first, scratch_path(name), &c.options, NULL, &r);
    if (st != ST_OK)
        fail_msg("%s", status_text());
    mesh_input_close(first);
    mesh_cases_free(&c);
}

/* Each step has a grid of its own, there and back: few treelets at a time leave most to it, with
 * all of them the picture becomes exact. */
static void test_steps(void **state) {
    (void)state;
    static const uint32_t order[] = {0, 2, 1, 1, 2, 0};
    static picture exact, gridded, got;
    make_series("series.leaf");
    for (int kind = 0; kind < 2; kind++) {
        uint64_t most = 0;
        leafcast *v = open_with("series.leaf", NULL, kind ? 0 : 2);
        leafcast *w = open_with("series.leaf", "scalar", 0);
        const leafcast_camera view = leafcast_standard_view(v, 1.3, PICTURE_WIDTH, PICTURE_HEIGHT);
        leafcast_scene scene = leafcast_scene_default();
        select_one(v, ISO);
        select_one(w, ISO);
        for (size_t k = 0; k < sizeof order / sizeof *order; k++) {
            leafcast_stats stats = {.size = sizeof(leafcast_stats)};
            take_part("series.leaf", order[k], "part.leaf");
            scene.preview = false;
            assert_int_equal(leafcast_select_set(w, 0, order[k]), LEAFCAST_OK);
            pictures_draw(w, &scene, &view, &exact, &stats);
            draw_exact("part.leaf", &scene, &view, ISO, &gridded);
            scene.preview = true;
            assert_int_equal(leafcast_select_set(v, 0, order[k]), LEAFCAST_OK);
            uint64_t marked = 1;
            for (int n = 0; n < FRAMES_MAX && marked; n++) {
                if (n > 0 && !kind && grid_has_come(&got, &gridded))
                    break;
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

/* ---- what may go wrong ---- */

static leafcast_status try_draw(leafcast *v, bool preview) {
    static picture p;
    leafcast_scene scene = leafcast_scene_default();
    scene.preview = preview;
    const leafcast_camera view = leafcast_standard_view(v, 1.3, PICTURE_WIDTH, PICTURE_HEIGHT);
    const leafcast_image image = {
        .size = sizeof(leafcast_image), .z = p.z, .provisional = p.provisional};
    return leafcast_trace(v, &scene, &view, &image, NULL, NULL, NULL);
}

/* Damage in the grid is told by previews alone. */
static void test_damage(void **state) {
    (void)state;
    make("mesh.leaf", NULL, true);
    leaf_file *f = NULL, *coarse = NULL;
    assert_int_equal(leaf_file_open(&m, scratch_path("mesh.leaf"), &f), ST_OK);
    assert_int_equal(leaf_file_open_coarse(&m, f, 0, &coarse), ST_OK);
    const uint64_t start = f->mesh->coarse[0].offset;
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

/* A budget that draws the exact picture draws a preview, with the grid or without. */
static void test_memory(void **state) {
    (void)state;
    make("mesh.leaf", NULL, true);
    int enough = 0;
    for (uint64_t memory = 256 << 10; memory < 64 << 20; memory += memory / 3) {
        const leafcast_options o = {
            .size = sizeof(leafcast_options), .threads = 2, .memory = memory};
        leafcast *v = NULL;
        if (leafcast_open(scratch_path("mesh.leaf"), &o, &v) != LEAFCAST_OK)
            continue;
        select_one(v, ISO);
        const leafcast_status exact = try_draw(v, false);
        assert_true(exact == LEAFCAST_OK || exact == LEAFCAST_NOMEM);
        for (int n = 0; n < 3; n++)
            assert_int_equal(try_draw(v, true), exact);
        assert_int_equal(try_draw(v, false), exact);
        enough += exact == LEAFCAST_OK;
        leafcast_close(v);
    }
    assert_true(enough > 3);
}

int main(void) {
    mem_init(&m, 0);
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_becomes_exact), cmocka_unit_test(test_is_the_grid),
        cmocka_unit_test(test_scenes),        cmocka_unit_test(test_damage),
        cmocka_unit_test(test_memory),        cmocka_unit_test(test_steps),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
