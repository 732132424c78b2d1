/* test_slice.c - slices through grids and meshes: the values against plain interpolation of what
 * the second readers find, the same bits as probes and for any budget, backend and number of
 * threads; which treelets are read. */
/* marks: bits threads */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "formats/base/vec3.h"
#include "prep/grid/convert.h"
#include "render/door/leafcast_volume.h"
#include "tests/support/fixture.h"
#include "tests/support/lab_leaf.h"
#include "tests/support/naive_points.h"
#include "tests/support/scratch.h"
#include "tests/support/watched.h"

enum { WIDTH = 61, HEIGHT = 47, PIXELS = WIDTH * HEIGHT };

/* A file in both views. */
typedef struct subject {
    char path[600];
    bool mesh;
    naive_leaf grid;
    naive_mesh tets;
} subject;

static subject *subject_load(const char *path, bool mesh) {
    subject *s = calloc(1, sizeof *s);
    snprintf(s->path, sizeof s->path, "%s", path);
    s->mesh = mesh;
    if (mesh ? !naive_mesh_load(&s->tets, path) : !naive_leaf_load(&s->grid, path))
        fail_msg("%s", mesh ? s->tets.why : s->grid.why);
    return s;
}

static void subject_free(subject *s) {
    if (s->mesh)
        naive_mesh_release(&s->tets);
    else
        naive_leaf_release(&s->grid);
    free(s);
}

static naive_point truth_at(const subject *s, int level, const double point[3]) {
    return s->mesh ? naive_points_mesh(&s->tets, 0, point)
                   : naive_points_grid(&s->grid, level, point);
}

static subject *field_subject(const char *name, const char *type, long n, bool compressed) {
    field f;
    assert_true(field_make(&f, name, n, FIELD_SEED));
    if (type)
        f.type = type;
    subject *s = subject_load(fixture_leaf(&f, 4, 1, compressed), false);
    field_release(&f);
    return s;
}

static subject *mesh_subject(const char *name, int cubes, uint32_t treelet_tets) {
    lab_mesh lab;
    assert_true(lab_mesh_make(&lab, name, cubes, 5));
    subject *s = subject_load(lab_leaf_make(&lab, treelet_tets, false), true);
    lab_mesh_release(&lab);
    return s;
}

/* A volume that is turned, sheared a bit, and far away. */
static const char TURNED[] = "space directions: (0.8,0.6,0.05) (-0.9,1.2,0) (0.1,0.2,-0.7)\n"
                             "space origin: (1003.25,-77.5,12.125)\n";
enum { TURNED_X = 37, TURNED_Y = 22, TURNED_Z = 19 };

static float turned_value(long i, long j, long k) {
    return (float)(sin(0.3 * (double)i) + cos(0.21 * (double)(j * k)) + 0.01 * (double)k);
}

static subject *turned_subject(void) {
    const char *path = scratch_path("turned.nrrd"), *leaf = scratch_path("turned.leaf");
    FILE *out = fopen(path, "wb");
    fprintf(out,
            "NRRD0004\ntype: float\ndimension: 3\nsizes: %d %d %d\nencoding: raw\nendian: little\n"
            "space dimension: 3\n%s\n",
            TURNED_X, TURNED_Y, TURNED_Z, TURNED);
    for (long k = 0; k < TURNED_Z; k++)
        for (long j = 0; j < TURNED_Y; j++)
            for (long i = 0; i < TURNED_X; i++) {
                const float f = turned_value(i, j, k);
                fwrite(&f, sizeof f, 1, out);
            }
    fclose(out);
    mem m;
    volume *v;
    const volume_hints hints = {0};
    convert_options o = {.file = leaf_parameters_default(), .memory = 1 << 30, .threads = 2};
    convert_plan plan;
    convert_result result;
    o.file.cells_log2 = 4;
    o.force = true;
    mem_init(&m, (size_t)o.memory);
    assert_int_equal(volume_open(&m, path, &hints, &v), ST_OK);
    assert_int_equal(convert_plan_make(&m, volume_grid(v), &o, &plan), ST_OK);
    assert_int_equal(convert_run(&m, v, leaf, &o, &plan, NULL, &result), ST_OK);
    volume_close(v);
    return subject_load(leaf, false);
}

/* ---- Slices to look at ---- */

static leafcast_slice_pixels slice_of(uint32_t width, uint32_t height) {
    return (leafcast_slice_pixels){
        .size = sizeof(leafcast_slice_pixels), .width = width, .height = height};
}

/* Across the volume, and somewhat beyond it. */
static leafcast_slice_pixels random_slice(const leafcast *v, field_random *r) {
    const leafcast_info info = leafcast_describe(v);
    leafcast_slice_pixels s = slice_of(WIDTH, HEIGHT);
    for (int a = 0; a < 3; a++) {
        const double edge = info.bounds[1][a] - info.bounds[0][a];
        s.u[a] = 1.4 * edge * field_random_in(r, -1.0, 1.0);
        s.v[a] = 1.4 * edge * field_random_in(r, -1.0, 1.0);
        s.origin[a] =
            info.bounds[0][a] + edge * field_random_in(r, 0.3, 0.7) - 0.5 * (s.u[a] + s.v[a]);
    }
    return s;
}

static void pixel_at(const leafcast_slice_pixels *s, int i, double point[3]) {
    const double right = (i % s->width + 0.5) / s->width, down = (i / s->width + 0.5) / s->height;
    for (int a = 0; a < 3; a++)
        point[a] = s->origin[a] + right * s->u[a] + down * s->v[a];
}

static leafcast_stats sample(leafcast *v, const leafcast_slice_pixels *s, double *value) {
    leafcast_stats stats = {.size = sizeof stats};
    if (leafcast_sample_slice(v, s, value, &stats, NULL, NULL) != LEAFCAST_OK)
        fail_msg("%s", leafcast_error_text());
    return stats;
}

/* ---- The values ---- */

typedef struct tally {
    int inside, outside, holes, doubtful;
} tally;

static void compare(const leafcast_slice_pixels *s, int i, const naive_point *truth, double got,
                    tally *t) {
    const bool nearest = s->interpolation == LEAFCAST_INTERPOLATION_NEAREST;
    const long double want = nearest ? truth->nearest : truth->linear;
    const long double also = nearest ? truth->second : truth->linear;
    if (truth->doubtful) {
        t->doubtful++;
        return;
    }
    t->outside += !truth->inside;
    t->inside += truth->inside && !isnan(want);
    t->holes += truth->inside && isnan(want);
    const long double slack = nearest ? 0.0L : 1e-9L * truth->magnitude;
    const bool right = !truth->inside || isnan(want)
                           ? isnan(got) || (truth->inside && isfinite(also) && got == also)
                           : fabsl(got - want) <= slack || got == also;
    if (!right)
        fail_msg("pixel %d: %.17g, truly %.17Lg", i, got, want);
}

static tally check_slice(const subject *x, leafcast *v, const leafcast_slice_pixels *s) {
    static double value[PIXELS];
    tally t = {0};
    assert_int_equal(s->width * s->height, PIXELS);
    (void)sample(v, s, value);
    for (int i = 0; i < PIXELS; i++) {
        double point[3];
        pixel_at(s, i, point);
        const naive_point truth = truth_at(x, (int)s->level, point);
        compare(s, i, &truth, value[i], &t);
    }
    return t;
}

/* Slices at random, linear and nearest, at all levels. */
static tally check_subject(const subject *x, int rounds) {
    leafcast *v = fixture_open(x->path, NULL);
    const uint32_t levels = leafcast_describe(v).levels;
    field_random r = {FIELD_SEED};
    tally all = {0};
    for (int i = 0; i < rounds; i++) {
        leafcast_slice_pixels s = random_slice(v, &r);
        s.level = (uint32_t)i / 2 % levels;
        s.interpolation = i % 2 ? LEAFCAST_INTERPOLATION_NEAREST : LEAFCAST_INTERPOLATION_LINEAR;
        const tally t = check_slice(x, v, &s);
        all.inside += t.inside;
        all.outside += t.outside;
        all.holes += t.holes;
        all.doubtful += t.doubtful;
    }
    assert_true(all.inside + all.holes > rounds * PIXELS / 100);
    assert_true(all.outside > rounds * PIXELS / 100);
    assert_true(all.doubtful < rounds * PIXELS / 50);
    leafcast_close(v);
    return all;
}

static void test_grids(void **state) {
    (void)state;
    skip_under_thread();
    static const char *const types[] = {"u8", "i8", "u16", "i16", "f32"};
    for (int i = 0; i < 5; i++) {
        subject *x = field_subject("noise-u8", types[i], 41, i % 2);
        (void)check_subject(x, SLOW ? 2 : 4);
        subject_free(x);
    }
}

static void test_all_fields(void **state) {
    (void)state;
    skip_under_thread();
    int holes = 0, rectilinear = 0;
    for (int i = 0; i < field_count(); i++) {
        field f;
        assert_true(field_make(&f, field_name(i), 21, FIELD_SEED));
        rectilinear += f.axis[0] != NULL;
        field_release(&f);
        subject *x = field_subject(field_name(i), NULL, 21, false);
        holes += check_subject(x, SLOW ? 2 : 4).holes;
        subject_free(x);
    }
    assert_true(holes > 100 && rectilinear > 0);
}

static void test_turned(void **state) {
    (void)state;
    subject *x = turned_subject();
    (void)check_subject(x, SLOW ? 4 : 12);
    subject_free(x);
}

static void test_meshes(void **state) {
    (void)state;
    skip_under_thread();
    static const char *const names[] = {"sphere", "noise"};
    for (int i = EMULATED; i < 2; i++) {
        subject *x = mesh_subject(names[i], 6, 100);
        assert_true(x->tets.treelets > 8);
        (void)check_subject(x, SLOW ? 2 : 4);
        subject_free(x);
    }
}

/* ---- The same bits ---- */

static bool same_bits(const double *a, const double *b, size_t count) {
    return memcmp(a, b, count * sizeof *a) == 0;
}

static subject *one_of(int which) {
    return which == 0   ? field_subject("noise-u8", NULL, 50, true)
           : which == 1 ? turned_subject()
                        : mesh_subject("noise", 6, 60);
}

static void test_as_probed(void **state) {
    static double value[PIXELS];
    static double points[PIXELS][3];
    static leafcast_sample samples[PIXELS];
    (void)state;
    for (int which = 0; which < 3; which++) {
        subject *x = one_of(which);
        leafcast *v = fixture_open(x->path, NULL);
        field_random r = {7};
        const leafcast_slice_pixels s = random_slice(v, &r);
        (void)sample(v, &s, value);
        for (int i = 0; i < PIXELS; i++)
            pixel_at(&s, i, points[i]);
        assert_int_equal(leafcast_sample_points(v, (const double(*)[3])points, PIXELS, samples),
                         LEAFCAST_OK);
        for (int i = 0; i < PIXELS; i++) {
            leafcast_sample one;
            assert_int_equal(leafcast_probe_point(v, points[i], &one), LEAFCAST_OK);
            assert_int_equal(one.inside, samples[i].inside);
            assert_memory_equal(&one.gradient, &samples[i].gradient, sizeof one.gradient);
            assert_int_equal(one.cell, samples[i].cell);
            assert_true(same_bits(&one.value, &samples[i].value, 1));
            assert_true(same_bits(&one.value, &value[i], 1));
        }
        leafcast_close(v);
        subject_free(x);
    }
}

/* A budget that is too small names one that will do. */
static uint64_t least_budget(const char *path, const leafcast_slice_pixels *s,
                             const leafcast_options *given) {
    static double value[PIXELS];
    for (uint64_t budget = 1 << 14;; budget *= 2) {
        leafcast_options o = *given;
        leafcast *v;
        o.memory = budget;
        if (leafcast_open(path, &o, &v) != LEAFCAST_OK)
            continue;
        const leafcast_status st = leafcast_sample_slice(v, s, value, NULL, NULL, NULL);
        leafcast_close(v);
        assert_int_equal(st, LEAFCAST_NOMEM);
        const char *text = strstr(leafcast_error_text(), "too small for these points: ");
        assert_non_null(text);
        return strtoull(strchr(text, ':') + 1, NULL, 10);
    }
}

static void test_any_budget(void **state) {
    static double want[PIXELS], got[PIXELS];
    (void)state;
    for (int which = 0; which < 3; which++) {
        subject *x = one_of(which);
        leafcast *v = fixture_open(x->path, NULL);
        field_random r = {9};
        const leafcast_slice_pixels s = random_slice(v, &r);
        (void)sample(v, &s, want);
        leafcast_close(v);
        for (int extra = -1; extra < 6; extra++) {
            leafcast_options o = {.size = sizeof o, .threads = 1 + (extra + 1) % 4};
            o.backend = x->mesh || which == 0 ? LEAFCAST_BACKEND_ARENA : LEAFCAST_BACKEND_MAPPED;
            const uint64_t least = least_budget(x->path, &s, &o);
            o.memory = extra < 0 ? least - 1 : least + extra * (least / 8);
            v = fixture_open(x->path, &o);
            leafcast_stats stats = {.size = sizeof stats};
            memset(got, 0, sizeof got);
            const leafcast_status st = leafcast_sample_slice(v, &s, got, &stats, NULL, NULL);
            if (st != (extra < 0 ? LEAFCAST_NOMEM : LEAFCAST_OK))
                fail_msg("%d, %d more: %s", which, extra, leafcast_error_text());
            assert_true(st != LEAFCAST_OK || same_bits(want, got, PIXELS));
            assert_true(stats.bytes_peak <= o.memory);
            leafcast_close(v);
        }
        subject_free(x);
    }
}

/* Some rows at a time: the same bits, and no row besides. */
static void test_rows(void **state) {
    static double want[PIXELS], got[PIXELS + 1];
    (void)state;
    for (int which = 0; which < 3; which++) {
        subject *x = one_of(which);
        leafcast *v = fixture_open(x->path, NULL);
        field_random r = {11};
        leafcast_slice_pixels s = random_slice(v, &r);
        (void)sample(v, &s, want);
        for (uint32_t step = 1; step <= HEIGHT; step += step < 5 ? 1 : 14) {
            for (s.first_row = 0; s.first_row < HEIGHT; s.first_row += step) {
                double *at = got + (size_t)s.first_row * WIDTH;
                s.rows = HEIGHT - s.first_row < step ? HEIGHT - s.first_row : step;
                at[(size_t)s.rows * WIDTH] = -77.0;
                (void)sample(v, &s, at);
                assert_true(at[(size_t)s.rows * WIDTH] == -77.0);
            }
            assert_true(same_bits(want, got, PIXELS));
        }
        leafcast_close(v);
        subject_free(x);
    }
}

/* After a picture's turn, and before the next. */
static void test_between_pictures(void **state) {
    static double want[PIXELS], got[PIXELS], z[2][64 * 64];
    (void)state;
    subject *x = field_subject("sphere", NULL, 50, false);
    leafcast *free_one = fixture_open(x->path, NULL);
    field_random r = {11};
    const leafcast_slice_pixels s = random_slice(free_one, &r);
    (void)sample(free_one, &s, want);
    leafcast_close(free_one);
    const leafcast_options o = {.size = sizeof o, .memory = 4 << 20, .threads = 2};
    leafcast *v = fixture_open(x->path, &o);
    const leafcast_surface skin = leafcast_surface_default(0.25);
    const leafcast_camera view = leafcast_standard_view(v, 1.6, 64, 64);
    const leafcast_scene scene = leafcast_scene_default();
    assert_int_equal(leafcast_select(v, &skin, 1), LEAFCAST_OK);
    for (int i = 0; i < 2; i++) {
        const leafcast_image image = {.size = sizeof image, .z = z[i]};
        leafcast_frame *drawn;
        bool done = false;
        assert_int_equal(leafcast_frame_begin(v, &scene, &view, &image, &drawn), LEAFCAST_OK);
        while (!done) {
            assert_int_equal(leafcast_frame_advance(drawn, 0.0, &done, NULL), LEAFCAST_OK);
            if (i == 1) {
                (void)sample(v, &s, got);
                assert_true(same_bits(want, got, PIXELS));
            }
        }
        leafcast_frame_end(drawn);
    }
    assert_true(same_bits(z[0], z[1], sizeof z[0] / sizeof *z[0]));
    leafcast_close(v);
    subject_free(x);
}

/* ---- What is read ---- */

/* Treelets of a grid with pixels in them; of a mesh those whose boxes hold a pixel and that come no
 * later than the tet at it. */
static long cut_treelets(const subject *x, const leafcast_slice_pixels *s, uint64_t *bytes) {
    static bool cut[1 << 16];
    const long treelets = x->mesh ? x->tets.treelets : x->grid.treelet_count;
    long count = 0;
    memset(cut, 0, sizeof cut);
    for (int i = 0; i < PIXELS; i++) {
        double point[3];
        pixel_at(s, i, point);
        const naive_point truth = truth_at(x, (int)s->level, point);
        for (long t = 0; t < treelets; t++) {
            bool here = truth.treelet == t;
            const float *b = x->mesh ? x->tets.part[t].bounds[0] : NULL;
            if (x->mesh && (!truth.inside || t < truth.treelet)) {
                here = true;
                for (int a = 0; a < 3; a++)
                    here = here && (double)b[a] <= point[a] && point[a] <= (double)b[a + 3];
            }
            cut[t] = cut[t] || here;
        }
    }
    *bytes = 0;
    for (long t = 0; t < treelets; t++) {
        count += cut[t];
        *bytes += cut[t] && !x->mesh ? x->grid.treelets[t].size : 0;
    }
    return count;
}

static void test_treelets(void **state) {
    static double value[PIXELS];
    (void)state;
    for (int which = 0; which < 3; which++) {
        subject *x = one_of(which);
        field_random r = {13};
        for (int round = 0; round < (SLOW ? 2 : 6); round++) {
            const leafcast_options o = {.size = sizeof o,
                                        .threads = 2,
                                        .experiments = EXPERIMENTS(.treelet_limit = round % 2)};
            leafcast *v = fixture_open(x->path, &o);
            leafcast_slice_pixels s = random_slice(v, &r);
            s.level = (uint32_t)round / 2 % leafcast_describe(v).levels;
            uint64_t bytes;
            const long cut = cut_treelets(x, &s, &bytes);
            const leafcast_stats stats = sample(v, &s, value);
            assert_int_equal(stats.treelets_active, cut);
            assert_int_equal(stats.treelets_loaded, cut); /* once, also one by one */
            if (!x->mesh)
                assert_int_equal(stats.bytes_read, bytes);
            assert_int_equal(stats.bytes_active > 0, stats.bytes_read > 0);
            if (round % 2 == 0)
                assert_int_equal(sample(v, &s, value).treelets_loaded, 0);
            leafcast_close(v);
        }
        subject_free(x);
    }
}

/* Points in no order: each treelet is read once all the same. */
static void test_points_in_no_order(void **state) {
    enum { POINTS = 20000 };
    static double points[POINTS][3];
    static leafcast_sample samples[POINTS];
    (void)state;
    subject *x = one_of(0);
    const leafcast_options o = {
        .size = sizeof o, .threads = 2, .experiments = EXPERIMENTS(.treelet_limit = 2)};
    leafcast *v = fixture_open(x->path, &o);
    const leafcast_info info = leafcast_describe(v);
    field_random r = {3};
    for (int i = 0; i < POINTS; i++)
        for (int a = 0; a < 3; a++)
            points[i][a] = field_random_in(&r, info.bounds[0][a], info.bounds[1][a]);
    assert_int_equal(leafcast_sample_points(v, (const double(*)[3])points, POINTS, samples),
                     LEAFCAST_OK);
    bool seen[1 << 12] = {false};
    long treelets = 0;
    for (int i = 0; i < POINTS; i++) {
        const naive_point truth = naive_points_grid(&x->grid, 0, points[i]);
        assert_true(samples[i].inside);
        assert_true(fabsl(samples[i].value - truth.linear) <= 1e-9L * truth.magnitude);
        treelets += !seen[samples[i].treelet];
        seen[samples[i].treelet] = true;
    }
    assert_true(treelets > 8);
    assert_int_equal(loader_statistics(v->treelets).loads, treelets);
    leafcast_close(v);
    subject_free(x);
}

/* ---- Curved slices ---- */

static void test_curved(void **state) {
    static const double line[][3] = {{3, 4, 5},   {20, 4, 5},     {20, 4, 5},
                                     {30, 25, 8}, {12.5, 30, 20}, {12.5, 30, 20}};
    static double value[PIXELS];
    enum { POINTS = sizeof line / sizeof *line };
    (void)state;
    subject *x = field_subject("noise-u8", NULL, 41, false);
    leafcast *v = fixture_open(x->path, NULL);
    leafcast_slice_pixels s = slice_of(WIDTH, HEIGHT);
    s.line = line;
    s.line_count = POINTS;
    s.v[1] = 2.5;
    s.v[2] = 40;
    (void)sample(v, &s, value);
    long double length[POINTS] = {0};
    for (int k = 1; k < POINTS; k++) {
        long double sum = 0;
        for (int a = 0; a < 3; a++)
            sum += (line[k][a] - line[k - 1][a]) * (line[k][a] - line[k - 1][a]);
        length[k] = length[k - 1] + sqrtl(sum);
    }
    int inside = 0;
    for (int i = 0; i < PIXELS; i++) {
        const long double at = (i % WIDTH + 0.5L) / WIDTH * length[POINTS - 1];
        double point[3];
        int k = 0;
        while (length[k + 1] < at)
            k++;
        for (int a = 0; a < 3; a++)
            point[a] = (double)(line[k][a] +
                                (at - length[k]) / (length[k + 1] - length[k]) *
                                    (line[k + 1][a] - line[k][a]) +
                                (i / WIDTH + 0.5L) / HEIGHT * s.v[a]);
        const naive_point truth = naive_points_grid(&x->grid, 0, point);
        assert_true(truth.doubtful || truth.inside == !isnan(value[i]));
        inside += truth.inside;
        if (truth.inside && !truth.doubtful)
            assert_true(fabsl(value[i] - truth.linear) <= 1e-9L * truth.magnitude);
    }
    assert_true(inside > PIXELS / 2 && inside < PIXELS);
    leafcast_close(v);
    subject_free(x);
}

/* ---- Slices across the volume ---- */

/* All node planes, in the nearest interpolation, are the samples. */
static void test_layers_are_samples(void **state) {
    (void)state;
    subject *x = turned_subject();
    leafcast *v = fixture_open(x->path, NULL);
    const long dims[3] = {TURNED_X, TURNED_Y, TURNED_Z};
    double *value = malloc(sizeof *value << 20);
    for (int axis = 0; axis < 3; axis++) {
        const int right = axis == 0 ? 1 : 0, up = axis == 2 ? 1 : 2;
        for (long k = 0; k < dims[axis]; k++) {
            leafcast_slice_pixels s = slice_of(0, 0);
            s.interpolation = LEAFCAST_INTERPOLATION_NEAREST;
            assert_int_equal(leafcast_layer_slice(v, axis, (uint32_t)k, &s), LEAFCAST_OK);
            s.width = (uint32_t)dims[right]; /* cells are no cubes */
            s.height = (uint32_t)dims[up];
            (void)sample(v, &s, value);
            for (long row = 0; row < dims[up]; row++)
                for (long column = 0; column < dims[right]; column++) {
                    long node[3];
                    node[axis] = k;
                    node[right] = column;
                    node[up] = dims[up] - 1 - row;
                    assert_true(value[row * dims[right] + column] ==
                                (double)turned_value(node[0], node[1], node[2]));
                }
        }
    }
    free(value);
    leafcast_close(v);
    subject_free(x);
}

static void test_layer_size(void **state) {
    (void)state;
    field f;
    assert_true(field_make(&f, "noise-u8", 41, FIELD_SEED));
    leafcast *v = fixture_open(fixture_leaf(&f, 4, 1, false), NULL);
    for (int nearest = 0; nearest < 2; nearest++)
        for (int axis = 0; axis < 3; axis++) {
            leafcast_slice_pixels s = slice_of(0, 0);
            s.interpolation = (leafcast_interpolation)nearest;
            assert_int_equal(leafcast_layer_slice(v, axis, 3, &s), LEAFCAST_OK);
            assert_int_equal(s.width, f.dims[axis == 0] - 1 + nearest);
            assert_int_equal(s.height, f.dims[axis == 2 ? 1 : 2] - 1 + nearest);
            s.level = 1;
            assert_int_equal(leafcast_layer_slice(v, axis, 3, &s), LEAFCAST_OK);
            assert_int_equal(s.width, f.dims[axis == 0] / 2 + nearest);
        }
    leafcast_close(v);
    field_release(&f);
}

/* The plane's own rectangle: in the plane, seen from the right side, holding all of the cut and no
 * more. */
static void check_plane(leafcast *v, const double plane[4], const double corners[8][3]) {
    leafcast_slice_pixels s = slice_of(0, 0);
    assert_int_equal(leafcast_plane_slice(v, plane, &s), LEAFCAST_OK);
    const double n = vec3_length(plane), u = vec3_length(s.u), w = vec3_length(s.v);
    double seen[3], least[2] = {1, 1}, most[2] = {0, 0};
    assert_true(fabs(vec3_dot(plane, s.u)) < 1e-9 * n * u);
    assert_true(fabs(vec3_dot(plane, s.v)) < 1e-9 * n * w);
    assert_true(fabs(vec3_dot(s.u, s.v)) < 1e-9 * u * w);
    assert_true(fabs(vec3_dot(plane, s.origin) + plane[3]) < 1e-9 * n * (u + w));
    vec3_cross(s.u, s.v, seen);
    assert_true(vec3_dot(seen, plane) < 0.0); /* down, not up */
    assert_true(s.v[2] < 0.0 || (fabs(s.v[2]) < 1e-9 * w && s.v[1] < 0.0));
    for (int i = 0; i < 8; i++)
        for (int a = 0; a < 3; a++) {
            const double *p = corners[i], *q = corners[i | 1 << a];
            const double from = vec3_dot(plane, p) + plane[3], to = vec3_dot(plane, q) + plane[3];
            if (i >> a & 1 || (from > 0) == (to > 0))
                continue;
            double at[3];
            for (int k = 0; k < 3; k++)
                at[k] = p[k] + from / (from - to) * (q[k] - p[k]) - s.origin[k];
            const double share[2] = {vec3_dot(at, s.u) / (u * u), vec3_dot(at, s.v) / (w * w)};
            for (int k = 0; k < 2; k++) {
                least[k] = fmin(least[k], share[k]);
                most[k] = fmax(most[k], share[k]);
            }
        }
    for (int k = 0; k < 2; k++)
        assert_true(fabs(least[k]) < 1e-9 && fabs(most[k] - 1.0) < 1e-9);
}

static void test_planes(void **state) {
    (void)state;
    subject *x = turned_subject();
    leafcast *v = fixture_open(x->path, NULL);
    const double last[3] = {TURNED_X - 1, TURNED_Y - 1, TURNED_Z - 1};
    double corners[8][3];
    field_random r = {17};
    for (int i = 0; i < 8; i++)
        for (int a = 0; a < 3; a++) {
            corners[i][a] = x->grid.to_world[a][3];
            for (int k = 0; k < 3; k++)
                corners[i][a] += x->grid.to_world[a][k] * (i >> k & 1 ? last[k] : 0.0);
        }
    for (int round = 0; round < 300; round++) {
        double plane[4], through[3] = {0};
        for (int a = 0; a < 3; a++) {
            plane[a] =
                round < 6 ? (round % 3 == a) * (round < 3 ? 1 : -2) : field_random_in(&r, -3, 3);
            for (int i = 0; i < 8; i++)
                through[a] += corners[i][a] / 8;
            through[a] += field_random_in(&r, -2, 2);
        }
        plane[3] = -vec3_dot(plane, through);
        check_plane(v, plane, (const double(*)[3])corners);
    }
    const double beside[4] = {0, 0, 1, 1000}, none[4] = {0, 0, 0, 1};
    leafcast_slice_pixels s = slice_of(0, 0);
    assert_int_equal(leafcast_plane_slice(v, beside, &s), LEAFCAST_USAGE);
    assert_int_equal(leafcast_plane_slice(v, none, &s), LEAFCAST_USAGE);
    leafcast_close(v);
    subject_free(x);
}

/* A face of the volume is a slice like another: its border is inside. */
static void test_faces(void **state) {
    static double value[1 << 16];
    (void)state;
    field f;
    assert_true(field_make(&f, "noise-u8", 33, FIELD_SEED));
    f.spacing[0] = 0.3;
    f.spacing[1] = -0.7;
    f.origin[2] = 0.1;
    leafcast *v = fixture_open(fixture_leaf(&f, 4, 1, false), NULL);
    const leafcast_info info = leafcast_describe(v);
    for (int face = 0; face < 6; face++) {
        double plane[4] = {0};
        plane[face / 2] = 1;
        plane[3] = -info.bounds[face % 2][face / 2];
        leafcast_slice_pixels s = slice_of(0, 0);
        assert_int_equal(leafcast_plane_slice(v, plane, &s), LEAFCAST_OK);
        assert_true((size_t)s.width * s.height < sizeof value / sizeof *value);
        (void)sample(v, &s, value);
        for (uint32_t i = 0; i < s.width * s.height; i++)
            assert_false(isnan(value[i]));
    }
    leafcast_close(v);
    field_release(&f);
}

/* ---- What cannot be ---- */

static void refused(leafcast *v, const leafcast_slice_pixels *s, const char *said) {
    static double value[PIXELS];
    assert_int_equal(leafcast_sample_slice(v, s, value, NULL, NULL, NULL), LEAFCAST_USAGE);
    if (!strstr(leafcast_error_text(), said))
        fail_msg("%s", leafcast_error_text());
}

static void test_refused(void **state) {
    static const double line[2][3] = {{1, 1, 1}, {1, 1, 1}}, odd[2][3] = {{1, 1, 1}, {2, NAN, 1}};
    (void)state;
    subject *x = one_of(0);
    leafcast *v = fixture_open(x->path, NULL);
    leafcast_slice_pixels s = slice_of(4, 4), wrong;
#define WRONG(set, said)          \
    do {                          \
        wrong = s;                \
        wrong.set;                \
        refused(v, &wrong, said); \
    } while (0)
    WRONG(size = 3, "leafcast_slice_pixels");
    WRONG(interpolation = (leafcast_interpolation)2, "interpolation");
    WRONG(level = 20, "level");
    WRONG(width = 0, "width is 0");
    WRONG(rows = 5, "5 rows");
    WRONG(first_row = 1, "0 rows from row 1");
    s.rows = 2;
    WRONG(first_row = 3, "2 rows from row 3");
    WRONG(first_row = 5, "2 rows from row 5");
    s.rows = 0;
    WRONG(u[1] = INFINITY, "u[1] is inf");
    WRONG(line_count = 2, "line");
    s.line = line;
    WRONG(line_count = 1, "line_count is 1");
    WRONG(line_count = 2, "length 0");
    s.line = odd;
    WRONG(line_count = 2, "line[4] is");
#undef WRONG
    leafcast_slice_pixels layer = slice_of(0, 0);
    assert_int_equal(leafcast_layer_slice(v, 3, 0, &layer), LEAFCAST_USAGE);
    assert_int_equal(leafcast_layer_slice(v, 0, 1000, &layer), LEAFCAST_USAGE);
    leafcast_close(v);
    subject_free(x);
    x = one_of(2);
    v = fixture_open(x->path, NULL);
    assert_int_equal(leafcast_layer_slice(v, 0, 0, &layer), LEAFCAST_USAGE);
    leafcast_close(v);
    subject_free(x);
}

static bool stop_at_half(void *ctx, double done) {
    double *most = ctx;
    *most = done;
    return done < 0.5;
}

static void test_stopped(void **state) {
    static double value[PIXELS];
    (void)state;
    subject *x = one_of(0);
    const leafcast_options o = {
        .size = sizeof o, .threads = 2, .experiments = EXPERIMENTS(.treelet_limit = 1)};
    leafcast *v = fixture_open(x->path, &o);
    field_random r = {7};
    double most = 0.0;
    const leafcast_slice_pixels s = random_slice(v, &r);
    assert_int_equal(leafcast_sample_slice(v, &s, value, NULL, stop_at_half, &most),
                     LEAFCAST_STOPPED);
    assert_true(most >= 0.5 && most < 1.0);
    (void)sample(v, &s, value);
    leafcast_close(v);
    subject_free(x);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_grids),      cmocka_unit_test(test_all_fields),
        cmocka_unit_test(test_turned),     cmocka_unit_test(test_meshes),
        cmocka_unit_test(test_as_probed),  cmocka_unit_test(test_any_budget),
        cmocka_unit_test(test_rows),       cmocka_unit_test(test_between_pictures),
        cmocka_unit_test(test_treelets),   cmocka_unit_test(test_points_in_no_order),
        cmocka_unit_test(test_curved),     cmocka_unit_test(test_layers_are_samples),
        cmocka_unit_test(test_layer_size), cmocka_unit_test(test_planes),
        cmocka_unit_test(test_faces),      cmocka_unit_test(test_refused),
        cmocka_unit_test(test_stopped),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
