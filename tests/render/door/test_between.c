/* test_between.c - times between the steps of a grid: pictures are those of a file with the samples
 * that this test makes of both steps, and what brute force sees in them; the steps are read once.
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

#include "formats/leaf/deviation.h"
#include "formats/leaf/leaf_between.h"
#include "render/door/leafcast_volume.h"
#include "tests/support/fields.h"
#include "tests/support/leaf_files.h"
#include "tests/support/pictures.h"
#include "tests/support/ref_judge.h"
#include "tests/support/scratch.h"

enum { STEPS = 5, N = 36, COUNT = N * N * N };

static const double TIMES[STEPS] = {-3, 1, 2, 10, 1e6};

/* What a series is like. */
typedef struct kind {
    sample_type type;
    leaf_codec codec;
    bool bare, grown; /* levels 1; the last steps were added to the file */
    int non_finite;   /* of f32: one sample in so many is NaN or infinite; 0: none */
} kind;

typedef struct stage {
    kind of;
    char series[256];
    float *step[STEPS]; /* samples */
    double iso;
    leafcast_camera view;
} stage;

/* ---- Samples ---- */

/* A ball that moves along x and gets larger, of values from 0 to 1. Nothing changes at the other
 * end, and step 3 is step 2 with but one other sample. */
static double unit_of(int step, int x, int y, int z) {
    const int moved = step == 3 ? 2 : step;
    const double dx = x - 11 - 2 * moved, dy = y - 17, dz = z - 16;
    const double d = dx * dx + dy * dy + dz * dz - 14 * moved;
    if (step == 3 && x == 20 && y == 17 && z == 16)
        return 0.1;
    return d > 330 ? 0 : (330 - (d > 0 ? d : 0)) / 330 * (0.93 + 0.07 * sin(x * y + z + moved));
}

static float sample_of(const kind *of, int step, int x, int y, int z) {
    static const float strange[] = {NAN, INFINITY, -INFINITY};
    const double unit = unit_of(step, x, y, z);
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
    for (int i = 0; i < COUNT; i++)
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
static float between(float a, float b, double share) {
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

static float *blend(const stage *s, uint32_t step, double share) {
    float *to = malloc(COUNT * sizeof *to);
    for (int i = 0; i < COUNT; i++)
        to[i] = between(s->step[step][i], s->step[step + 1][i], share);
    return to;
}

/* ---- Files ---- */

static leaf_case case_of(const kind *of) {
    leaf_case c = leaf_files_case(N, N, N, of->type);
    c.options.file.codec = of->codec;
    c.options.file.zstd_level = 1;
    c.options.file.bare = of->bare;
    c.options.file.histograms = true;
    c.options.file.deviations = !of->bare;
    return c;
}

static grid_series series_of(const char *const *paths, uint32_t first, uint32_t count,
                             sample_type type) {
    return (grid_series){.of = {.paths = (const char **)(uintptr_t)(paths + first),
                                .sets = {.fields = 1, .steps = count, .times = TIMES + first}},
                         .hints = {.dims = {N, N, N}, .type = type}};
}

static void make_series(stage *s) {
    const kind *of = &s->of;
    const leaf_case c = case_of(of);
    const char *paths[STEPS];
    char name[64], *stored = malloc(COUNT * sizeof(float));
    for (int step = 0; step < STEPS; step++) {
        s->step[step] = malloc(COUNT * sizeof(float));
        for (int i = 0; i < COUNT; i++)
            s->step[step][i] = sample_of(of, step, i % N, i / N % N, i / N / N);
        store(of->type, s->step[step], stored);
        snprintf(name, sizeof name, "between%d.bin", step);
        paths[step] = strdup(scratch_write(name, stored, COUNT * sample_size(of->type)));
    }
    const uint32_t first = of->grown ? 2 : STEPS;
    const grid_series begun = series_of(paths, 0, first, of->type);
    snprintf(name, sizeof name, "series-%d-%d-%d-%d.leaf", of->type, of->codec, of->bare,
             of->grown);
    snprintf(s->series, sizeof s->series, "%s", leaf_files_series(&begun, &c.options, name));
    if (of->grown) {
        const grid_series rest = series_of(paths, first, STEPS - first, of->type);
        assert_int_equal(leaf_files_add(&rest, &c.options, s->series), ST_OK);
    }
    for (int step = 0; step < STEPS; step++)
        free((void *)(uintptr_t)paths[step]);
    free(stored);
}

static stage *stage_make(const kind *of) {
    stage *s = calloc(1, sizeof *s);
    s->of = *of;
    make_series(s);
    s->iso = (double)sample_of(&(kind){.type = of->type}, 0, 20, 17, 16) * 0.5;
    s->view = (leafcast_camera){.size = sizeof s->view,
                                .eye = {2.5 * N, 1.7 * N, 2.1 * N},
                                .look_at = {N / 2.0, N / 2.0, N / 2.0},
                                .up = {0, 0, 1},
                                .fov = 30,
                                .width = PICTURE_WIDTH,
                                .height = PICTURE_HEIGHT};
    return s;
}

static void stage_free(stage *s) {
    for (int step = 0; step < STEPS; step++)
        free(s->step[step]);
    free(s);
}

/* A file of the samples between, alone. */
static const char *alone(const stage *s, const float *samples) {
    leaf_case c = case_of(&s->of);
    c.type = SAMPLE_F32;
    c.samples = samples;
    return leaf_files_make(&c, "between-alone.leaf");
}

static void fine(leafcast_status st) {
    if (st != LEAFCAST_OK)
        fail_msg("%s", leafcast_error_text());
}

static void refused(leafcast_status st, leafcast_status as, const char *text) {
    assert_int_equal(st, as);
    if (!strstr(leafcast_error_text(), text))
        fail_msg("\"%s\" is not in: %s", text, leafcast_error_text());
}

static leafcast *open_at(const char *path, const leafcast_options *o, double iso) {
    const leafcast_surface surface = leafcast_surface_default(iso);
    leafcast *v;
    fine(leafcast_open(path, o, &v));
    fine(leafcast_select(v, &surface, 1));
    return v;
}

/* ---- What is drawn ---- */

enum { SURFACE, SHADOWS, CLIPPED, ANALYTIC, LARGEST, FIRST, LOOKS };

static leafcast_scene scene_of(const stage *s, int look) {
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
static int same(const picture *is, const picture *want, const char *what) {
    int hits = 0;
    for (int i = 0; i < PICTURE_PIXELS; i++) {
        hits += isfinite(want->z[i]) != 0;
        if (!pictures_same_pixel(is, want, i))
            fail_msg("%s: pixel %d: t %.17g, red %g, expected %.17g, %g", what, i, is->z[i],
                     (double)is->rgba[0][i], want->z[i], (double)want->rgba[0][i]);
    }
    return hits;
}

/* All looks at a moment are those of the samples alone. */
static void check_looks(const stage *s, leafcast *v, const char *path, const char *what) {
    static picture want, is;
    const leafcast_options o = {.size = sizeof o, .threads = 2};
    leafcast *one = open_at(path, &o, s->iso);
    for (int look = 0; look < LOOKS; look++) {
        const leafcast_scene scene = scene_of(s, look);
        pictures_draw(one, &scene, &s->view, &want, NULL);
        pictures_draw(v, &scene, &s->view, &is, NULL);
        char which[100];
        snprintf(which, sizeof which, "%s, look %d", what, look);
        assert_in_range(same(&is, &want, which), 20, PICTURE_PIXELS);
    }
    leafcast_close(one);
}

/* Brute force agrees with the first look, outside the grazing band. */
static void judge(const stage *s, leafcast *v, const float *samples) {
    static picture is;
    static const double unit[3] = {1, 1, 1}, zero[3] = {0, 0, 0};
    const leafcast_scene scene = scene_of(s, SURFACE);
    const ref_volume truth = ref_volume_regular((long[3]){N, N, N}, samples, unit, zero);
    ref_camera look = {.fov = s->view.fov, .width = PICTURE_WIDTH, .height = PICTURE_HEIGHT};
    ref_tally tally = {0};
    memcpy(look.eye, s->view.eye, sizeof look.eye);
    memcpy(look.look_at, s->view.look_at, sizeof look.look_at);
    memcpy(look.up, s->view.up, sizeof look.up);
    pictures_draw(v, &scene, &s->view, &is, NULL);
    ref_compare(&tally, &truth, &look, &s->iso, 1, NULL, is.z, WATCHED ? 11 : 3, "test_between",
                stdout);
    assert_true(tally.hits > 20);
    assert_int_equal(ref_tally_faults(&tally), 0);
}

/* Values at points, and cells of all levels, are blends of those of both steps. */
static void check_values(const stage *s, leafcast *v, leafcast *steps, uint32_t step, double share,
                         const float *samples) {
    double points[64][3];
    leafcast_sample got[64];
    field_random r = {FIELD_SEED};
    const uint32_t levels = leafcast_describe(v).levels;
    for (int i = 0; i < 64; i++)
        for (int a = 0; a < 3; a++)
            points[i][a] = (double)field_random_below(&r, N);
    fine(leafcast_sample_points(v, (const double(*)[3])points, 64, got));
    for (int i = 0; i < 64; i++) {
        const double *at = points[i];
        leafcast_sample probed;
        fine(leafcast_probe_point(v, at, &probed));
        assert_memory_equal(&probed.value, &got[i].value, sizeof probed.value);
        const double want = (double)samples[(int)(at[0] + N * (at[1] + N * at[2]))];
        if (!isnan(got[i].value))
            assert_true(got[i].value == want);
        else
            assert_true(s->of.non_finite > 0);
    }
    for (uint32_t level = 0; level < levels; level++)
        for (uint64_t cell = 0; cell < 40; cell++) {
            leafcast_cell c[3] = {{.size = sizeof *c}, {.size = sizeof *c}, {.size = sizeof *c}};
            const uint64_t number = level == levels - 1 ? cell : cell * 17 + 5;
            fine(leafcast_get_cell(v, level, number, &c[2]));
            for (uint32_t k = 0; k < 2; k++) {
                fine(leafcast_select_set(steps, 0, step + k));
                fine(leafcast_get_cell(steps, level, number, &c[k]));
            }
            for (int i = 0; i < 8; i++) {
                const double want =
                    (double)between((float)c[0].value[i], (float)c[1].value[i], share);
                assert_true(c[2].value[i] == want || (isnan(want) && isnan(c[2].value[i])));
            }
        }
}

/* ---- Moments ---- */

static const double SHARES[] = {0.5, 1e-300, 0.3, 1 - 0x1p-53, 0x1p-20};
enum { SHARE_COUNT = sizeof SHARES / sizeof *SHARES };

static void check_kind(const kind *of, const leafcast_options *o, uint32_t only) {
    stage *s = stage_make(of);
    leafcast *v = open_at(s->series, o, s->iso), *steps = open_at(s->series, NULL, s->iso);
    for (uint32_t step = 0; step + 1 < STEPS; step++)
        for (uint32_t i = 0; i < SHARE_COUNT; i++) {
            char what[80];
            if ((step + i) % STEPS != only)
                continue;
            float *samples = blend(s, step, SHARES[i]);
            snprintf(what, sizeof what, "type %d, codec %d, step %u + %g", of->type, of->codec,
                     step, SHARES[i]);
            fine(leafcast_select_between(v, 0, step, SHARES[i]));
            check_looks(s, v, alone(s, samples), what);
            judge(s, v, samples);
            check_values(s, v, steps, step, SHARES[i], samples);
            free(samples);
        }
    leafcast_close(v);
    leafcast_close(steps);
    stage_free(s);
}

static const kind KINDS[] = {
    {.type = SAMPLE_U8, .codec = LEAF_CODEC_ZSTD},
    {.type = SAMPLE_I8, .codec = LEAF_CODEC_RAW},
    {.type = SAMPLE_U16, .codec = LEAF_CODEC_ZSTD, .grown = true},
    {.type = SAMPLE_I16, .codec = LEAF_CODEC_ZSTD, .bare = true},
    {.type = SAMPLE_F32, .codec = LEAF_CODEC_ZSTD, .non_finite = 900},
    {.type = SAMPLE_F32, .codec = LEAF_CODEC_RAW},
};
enum { KIND_COUNT = sizeof KINDS / sizeof *KINDS };

static void test_kinds(void **state) {
    (void)state;
    for (uint32_t i = 0; i < KIND_COUNT; i++) {
        const leafcast_options o = {.size = sizeof o,
                                    .threads = 1 + (int)i % 3,
                                    .backend = (leafcast_backend)(i % 3),
                                    .isa = i == 4 ? "scalar" : NULL};
        for (uint32_t only = i % 2; only < STEPS; only += WATCHED ? 3 : 2)
            check_kind(&KINDS[i], &o, only);
    }
}

/* The same bits by any kernel. */
static void test_kernels(void **state) {
    static picture want, is;
    (void)state;
    stage *s = stage_make(&KINDS[4]);
    const leafcast_scene scene = scene_of(s, SHADOWS);
    for (int isa = 0; isa <= (int)cpu_best(); isa++) {
        const leafcast_options o = {.size = sizeof o, .isa = cpu_isa_name((cpu_isa)isa)};
        leafcast *v = open_at(s->series, &o, s->iso);
        fine(leafcast_select_between(v, 0, 1, 0.3));
        pictures_draw(v, &scene, &s->view, isa ? &is : &want, NULL);
        if (isa)
            (void)same(&is, &want, cpu_isa_name((cpu_isa)isa));
        leafcast_close(v);
    }
    stage_free(s);
}

/* ---- Media ---- */

/* A medium is within its bound of that of the samples alone. */
static void test_media(void **state) {
    static const leafcast_transfer_point points[2] = {{-0.9, {1, 0.5, 0.2}, 0},
                                                      {2, {0.2, 0.5, 1}, 0.3}};
    static const leafcast_medium medium = {points, 2};
    static picture want, is;
    (void)state;
    stage *s = stage_make(&KINDS[4]);
    leafcast_scene scene = leafcast_scene_default();
    scene.media = &medium;
    scene.media_count = 1;
    scene.error = 1e-4;
    float *samples = blend(s, 0, 0.3);
    leafcast *v = open_at(s->series, NULL, s->iso);
    leafcast *one = open_at(alone(s, samples), NULL, s->iso);
    fine(leafcast_select_between(v, 0, 0, 0.3));
    pictures_draw(v, &scene, &s->view, &is, NULL);
    pictures_draw(one, &scene, &s->view, &want, NULL);
    for (int i = 0; i < PICTURE_PIXELS; i++)
        for (int c = 0; c < 4; c++)
            assert_true(fabs((double)(is.rgba[c][i] - want.rgba[c][i])) <= 2.001e-4);
    leafcast_close(v);
    leafcast_close(one);
    free(samples);
    stage_free(s);
}

/* ---- What is read ---- */

static leafcast_stats draw(const stage *s, leafcast *v, uint32_t step, double share) {
    static picture p;
    leafcast_stats stats = {.size = sizeof stats};
    const leafcast_scene scene = scene_of(s, SURFACE);
    fine(leafcast_select_between(v, 0, step, share));
    pictures_draw(v, &scene, &s->view, &p, &stats);
    return stats;
}

/* Both steps once; another time between them nothing; the next two the step that is not there. What
 * is the same in both counts once. */
static void test_reading(void **state) {
    (void)state;
    for (int i = 0; i < 2; i++) {
        stage *s = stage_make(i ? &KINDS[0] : &KINDS[5]);
        const leafcast_options o = {.size = sizeof o, .threads = 2};
        leafcast *plain = open_at(s->series, &o, s->iso), *v = open_at(s->series, &o, s->iso);
        uint64_t alone_bytes = 0;
        for (uint32_t step = 0; step < 2; step++)
            alone_bytes += draw(s, plain, step, 0).bytes_read;
        const leafcast_stats first = draw(s, v, 0, 0.25), second = draw(s, v, 0, 0.75);
        assert_in_range(first.treelets_loaded, 3, first.treelets_active);
        assert_true(first.treelets_active < first.treelets_total);
        assert_true(first.bytes_read > 0);
        assert_true(second.bytes_read_ever > 0);
        /* Rays may see other treelets; those that they saw are not read again. */
        assert_true(second.bytes_read < first.bytes_read / 2);
        assert_int_equal(draw(s, v, 0, 0.25).bytes_read, 0);
        assert_int_equal(draw(s, v, 0, 0.3).treelets_loaded, 0);
        const leafcast_stats next = draw(s, v, 1, 0.5);
        assert_true(next.bytes_read > 0);
        assert_true(next.bytes_read < first.bytes_read);
        /* Of steps 2 and 3 all treelets but those around one sample are the same. */
        leafcast *other = open_at(s->series, &o, s->iso);
        const uint64_t one = draw(s, plain, 2, 0).bytes_read,
                       both = draw(s, other, 2, 0.5).bytes_read;
        assert_true(both > 0);
        assert_true(both < one + one / 2 + 3 * one / 8);
        assert_true(draw(s, other, 2, 0.5).bytes_read == 0);
        leafcast_close(other);
        leafcast_close(plain);
        leafcast_close(v);
        stage_free(s);
    }
}

/* No share of the way is the step itself, drawn as ever; so is a step behind a time between. */
static void test_steps(void **state) {
    static picture want, is;
    (void)state;
    stage *s = stage_make(&KINDS[0]);
    leafcast *plain = open_at(s->series, NULL, s->iso), *v = open_at(s->series, NULL, s->iso);
    const leafcast_scene scene = scene_of(s, SHADOWS);
    for (uint32_t step = 0; step < STEPS; step++) {
        fine(leafcast_select_set(plain, 0, step));
        fine(leafcast_select_between(v, 0, step, 0));
        pictures_draw(plain, &scene, &s->view, &want, NULL);
        pictures_draw(v, &scene, &s->view, &is, NULL);
        assert_true(same(&is, &want, "a step") > 20);
        (void)draw(s, v, step < STEPS - 1 ? step : 0, 0.5);
    }
    leafcast_close(plain);
    leafcast_close(v);
    stage_free(s);
}

/* ---- Budgets, frames ---- */

static void test_budgets(void **state) {
    static picture want, is;
    (void)state;
    stage *s = stage_make(&KINDS[4]);
    const leafcast_scene scene = scene_of(s, SHADOWS);
    leafcast *plain = open_at(s->series, NULL, s->iso);
    fine(leafcast_select_between(plain, 0, 3, 0.3));
    pictures_draw(plain, &scene, &s->view, &want, NULL);
    int refusals = 0, drawn = 0;
    for (uint64_t memory = 1 << 20; drawn < 3; memory += 100000) {
        const leafcast_options o = {.size = sizeof o, .threads = 2, .memory = memory};
        leafcast *v = NULL;
        if (leafcast_open(s->series, &o, &v) != LEAFCAST_OK) {
            refusals++;
            continue;
        }
        const leafcast_surface surface = leafcast_surface_default(s->iso);
        const leafcast_image image = {.size = sizeof image,
                                      .r = is.rgba[0],
                                      .g = is.rgba[1],
                                      .b = is.rgba[2],
                                      .a = is.rgba[3],
                                      .z = is.z,
                                      .normal = {is.normal[0], is.normal[1], is.normal[2]},
                                      .id = is.id};
        leafcast_stats stats = {.size = sizeof stats};
        fine(leafcast_select(v, &surface, 1));
        fine(leafcast_select_between(v, 0, 3, 0.3));
        const leafcast_status st = leafcast_trace(v, &scene, &s->view, &image, &stats, NULL, NULL);
        if (st == LEAFCAST_OK) {
            (void)same(&is, &want, "a small budget");
            assert_in_range(stats.bytes_peak, 1, memory);
            drawn++;
        } else {
            assert_int_equal(st, LEAFCAST_NOMEM);
            refusals++;
        }
        leafcast_close(v);
    }
    assert_true(refusals > 0);
    /* One treelet at a time. */
    const leafcast_options few = {.size = sizeof few,
                                  .threads = 2,
                                  .experiments = &(leafcast_experiments){
                                      .size = sizeof(leafcast_experiments), .treelet_limit = 1}};
    leafcast *v = open_at(s->series, &few, s->iso);
    fine(leafcast_select_between(v, 0, 3, 0.3));
    pictures_draw(v, &scene, &s->view, &is, NULL);
    (void)same(&is, &want, "one treelet");
    leafcast_close(v);
    leafcast_close(plain);
    stage_free(s);
}

/* Frames at many times that go on by turns: each has its own time to its end. */
static void test_turns(void **state) {
    enum { FRAMES = 7 };
    static picture want[FRAMES], is[FRAMES];
    (void)state;
    stage *s = stage_make(&KINDS[0]);
    leafcast *v = open_at(s->series, NULL, s->iso);
    leafcast_frame *frame[FRAMES];
    const leafcast_surface surface = leafcast_surface_default(s->iso);
    leafcast_shown shown[FRAMES];
    leafcast_scene scene[FRAMES];
    bool done[FRAMES] = {false}, all = false;
    for (int i = 0; i < FRAMES; i++) {
        shown[i] = (leafcast_shown){.volume = v,
                                    .step = (uint32_t)(i * 2 % (STEPS - 1)),
                                    .surfaces = &surface,
                                    .count = 1,
                                    .between = i == 3 ? 0 : 0.125 * (i + 1)};
        scene[i] = scene_of(s, SHADOWS);
        scene[i].volumes = &shown[i];
        scene[i].volume_count = 1;
        pictures_draw(v, &scene[i], &s->view, &want[i], NULL);
    }
    for (int i = 0; i < FRAMES; i++) {
        picture *p = &is[i];
        const leafcast_image image = {.size = sizeof image,
                                      .r = p->rgba[0],
                                      .g = p->rgba[1],
                                      .b = p->rgba[2],
                                      .a = p->rgba[3],
                                      .z = p->z,
                                      .normal = {p->normal[0], p->normal[1], p->normal[2]},
                                      .id = p->id};
        fine(leafcast_frame_begin(v, &scene[i], &s->view, &image, &frame[i]));
    }
    while (!all) {
        all = true;
        for (int i = 0; i < FRAMES; i++) {
            if (!done[i])
                fine(leafcast_frame_advance(frame[i], 0, &done[i], NULL));
            all &= done[i];
        }
    }
    for (int i = 0; i < FRAMES; i++) {
        leafcast_frame_end(frame[i]);
        assert_true(same(&is[i], &want[i], "by turns") > 20);
    }
    leafcast_close(v);
    stage_free(s);
}

/* What a preview does not mark is exact; some of it is marked at first, and in the end nothing. */
static void test_previews(void **state) {
    static picture want, is;
    (void)state;
    stage *s = stage_make(&KINDS[0]);
    leafcast *v = open_at(s->series, NULL, s->iso), *plain = open_at(s->series, NULL, s->iso);
    leafcast_scene scene = scene_of(s, SURFACE);
    fine(leafcast_select_between(plain, 0, 0, 0.3));
    pictures_draw(plain, &scene, &s->view, &want, NULL);
    fine(leafcast_select_between(v, 0, 0, 0.3));
    scene.preview = true;
    int marked = PICTURE_PIXELS;
    for (int round = 0; round < 100 && marked > 0; round++) {
        marked = 0;
        pictures_draw(v, &scene, &s->view, &is, NULL);
        for (int i = 0; i < PICTURE_PIXELS; i++) {
            marked += is.provisional[i];
            if (!is.provisional[i])
                assert_true(is.z[i] == want.z[i]);
        }
    }
    assert_int_equal(marked, 0);
    leafcast_close(plain);
    leafcast_close(v);
    stage_free(s);
}

/* ---- The directory ---- */

/* Coarse levels are no further from level 0 than deviations say, at any point of some slices. */
static void check_deviations(const stage *s, leaf_file *f, const leaf_moment *at) {
    enum { SIDE = 90 };
    static double fine_value[SIDE * SIDE], value[SIDE * SIDE];
    const leaf_layout *l = &f->layout;
    const uint32_t set = leaf_between_select(f, at);
    leafcast *v = open_at(s->series, NULL, s->iso);
    int compared = 0;
    fine(leafcast_select_between(v, 0, at->step, at->share));
    for (uint32_t level = 1; level < l->sampled; level++)
        for (int z = 0; z < 5; z++) {
            leafcast_slice_pixels p = {
                .size = sizeof p, .width = SIDE, .height = SIDE, .origin = {0, 0, 8.3 * z}};
            p.u[0] = p.v[1] = N - 1;
            fine(leafcast_sample_slice(v, &p, fine_value, NULL, NULL, NULL));
            p.level = level;
            fine(leafcast_sample_slice(v, &p, value, NULL, NULL, NULL));
            for (int i = 0; i < SIDE * SIDE; i++) {
                const double where[3] = {(i % SIDE + 0.5) / SIDE * (N - 1),
                                         (i / SIDE + 0.5) / SIDE * (N - 1), 8.3 * z};
                uint32_t cell[3], place[3];
                for (int a = 0; a < 3; a++) {
                    cell[a] = (uint32_t)where[a] >> level;
                    place[a] = cell[a] >> l->cells_log2;
                    cell[a] -= place[a] << l->cells_log2;
                }
                const uint32_t t = leaf_layout_find(l, level, place);
                const double most =
                    deviation_value(f->deviations[deviation_at(l, set, t) +
                                                  deviation_brick(l, cell[0], cell[1], cell[2])]);
                if (isnan(fine_value[i]) || isnan(value[i]))
                    continue;
                compared += most < (double)INFINITY;
                if (!(fabs(fine_value[i] - value[i]) <= most * (1 + 1e-9)))
                    fail_msg("type %d, step %u, level %u at %g,%g,%g: off by %g, expected %g or "
                             "less",
                             s->of.type, at->step, level, where[0], where[1], where[2],
                             fabs(fine_value[i] - value[i]), most);
            }
        }
    assert_true(compared > 0);
    leafcast_close(v);
}

/* Ranges hold all samples. */
static void test_directory(void **state) {
    (void)state;
    for (uint32_t i = 0; i < KIND_COUNT; i++) {
        stage *s = stage_make(&KINDS[i]);
        mem m;
        leaf_file *below = NULL, *f = NULL, *one = NULL;
        mem_init(&m, 0);
        assert_int_equal(leaf_file_open(&m, s->series, &below), ST_OK);
        assert_int_equal(leaf_between_open(&m, below, CPU_SCALAR, &f), ST_OK);
        for (uint32_t step = 0; step + 1 < STEPS; step++) {
            const leaf_moment at = {0, step, SHARES[step]};
            float *samples = blend(s, step, at.share);
            const uint32_t set = leaf_between_select(f, &at), n = f->layout.treelets;
            assert_int_equal(leaf_file_open(&m, alone(s, samples), &one), ST_OK);
            assert_int_equal(one->layout.treelets, n);
            for (uint32_t t = 0; t < n; t++) {
                const uint32_t p = leaf_layout_samples(&f->layout, set, t);
                const float *own = one->own[t];
                assert_true(f->flags[p] >= one->flags[t]);
                if (one->layout.level_of[t] == 0 && own[0] <= own[1])
                    assert_true(f->own[p][0] <= own[0] && own[1] <= f->own[p][1]);
                assert_true(f->ranges[p][0] <= f->own[p][0] && f->own[p][1] <= f->ranges[p][1]);
            }
            if (f->deviations)
                check_deviations(s, f, &at);
            leaf_file_close(one);
            free(samples);
        }
        assert_int_equal(f->versions[0], 1);
        leaf_file_close(f);
        leaf_file_close(below);
        assert_int_equal(mem_used(&m), 0);
        stage_free(s);
    }
}

/* ---- Times ---- */

static void test_times(void **state) {
    (void)state;
    stage *s = stage_make(&KINDS[0]);
    leafcast *v = open_at(s->series, NULL, s->iso);
    uint32_t step = 9;
    double share = 9;
    for (uint32_t i = 0; i < STEPS; i++) {
        fine(leafcast_find_time(v, TIMES[i], &step, &share));
        assert_int_equal(step, i);
        assert_true(share == 0);
    }
    fine(leafcast_find_time(v, 4, &step, &share));
    assert_int_equal(step, 2);
    assert_true(share == 0.25);
    fine(leafcast_find_time(v, nextafter(1e6, 0), &step, &share));
    assert_int_equal(step, 3);
    assert_true(share < 1 && share > 0.999);
    fine(leafcast_find_time(v, nextafter(1, 0), &step, &share)); /* the share rounds to 1 */
    assert_int_equal(step, 1);
    assert_true(share == 0);
    refused(leafcast_find_time(v, -3.5, &step, &share), LEAFCAST_USAGE, "times from -3 to 1e+06");
    refused(leafcast_find_time(v, 2e6, &step, &share), LEAFCAST_USAGE, "times from -3 to 1e+06");
    refused(leafcast_find_time(v, NAN, &step, &share), LEAFCAST_USAGE, "times from");
    refused(leafcast_select_between(v, 0, STEPS - 1, 0.5), LEAFCAST_USAGE, "there is no next one");
    refused(leafcast_select_between(v, 0, STEPS, 0.5), LEAFCAST_USAGE, "5 steps");
    refused(leafcast_select_between(v, 1, 0, 0.5), LEAFCAST_USAGE, "1 fields");
    refused(leafcast_select_between(v, 0, 0, 1), LEAFCAST_USAGE, "between");
    refused(leafcast_select_between(v, 0, 0, -1e-300), LEAFCAST_USAGE, "between");
    refused(leafcast_select_between(v, 0, 0, NAN), LEAFCAST_USAGE, "between");
    leafcast_close(v);
    stage_free(s);
}

/* ---- Damage ---- */

/* Bytes of the second step alone are wrong: that is told, by the name of the file; the time between
 * the two steps before is drawn. */
static void test_damage(void **state) {
    static picture p;
    (void)state;
    stage *s = stage_make(&KINDS[1]);
    mem m;
    leaf_file *f = NULL;
    size_t size;
    mem_init(&m, 0);
    assert_int_equal(leaf_file_open(&m, s->series, &f), ST_OK);
    char *bytes = scratch_read(s->series, &size);
    for (uint32_t t = 0; t < f->layout.treelets; t++) {
        const uint32_t at = leaf_layout_samples(&f->layout, 4, t);
        if (leaf_file_is_home(f, at))
            bytes[f->offsets[at] + 1000] ^= 1;
    }
    leaf_file_close(f);
    leafcast *v = open_at(scratch_write("damaged.leaf", bytes, size), NULL, s->iso);
    leafcast_scene scene = scene_of(s, SURFACE);
    const leafcast_image image = {.size = sizeof image, .z = p.z};
    (void)draw(s, v, 2, 0.5);
    fine(leafcast_select_between(v, 0, 3, 0.5));
    refused(leafcast_trace(v, &scene, &s->view, &image, NULL, NULL, NULL), LEAFCAST_CORRUPT,
            "damaged.leaf");
    (void)draw(s, v, 2, 0.25);
    leafcast_close(v);
    free(bytes);
    stage_free(s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_kinds),     cmocka_unit_test(test_kernels),
        cmocka_unit_test(test_media),     cmocka_unit_test(test_reading),
        cmocka_unit_test(test_steps),     cmocka_unit_test(test_budgets),
        cmocka_unit_test(test_turns),     cmocka_unit_test(test_previews),
        cmocka_unit_test(test_directory), cmocka_unit_test(test_times),
        cmocka_unit_test(test_damage),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
