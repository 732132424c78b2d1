/* test_api_fuzz.c - the public calls, at random and in any order, on small volumes: grids, meshes,
 * time steps, coarse grids, several on a device, budgets, frames between other calls. Whatever they
 * are given, they end, with a status that is one, and sanitizers have nothing to say.
 *
 *   test_api_fuzz           LEAFCAST_STRESS calls, or CALLS; in episodes, of which each begins
 * anew; LEAFCAST_SEED: the first episode, 1
 *
 * Whatever goes wrong is told with the call and the line that begins with the episode it was in. A
 * call of more than a minute is a fault, too.
 */
/* marks: long */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "tests/support/api_draw.h"
#include "tests/support/fixture.h"
#include "tests/support/leaf_steps.h"
#include "tests/support/mesh_leaves.h"
#include "tests/support/scratch.h"

#ifdef __SANITIZE_ADDRESS__
#include <sanitizer/common_interface_defs.h>

/* What they find ends in a signal, so that it can be told where it was. */
__attribute__((visibility("default"))) const char *__ubsan_default_options(void);
const char *__ubsan_default_options(void) {
    return "abort_on_error=1:print_stacktrace=1";
}
#endif

enum { CALLS = 150000, EPISODE = 400, FRAMES = 2, FOUND = 8, HANG_S = 60 };

typedef struct begun {
    leafcast_frame *frame;
    leafcast_image image;
} begun;

typedef struct world {
    field_random r;
    leafcast_device *device;
    leafcast *volumes[API_VOLUMES];
    int count;
    begun frames[FRAMES];
} world;

/* ---- What happens is told ---- */

static struct {
    uint64_t episode, calls, refused;
    const char *volatile call;
} now;

static void tell_where(void) {
    char line[200];
    const int length =
        snprintf(line, sizeof line,
                 "in %s(); again: LEAFCAST_SEED=%llu LEAFCAST_STRESS=%d "
                 "build/*/tests/test_api_fuzz\n",
                 now.call ? now.call : "none", (unsigned long long)now.episode, EPISODE);
    (void)!write(STDERR_FILENO, line, (size_t)length);
}

static void on_signal(int number) {
    static const char hang[] = "a call takes too long, ";
    if (number == SIGALRM)
        (void)!write(STDERR_FILENO, hang, sizeof hang - 1);
    tell_where();
    _exit(99);
}

static void watch_over(void) {
    signal(SIGALRM, on_signal);
#ifdef __SANITIZE_ADDRESS__
    __sanitizer_set_death_callback(tell_where);
    signal(SIGABRT, on_signal);
#else
    for (int i = 0; i < 4; i++)
        signal((const int[]){SIGSEGV, SIGBUS, SIGFPE, SIGABRT}[i], on_signal);
#endif
}

static void begin(const char *call) {
    now.call = call;
    if (now.calls++ % 64 == 0)
        alarm(HANG_S);
}

/* What a call says must be one of the statuses, with a text. */
static bool ended(leafcast_status st) {
    if ((int)st < 0 || (int)st == 1 || (int)st > LEAFCAST_FAILED ||
        (st != LEAFCAST_OK && leafcast_error_text()[0] == '\0')) {
        tell_where();
        fail_msg("status %d, \"%s\"", (int)st, leafcast_error_text());
    }
    now.refused += st != LEAFCAST_OK;
    return st == LEAFCAST_OK;
}

static void must(bool true_of, const char *what) {
    if (true_of)
        return;
    tell_where();
    fail_msg("%s", what);
}

/* ---- Volumes ---- */

enum { FILES = 7 };
static const char *files[FILES];

/* Paths of the fixture stay valid, files of one field have different names. */
static const char *grid_file(const char *name, long n, bool compressed) {
    field f;
    assert_true(field_make(&f, name, n, FIELD_SEED));
    const char *path = fixture_leaf(&f, 4, compressed, compressed);
    field_release(&f);
    return path;
}

static const char *mesh_file(const char *name, int non_finite) {
    mesh_case c = mesh_leaves_cube(2, 2, 3, 7, non_finite);
    if (!non_finite)
        mesh_leaves_extend(&c, 8);
    const char *path = mesh_leaves_make(&c, name);
    mesh_leaves_release(&c);
    return path;
}

/* With a coarse grid and gradients. */
static const char *coarse_file(const char *name) {
    mesh_case c = mesh_leaves_cube(3, 1, 1, 9, 0);
    const leafcast_tets tets = {.size = sizeof tets,
                                .vertex_count = c.points,
                                .tet_count = c.tets,
                                .vertices = (const float(*)[3])c.xyz,
                                .values = c.values,
                                .tets = (const uint32_t(*)[4])c.ids};
    const leafcast_convert_options o = {.size = sizeof o,
                                        .threads = 1,
                                        .gradients = true,
                                        .coarse = true,
                                        .coarse_dims = 6,
                                        .treelet_tets = 40};
    assert_int_equal(leafcast_convert_tets(&tets, scratch_path(name), &o), LEAFCAST_OK);
    mesh_leaves_release(&c);
    return scratch_path(name);
}

/* A grid of many steps. */
static const char *steps_file(const char *name) {
    leaf_steps s;
    leaf_steps_make(&s, 19, 18, 17, SAMPLE_F32);
    leaf_steps_use(&s, LEAF_CODEC_ZSTD);
    const char *path = leaf_files_series(&s.of, &s.c.options, name);
    leaf_steps_release(&s);
    return path;
}

static void make_files(void) {
    files[0] = grid_file("sphere", 9, false);
    files[1] = grid_file("noise-u8", 19, true);
    files[2] = grid_file("missing", 18, false);
    files[3] = mesh_file("moving.leaf", 0);
    files[4] = mesh_file("broken.leaf", 9);
    files[5] = coarse_file("coarse.leaf");
    files[6] = steps_file("steps.leaf");
}

static int below(world *w, long n) {
    return (int)field_random_below(&w->r, n);
}

static void open_volume(world *w) {
    leafcast_options o;
    leafcast_experiments e;
    leafcast *opened = NULL;
    if (w->count == API_VOLUMES)
        return;
    api_draw_options(&w->r, w->device && !api_chance(&w->r, 4) ? w->device : NULL, &e, &o);
    begin("leafcast_open");
    if (!ended(leafcast_open(files[below(w, FILES)], &o, &opened)))
        return;
    must(opened != NULL, "a volume is opened, and NULL");
    w->volumes[w->count++] = opened;
}

/* Frames show volumes, so they end first. */
static void end_frames(world *w) {
    for (int i = 0; i < FRAMES; i++) {
        begin("leafcast_frame_end");
        leafcast_frame_end(w->frames[i].frame);
        api_free_image(&w->frames[i].image);
        w->frames[i] = (begun){0};
    }
}

static void close_volume(world *w) {
    const int i = below(w, w->count);
    end_frames(w);
    begin("leafcast_close");
    leafcast_close(w->volumes[i]);
    w->volumes[i] = w->volumes[--w->count];
}

static leafcast *any(world *w) {
    leafcast **const v = &w->volumes[below(w, w->count)], *const first = w->volumes[0];
    w->volumes[0] = *v; /* scenes show the first ones */
    *v = first;
    return w->volumes[0];
}

/* ---- Calls ---- */

typedef struct watched {
    field_random *r;
    long n;
} watched;

static bool watch(void *ctx, double done) {
    const watched *w = ctx;
    (void)done;
    static int asked;
    return w->n == 0 || ++asked % w->n != 0;
}

static void call_select(world *w) {
    leafcast_surface surfaces[LEAFCAST_SURFACES_MAX];
    int count;
    leafcast *v = any(w);
    api_draw_surfaces(&w->r, v, surfaces, &count);
    begin("leafcast_select");
    (void)ended(leafcast_select(v, surfaces, count));
    begin("leafcast_select_set");
    (void)ended(leafcast_select_set(v, (uint32_t)below(w, 3), (uint32_t)below(w, 4)));
    begin("leafcast_select_between");
    (void)ended(leafcast_select_between(v, (uint32_t)below(w, 3), (uint32_t)below(w, 4),
                                        api_number(&w->r, field_random_unit(&w->r))));
    begin("leafcast_refresh");
    uint32_t steps;
    (void)ended(leafcast_refresh(v, &steps));
    begin("leafcast_expect_between");
    (void)ended(leafcast_expect_between(v, (uint32_t)below(w, 3), (uint32_t)below(w, 4),
                                        api_number(&w->r, 0.5)));
    begin("leafcast_expect_set");
    (void)ended(leafcast_expect_set(v, (uint32_t)below(w, 3), (uint32_t)below(w, 4)));
}

static void call_trace(world *w) {
    static api_scene s;
    leafcast_camera c;
    leafcast_image image;
    leafcast_stats stats = {.size = sizeof stats};
    watched told = {&w->r, api_chance(&w->r, 10) ? 1 + below(w, 5) : 0};
    leafcast *v = any(w);
    api_draw_scene(&w->r, w->volumes, w->count, &s);
    api_draw_camera(&w->r, v, &c);
    api_draw_image(&w->r, &c, &image);
    begin("leafcast_trace");
    (void)ended(leafcast_trace(v, &s.scene, &c, &image, api_chance(&w->r, 2) ? &stats : NULL,
                               api_chance(&w->r, 2) ? watch : NULL, &told));
    begin("leafcast_check_room");
    (void)ended(leafcast_check_room(v, &s.scene, &c, &image,
                                    api_chance(&w->r, 20) ? field_random_bits(&w->r) : 0));
    api_free_image(&image);
}

static void call_frame_begin(world *w) {
    static api_scene s;
    begun *b = &w->frames[below(w, FRAMES)];
    leafcast_camera c;
    leafcast *v = any(w);
    if (b->frame)
        return;
    api_draw_scene(&w->r, w->volumes, w->count, &s);
    api_draw_camera(&w->r, v, &c);
    api_draw_image(&w->r, &c, &b->image);
    begin("leafcast_frame_begin");
    if (ended(leafcast_frame_begin(v, &s.scene, &c, &b->image, &b->frame)))
        return;
    api_free_image(&b->image);
    b->frame = NULL;
}

static void call_frame(world *w) {
    begun *b = &w->frames[below(w, FRAMES)];
    leafcast_stats stats = {.size = sizeof stats};
    bool done;
    if (!b->frame)
        return;
    if (api_chance(&w->r, 8)) {
        begin("leafcast_frame_cancel");
        leafcast_frame_cancel(b->frame);
    }
    begin("leafcast_frame_advance");
    const bool fine = ended(
        leafcast_frame_advance(b->frame, api_number(&w->r, api_chance(&w->r, 2) ? 0.0 : INFINITY),
                               &done, api_chance(&w->r, 2) ? &stats : NULL));
    if (fine && !done && !api_chance(&w->r, 4))
        return;
    begin("leafcast_frame_end");
    leafcast_frame_end(b->frame);
    api_free_image(&b->image);
    *b = (begun){0};
}

static void call_probe(world *w) {
    static api_scene s;
    leafcast_ray ray;
    const int room = below(w, FOUND), max = api_chance(&w->r, 30) ? -below(w, 1000) : room;
    int count = -1;
    leafcast *v = any(w);
    api_draw_scene(&w->r, w->volumes, w->count, &s);
    api_draw_ray(&w->r, v, &ray);
    leafcast_hit *hits = malloc((size_t)(room + 1) * sizeof *hits);
    begin("leafcast_probe_ray");
    if (ended(leafcast_probe_ray(v, &s.scene, ray.origin, ray.direction, hits, max, &count)))
        must(count >= 0 && count <= max, "more hits than there is room for");
    free(hits);
    leafcast_segment *segments = malloc((size_t)(room + 1) * sizeof *segments);
    begin("leafcast_probe_segments");
    if (ended(
            leafcast_probe_segments(v, &s.scene, ray.origin, ray.direction, segments, max, &count)))
        must(count >= 0 && count <= max, "more segments than there is room for");
    free(segments);
}

static void call_cell(world *w) {
    leafcast *v = any(w);
    const leafcast_info info = leafcast_describe(v);
    const uint32_t level = (uint32_t)below(w, (int)info.levels + 1);
    const uint64_t number = (uint64_t)below(w, (int)(info.cells < 1000 ? info.cells + 1 : 1000));
    leafcast_cell cell = {.size = sizeof cell};
    uint32_t index[3];
    begin("leafcast_get_cell");
    if (ended(leafcast_get_cell(v, level, number, &cell)))
        must(leafcast_cell_indices(v, level, number, index) == cell.indices, "other indices");
}

static void call_rays(world *w) {
    static api_scene s;
    const size_t count = (size_t)below(w, FOUND);
    leafcast *v = any(w);
    leafcast_ray *rays = malloc((count + 1) * sizeof *rays);
    leafcast_ray_hit *hits = malloc((count + 1) * sizeof *hits);
    uint8_t *occluded = malloc(count + 1);
    api_draw_scene(&w->r, w->volumes, w->count, &s);
    for (size_t i = 0; i < count; i++)
        api_draw_ray(&w->r, v, &rays[i]);
    begin("leafcast_trace_rays");
    const bool fine = ended(leafcast_trace_rays(v, &s.scene, rays, count, hits));
    begin("leafcast_occluded_rays");
    if (ended(leafcast_occluded_rays(v, &s.scene, rays, count, occluded)) && fine)
        for (size_t i = 0; i < count; i++)
            must((hits[i].surface >= 0) == (occluded[i] != 0), "occluded, but not hit");
    free(rays);
    free(hits);
    free(occluded);
}

static void call_points(world *w) {
    const size_t count = (size_t)below(w, FOUND);
    leafcast *v = any(w);
    double(*points)[3] = malloc((count + 1) * sizeof *points);
    leafcast_sample *samples = malloc((count + 1) * sizeof *samples), one;
    for (size_t i = 0; i <= count; i++)
        api_draw_place(&w->r, v, points[i]);
    begin("leafcast_sample_points");
    const bool fine = ended(leafcast_sample_points(v, (const double(*)[3])points, count, samples));
    begin("leafcast_probe_point");
    if (ended(leafcast_probe_point(v, points[0], &one)) && fine && count > 0)
        must(memcmp(&one.value, &samples[0].value, sizeof one.value) == 0,
             "a point has another value by itself");
    free(points);
    free(samples);
}

static void call_slice(world *w) {
    leafcast_slice_pixels s;
    double line[API_LINE][3], plane[4];
    leafcast_stats stats = {.size = sizeof stats};
    watched told = {&w->r, api_chance(&w->r, 10) ? 1 + below(w, 5) : 0};
    leafcast *v = any(w);
    api_draw_slice(&w->r, v, line, &s);
    const size_t rows = s.rows ? s.rows : s.height;
    double *values = malloc((s.width * rows + 1) * sizeof *values);
    begin("leafcast_sample_slice");
    (void)ended(leafcast_sample_slice(v, &s, values, api_chance(&w->r, 2) ? &stats : NULL,
                                      api_chance(&w->r, 2) ? watch : NULL, &told));
    free(values);
    begin("leafcast_fit_slice");
    (void)ended(leafcast_fit_slice(v, &s));
    api_draw_direction(&w->r, plane);
    plane[3] = api_number(&w->r, field_random_in(&w->r, -5.0, 5.0));
    begin("leafcast_plane_slice");
    (void)ended(leafcast_plane_slice(v, plane, &s));
    begin("leafcast_layer_slice");
    (void)ended(leafcast_layer_slice(v, below(w, 5) - 1, (uint32_t)below(w, 20), &s));
}

static void call_facts(world *w) {
    static leafcast_histogram spread;
    leafcast_camera c = {.size = sizeof c};
    leafcast_block map[4 * 4 * 4];
    double range[2], isovalues[LEAFCAST_SURFACES_MAX] = {0}, origin[3], direction[3];
    int count = -1;
    uint32_t number = (uint32_t)below(w, 3), step = (uint32_t)below(w, 4);
    uint32_t blocks[3];
    leafcast *v = any(w);
    for (int a = 0; a < 3; a++)
        blocks[a] = api_chance(&w->r, 20) ? (uint32_t)field_random_bits(&w->r) | 65
                                          : 1 + (uint32_t)below(w, 4);
    leafcast_holding holdings[8];
    begin("leafcast_map_steps");
    (void)ended(leafcast_map_steps(v, (uint32_t)below(w, 3), (uint32_t)below(w, 8), holdings));
    uint8_t has[8];
    const double lo = api_number(&w->r, 0);
    begin("leafcast_find_steps");
    (void)ended(leafcast_find_steps(v, (uint32_t)below(w, 3), lo, api_number(&w->r, lo),
                                    (uint32_t)below(w, 8), api_chance(&w->r, 2) ? has : NULL,
                                    &number));
    begin("leafcast_map_treelets");
    (void)ended(leafcast_map_treelets(v, (uint32_t)below(w, 4), blocks, map));
    begin("leafcast_range");
    (void)ended(leafcast_range(v, number, step, range));
    begin("leafcast_data_range");
    (void)ended(leafcast_data_range(v, number, step, range));
    begin("leafcast_get_histogram");
    (void)ended(leafcast_get_histogram(v, number, step, &spread));
    begin("leafcast_suggested_isovalues");
    if (ended(leafcast_suggested_isovalues(v, number, step, isovalues, below(w, 12) - 4, &count)))
        must(count >= 0 && count <= LEAFCAST_SUGGESTIONS_MAX, "too many suggestions");
    isovalues[0] = api_number(&w->r, isovalues[0]);
    begin("leafcast_fit_view");
    (void)ended(leafcast_fit_view(v, number, step, isovalues,
                                  api_chance(&w->r, 10) ? below(w, 4000) - 2000 : below(w, 33),
                                  api_number(&w->r, 40.0), 1 + (uint32_t)below(w, 9), 4, &c));
    begin("leafcast_pixel_ray");
    leafcast_pixel_ray(&c, api_number(&w->r, 1.0), api_number(&w->r, 2.0), origin, direction);
    begin("leafcast_stop_reading");
    leafcast_stop_reading(v);
    begin("leafcast_find_field");
    (void)ended(leafcast_find_field(v, api_chance(&w->r, 2) ? "0" : "nobody", &number));
    begin("leafcast_field_name");
    must(leafcast_field_name(v, (uint32_t)field_random_bits(&w->r)) != NULL, "no name");
    must(!isnan(leafcast_step_time(v, step)), "no time");
}

static leafcast_status deliver(void *ctx, uint32_t z, void *samples) {
    world *w = ctx;
    (void)z;
    *(uint8_t *)samples = (uint8_t)below(w, 256);
    return api_chance(&w->r, 10) ? (leafcast_status)(below(w, 30) - 10) : LEAFCAST_OK;
}

static void call_convert(world *w) {
    double samples[6 * 6 * 6], axis[6] = {0, 1, 3, 4, 5, 8};
    leafcast_convert_options o;
    leafcast_grid g;
    leafcast *v = NULL;
    const char *out = scratch_path("made.leaf");
    if (!api_chance(&w->r, 12))
        return;
    for (int i = 0; i < 6 * 6 * 6; i++)
        samples[i] = api_number(&w->r, i);
    api_draw_convert_options(&w->r, &o);
    api_draw_grid(&w->r, &g);
    g.axis[below(w, 3)] = api_chance(&w->r, 3) ? axis : NULL;
    axis[below(w, 6)] = api_number(&w->r, 2.0);
    begin("leafcast_convert_array");
    const bool array = api_chance(&w->r, 2);
    leafcast_status st = array ? leafcast_convert_array(&g, samples, NULL, out, &o)
                               : leafcast_convert_slices(&g, deliver, w, out, &o);
    if (!ended(st))
        return;
    begin("leafcast_open");
    if (!ended(leafcast_open(out, NULL, &v)))
        return;
    if (w->count < API_VOLUMES)
        w->volumes[w->count++] = v; /* until another one is made in its place */
    else
        leafcast_close(v);
}

enum { LIVE_SIDE = 6 }; /* api_draw_grid() makes no larger ones that are sound */

static void call_open_live(world *w) {
    leafcast_options o;
    leafcast_experiments e;
    leafcast_grid g;
    leafcast *v = NULL;
    if (w->count == API_VOLUMES || !api_chance(&w->r, 4))
        return;
    api_draw_options(&w->r, w->device && !api_chance(&w->r, 4) ? w->device : NULL, &e, &o);
    api_draw_grid(&w->r, &g);
    for (int a = 0; a < 3; a++)
        if (g.dims[a] > LIVE_SIDE && g.dims[a] <= 1 << 20)
            return;
    begin("leafcast_open_live");
    if (ended(leafcast_open_live(&g, &o, &v)))
        w->volumes[w->count++] = v;
}

/* Of any volume: most are not live. */
static void call_live(world *w) {
    double samples[LIVE_SIDE * LIVE_SIDE * LIVE_SIDE];
    uint32_t first[3], size[3];
    leafcast *v = w->volumes[below(w, w->count)];
    for (int i = 0; i < LIVE_SIDE * LIVE_SIDE * LIVE_SIDE; i++)
        samples[i] = api_number(&w->r, i);
    for (int a = 0; a < 3; a++) {
        first[a] = (uint32_t)(api_chance(&w->r, 30) ? -1 : below(w, 4));
        size[a] = (uint32_t)(api_chance(&w->r, 30) ? -1 : below(w, LIVE_SIDE));
    }
    const bool all = api_chance(&w->r, 3), half_given = api_chance(&w->r, 30);
    begin("leafcast_update");
    (void)ended(
        leafcast_update(v, all ? NULL : first, all && !half_given ? NULL : size, samples, NULL));
    begin("leafcast_commit");
    (void)ended(leafcast_commit(v, api_number(&w->r, 1.0)));
}

/* ---- Episodes ---- */

static void any_call(world *w) {
    static void (*const calls[])(world *) = {
        call_select, call_select, call_trace,    call_trace, call_frame_begin, call_frame,
        call_frame,  call_probe,  call_probe,    call_cell,  call_rays,        call_points,
        call_points, call_slice,  call_slice,    call_facts, call_facts,       call_convert,
        call_live,   call_live,   call_open_live};
    if (w->count == 0 || api_chance(&w->r, 30))
        open_volume(w);
    else if (w->count > 1 && api_chance(&w->r, 60))
        close_volume(w);
    if (w->count > 0)
        calls[below(w, sizeof calls / sizeof *calls)](w);
}

static void end_world(world *w) {
    end_frames(w);
    while (w->count > 0)
        close_volume(w);
    begin("leafcast_device_destroy");
    leafcast_device_destroy(w->device);
}

/* All that an episode does follows from its number. */
static void run_episode(uint64_t number) {
    world w = {.r = {number * 1000003}};
    leafcast_options o;
    leafcast_experiments e;
    const uint64_t until = now.calls + EPISODE;
    now.episode = number;
    api_draw_options(&w.r, NULL, &e, &o);
    begin("leafcast_device_create");
    if (!ended(leafcast_device_create(&o, &w.device)))
        w.device = NULL;
    while (now.calls < until)
        any_call(&w);
    end_world(&w);
}

/* What was there before all this, and is after it. */
static void draw(const char *path, double z[API_SIDE * API_SIDE]) {
    leafcast *v = fixture_open(path, NULL);
    const leafcast_info info = leafcast_describe(v);
    const leafcast_surface s = leafcast_surface_default(0.5 * (info.value_min + info.value_max));
    const leafcast_scene scene = leafcast_scene_default();
    const leafcast_camera c = leafcast_standard_view(v, 2.2, API_SIDE, API_SIDE);
    const leafcast_image image = {.size = sizeof image, .z = z};
    assert_int_equal(leafcast_select(v, &s, 1), LEAFCAST_OK);
    assert_int_equal(leafcast_trace(v, &scene, &c, &image, NULL, NULL, NULL), LEAFCAST_OK);
    leafcast_close(v);
}

static uint64_t number_of(const char *name, uint64_t otherwise) {
    const char *text = getenv(name);
    return text ? strtoull(text, NULL, 10) : otherwise;
}

static void test_any_calls(void **state) {
    (void)state;
    double before[API_SIDE * API_SIDE], after[API_SIDE * API_SIDE];
    const uint64_t calls = number_of("LEAFCAST_STRESS", CALLS);
    make_files();
    draw(files[1], before);
    watch_over();
    for (uint64_t episode = number_of("LEAFCAST_SEED", 1); now.calls < calls; episode++)
        run_episode(episode);
    alarm(0);
    draw(files[1], after);
    assert_memory_equal(before, after, sizeof before);
    print_message("%llu calls, %llu of them refused, up to episode %llu\n",
                  (unsigned long long)now.calls, (unsigned long long)now.refused,
                  (unsigned long long)now.episode);
    assert_true(now.refused > now.calls / 50 && now.refused < now.calls * 9 / 10);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_any_calls)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
