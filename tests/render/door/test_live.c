/* test_live.c - live volumes: after any updates what is drawn, probed and cut has the bits of a
 * file of those samples; whatever has begun shows one step to its end; only what changed is read
 * again.
 */
/* marks: threads */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <math.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "prep/leafcast_prep.h"
#include "tests/support/pictures.h"
#include "tests/support/scratch.h"

enum { SIDE = WATCHED ? 24 : 40, PIXELS = SIDE * SIDE, STEPS = WATCHED ? 3 : 8 };

static void fine(leafcast_status st) {
    if (st != LEAFCAST_OK)
        fail_msg("%s", leafcast_error_text());
}

static void refused(leafcast_status st, const char *why) {
    assert_int_equal(st, LEAFCAST_USAGE);
    if (!strstr(leafcast_error_text(), why))
        fail_msg("\"%s\" is not in: %s", why, leafcast_error_text());
}

/* ---- A live volume and what it should hold ---- */

typedef struct subject {
    field_random r;
    leafcast_grid grid;
    size_t width; /* bytes of a sample */
    char *model;
    double axis[3][128];
    leafcast *live;
    double iso;
} subject;

static size_t width_of(leafcast_sample_type type) {
    static const size_t widths[] = {0, 1, 1, 2, 2, 4, 4, 4, 8};
    return widths[type];
}

static subject begin(leafcast_sample_type type, const uint32_t dims[3], bool rectilinear,
                     const leafcast_options *o, uint64_t seed) {
    subject t = {.r = {seed}, .width = width_of(type)};
    t.grid = (leafcast_grid){.size = sizeof t.grid,
                             .dims = {dims[0], dims[1], dims[2]},
                             .type = type,
                             .spacing = {0.5, -0.75, 1.25},
                             .origin = {3, -4, 5}};
    t.model = calloc((size_t)dims[0] * dims[1] * dims[2], t.width);
    for (int a = 0; a < 3 && rectilinear; a++) {
        t.grid.axis[a] = t.axis[a];
        for (uint32_t i = 0; i < dims[a]; i++)
            t.axis[a][i] = i + 0.3 * sin(i);
    }
    fine(leafcast_open_live(&t.grid, o, &t.live));
    /* What it was opened with is the caller's again. */
    memset(t.axis, 0, rectilinear ? sizeof t.axis : 0);
    t.iso = type == LEAFCAST_U8 || type == LEAFCAST_I8 ? 40 : 400;
    return t;
}

static void end(subject *t) {
    leafcast_close(t->live);
    free(t->model);
}

/* A smooth field that moves with the phase, with noise, and holes in floats. */
static double value_at(subject *t, uint32_t x, uint32_t y, uint32_t z, double phase) {
    const double wave = sin(0.21 * x + phase) + cos(0.17 * y - phase) + sin(0.13 * z);
    return t->iso * (1 + 0.5 * wave + 0.05 * field_random_unit(&t->r));
}

static void put_value(subject *t, double v, char *to) {
    const float f = field_random_below(&t->r, 3000) == 0 ? NAN : (float)v;
    const uint32_t u = (uint32_t)fmax(v, 0);
    const int32_t i = (int32_t)v;
    switch (t->grid.type) {
    case LEAFCAST_F32: memcpy(to, &f, 4); break;
    case LEAFCAST_F64: memcpy(to, &v, 8); break;
    case LEAFCAST_U8:
    case LEAFCAST_U16:
    case LEAFCAST_U32: memcpy(to, &u, t->width); break;
    default: memcpy(to, &i, t->width);
    }
}

static char *model_at(const subject *t, uint32_t x, uint32_t y, uint32_t z) {
    const uint32_t *d = t->grid.dims;
    return t->model + (((size_t)z * d[1] + y) * d[0] + x) * t->width;
}

/* Change a region of the model, and give it: where it lies in the model, or packed. */
static void update(subject *t, const uint32_t first[3], const uint32_t size[3], double phase) {
    const uint32_t *d = t->grid.dims;
    const ptrdiff_t w = (ptrdiff_t)t->width;
    const ptrdiff_t strides[3] = {w, w * d[0], w * d[0] * d[1]};
    char *packed = malloc((size_t)size[0] * size[1] * size[2] * t->width), *to = packed;
    for (uint32_t z = first[2]; z < first[2] + size[2]; z++)
        for (uint32_t y = first[1]; y < first[1] + size[1]; y++)
            for (uint32_t x = first[0]; x < first[0] + size[0]; x++, to += t->width) {
                put_value(t, value_at(t, x, y, z, phase), model_at(t, x, y, z));
                memcpy(to, model_at(t, x, y, z), t->width);
            }
    if (field_random_below(&t->r, 2))
        fine(leafcast_update(t->live, first, size, packed, NULL));
    else
        fine(leafcast_update(t->live, first, size, model_at(t, first[0], first[1], first[2]),
                             strides));
    free(packed);
}

static void update_somewhere(subject *t, double phase) {
    uint32_t first[3], size[3];
    for (int a = 0; a < 3; a++) {
        first[a] = (uint32_t)field_random_below(&t->r, (long)t->grid.dims[a]);
        size[a] = 1 + (uint32_t)field_random_below(&t->r, (long)(t->grid.dims[a] - first[a]));
    }
    update(t, first, size, phase);
}

static void update_all(subject *t, double phase) {
    const uint32_t none[3] = {0, 0, 0};
    update(t, none, t->grid.dims, phase);
}

/* The same samples as a file. */
static leafcast *file_of(subject *t, const leafcast_options *o, const char *name) {
    const leafcast_convert_options how = {.size = sizeof how,
                                          .threads = 1,
                                          .replace = true,
                                          .allow_empty = true,
                                          .without_levels = true};
    const char *path = scratch_path(name);
    double axis[3][128];
    leafcast *v = NULL;
    leafcast_grid of = t->grid;
    for (int a = 0; a < 3 && of.axis[a]; a++) {
        of.axis[a] = axis[a];
        for (uint32_t i = 0; i < of.dims[a]; i++)
            axis[a][i] = i + 0.3 * sin(i);
    }
    fine(leafcast_convert_array(&of, t->model, NULL, path, &how));
    fine(leafcast_open(path, o, &v));
    return v;
}

/* ---- The same bits ---- */

enum { PLAIN, SHADOWS, LAYERS, CAPS, MEDIUM, MAXIMUM, MEAN, LOOKS };

static leafcast_transfer_point points[3];
static const leafcast_medium medium = {points, 3};
static leafcast_surface surfaces[2];

static leafcast_scene scene_of(double iso, int look) {
    leafcast_scene scene = leafcast_scene_default();
    points[0] = (leafcast_transfer_point){0.4 * iso, {0.1, 0.4, 0.9}, 0.0};
    points[1] = (leafcast_transfer_point){iso, {0.9, 0.4, 0.1}, 0.05};
    points[2] = (leafcast_transfer_point){1.5 * iso, {0.3, 0.9, 0.1}, 0.4};
    surfaces[0] = leafcast_surface_default(iso);
    surfaces[1] = leafcast_surface_default(1.3 * iso);
    surfaces[0].opacity = look == LAYERS ? 0.5f : 1.0f;
    if (look == SHADOWS) {
        scene.shadows = true;
        scene.light_count = 1;
        scene.lights[0] = (leafcast_light){.vector = {1, 2, 3}, .rgb = {1, 1, 1}};
    }
    scene.caps = look == CAPS;
    scene.clip_plane_count = look == CAPS;
    scene.clip_planes[0][0] = -1;
    scene.clip_planes[0][3] = 10; /* x below 10 */
    scene.media = &medium;
    scene.media_count = look >= MEDIUM;
    scene.project = look == MAXIMUM ? LEAFCAST_PROJECT_MAX
                    : look == MEAN  ? LEAFCAST_PROJECT_MEAN
                                    : LEAFCAST_PROJECT_NONE;
    return scene;
}

typedef struct drawn {
    double rgba[4 * PIXELS], z[PIXELS], error[PIXELS], value[PIXELS];
    float normal[3][PIXELS];
    int32_t id[PIXELS];
    leafcast_stats stats;
} drawn;

static leafcast_image image_of(drawn *to, int look) {
    leafcast_image image = {
        .size = sizeof image, .rgba = to->rgba, .error = to->error, .value = to->value};
    if (look < MAXIMUM) {
        image.z = to->z;
        image.id = to->id;
        for (int a = 0; a < 3; a++)
            image.normal[a] = to->normal[a];
    }
    return image;
}

static void draw(leafcast *v, double iso, int look, drawn *to) {
    memset(to, 0, sizeof *to);
    const leafcast_scene scene = scene_of(iso, look);
    const leafcast_camera c = leafcast_standard_view(v, 1.4, SIDE, SIDE);
    const leafcast_image image = image_of(to, look);
    to->stats.size = sizeof to->stats;
    fine(leafcast_select(v, surfaces, 2));
    fine(leafcast_trace(v, &scene, &c, &image, &to->stats, NULL, NULL));
}

static void same_pixels(const drawn *a, const drawn *b) {
    assert_memory_equal(a->rgba, b->rgba, sizeof a->rgba);
    assert_memory_equal(a->z, b->z, sizeof a->z);
    assert_memory_equal(a->error, b->error, sizeof a->error);
    assert_memory_equal(a->value, b->value, sizeof a->value);
    assert_memory_equal(a->normal, b->normal, sizeof a->normal);
    assert_memory_equal(a->id, b->id, sizeof a->id);
}

/* How far rays go depends on the order of tiles where several threads draw. */
static void same_counts(const leafcast_stats *a, const leafcast_stats *b) {
    assert_true(a->rays == b->rays && a->roots == b->roots);
    assert_true(a->threads > 1 || (a->cells == b->cells && a->nodes == b->nodes));
    assert_true(a->covered_pixels == b->covered_pixels);
    assert_true(a->treelets_active == b->treelets_active && a->treelets_total == b->treelets_total);
    assert_true(a->ill_conditioned == b->ill_conditioned);
}

static void same_points(subject *t, leafcast *file) {
    const leafcast_info info = leafcast_describe(t->live);
    double point[64][3];
    leafcast_sample a[64], b[64];
    memset(a, 0, sizeof a);
    memset(b, 0, sizeof b);
    for (int i = 0; i < 64; i++)
        for (int k = 0; k < 3; k++)
            point[i][k] = field_random_in(&t->r, info.bounds[0][k], info.bounds[1][k]);
    fine(leafcast_sample_points(t->live, (const double(*)[3])point, 64, a));
    fine(leafcast_sample_points(file, (const double(*)[3])point, 64, b));
    for (int i = 0; i < 64; i++) {
        leafcast_sample one;
        fine(leafcast_probe_point(t->live, point[i], &one));
        assert_memory_equal(&a[i].value, &b[i].value, sizeof a[i].value);
        assert_memory_equal(&one.value, &b[i].value, sizeof one.value);
        assert_memory_equal(a[i].gradient, b[i].gradient, sizeof a[i].gradient);
        assert_true(a[i].cell == b[i].cell && a[i].inside && b[i].inside);
    }
}

static void same_slices(leafcast *live, leafcast *file) {
    double value[2][4096];
    leafcast_slice_pixels slice[2] = {{.size = sizeof slice[0]}, {.size = sizeof slice[0]}};
    fine(leafcast_layer_slice(live, 2, 1, &slice[0]));
    fine(leafcast_layer_slice(file, 2, 1, &slice[1]));
    for (int i = 0; i < 2; i++) {
        slice[i].width = slice[i].height = 48;
        fine(leafcast_sample_slice(i ? file : live, &slice[i], value[i], NULL, NULL, NULL));
    }
    assert_memory_equal(value[0], value[1], 48 * 48 * sizeof(double));
}

static void same_rays(subject *t, leafcast *file) {
    const leafcast_scene scene = scene_of(t->iso, PLAIN);
    const leafcast_info info = leafcast_describe(file);
    leafcast_hit hits[2][16];
    leafcast_segment pieces[2][256];
    leafcast_ray_hit first[2];
    int count[2];
    for (int n = 0; n < 4; n++) {
        leafcast_ray ray = {.t1 = (double)INFINITY};
        for (int a = 0; a < 3; a++) {
            ray.origin[a] = info.bounds[0][a] - 1;
            ray.direction[a] = field_random_in(&t->r, 0.2, 1);
        }
        memset(hits, 0, sizeof hits);
        memset(pieces, 0, sizeof pieces);
        memset(first, 0, sizeof first);
        for (int i = 0; i < 2; i++) {
            leafcast *v = i ? file : t->live;
            fine(leafcast_probe_ray(v, &scene, ray.origin, ray.direction, hits[i], 16, &count[i]));
            fine(leafcast_trace_rays(v, &scene, &ray, 1, &first[i]));
        }
        assert_int_equal(count[0], count[1]);
        for (int i = 0; i < count[0]; i++)
            assert_true(hits[0][i].t == hits[1][i].t && hits[0][i].cell == hits[1][i].cell &&
                        memcmp(hits[0][i].normal, hits[1][i].normal, sizeof hits[0][i].normal) ==
                            0);
        assert_memory_equal(&first[0].t, &first[1].t, sizeof first[0].t);
        for (int i = 0; i < 2; i++)
            fine(leafcast_probe_segments(i ? file : t->live, &scene, ray.origin, ray.direction,
                                         pieces[i], 256, &count[i]));
        assert_int_equal(count[0], count[1]);
        for (int i = 0; i < count[0]; i++)
            assert_memory_equal(pieces[0][i].control, pieces[1][i].control,
                                sizeof pieces[0][i].control);
    }
}

static void same_facts(leafcast *live, leafcast *file) {
    const leafcast_info a = leafcast_describe(live), b = leafcast_describe(file);
    double range[2][2];
    fine(leafcast_range(live, 0, 0, range[0]));
    fine(leafcast_range(file, 0, 0, range[1]));
    assert_memory_equal(range[0], range[1], sizeof range[0]);
    assert_true(a.value_min == b.value_min && a.value_max == b.value_max);
    assert_memory_equal(a.bounds, b.bounds, sizeof a.bounds);
    assert_memory_equal(a.dims, b.dims, sizeof a.dims);
    assert_true(a.cells == b.cells && a.cell_size == b.cell_size && a.levels == 1 &&
                b.levels == 1 && a.steps == 1 && a.fields == 1 && a.treelets == b.treelets);
    assert_string_equal(a.sample_type, b.sample_type);
}

static void same(subject *t, const leafcast_options *o) {
    static drawn is, want;
    leafcast *file = file_of(t, o, "step.leaf");
    same_facts(t->live, file);
    for (int look = 0; look < LOOKS; look++) {
        draw(t->live, t->iso, look, &is);
        draw(file, t->iso, look, &want);
        same_pixels(&is, &want);
        if (look == PLAIN) {
            draw(t->live, t->iso, look, &is); /* all is there now */
            draw(file, t->iso, look, &want);
            same_pixels(&is, &want);
            same_counts(&is.stats, &want.stats);
        }
    }
    same_points(t, file);
    same_slices(t->live, file);
    same_rays(t, file);
    leafcast_close(file);
}

static void test_same_bits(void **state) {
    static const uint32_t dims[][3] = {{67, 45, 34}, {33, 70, 65}, {9, 3, 97}, {64, 33, 32}};
    static const char *const isas[] = {"auto", "scalar"};
    (void)state;
    uint64_t seed = 1;
    for (int type = LEAFCAST_U8; type <= LEAFCAST_F64; type += WATCHED_THREADS ? 3 : 1, seed++) {
        const leafcast_options o = {.size = sizeof o,
                                    .threads = 1 + (int)(seed % 3),
                                    .isa = isas[seed / 2 % 2],
                                    .memory = seed % 4 == 3 ? 24 << 20 : 0};
        subject t = begin((leafcast_sample_type)type, dims[seed % 4], seed % 3 == 0, &o, seed);
        same(&t, &o); /* all 0 */
        for (int step = 1; step <= STEPS; step++) {
            if (step % 4 == 1)
                update_all(&t, step);
            for (long n = field_random_below(&t.r, 4); n > 0; n--)
                update_somewhere(&t, step);
            fine(leafcast_commit(t.live, 0.5 * step));
            assert_true(leafcast_step_time(t.live, 0) == 0.5 * step);
            if (step % 3 || step == STEPS)
                same(&t, &o); /* else two commits without a picture between them */
        }
        end(&t);
    }
}

/* The volumes of a scene: the surfaces of both. */
static void draw_scene(leafcast *first, leafcast *second, double iso, drawn *to) {
    leafcast_scene scene = scene_of(iso, SHADOWS);
    const leafcast_shown shown[2] = {{.volume = first, .surfaces = surfaces, .count = 2},
                                     {.volume = second, .surfaces = surfaces, .count = 1}};
    const leafcast_camera c = leafcast_standard_view(first, 1.4, SIDE, SIDE);
    const leafcast_image image = image_of(to, SHADOWS);
    memset(to, 0, sizeof *to);
    scene.volumes = shown;
    scene.volume_count = 2;
    fine(leafcast_trace(first, &scene, &c, &image, NULL, NULL, NULL));
}

/* Beside a file, and another live volume, on one device. */
static void test_scenes(void **state) {
    static drawn is, want;
    static const uint32_t dims[][3] = {{40, 50, 60}, {65, 33, 34}};
    static const char *const names[] = {"first.leaf", "second.leaf"};
    leafcast_device *device;
    (void)state;
    fine(leafcast_device_create(NULL, &device));
    const leafcast_options o = {.size = sizeof o, .device = device};
    subject t[2];
    for (int i = 0; i < 2; i++) {
        t[i] = begin(LEAFCAST_F32, dims[i], false, &o, 20 + (uint64_t)i);
        update_all(&t[i], 1);
    }
    for (int step = 1; step < 4; step++) {
        leafcast *file[2];
        for (int i = 0; i < 2; i++) {
            update_somewhere(&t[i], step);
            fine(leafcast_commit(t[i].live, step));
            file[i] = file_of(&t[i], &o, names[i]);
        }
        draw_scene(file[0], file[1], t[0].iso, &want);
        draw_scene(t[0].live, t[1].live, t[0].iso, &is);
        same_pixels(&is, &want);
        draw_scene(t[0].live, file[1], t[0].iso, &is);
        same_pixels(&is, &want);
        for (int i = 0; i < 2; i++)
            leafcast_close(file[i]);
    }
    for (int i = 0; i < 2; i++)
        end(&t[i]);
    leafcast_device_destroy(device);
}

/* ---- One step at a time ---- */

static const uint32_t cube[3] = {70, 70, 70};

typedef struct late {
    subject *t;
    atomic_bool begun, done;
} late;

static void *update_late(void *of) {
    late *l = of;
    atomic_store(&l->begun, true);
    fine(leafcast_update(l->t->live, NULL, NULL, l->t->model, NULL));
    fine(leafcast_commit(l->t->live, 9));
    atomic_store(&l->done, true);
    return NULL;
}

/* A frame that is drawn bit by bit has the step that it began with, whatever is committed; another
 * one that begins meanwhile has the next; what comes behind that waits, but not for itself. */
static void test_frames_hold(void **state) {
    static drawn is, want, next;
    (void)state;
    subject t = begin(LEAFCAST_U8, cube, false, NULL, 3);
    const leafcast_scene scene = scene_of(t.iso, SHADOWS);
    leafcast_frame *frame;
    bool done = false;
    update_all(&t, 1);
    fine(leafcast_commit(t.live, 1));
    draw(t.live, t.iso, SHADOWS, &want);
    const leafcast_camera c = leafcast_standard_view(t.live, 1.4, SIDE, SIDE);
    const leafcast_image image = image_of(&is, SHADOWS);
    fine(leafcast_frame_begin(t.live, &scene, &c, &image, &frame));
    fine(leafcast_frame_advance(frame, 0, &done, NULL));
    update_all(&t, 2);
    fine(leafcast_frame_advance(frame, 0, &done, NULL));
    fine(leafcast_commit(t.live, 2));
    draw(t.live, t.iso, SHADOWS, &next);
    assert_memory_not_equal(next.z, want.z, sizeof next.z);
    refused(leafcast_update(t.live, NULL, NULL, t.model, NULL), "end it first");
    refused(leafcast_commit(t.live, 3), "end it first");
    memset(t.model, 0, (size_t)70 * 70 * 70);
    late l = {.t = &t};
    pthread_t thread;
    assert_int_equal(pthread_create(&thread, NULL, update_late, &l), 0);
    while (!atomic_load(&l.begun))
        nanosleep(&(struct timespec){0, 1000000}, NULL);
    nanosleep(&(struct timespec){0, 20000000}, NULL);
    assert_false(atomic_load(&l.done));
    fine(leafcast_frame_advance(frame, (double)INFINITY, &done, NULL));
    assert_true(done);
    assert_memory_equal(is.z, want.z, sizeof is.z);
    assert_memory_equal(is.rgba, want.rgba, sizeof is.rgba);
    assert_memory_equal(is.id, want.id, sizeof is.id);
    assert_false(atomic_load(&l.done));
    leafcast_frame_end(frame);
    assert_int_equal(pthread_join(thread, NULL), 0);
    assert_true(leafcast_step_time(t.live, 0) == 9);
    draw(t.live, t.iso, SHADOWS, &is);
    assert_int_equal(is.stats.covered_pixels, 0);
    /* The step before is nobody's any more. */
    update_all(&t, 2);
    fine(leafcast_commit(t.live, 4));
    draw(t.live, t.iso, SHADOWS, &is);
    assert_true(is.stats.covered_pixels > 0);
    end(&t);
}

/* ---- While frames go on ---- */

enum { RUN_STEPS = WATCHED ? 12 : 60, RUN_KINDS = 4, RUN_SIDE = 66 };

typedef struct running {
    subject t;
    uint8_t *kinds[RUN_KINDS]; /* the samples of step s are kinds[s % RUN_KINDS] */
    drawn want[RUN_KINDS];
    atomic_bool ended;
    atomic_int pictures;
} running;

/* Give half of each step in slabs; the first half of the slabs is another thread's. */
typedef struct half {
    running *run;
    int step, which;
} half;

static void *give_half(void *of) {
    const half *h = of;
    const uint8_t *samples = h->run->kinds[h->step % RUN_KINDS];
    const uint32_t slab = 11;
    for (uint32_t z = h->which * RUN_SIDE / 2; z < (h->which + 1U) * RUN_SIDE / 2; z += slab) {
        const uint32_t first[3] = {0, 0, z}, size[3] = {RUN_SIDE, RUN_SIDE, slab};
        fine(leafcast_update(h->run->t.live, first, size, samples + (size_t)z * RUN_SIDE * RUN_SIDE,
                             NULL));
    }
    return NULL;
}

static void *simulate(void *of) {
    running *run = of;
    for (int step = 0; step < RUN_STEPS; step++) {
        half halves[2] = {{run, step, 0}, {run, step, 1}};
        pthread_t other;
        assert_int_equal(pthread_create(&other, NULL, give_half, &halves[0]), 0);
        give_half(&halves[1]);
        assert_int_equal(pthread_join(other, NULL), 0);
        fine(leafcast_commit(run->t.live, step));
    }
    atomic_store(&run->ended, true);
    return NULL;
}

static int kind_of_picture(const running *run, const drawn *is) {
    int kind = 0;
    while (kind < RUN_KINDS && memcmp(is->z, run->want[kind].z, sizeof is->z) != 0)
        kind++;
    return kind;
}

/* Facts, meanwhile: of some step, all of them. */
static void *ask(void *of) {
    running *run = of;
    const double point[3] = {4, -10, 20};
    while (!atomic_load(&run->ended)) {
        double range[2], values[2];
        int count = 0;
        leafcast_camera c = {.size = sizeof c};
        leafcast_sample sample;
        fine(leafcast_range(run->t.live, 0, 0, range));
        const leafcast_info info = leafcast_describe(run->t.live);
        assert_true(range[0] < range[1] && info.value_min < info.value_max);
        fine(leafcast_suggested_isovalues(run->t.live, 0, 0, values, 2, &count));
        fine(leafcast_fit_view(run->t.live, 0, 0, &run->t.iso, 1, 0, 8, 8, &c));
        fine(leafcast_probe_point(run->t.live, point, &sample));
        assert_true(leafcast_step_time(run->t.live, 0) >= 0);
    }
    return NULL;
}

static void *look_on(void *of) {
    running *run = of;
    drawn *is = malloc(sizeof *is);
    while (!atomic_load(&run->ended)) {
        const leafcast_scene scene = scene_of(run->t.iso, PLAIN);
        const leafcast_camera c = leafcast_standard_view(run->t.live, 1.4, SIDE, SIDE);
        const leafcast_image image = {.size = sizeof image, .z = is->z};
        fine(leafcast_trace(run->t.live, &scene, &c, &image, NULL, NULL, NULL));
        assert_true(kind_of_picture(run, is) < RUN_KINDS);
        atomic_fetch_add(&run->pictures, 1);
    }
    free(is);
    return NULL;
}

static void test_running(void **state) {
    static running run;
    const uint32_t dims[3] = {RUN_SIDE, RUN_SIDE, RUN_SIDE};
    const leafcast_options o = {.size = sizeof o, .threads = 2};
    pthread_t threads[3];
    (void)state;
    run.t = begin(LEAFCAST_U8, dims, false, &o, 4);
    for (int kind = RUN_KINDS; kind-- > 0;) {
        update_all(&run.t, kind);
        fine(leafcast_commit(run.t.live, 0));
        draw(run.t.live, run.t.iso, PLAIN, &run.want[kind]);
        run.kinds[kind] = malloc((size_t)RUN_SIDE * RUN_SIDE * RUN_SIDE);
        memcpy(run.kinds[kind], run.t.model, (size_t)RUN_SIDE * RUN_SIDE * RUN_SIDE);
    }
    for (int kind = 0; kind < RUN_KINDS; kind++)
        assert_int_equal(kind_of_picture(&run, &run.want[kind]), kind);
    (void)scene_of(run.t.iso, PLAIN); /* what scenes point to stays the same */
    assert_int_equal(pthread_create(&threads[0], NULL, simulate, &run), 0);
    assert_int_equal(pthread_create(&threads[1], NULL, look_on, &run), 0);
    assert_int_equal(pthread_create(&threads[2], NULL, ask, &run), 0);
    for (int i = 0; i < 3; i++)
        assert_int_equal(pthread_join(threads[i], NULL), 0);
    assert_true(atomic_load(&run.pictures) > 0);
    for (int kind = 0; kind < RUN_KINDS; kind++)
        free(run.kinds[kind]);
    end(&run.t);
}

/* ---- What stays in memory ---- */

static uint64_t loads_of(subject *t) {
    static drawn is;
    leafcast_scene scene = scene_of(t->iso, PLAIN);
    const leafcast_camera c = leafcast_standard_view(t->live, 1.4, SIDE, SIDE);
    const leafcast_image image = image_of(&is, PLAIN);
    scene.sweep = true;
    is.stats.size = sizeof is.stats;
    fine(leafcast_trace(t->live, &scene, &c, &image, &is.stats, NULL, NULL));
    return is.stats.treelets_loaded;
}

static void test_residency(void **state) {
    (void)state;
    const uint32_t dims[3] = {129, 129, 129}, first[3] = {3, 4, 5}, size[3] = {20, 9, 8};
    subject t = begin(LEAFCAST_U8, dims, false, NULL, 5);
    update_all(&t, 1);
    fine(leafcast_commit(t.live, 1));
    (void)scene_of(t.iso, PLAIN);
    fine(leafcast_select(t.live, surfaces, 2));
    assert_int_equal(loads_of(&t), 64);
    /* The same once more, and again: nothing is read. */
    for (int i = 0; i < 3; i++) {
        fine(leafcast_update(t.live, NULL, NULL, t.model, NULL));
        fine(leafcast_commit(t.live, 2));
        assert_int_equal(loads_of(&t), 0);
    }
    /* A few samples: their treelet, and those around that have their block in the halo. */
    for (int i = 0; i < 3; i++) {
        update(&t, first, size, 2 + i);
        fine(leafcast_commit(t.live, 3));
        assert_in_range(loads_of(&t), 1, 8);
    }
    /* Two steps without a picture between them, in different places. */
    for (int i = 0; i < 2; i++) {
        const uint32_t place[3] = {100, 100, (uint32_t)(i ? 100 : 10)};
        update(&t, place, size, 5);
        fine(leafcast_commit(t.live, 4));
    }
    assert_in_range(loads_of(&t), 2, 40);
    same(&t, NULL);
    end(&t);
}

/* ---- What is refused ---- */

static void test_refused(void **state) {
    (void)state;
    const uint32_t dims[3] = {40, 30, 20}, none[3] = {0, 0, 0}, far_off[3] = {0, 0, 21};
    const uint32_t wide[3] = {40, 31, 20}, nothing[3] = {0, 3, 3}, most[3] = {UINT32_MAX, 1, 1};
    const ptrdiff_t huge[3] = {1, (ptrdiff_t)1 << 61, 1};
    subject t = begin(LEAFCAST_U8, dims, false, NULL, 6);
    refused(leafcast_update(t.live, none, NULL, t.model, NULL), "size is NULL, and first is not");
    refused(leafcast_update(t.live, NULL, none, t.model, NULL), "first is NULL, and size is not");
    refused(leafcast_update(t.live, none, wide, t.model, NULL),
            "31 nodes from number 0 on along y");
    refused(leafcast_update(t.live, far_off, none, t.model, NULL), "along z: there are 20");
    refused(leafcast_update(t.live, most, most, t.model, NULL), "along x: there are 40");
    refused(leafcast_update(t.live, none, most, t.model, NULL), "along x: there are 40");
    refused(leafcast_update(t.live, NULL, NULL, NULL, NULL), "samples is NULL");
    refused(leafcast_update(t.live, NULL, NULL, t.model, huge), "no array is that large");
    fine(leafcast_update(t.live, none, nothing, NULL, NULL));
    refused(leafcast_commit(t.live, (double)NAN), "time");
    refused(leafcast_select_set(t.live, 0, 1), "1 fields and 1 steps");
    fine(leafcast_select_set(t.live, 0, 0));
    fine(leafcast_commit(t.live, 1));
    leafcast *file = file_of(&t, NULL, "still.leaf");
    refused(leafcast_update(file, NULL, NULL, t.model, NULL), "not of leafcast_open_live()");
    refused(leafcast_commit(file, 1), "not of leafcast_open_live()");
    leafcast_close(file);
    leafcast *v = NULL;
    leafcast_grid bad = t.grid;
    bad.dims[1] = 1;
    refused(leafcast_open_live(&bad, NULL, &v), "leafcast_grid.dims[1]");
    const double flat[12] = {1, 1, 0, 0, 1, 1, 0, 0, 0, 0, 1, 0};
    bad = t.grid;
    bad.to_world = flat;
    refused(leafcast_open_live(&bad, NULL, &v), "leafcast_grid");
    bad = t.grid;
    const double back[40] = {0, 1, 1};
    bad.axis[0] = back;
    refused(leafcast_open_live(&bad, NULL, &v), "leafcast_grid");
    /* No room for two steps. */
    const leafcast_options little = {.size = sizeof little, .threads = 1, .memory = 3 << 20};
    bad = t.grid;
    for (int a = 0; a < 3; a++)
        bad.dims[a] = 128;
    assert_int_equal(leafcast_open_live(&bad, &little, &v), LEAFCAST_NOMEM);
    assert_null(v);
    end(&t);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_same_bits),   cmocka_unit_test(test_scenes),
        cmocka_unit_test(test_frames_hold), cmocka_unit_test(test_running),
        cmocka_unit_test(test_residency),   cmocka_unit_test(test_refused)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
