#include "tests/support/between_lab.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/support/between_hexes.h"
#include "tests/support/scratch.h"

const double between_times[BETWEEN_STEPS] = {-3, 1, 2, 10, 1e6, 2e6};
const double between_shares[BETWEEN_SHARES] = {0.5, 1e-300, 0.3, 1 - 0x1p-53, 0x1p-20};
const between_kind between_kinds[BETWEEN_KINDS] = {
    {.type = SAMPLE_U8, .codec = LEAF_CODEC_ZSTD},
    {.type = SAMPLE_I8, .codec = LEAF_CODEC_RAW},
    {.type = SAMPLE_U16, .codec = LEAF_CODEC_ZSTD, .grown = true},
    {.type = SAMPLE_I16, .codec = LEAF_CODEC_ZSTD, .bare = true},
    {.type = SAMPLE_F32, .codec = LEAF_CODEC_ZSTD, .non_finite = 900},
    {.type = SAMPLE_F32, .codec = LEAF_CODEC_RAW},
    {.type = SAMPLE_F32, .codec = LEAF_CODEC_ZSTD, .small = true},
    {.type = SAMPLE_F32, .codec = LEAF_CODEC_RAW, .mesh = true},
    {.type = SAMPLE_F32, .codec = LEAF_CODEC_ZSTD, .mesh = true, .moves = true},
    {.type = SAMPLE_F32, .codec = LEAF_CODEC_ZSTD, .mesh = true, .grown = true, .non_finite = 90},
    {.type = SAMPLE_F32, .codec = LEAF_CODEC_RAW, .mesh = true, .moves = true, .non_finite = 90},
    {.type = SAMPLE_F32,
     .codec = LEAF_CODEC_ZSTD,
     .mesh = true,
     .grown = true,
     .non_finite = 90,
     .cells = BETWEEN_MIXED},
    {.type = SAMPLE_F32,
     .codec = LEAF_CODEC_ZSTD,
     .mesh = true,
     .moves = true,
     .cells = BETWEEN_MIXED},
    {.type = SAMPLE_F32,
     .codec = LEAF_CODEC_RAW,
     .mesh = true,
     .grown = true,
     .cells = BETWEEN_CURVILINEAR},
    {.type = SAMPLE_F32,
     .codec = LEAF_CODEC_ZSTD,
     .mesh = true,
     .moves = true,
     .non_finite = 90,
     .cells = BETWEEN_CURVILINEAR},
};

/* ---- Samples ---- */

/* A ball that moves along x and gets larger, of values from 0 to 1. Nothing changes at the other
 * end, and step 3 is step 2 with but one other sample. */
static double unit_of(bool small, int step, int x, int y, int z) {
    const int moved = step == 3 ? 2 : step;
    const double dx = x - 11 - (small ? 10 : 2) * moved, dy = y - 17, dz = z - 16;
    const double d = dx * dx + dy * dy + dz * dz - (small ? 0 : 14) * moved;
    const double most = small ? 40 : 330;
    if (step == 3 && x == 20 && y == 17 && z == 16)
        return 0.1;
    return d > most ? 0 : (most - (d > 0 ? d : 0)) / most * (0.93 + 0.07 * sin(x * y + z + moved));
}

static float sample_of(const between_kind *of, int step, int x, int y, int z) {
    static const float strange[] = {NAN, INFINITY, -INFINITY};
    const double unit = unit_of(of->small, step, x, y, z);
    const unsigned dice = (unsigned)(x * 7919 + y * 104729 + z * 1299709 + (step > 3) * 15485863);
    if (of->non_finite && dice % (unsigned)of->non_finite == 0)
        return strange[dice / 7 % 3];
    switch (of->type) {
    case SAMPLE_U8: return (float)floor(unit * 255);
    case SAMPLE_I8: return (float)floor(unit * 255) - 128;
    case SAMPLE_U16: return (float)floor(unit * 65535);
    case SAMPLE_I16: return (float)floor(unit * 65535) - 32768;
    default: return (float)(unit * 3 - 1);
    }
}

static void store(sample_type type, const float *from, void *to) {
    for (int i = 0; i < BETWEEN_SAMPLES; i++)
        switch (type) {
        case SAMPLE_U8: ((uint8_t *)to)[i] = (uint8_t)from[i]; break;
        case SAMPLE_I8: ((int8_t *)to)[i] = (int8_t)from[i]; break;
        case SAMPLE_U16: ((uint16_t *)to)[i] = (uint16_t)from[i]; break;
        case SAMPLE_I16: ((int16_t *)to)[i] = (int16_t)from[i]; break;
        default: ((float *)to)[i] = from[i]; break;
        }
}

/* The sample between two: what the header says, by volatile doubles; and as nearly what it stands
 * for as rounding allows. */
float between_lab_mix(float a, float b, double share) {
    const volatile double rest = 1.0 - share, first = rest * (double)a, second = share * (double)b;
    const volatile double sum = first + second;
    const float mixed = (float)sum;
    if (isfinite(a) && isfinite(b)) {
        const long double truth = (1.0L - (long double)share) * a + (long double)share * b;
        const long double most = fabsl((long double)a) + fabsl((long double)b);
        assert_true(fabsl(truth - (long double)mixed) <= 0x1p-23L * most + 0x1p-149L);
    }
    return mixed;
}

static int floats_of(const between_kind *of) {
    return of->mesh ? BETWEEN_MESH_FLOATS : BETWEEN_SAMPLES;
}

float *between_lab_blend(const between_lab *s, uint32_t step, double share) {
    const int count = floats_of(&s->of);
    float *to = malloc((size_t)count * sizeof *to);
    for (int i = 0; i < count; i++)
        to[i] = between_lab_mix(s->step[step][i], s->step[step + 1][i], share);
    return to;
}

/* ---- Files ---- */

static leaf_case case_of(const between_kind *of) {
    leaf_case c = leaf_files_case(BETWEEN_SIDE, BETWEEN_SIDE, BETWEEN_SIDE, of->type);
    c.options.file.codec = of->codec;
    c.options.file.zstd_level = 1;
    c.options.file.bare = of->bare;
    c.options.file.histograms = true;
    c.options.file.deviations = !of->bare;
    return c;
}

static grid_series series_of(const char *const *paths, uint32_t first, uint32_t count,
                             sample_type type) {
    return (grid_series){
        .of = {.paths = (const char **)(uintptr_t)(paths + first),
               .sets = {.fields = 1, .steps = count, .times = between_times + first}},
        .hints = {.dims = {BETWEEN_SIDE, BETWEEN_SIDE, BETWEEN_SIDE}, .type = type}};
}

/* The steps' samples: those of a mesh at the nodes of a coarser grid. */
static void fill_steps(between_lab *s) {
    const between_kind *of = &s->of;
    const int side = of->mesh ? BETWEEN_MESH_NODES : BETWEEN_SIDE;
    const int stride = of->mesh ? BETWEEN_MESH_STRIDE : 1;
    for (int step = 0; step < BETWEEN_STEPS; step++) {
        float *to = s->step[step] = malloc((size_t)floats_of(of) * sizeof *to);
        for (int i = 0; i < side * side * side; i++)
            to[i] = sample_of(of, step, i % side * stride, i / side % side * stride,
                              i / side / side * stride);
        if (of->mesh) {
            between_mesh_points(of->moves, step, (float(*)[3])(to + BETWEEN_MESH_POINTS));
            between_hexes_hide(of->moves ? step : 0, to + BETWEEN_MESH_HIDDEN);
            if (of->moves && of->cells != BETWEEN_TETS)
                between_hexes_fold(step, (float(*)[3])(to + BETWEEN_MESH_POINTS));
        }
    }
}

static void convert_mesh(const between_kind *of, const float *const *steps, uint32_t first,
                         uint32_t count, const char *path) {
    (of->cells == BETWEEN_TETS ? between_mesh_convert : between_hexes_convert)(of, steps, first,
                                                                               count, path);
}

static void make_mesh(between_lab *s) {
    const between_kind *of = &s->of;
    const uint32_t first = of->grown ? 2 : BETWEEN_STEPS;
    const float *const *steps = (const float *const *)s->step;
    char name[64];
    snprintf(name, sizeof name, "mesh-%d-%d-%d-%d.leaf", of->cells, of->moves, of->codec,
             of->grown);
    snprintf(s->series, sizeof s->series, "%s", scratch_path(name));
    convert_mesh(of, steps, 0, first, s->series);
    for (uint32_t step = first; step < BETWEEN_STEPS; step += 2)
        convert_mesh(of, steps, step, 2, s->series);
}

static void make_grid(between_lab *s) {
    const between_kind *of = &s->of;
    const leaf_case c = case_of(of);
    const char *paths[BETWEEN_STEPS];
    char name[64], *stored = malloc(BETWEEN_SAMPLES * sizeof(float));
    for (int step = 0; step < BETWEEN_STEPS; step++) {
        store(of->type, s->step[step], stored);
        snprintf(name, sizeof name, "between%d.bin", step);
        paths[step] = strdup(scratch_write(name, stored, BETWEEN_SAMPLES * sample_size(of->type)));
    }
    const uint32_t first = of->grown ? 2 : BETWEEN_STEPS;
    const grid_series begun = series_of(paths, 0, first, of->type);
    snprintf(name, sizeof name, "series-%d-%d-%d-%d-%d.leaf", of->small, of->type, of->codec,
             of->bare, of->grown);
    snprintf(s->series, sizeof s->series, "%s", leaf_files_series(&begun, &c.options, name));
    if (of->grown) {
        const grid_series rest = series_of(paths, first, BETWEEN_STEPS - first, of->type);
        assert_int_equal(leaf_files_add(&rest, &c.options, s->series), ST_OK);
    }
    for (int step = 0; step < BETWEEN_STEPS; step++)
        free((void *)(uintptr_t)paths[step]);
    free(stored);
}

between_lab *between_lab_make(const between_kind *of) {
    between_lab *s = calloc(1, sizeof *s);
    s->of = *of;
    fill_steps(s);
    (of->mesh ? make_mesh : make_grid)(s);
    /* A small ball is cut near its border, where it is lower than half of its height. */
    s->iso = of->small ? -0.7
                       : (double)sample_of(&(between_kind){.type = of->type}, 0, 20, 17, 16) * 0.5;
    s->view =
        (leafcast_camera){.size = sizeof s->view,
                          .eye = {2.5 * BETWEEN_SIDE, 1.7 * BETWEEN_SIDE, 2.1 * BETWEEN_SIDE},
                          .look_at = {BETWEEN_SIDE / 2.0, BETWEEN_SIDE / 2.0, BETWEEN_SIDE / 2.0},
                          .up = {0, 0, 1},
                          .fov = 30,
                          .width = PICTURE_WIDTH,
                          .height = PICTURE_HEIGHT};
    return s;
}

void between_lab_free(between_lab *s) {
    for (int step = 0; step < BETWEEN_STEPS; step++)
        free(s->step[step]);
    free(s);
}

/* A file of the samples between, alone. */
const char *between_lab_alone(const between_lab *s, const float *samples) {
    if (s->of.mesh) {
        const between_kind alone = {.codec = s->of.codec, .cells = s->of.cells};
        convert_mesh(&alone, &samples, 0, 1, scratch_path("between-alone.leaf"));
        return scratch_path("between-alone.leaf");
    }
    leaf_case c = case_of(&s->of);
    c.type = SAMPLE_F32;
    c.samples = samples;
    return leaf_files_make(&c, "between-alone.leaf");
}

void between_lab_fine(leafcast_status st) {
    if (st != LEAFCAST_OK)
        fail_msg("%s", leafcast_error_text());
}

void between_lab_refused(leafcast_status st, leafcast_status as, const char *text) {
    assert_int_equal(st, as);
    if (!strstr(leafcast_error_text(), text))
        fail_msg("\"%s\" is not in: %s", text, leafcast_error_text());
}

leafcast *between_lab_open(const char *path, const leafcast_options *o, double iso) {
    const leafcast_surface surface = leafcast_surface_default(iso);
    leafcast *v;
    between_lab_fine(leafcast_open(path, o, &v));
    between_lab_fine(leafcast_select(v, &surface, 1));
    return v;
}

/* ---- Pictures ---- */

leafcast_scene between_lab_scene(const between_lab *s, int look) {
    leafcast_scene scene = leafcast_scene_default();
    if (look == SHADOWS) {
        scene.light_count = 1;
        scene.lights[0] = (leafcast_light){.vector = {1, 2, 3}, .rgb = {1, 1, 1}};
        scene.shadows = true;
    }
    scene.clip_plane_count = look == CLIPPED;
    memcpy(scene.clip_planes[0], (double[4]){-1, 0.2, -0.4, 20}, sizeof scene.clip_planes[0]);
    scene.caps = look == CLIPPED;
    scene.analytic_normals = look == ANALYTIC;
    scene.project = look == LARGEST ? LEAFCAST_PROJECT_MAX
                    : look == FIRST ? LEAFCAST_PROJECT_FIRST
                                    : LEAFCAST_PROJECT_NONE;
    scene.project_value = s->iso;
    /* Colours do not depend on what is known of the range of all values. */
    static leafcast_transfer_point points[2];
    static const leafcast_medium colours = {points, 2};
    points[0] = (leafcast_transfer_point){s->iso, {0, 0.1F, 0.2F}, 1};
    points[1] = (leafcast_transfer_point){2 * fabs(s->iso) + 1, {1, 0.8F, 0.9F}, 1};
    scene.media = look == LARGEST || look == FIRST ? &colours : NULL;
    scene.media_count = scene.media != NULL;
    return scene;
}

/* Whether every pixel of both is the same. Returns the pixels that show something. */
int between_lab_same(const picture *is, const picture *want, const char *what) {
    int hits = 0;
    for (int i = 0; i < PICTURE_PIXELS; i++) {
        hits += isfinite(want->z[i]) != 0;
        if (!pictures_same_pixel(is, want, i))
            fail_msg("%s: pixel %d: t %.17g, red %g, expected %.17g, %g", what, i, is->z[i],
                     (double)is->rgba[0][i], want->z[i], (double)want->rgba[0][i]);
    }
    return hits;
}
