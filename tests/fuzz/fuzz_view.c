/* fuzz_view.c - states as a hostile page may send them: taken or refused as the viewer does it, and
 * drawn, a moment long, as a few pixels of a small grid. None may get a file named. Seeds: states
 * that pages have sent.
 */
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "prep/leafcast_prep.h"
#include "render/app/colour_map.h"
#include "render/app/picture_scene.h"
#include "render/app/transfer_preset.h"
#include "render/app/view_camera.h"
#include "render/view/view_state.h"
#include "tests/support/scratch.h"

enum { SIDE = 20, WIDTH = 8, HEIGHT = 6, PIXELS = WIDTH * HEIGHT };
enum { STEP_MAX = 4 }; /* cells */
#define MOMENT_S 0.02

static mem budget;
static leafcast *volume;

int LLVMFuzzerInitialize(int *argc, char ***argv);
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void fail(const char *what) {
    fprintf(stderr, "fuzz_view: %s: %s\n", what, status_text());
    abort();
}

int LLVMFuzzerInitialize(int *argc, char ***argv) {
    static float samples[SIDE * SIDE * SIDE];
    const leafcast_grid grid = {
        .size = sizeof grid, .dims = {SIDE, SIDE, SIDE}, .type = LEAFCAST_F32};
    const leafcast_options options = {.size = sizeof options, .threads = 1};
    const char *path = scratch_path("view.leaf");
    (void)argc;
    (void)argv;
    mem_init(&budget, 0);
    for (int i = 0; i < SIDE * SIDE * SIDE; i++)
        samples[i] =
            (float)(sin(0.5 * (i % SIDE)) + cos(0.4 * (i / SIDE % SIDE)) + i / (SIDE * SIDE));
    if (leafcast_convert_array(&grid, samples, NULL, path, NULL) != LEAFCAST_OK ||
        leafcast_open(path, &options, &volume) != LEAFCAST_OK)
        fail("no volume");
    return 0;
}

static void draw(const view_options *v, const leafcast_scene *scene) {
    static float plane[4][PIXELS];
    static double error[PIXELS];
    static uint8_t provisional[PIXELS];
    const bool errors = view_options_any_medium(v) && scene->samples <= 1;
    const leafcast_image image = {.size = sizeof image,
                                  .r = plane[0],
                                  .g = plane[1],
                                  .b = plane[2],
                                  .a = plane[3],
                                  .error = errors ? error : NULL,
                                  .provisional = provisional};
    const leafcast_camera camera = view_camera_of(v, volume);
    leafcast_frame *frame = NULL;
    bool done = false;
    leafcast_status st = leafcast_frame_begin(volume, scene, &camera, &image, &frame);
    if (st == LEAFCAST_OK)
        st = leafcast_frame_advance(frame, MOMENT_S, &done, NULL);
    leafcast_frame_end(frame);
    for (int i = 0; st == LEAFCAST_OK && done && i < PIXELS; i++)
        for (int c = 0; c < 4; c++)
            if (!isfinite(plane[c][i]))
                fail("a pixel that is no number");
}

/* What the viewer does with a state that it has taken. */
static void look(view_options *v) {
    picture_scene parts;
    leafcast_scene scene;
    double suggested[LEAFCAST_SUGGESTIONS_MAX];
    int count;
    const picture_volume shown = {volume, v, NULL, 0};
    v->camera.width = WIDTH;
    v->camera.height = HEIGHT;
    picture_scene_init(&parts, &budget);
    status st = picture_scene_choose(volume, v, suggested, &count);
    if (st == ST_OK)
        st = view_options_check(v);
    if (st == ST_OK)
        st = view_options_check_volume(v, volume);
    if (st == ST_OK)
        st = picture_scene_describe(&parts, &shown, 1, true, &scene);
    /* The table of pre-integrated steps is made before a frame looks at the clock. That of long
     * ones takes seconds, and with sanitizers half a minute. */
    const leafcast_scene_experiments *e = &v->experiments;
    if (st == ST_OK && !(e->summing == LEAFCAST_PREINTEGRATED && e->step > STEP_MAX))
        draw(v, &scene);
    picture_scene_release(&parts);
}

static bool is_map(const char *name) {
    char list[256], *next = list;
    snprintf(list, sizeof list, "%s", colour_map_names());
    for (const char *at; (at = strsep(&next, "|"));)
        if (strcmp(at, name) == 0)
            return true;
    return name[0] == 0;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    static view_options v;
    json_t *object = NULL;
    status st = view_state_parse((const char *)data, size, &object);
    if (st == ST_OK)
        st = view_state_apply(&budget, object, &v);
    json_decref(object);
    if (st != ST_OK)
        return 0;
    if ((v.medium.tf[0] && !transfer_preset_is(v.medium.tf)) || !is_map(v.medium.colour_map) ||
        !is_map(v.caps.colour_map))
        fail("a file is named");
    look(&v);
    return 0;
}
