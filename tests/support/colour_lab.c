#include "tests/support/colour_lab.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/support/curvilinear_file.h"
#include "tests/support/fixture.h"
#include "tests/support/leaf_files.h"
#include "tests/support/mixed_file.h"
#include "tests/support/scene_stage.h"
#include "tests/support/scratch.h"
#include "tests/support/triangle_lab.h"

/* ---- Files of all kinds ---- */

const char *const colour_lab_names[FILES] = {
    "grid", "grid with holes", "mesh", "curvilinear grid", "mixed", "heights", "triangles"};
char colour_lab_paths[IMAGE + 1][600];
heights_terrain colour_lab_image;
static const scene_stage *stage;

void colour_lab_keep(int which, const char *path) {
    snprintf(colour_lab_paths[which], sizeof colour_lab_paths[which], "%s", path);
}

static void make_holes(void) {
    leaf_case c = leaf_files_case(29, 35, 40, SAMPLE_F32);
    void *samples = leaf_files_random(&c, 5, 300);
    c.samples = samples;
    colour_lab_keep(HOLES, leaf_files_make(&c, "holes.leaf"));
    free(samples);
}

static void make_curved(void) {
    enum { I = 36, J = 12, K = 18 };
    static float p[I * J * K][3], values[I * J * K];
    for (int n = 0; n < I * J * K; n++) {
        const double i = n % I, j = n / I % J, k = n / (I * J);
        p[n][0] = (float)(i + 1.5 * sin(0.3 * k));
        p[n][1] = (float)(j + cos(0.2 * i));
        p[n][2] = (float)(k + 0.5 * sin(j));
        values[n] = (float)(sin(0.35 * i) + cos(0.3 * k) + 0.2 * j);
    }
    const curvilinear_zone zone = {{I, J, K}, (const float(*)[3])p, values, NULL};
    const leaf_image image = curvilinear_file(&zone, 1);
    colour_lab_keep(CURVED, scratch_write("curved.leaf", image.bytes, image.size));
    free(image.bytes);
}

static void make_mixed(void) {
    static cell_mix mix;
    mesh_result result;
    cell_mix_make(&mix, 0, FIELD_SEED);
    (void)mixed_file_write(mix.cell, mix.count, scratch_path("mix.vtk"));
    mixed_file_convert(scratch_path("mix.vtk"), scratch_path("mix.leaf"), 40, UINT64_C(1) << 32,
                       &result);
    colour_lab_keep(MIXED, scratch_path("mix.leaf"));
}

static void make_surfaces(void) {
    static triangle_lab lab;
    heights_terrain terrain;
    mesh_result result;
    triangle_lab_make(&lab, 0, FIELD_SEED);
    triangle_lab_convert(&lab, scratch_path("lab.leaf"), 64, "f", true, &result);
    colour_lab_keep(TRIANGLES, scratch_path("lab.leaf"));
    heights_lab_make(&terrain, 0, 50, FIELD_SEED);
    colour_lab_keep(HEIGHTS, heights_lab_leaf(&terrain, 4, 1, true));
    heights_lab_release(&terrain);
}

/* Terrain whose heights are colours. */
static void make_image(void) {
    static float colours[64 * 64];
    field_random r = {8};
    heights_lab_make(&colour_lab_image, 0, 50, FIELD_SEED + 1);
    heights_lab_release(&colour_lab_image);
    for (int i = 0; i < colour_lab_image.truth.nx * colour_lab_image.truth.ny; i++)
        colours[i] = (float)field_random_below(&r, 1 << 24);
    colour_lab_image.truth.heights = colour_lab_image.heights = colours;
    colour_lab_image.field = "rgb";
    colour_lab_keep(IMAGE, scratch_path("image.leaf"));
    assert_int_equal(
        rename(heights_lab_leaf(&colour_lab_image, 4, 0, true), colour_lab_paths[IMAGE]), 0);
}

int colour_lab_set(void **state) {
    (void)scene_stage_set(state);
    stage = *state;
    colour_lab_keep(GRID, stage->grid_path);
    colour_lab_keep(MESH, stage->mesh_path);
    make_holes();
    make_curved();
    make_mixed();
    make_image();
    make_surfaces();
    return 0;
}

/* ---- A scene of one volume coloured by another ---- */

void colour_lab_place(const leafcast *v, double angle, double scale, double place[12]) {
    const leafcast_info info = leafcast_describe(v);
    double own[3][4] = {{0}};
    for (int a = 0; a < 3; a++) {
        const double length = info.bounds[1][a] - info.bounds[0][a];
        own[a][a] = scale * 10.0 / length;
        own[a][3] = -scale * (10.0 * info.bounds[0][a] / length + 5.0);
    }
    const double c = cos(angle), s = sin(angle), turn[3][3] = {{c, -s, 0}, {s, c, 0}, {0, 0, 1}};
    for (int r = 0; r < 3; r++)
        for (int k = 0; k < 4; k++) {
            place[4 * r + k] = k == 3 ? 5.0 : 0.0;
            for (int m = 0; m < 3; m++)
                place[4 * r + k] += turn[r][m] * own[m][k];
        }
}

/* Let a place lead from [0, 10]^3 to the box of a volume instead. */
static void place_into(const leafcast *v, double place[12]) {
    const leafcast_info info = leafcast_describe(v);
    for (int a = 0; a < 3; a++) {
        const double length = (info.bounds[1][a] - info.bounds[0][a]) / 10.0;
        for (int k = 0; k < 4; k++)
            place[4 * a + k] *= length;
        place[4 * a + 3] += info.bounds[0][a];
    }
}

void colour_lab_open(coloured *c, int of, int by, where how, const leafcast_options *device,
                     uint32_t treelets) {
    const leafcast_options none = {.size = sizeof none};
    double range[2];
    int count;
    memset(c, 0, sizeof *c);
    assert_int_equal(leafcast_device_create(device ? device : &none, &c->device), LEAFCAST_OK);
    const leafcast_options on = {.size = sizeof on,
                                 .device = c->device,
                                 .experiments = EXPERIMENTS(.treelet_limit = treelets)};
    assert_int_equal(leafcast_open(colour_lab_paths[of], &on, &c->of), LEAFCAST_OK);
    assert_int_equal(leafcast_open(colour_lab_paths[by], &on, &c->by), LEAFCAST_OK);
    assert_int_equal(leafcast_range(c->by, 0, 0, range), LEAFCAST_OK);
    const double middle = 0.4 * range[0] + 0.6 * range[1];
    c->points[0] = (leafcast_transfer_point){.value = range[0], .rgb = {1.0, 0.0, 0.1}};
    c->points[1] = (leafcast_transfer_point){.value = middle, .rgb = {0.0, 1.0, 0.5}};
    c->points[2] = (leafcast_transfer_point){.value = range[1], .rgb = {0.0, 0.2, 1.0}};
    c->map = (leafcast_medium){c->points, 3};
    double iso = 0.0;
    assert_int_equal(leafcast_suggested_isovalues(c->of, 0, 0, &iso, 1, &count), LEAFCAST_OK);
    c->surfaces[0] = leafcast_surface_default(of == GRID ? scene_stage_isos[0] : iso);
    c->surfaces[1] = leafcast_surface_default(scene_stage_isos[1]);
    for (int i = 0; i < 2; i++)
        memcpy(c->surfaces[i].rgb, (const float[3]){0.25f, 0.75f, 0.875f}, sizeof(float[3]));
    colour_lab_place(c->of, 0.2, 0.9, c->place[0]);
    colour_lab_place(c->by, -0.3, 0.95, c->place[1]);
    if (how == TILED)
        place_into(c->of, c->place[1]);
    c->colouring =
        (leafcast_colouring){.volume = c->by, .place = how != AS_FILES_SAY ? c->place[1] : NULL};
    c->shown = (leafcast_shown){.volume = c->of,
                                .surfaces = c->surfaces,
                                .count = 1,
                                .place = how == PLACED ? c->place[0] : NULL,
                                .colours = &c->map,
                                .colour_by = &c->colouring};
    c->scene = leafcast_scene_default();
    c->scene.volumes = &c->shown;
    c->scene.volume_count = 1;
    c->scene.shading = LEAFCAST_SHADING_FLAT;
    c->camera = scene_stage_view(50.0);
    if (how == TILED)
        c->camera = leafcast_standard_view(c->of, 1.2, PICTURE_WIDTH, PICTURE_HEIGHT);
    if (how == PLACED) {
        const double eye[3] = {21.0, 15.0, 19.0}, at[3] = {5.1, 4.9, 5.0};
        memcpy(c->camera.eye, eye, sizeof eye);
        memcpy(c->camera.look_at, at, sizeof at);
    }
}

void colour_lab_close(coloured *c) {
    leafcast_close(c->of);
    leafcast_close(c->by);
    leafcast_device_destroy(c->device);
}

void colour_lab_refused(coloured *c, const char *said) {
    float r[4];
    const leafcast_camera view = leafcast_standard_view(c->of, 2.0, 2, 2);
    const leafcast_image image = {.size = sizeof image, .r = r};
    assert_int_equal(leafcast_trace(c->of, &c->scene, &view, &image, NULL, NULL, NULL),
                     LEAFCAST_USAGE);
    if (!strstr(leafcast_error_text(), said))
        fail_msg("\"%s\" lacks \"%s\"", leafcast_error_text(), said);
}
