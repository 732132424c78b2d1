#include "tests/support/public_calls.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "prep/prep_arguments.h"
#include "render/door/arguments.h"
#include "tests/support/fixture.h"
#include "tests/support/scratch.h"

#define BIT(slot) (UINT64_C(1) << CALLS_##slot)
#define P(slot)   (l->p[CALLS_##slot])

/* ---- Calls ---- */

static leafcast_status device_create(calls_lab *l) {
    const leafcast_status st = leafcast_device_create(P(OPTIONS), P(OUT));
    if (st == LEAFCAST_OK)
        leafcast_device_destroy(*(leafcast_device **)P(OUT));
    return st;
}

static leafcast_status open_path(calls_lab *l) {
    const leafcast_status st = leafcast_open(P(PATH), P(OPTIONS), P(OUT));
    if (st == LEAFCAST_OK)
        leafcast_close(*(leafcast **)P(OUT));
    return st;
}

static leafcast_status make_places(calls_lab *l) {
    const leafcast_status st = leafcast_make_places(P(VOLUME), P(PLACES), NULL, 1, P(OUT));
    if (st == LEAFCAST_OK)
        leafcast_free_places(*(leafcast_places **)P(OUT));
    return st;
}

static leafcast_status open_bytes(calls_lab *l) {
    const leafcast_status st = leafcast_open_memory(P(BYTES), l->many, P(OPTIONS), P(OUT));
    if (st == LEAFCAST_OK)
        leafcast_close(*(leafcast **)P(OUT));
    return st;
}

static leafcast_status open_live(calls_lab *l) {
    const leafcast_status st = leafcast_open_live(P(GRID), P(OPTIONS), P(OUT));
    if (st == LEAFCAST_OK)
        leafcast_close(*(leafcast **)P(OUT));
    return st;
}

static leafcast_status update_live(calls_lab *l) {
    return leafcast_update(P(LIVE), NULL, NULL, P(SAMPLES), NULL);
}

static leafcast_status commit_live(calls_lab *l) {
    return leafcast_commit(P(LIVE), l->x);
}

static leafcast_status open_triangles(calls_lab *l) {
    const leafcast_status st = leafcast_open_triangles(P(TRIANGLES), P(OPTIONS), P(OUT));
    if (st == LEAFCAST_OK)
        leafcast_close(*(leafcast **)P(OUT));
    return st;
}

static leafcast_status update_vertices(calls_lab *l) {
    return leafcast_update_vertices(P(MOVING), P(POSITIONS), 4);
}

static leafcast_status get_info(calls_lab *l) {
    return leafcast_get_info(P(VOLUME), P(INFO));
}

static leafcast_status select_surfaces(calls_lab *l) {
    return leafcast_select(P(VOLUME), P(SURFACES), l->count);
}

static leafcast_status select_set(calls_lab *l) {
    return leafcast_select_set(P(VOLUME), l->field, l->step);
}

static leafcast_status expect_set(calls_lab *l) {
    return leafcast_expect_set(P(VOLUME), l->field, l->step);
}

static leafcast_status select_between(calls_lab *l) {
    return leafcast_select_between(P(VOLUME), l->field, l->step, 0.0);
}

static leafcast_status expect_between(calls_lab *l) {
    return leafcast_expect_between(P(VOLUME), l->field, l->step, 0.0);
}

static leafcast_status find_time(calls_lab *l) {
    return leafcast_find_time(P(VOLUME), 0.0, P(COUNT), P(NUMBERS));
}

static leafcast_status map_steps(calls_lab *l) {
    return leafcast_map_steps(P(VOLUME), l->field, l->step + 1, P(FOUND));
}

static leafcast_status find_steps(calls_lab *l) {
    return leafcast_find_steps(P(VOLUME), l->field, 0.0, l->distance, l->step + 1, P(FOUND),
                               P(COUNT));
}

static leafcast_status refresh(calls_lab *l) {
    return leafcast_refresh(P(VOLUME), P(COUNT));
}

static leafcast_status find_field(calls_lab *l) {
    return leafcast_find_field(P(VOLUME), P(TEXT) ? "0" : NULL, P(COUNT));
}

static leafcast_status map_treelets(calls_lab *l) {
    return leafcast_map_treelets(P(VOLUME), l->level, P(BLOCKS), P(FOUND));
}

static leafcast_status range(calls_lab *l) {
    return leafcast_range(P(VOLUME), l->field, l->step, P(NUMBERS));
}

static leafcast_status init_scene(calls_lab *l) {
    leafcast_scene scene = *(leafcast_scene *)(P(SCENE) ? P(SCENE) : &(leafcast_scene){0});
    return leafcast_init_scene(P(SCENE) ? &scene : NULL);
}

static leafcast_status standard_view(calls_lab *l) {
    leafcast_camera camera = *(leafcast_camera *)(P(CAMERA) ? P(CAMERA) : &(leafcast_camera){0});
    return leafcast_get_standard_view(P(VOLUME), l->distance, l->width, l->height,
                                      P(CAMERA) ? &camera : NULL);
}

static leafcast_status get_histogram(calls_lab *l) {
    return leafcast_get_histogram(P(VOLUME), l->field, l->step, P(FOUND));
}

static leafcast_status data_range(calls_lab *l) {
    return leafcast_data_range(P(VOLUME), l->field, l->step, P(NUMBERS));
}

static leafcast_status suggested(calls_lab *l) {
    double isovalues[CALLS_SOME];
    return leafcast_suggested_isovalues(P(VOLUME), l->field, l->step, P(NUMBERS) ? isovalues : NULL,
                                        l->max, P(COUNT));
}

static leafcast_status fit_view(calls_lab *l) {
    leafcast_camera camera = *(leafcast_camera *)(P(CAMERA) ? P(CAMERA) : &(leafcast_camera){0});
    return leafcast_fit_view(P(VOLUME), l->field, l->step, P(NUMBERS), l->count, l->fov, l->width,
                             l->height, P(CAMERA) ? &camera : NULL);
}

static leafcast_status check_room(calls_lab *l) {
    return leafcast_check_room(P(VOLUME), P(SCENE), P(CAMERA), P(IMAGE), l->beside);
}

static leafcast_status trace(calls_lab *l) {
    return leafcast_trace(P(VOLUME), P(SCENE), P(CAMERA), P(IMAGE), P(STATS), NULL, NULL);
}

static leafcast_status frame_begin(calls_lab *l) {
    const leafcast_status st =
        leafcast_frame_begin(P(VOLUME), P(SCENE), P(CAMERA), P(IMAGE), P(OUT));
    if (st == LEAFCAST_OK)
        leafcast_frame_end(*(leafcast_frame **)P(OUT));
    return st;
}

static leafcast_status frame_advance(calls_lab *l) {
    return leafcast_frame_advance(P(FRAME), l->seconds, P(DONE), P(STATS));
}

static leafcast_status probe_ray(calls_lab *l) {
    return leafcast_probe_ray(P(VOLUME), P(SCENE), P(VECTOR), P(VECTOR2), P(FOUND), l->max,
                              P(COUNT));
}

static leafcast_status probe_segments(calls_lab *l) {
    return leafcast_probe_segments(P(VOLUME), P(SCENE), P(VECTOR), P(VECTOR2), P(FOUND), l->max,
                                   P(COUNT));
}

static leafcast_status trace_rays(calls_lab *l) {
    return leafcast_trace_rays(P(VOLUME), P(SCENE), P(RAYS), (size_t)l->count, P(FOUND));
}

static leafcast_status occluded_rays(calls_lab *l) {
    return leafcast_occluded_rays(P(VOLUME), P(SCENE), P(RAYS), (size_t)l->count, P(FOUND));
}

/* It has no status, but a direction. */
static leafcast_status pixel_ray(calls_lab *l) {
    double origin[3], direction[3];
    leafcast_pixel_ray(P(CAMERA), l->x, 1.0, origin, direction);
    return direction[0] == 0.0 && direction[1] == 0.0 && direction[2] == 0.0 ? LEAFCAST_USAGE
                                                                             : LEAFCAST_OK;
}

static leafcast_status get_cell(calls_lab *l) {
    return leafcast_get_cell(P(VOLUME), l->level, 0, P(CELL));
}

static leafcast_status probe_point(calls_lab *l) {
    return leafcast_probe_point(P(VOLUME), P(VECTOR), P(FOUND));
}

static leafcast_status sample_points(calls_lab *l) {
    return leafcast_sample_points(P(VOLUME), P(VECTOR), 1, P(FOUND));
}

static leafcast_slice_pixels slice_of(const calls_lab *l) {
    return *(leafcast_slice_pixels *)(P(SLICE) ? P(SLICE) : &(leafcast_slice_pixels){0});
}

static leafcast_status fit_slice(calls_lab *l) {
    leafcast_slice_pixels slice = slice_of(l);
    return leafcast_fit_slice(P(VOLUME), P(SLICE) ? &slice : NULL);
}

static leafcast_status plane_slice(calls_lab *l) {
    leafcast_slice_pixels slice = slice_of(l);
    return leafcast_plane_slice(P(VOLUME), P(VECTOR), P(SLICE) ? &slice : NULL);
}

static leafcast_status layer_slice(calls_lab *l) {
    leafcast_slice_pixels slice = slice_of(l);
    return leafcast_layer_slice(P(VOLUME), l->axis, l->node, P(SLICE) ? &slice : NULL);
}

static leafcast_status sample_slice(calls_lab *l) {
    return leafcast_sample_slice(P(VOLUME), P(SLICE), P(NUMBERS), P(STATS), NULL, NULL);
}

static leafcast_status convert_path(calls_lab *l) {
    return leafcast_convert_path(P(TEXT), P(OUTPUT), P(CONVERT_OPTIONS));
}

static leafcast_status convert_steps(calls_lab *l) {
    const char *paths[] = {P(TEXT), P(TEXT)};
    return leafcast_convert_steps(paths, l->steps, NULL, P(OUTPUT), P(CONVERT_OPTIONS));
}

static leafcast_status deliver(void *ctx, uint32_t z, void *samples) {
    (void)z;
    memcpy(samples, ctx, 4 * sizeof(float));
    return LEAFCAST_OK;
}

static leafcast_status convert_slices(calls_lab *l) {
    static const float samples[4] = {1, 2, 3, 4};
    return leafcast_convert_slices(P(GRID), P(SLICES) ? deliver : NULL, (void *)samples, P(OUTPUT),
                                   P(CONVERT_OPTIONS));
}

static leafcast_status convert_array(calls_lab *l) {
    return leafcast_convert_array(P(GRID), P(SAMPLES), NULL, P(OUTPUT), P(CONVERT_OPTIONS));
}

static leafcast_status convert_tets(calls_lab *l) {
    return leafcast_convert_tets(P(TETS), P(OUTPUT), P(CONVERT_OPTIONS));
}

#define PICTURE (BIT(SCENE) | BIT(CAMERA) | BIT(IMAGE))
#define RAY     (BIT(VOLUME) | BIT(SCENE) | BIT(VECTOR) | BIT(VECTOR2) | BIT(FOUND) | BIT(COUNT))

const public_call *public_calls(int *count) {
    static const public_call calls[] = {
        {.name = "leafcast_version"},
        {.name = "leafcast_error_text"},
        {.name = "leafcast_device_destroy"},
        {.name = "leafcast_close"},
        {.name = "leafcast_free_places"},
        {"leafcast_make_places", make_places, BIT(VOLUME) | BIT(PLACES) | BIT(OUT), 0, 0, NULL},
        {.name = "leafcast_surface_default"},
        {.name = "leafcast_field_name"},
        {.name = "leafcast_step_time"},
        {.name = "leafcast_stop_reading"},
        {.name = "leafcast_cell_indices"},
        {.name = "leafcast_frame_cancel"},
        {.name = "leafcast_frame_end"},
        {"leafcast_device_create", device_create, BIT(OUT), BIT(OPTIONS), 0, NULL},
        {"leafcast_open", open_path, BIT(PATH) | BIT(OUT), BIT(OPTIONS), 0, NULL},
        {"leafcast_open_memory", open_bytes, BIT(BYTES) | BIT(OUT), BIT(OPTIONS), 0, NULL},
        {"leafcast_open_live", open_live, BIT(GRID) | BIT(OUT), BIT(GRID) | BIT(OPTIONS), 0, NULL},
        {"leafcast_update", update_live, BIT(LIVE) | BIT(SAMPLES), 0, 0, NULL},
        {"leafcast_commit", commit_live, BIT(LIVE), 0, 0, NULL},
        {"leafcast_open_triangles", open_triangles, BIT(TRIANGLES) | BIT(OUT),
         BIT(TRIANGLES) | BIT(OPTIONS), 0, NULL},
        {"leafcast_update_vertices", update_vertices, BIT(MOVING) | BIT(POSITIONS), 0, 0, NULL},
        {"leafcast_get_info", get_info, BIT(VOLUME) | BIT(INFO), 0, BIT(INFO), NULL},
        {"leafcast_select", select_surfaces, BIT(VOLUME) | BIT(SURFACES), BIT(SURFACES), 0, NULL},
        {"leafcast_select_set", select_set, BIT(VOLUME), 0, 0, NULL},
        {"leafcast_expect_set", expect_set, BIT(VOLUME), 0, 0, NULL},
        {"leafcast_select_between", select_between, BIT(VOLUME), 0, 0, NULL},
        {"leafcast_expect_between", expect_between, BIT(VOLUME), 0, 0, NULL},
        {"leafcast_find_time", find_time, BIT(VOLUME) | BIT(COUNT) | BIT(NUMBERS), 0, 0, NULL},
        {"leafcast_map_steps", map_steps, BIT(VOLUME) | BIT(FOUND), 0, 0, NULL},
        {"leafcast_find_steps", find_steps, BIT(VOLUME) | BIT(COUNT), 0, 0, NULL},
        {"leafcast_refresh", refresh, BIT(VOLUME) | BIT(COUNT), 0, 0, NULL},
        {"leafcast_find_field", find_field, BIT(VOLUME) | BIT(TEXT) | BIT(COUNT), 0, 0, NULL},
        {"leafcast_map_treelets", map_treelets, BIT(VOLUME) | BIT(BLOCKS) | BIT(FOUND), 0, 0, NULL},
        {"leafcast_range", range, BIT(VOLUME) | BIT(NUMBERS), 0, 0, NULL},
        {"leafcast_init_scene", init_scene, BIT(SCENE), 0, BIT(SCENE), NULL},
        {"leafcast_get_standard_view", standard_view, BIT(VOLUME) | BIT(CAMERA), 0, BIT(CAMERA),
         NULL},
        {"leafcast_get_histogram", get_histogram, BIT(VOLUME) | BIT(FOUND), 0, 0, NULL},
        {"leafcast_data_range", data_range, BIT(VOLUME) | BIT(NUMBERS), 0, 0, NULL},
        {"leafcast_suggested_isovalues", suggested, BIT(VOLUME) | BIT(NUMBERS) | BIT(COUNT), 0, 0,
         NULL},
        {"leafcast_fit_view", fit_view, BIT(VOLUME) | BIT(NUMBERS) | BIT(CAMERA), 0, BIT(CAMERA),
         NULL},
        {"leafcast_check_room", check_room, BIT(VOLUME) | PICTURE, PICTURE, 0, NULL},
        {"leafcast_trace", trace, BIT(VOLUME) | PICTURE, PICTURE, BIT(STATS), NULL},
        {"leafcast_frame_begin", frame_begin, BIT(VOLUME) | PICTURE | BIT(OUT), PICTURE, 0, NULL},
        {"leafcast_frame_advance", frame_advance, BIT(FRAME) | BIT(DONE), 0, BIT(STATS), NULL},
        {"leafcast_probe_ray", probe_ray, RAY, BIT(SCENE), 0, NULL},
        {"leafcast_probe_segments", probe_segments, RAY, BIT(SCENE), 0, NULL},
        {"leafcast_trace_rays", trace_rays, BIT(VOLUME) | BIT(SCENE) | BIT(RAYS) | BIT(FOUND),
         BIT(SCENE) | BIT(RAYS), 0, NULL},
        {"leafcast_occluded_rays", occluded_rays, BIT(VOLUME) | BIT(SCENE) | BIT(RAYS) | BIT(FOUND),
         BIT(SCENE) | BIT(RAYS), 0, NULL},
        {"leafcast_pixel_ray", pixel_ray, BIT(CAMERA), BIT(CAMERA), 0, NULL},
        {"leafcast_get_cell", get_cell, BIT(VOLUME) | BIT(CELL), 0, BIT(CELL), NULL},
        {"leafcast_probe_point", probe_point, BIT(VOLUME) | BIT(VECTOR) | BIT(FOUND), 0, 0, NULL},
        {"leafcast_sample_points", sample_points, BIT(VOLUME) | BIT(VECTOR) | BIT(FOUND), 0, 0,
         NULL},
        {"leafcast_fit_slice", fit_slice, BIT(VOLUME) | BIT(SLICE), BIT(SLICE), 0,
         " size interpolation level origin u v line line_count beside "},
        {"leafcast_plane_slice", plane_slice, BIT(VOLUME) | BIT(VECTOR) | BIT(SLICE), BIT(SLICE), 0,
         " size interpolation level "},
        {"leafcast_layer_slice", layer_slice, BIT(VOLUME) | BIT(SLICE), BIT(SLICE), 0,
         " size interpolation level "},
        {"leafcast_sample_slice", sample_slice, BIT(VOLUME) | BIT(SLICE) | BIT(NUMBERS), BIT(SLICE),
         BIT(STATS), NULL},
        {"leafcast_convert_path", convert_path, BIT(TEXT) | BIT(OUTPUT), BIT(CONVERT_OPTIONS), 0,
         NULL},
        {"leafcast_convert_steps", convert_steps, BIT(TEXT) | BIT(OUTPUT), BIT(CONVERT_OPTIONS), 0,
         NULL},
        {"leafcast_convert_slices", convert_slices, BIT(GRID) | BIT(SLICES) | BIT(OUTPUT),
         BIT(GRID) | BIT(CONVERT_OPTIONS), 0, NULL},
        {"leafcast_convert_array", convert_array, BIT(GRID) | BIT(SAMPLES) | BIT(OUTPUT),
         BIT(GRID) | BIT(CONVERT_OPTIONS), 0, NULL},
        {"leafcast_convert_tets", convert_tets, BIT(TETS) | BIT(OUTPUT),
         BIT(TETS) | BIT(CONVERT_OPTIONS), 0, NULL},
    };
    *count = (int)(sizeof calls / sizeof *calls);
    return calls;
}

const public_fields *public_calls_table(const char *name) {
    int counts[2];
    const public_fields *const *const tables[2] = {arguments_tables(&counts[0]),
                                                   prep_arguments_tables(&counts[1])};
    for (int k = 0; k < 2; k++)
        for (int i = 0; i < counts[k]; i++)
            if (strcmp(tables[k][i]->name, name) == 0)
                return tables[k][i];
    return NULL;
}

/* ---- Arguments ---- */

static field sphere;

static leafcast_places *places;
static double place[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};

/* A scene of which every array has elements. */
static leafcast_scene scene_of(leafcast *volume) {
    static leafcast_shown shown[1], grouped[1];
    static leafcast_group groups[1];
    static leafcast_surface surfaces[CALLS_SOME];
    static leafcast_transfer_point points[] = {{0.0, {1, 0, 0}, 0.0}, {1.0, {0, 1, 0}, 1.0}};
    static leafcast_medium media[1], colours;
    static leafcast_colouring by;
    static leafcast_scene_experiments experiments;
    for (int i = 0; i < CALLS_SOME; i++)
        surfaces[i] = leafcast_surface_default(sphere.iso * (1.0 + 0.1 * i));
    by = (leafcast_colouring){.volume = volume};
    shown[0] = (leafcast_shown){.volume = volume,
                                .surfaces = surfaces,
                                .count = CALLS_SOME,
                                .colours = &colours,
                                .colour_by = &by};
    media[0] = colours = (leafcast_medium){points, 2};
    experiments = (leafcast_scene_experiments){.size = sizeof experiments};
    leafcast_scene scene = leafcast_scene_default();
    scene.volumes = shown;
    scene.volume_count = 1;
    scene.light_count = 2;
    scene.lights[0] = (leafcast_light){.vector = {1, 2, 3}, .rgb = {1, 1, 1}};
    scene.lights[1] = (leafcast_light){.point = true, .rgb = {1, 1, 1}};
    scene.clip_plane_count = 1;
    scene.clip_planes[0][0] = 1;
    scene.clip_planes[0][3] = 1e6;
    scene.experiments = &experiments;
    scene.media = media;
    scene.media_count = 1;
    scene.cap_colours = &colours;
    grouped[0] = (leafcast_shown){.volume = volume, .surfaces = surfaces, .count = CALLS_SOME};
    assert_int_equal(leafcast_make_places(volume, place, NULL, 1, &places), LEAFCAST_OK);
    groups[0] = (leafcast_group){.places = places, .volumes = grouped, .volume_count = 1};
    scene.groups = groups;
    scene.group_count = 1;
    return scene;
}

static void set_up_prep(calls_lab *l) {
    static leafcast_convert_options options;
    static leafcast_grid grid;
    static leafcast_tets tets;
    static leafcast_triangles triangles;
    static const uint32_t rows[2][3] = {{0, 1, 2}, {1, 2, 3}}, colours[4] = {1, 2, 3, 4};
    static double to_world[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
    static const float samples[8] = {1, 2, 3, 4, 5, 6, 7, 8};
    static const float vertices[4][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    static const uint32_t ids[1][4] = {{0, 1, 2, 3}};
    static const char *const fields[] = {"of meshes alone"};
    options = (leafcast_convert_options){
        .size = sizeof options, .replace = true, .threads = 1, .fields = fields, .field_count = 1};
    grid = (leafcast_grid){
        .size = sizeof grid, .dims = {2, 2, 2}, .type = LEAFCAST_F32, .to_world = to_world};
    tets = (leafcast_tets){.size = sizeof tets,
                           .vertex_count = 4,
                           .tet_count = 1,
                           .vertices = vertices,
                           .values = samples,
                           .tets = ids};
    triangles = (leafcast_triangles){.size = sizeof triangles,
                                     .vertex_count = 4,
                                     .triangle_count = 2,
                                     .vertices = vertices,
                                     .triangles = rows,
                                     .values = samples,
                                     .colours = colours};
    l->p[CALLS_TRIANGLES] = &triangles;
    l->p[CALLS_POSITIONS] = (void *)vertices;
    l->p[CALLS_CONVERT_OPTIONS] = &options;
    l->p[CALLS_GRID] = &grid;
    l->p[CALLS_TETS] = &tets;
    l->p[CALLS_SAMPLES] = (void *)samples;
    l->p[CALLS_SLICES] = l;
    l->p[CALLS_OUTPUT] = (void *)scratch_path("converted.leaf");
}

static void set_up_pictures(calls_lab *l) {
    static leafcast_scene scene;
    static leafcast_camera camera;
    static leafcast_image image;
    static leafcast_stats stats;
    static leafcast_info info;
    static leafcast_cell cell;
    static double z[CALLS_SIDE * CALLS_SIDE];
    leafcast *volume = l->p[CALLS_VOLUME];
    scene = scene_of(volume);
    camera = leafcast_standard_view(volume, 2.2, CALLS_SIDE, CALLS_SIDE);
    image = (leafcast_image){.size = sizeof image, .z = z};
    stats = (leafcast_stats){.size = sizeof stats};
    info = (leafcast_info){.size = sizeof info};
    cell = (leafcast_cell){.size = sizeof cell};
    l->p[CALLS_SCENE] = &scene;
    l->p[CALLS_CAMERA] = &camera;
    l->p[CALLS_IMAGE] = &image;
    l->p[CALLS_STATS] = &stats;
    l->p[CALLS_INFO] = &info;
    l->p[CALLS_CELL] = &cell;
}

static void set_up_places(calls_lab *l) {
    static leafcast_surface surfaces[CALLS_SOME];
    static leafcast_ray rays[CALLS_SOME];
    static leafcast_slice_pixels slice;
    static double line[3][3], vector[4], direction[3] = {0.5, 0.25, 1}, numbers[64];
    const leafcast_info info = leafcast_describe(l->p[CALLS_VOLUME]);
    for (int i = 0; i < CALLS_SOME; i++) {
        surfaces[i] = leafcast_surface_default(sphere.iso * (1.0 + 0.1 * i));
        rays[i] = (leafcast_ray){.direction = {1, 0.5, i}, .t1 = (double)INFINITY};
    }
    for (int a = 0; a < 3; a++) {
        vector[a] = 0.5 * (info.bounds[0][a] + info.bounds[1][a]);
        for (int i = 0; i < 3; i++)
            line[i][a] = info.bounds[0][a] + (a < 2 ? i : 0) * 0.4 * info.cell_size;
    }
    vector[3] = -(vector[0] * vector[0] + vector[1] * vector[1] + vector[2] * vector[2]);
    numbers[0] = numbers[1] = sphere.iso;
    slice = (leafcast_slice_pixels){.size = sizeof slice,
                                    .line = (const double(*)[3])line,
                                    .line_count = 3,
                                    .v = {0, 0, 1},
                                    .width = 4,
                                    .height = 4};
    l->p[CALLS_SURFACES] = surfaces;
    l->p[CALLS_RAYS] = rays;
    l->p[CALLS_SLICE] = &slice;
    l->p[CALLS_VECTOR] = vector;
    l->p[CALLS_VECTOR2] = direction;
    l->p[CALLS_NUMBERS] = numbers;
}

void public_calls_set_up(calls_lab *l) {
    static leafcast_options options;
    static leafcast_experiments experiments;
    static union {
        leafcast_histogram histogram;
        leafcast_hit hits[CALLS_SOME];
        leafcast_segment segments[CALLS_SOME];
        leafcast_sample samples[CALLS_SOME];
        leafcast_block map[8];
    } found;
    static int count;
    static bool done;
    static uint32_t blocks[3] = {2, 2, 2};
    static void *out;
    *l = (calls_lab){.max = CALLS_SOME,
                     .count = CALLS_SOME,
                     .node = 1,
                     .width = 4,
                     .height = 4,
                     .steps = 1,
                     .seconds = INFINITY,
                     .distance = 2.2,
                     .x = 1.0};
    assert_true(field_make(&sphere, "sphere", 9, FIELD_SEED));
    experiments = (leafcast_experiments){.size = sizeof experiments};
    options = (leafcast_options){.size = sizeof options, .threads = 1, .experiments = &experiments};
    l->p[CALLS_PATH] = (void *)fixture_leaf(&sphere, 4, 1, false);
    l->p[CALLS_VOLUME] = fixture_open(l->p[CALLS_PATH], &options);
    const leafcast_surface surface = leafcast_surface_default(sphere.iso);
    assert_int_equal(leafcast_select(l->p[CALLS_VOLUME], &surface, 1), LEAFCAST_OK);
    l->p[CALLS_BYTES] = scratch_read(l->p[CALLS_PATH], &l->many);
    l->p[CALLS_OPTIONS] = &options;
    l->p[CALLS_FOUND] = &found;
    l->p[CALLS_COUNT] = &count;
    l->p[CALLS_DONE] = &done;
    l->p[CALLS_BLOCKS] = blocks;
    l->p[CALLS_OUT] = &out;
    l->p[CALLS_PLACES] = place;
    l->p[CALLS_TEXT] = (void *)scratch_path("sphere.nrrd");
    assert_true(field_write_nrrd(&sphere, l->p[CALLS_TEXT]));
    set_up_prep(l);
    assert_int_equal(leafcast_open_live(P(GRID), &options, (leafcast **)&l->p[CALLS_LIVE]),
                     LEAFCAST_OK);
    assert_int_equal(
        leafcast_open_triangles(P(TRIANGLES), &options, (leafcast **)&l->p[CALLS_MOVING]),
        LEAFCAST_OK);
    set_up_pictures(l);
    set_up_places(l);
    assert_int_equal(leafcast_frame_begin(P(VOLUME), P(SCENE), P(CAMERA), P(IMAGE),
                                          (leafcast_frame **)&l->p[CALLS_FRAME]),
                     LEAFCAST_OK);
}

void public_calls_tear_down(calls_lab *l) {
    leafcast_frame_end(P(FRAME));
    leafcast_free_places(places);
    leafcast_close(P(LIVE));
    leafcast_close(P(MOVING));
    leafcast_close(P(VOLUME));
    free(P(BYTES));
    field_release(&sphere);
}

void public_calls_draw(const calls_lab *l, double z[CALLS_SIDE * CALLS_SIDE]) {
    const leafcast_scene scene = leafcast_scene_default();
    const leafcast_camera camera = leafcast_standard_view(P(VOLUME), 2.2, CALLS_SIDE, CALLS_SIDE);
    const leafcast_image image = {.size = sizeof image, .z = z};
    const leafcast_surface surface = leafcast_surface_default(sphere.iso);
    assert_int_equal(leafcast_select(P(VOLUME), &surface, 1), LEAFCAST_OK);
    assert_int_equal(leafcast_trace(P(VOLUME), &scene, &camera, &image, NULL, NULL, NULL),
                     LEAFCAST_OK);
}
