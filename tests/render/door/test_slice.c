/* test_slice.c - slices through grids and meshes: the values against plain interpolation of what
 * the second readers find, the same bits as probes and for any budget, backend and number of
 * threads; which treelets are read. */
/* marks: bits threads, long */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "render/door/leafcast_volume.h"
#include "tests/support/fixture.h"
#include "tests/support/slice_subject.h"
#include "tests/support/watched.h"

/* ---- The values ---- */

enum { ROUNDS = EMULATED ? 1 : WATCHED ? 2 : 4 };

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

static tally check_slice(const slice_subject *x, leafcast *v, const leafcast_slice_pixels *s) {
    static double value[SLICE_PIXELS];
    tally t = {0};
    assert_int_equal(s->width * s->height, SLICE_PIXELS);
    (void)slice_subject_sample(v, s, value);
    for (int i = 0; i < SLICE_PIXELS; i++) {
        double point[3];
        slice_subject_pixel(s, i, point);
        const naive_point truth = slice_subject_truth(x, (int)s->level, point);
        compare(s, i, &truth, value[i], &t);
    }
    return t;
}

/* Slices at random, linear and nearest, at all levels. */
static tally check_subject(const slice_subject *x, int rounds) {
    leafcast *v = fixture_open(x->path, NULL);
    const uint32_t levels = leafcast_describe(v).levels;
    field_random r = {FIELD_SEED};
    tally all = {0};
    for (int i = 0; i < rounds; i++) {
        leafcast_slice_pixels s = slice_subject_slice(v, &r);
        s.level = (uint32_t)i / 2 % levels;
        s.interpolation = i % 2 ? LEAFCAST_INTERPOLATION_NEAREST : LEAFCAST_INTERPOLATION_LINEAR;
        const tally t = check_slice(x, v, &s);
        all.inside += t.inside;
        all.outside += t.outside;
        all.holes += t.holes;
        all.doubtful += t.doubtful;
    }
    assert_true(all.inside + all.holes > rounds * SLICE_PIXELS / 100);
    assert_true(all.outside > rounds * SLICE_PIXELS / 100);
    assert_true(all.doubtful < rounds * SLICE_PIXELS / 50);
    leafcast_close(v);
    return all;
}

static void test_grids(void **state) {
    (void)state;
    skip_under_thread();
    static const char *const types[] = {"u8", "i8", "u16", "i16", "f32"};
    for (int i = 0; i < 5; i++) {
        slice_subject *x = slice_subject_of_field("noise-u8", types[i], 41, i % 2);
        (void)check_subject(x, ROUNDS);
        slice_subject_free(x);
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
        slice_subject *x = slice_subject_of_field(field_name(i), NULL, 21, false);
        holes += check_subject(x, ROUNDS).holes;
        slice_subject_free(x);
    }
    assert_true(holes > 100 && rectilinear > 0);
}

static void test_turned(void **state) {
    (void)state;
    slice_subject *x = slice_subject_turned();
    (void)check_subject(x, EMULATED ? 2 : SLOW ? 4 : 12);
    slice_subject_free(x);
}

static void test_meshes(void **state) {
    (void)state;
    skip_under_thread();
    static const char *const names[] = {"sphere", "noise"};
    for (int i = EMULATED; i < 2; i++) {
        slice_subject *x = slice_subject_of_mesh(names[i], 6, 100);
        assert_true(x->tets.treelets > 8);
        (void)check_subject(x, ROUNDS);
        slice_subject_free(x);
    }
}

/* ---- The same bits ---- */

static bool same_bits(const double *a, const double *b, size_t count) {
    return memcmp(a, b, count * sizeof *a) == 0;
}

static void test_as_probed(void **state) {
    static double value[SLICE_PIXELS];
    static double points[SLICE_PIXELS][3];
    static leafcast_sample samples[SLICE_PIXELS];
    (void)state;
    for (int which = 0; which < 3; which++) {
        slice_subject *x = slice_subject_one(which);
        leafcast *v = fixture_open(x->path, NULL);
        field_random r = {7};
        const leafcast_slice_pixels s = slice_subject_slice(v, &r);
        (void)slice_subject_sample(v, &s, value);
        for (int i = 0; i < SLICE_PIXELS; i++)
            slice_subject_pixel(&s, i, points[i]);
        assert_int_equal(
            leafcast_sample_points(v, (const double(*)[3])points, SLICE_PIXELS, samples),
            LEAFCAST_OK);
        for (int i = 0; i < SLICE_PIXELS; i++) {
            leafcast_sample one;
            assert_int_equal(leafcast_probe_point(v, points[i], &one), LEAFCAST_OK);
            assert_int_equal(one.inside, samples[i].inside);
            assert_memory_equal(&one.gradient, &samples[i].gradient, sizeof one.gradient);
            assert_int_equal(one.cell, samples[i].cell);
            assert_true(same_bits(&one.value, &samples[i].value, 1));
            assert_true(same_bits(&one.value, &value[i], 1));
        }
        leafcast_close(v);
        slice_subject_free(x);
    }
}

/* A budget that is too small names one that will do. */
static uint64_t least_budget(const char *path, const leafcast_slice_pixels *s,
                             const leafcast_options *given) {
    static double value[SLICE_PIXELS];
    for (uint64_t budget = 1 << 14;; budget += budget / 8) {
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
    static double want[SLICE_PIXELS], got[SLICE_PIXELS];
    (void)state;
    for (int which = 0; which < 3; which++) {
        slice_subject *x = slice_subject_one(which);
        leafcast *v = fixture_open(x->path, NULL);
        field_random r = {9};
        const leafcast_slice_pixels s = slice_subject_slice(v, &r);
        (void)slice_subject_sample(v, &s, want);
        leafcast_close(v);
        for (int extra = -1; extra < (SLOW ? 3 : 6); extra++) {
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
            assert_true(st != LEAFCAST_OK || same_bits(want, got, SLICE_PIXELS));
            assert_true(stats.bytes_peak <= o.memory);
            leafcast_close(v);
        }
        slice_subject_free(x);
    }
}

/* Some rows at a time: the same bits, and no row besides. */
static void test_rows(void **state) {
    static double want[SLICE_PIXELS], got[SLICE_PIXELS + 1];
    (void)state;
    for (int which = 0; which < 3; which++) {
        slice_subject *x = slice_subject_one(which);
        leafcast *v = fixture_open(x->path, NULL);
        field_random r = {11};
        leafcast_slice_pixels s = slice_subject_slice(v, &r);
        (void)slice_subject_sample(v, &s, want);
        for (uint32_t step = SLOW ? 3 : 1; step <= SLICE_HEIGHT; step += step < 5 ? 1 : 14) {
            for (s.first_row = 0; s.first_row < SLICE_HEIGHT; s.first_row += step) {
                double *at = got + (size_t)s.first_row * SLICE_WIDTH;
                s.rows = SLICE_HEIGHT - s.first_row < step ? SLICE_HEIGHT - s.first_row : step;
                at[(size_t)s.rows * SLICE_WIDTH] = -77.0;
                (void)slice_subject_sample(v, &s, at);
                assert_true(at[(size_t)s.rows * SLICE_WIDTH] == -77.0);
            }
            assert_true(same_bits(want, got, SLICE_PIXELS));
        }
        leafcast_close(v);
        slice_subject_free(x);
    }
}

/* After a picture's turn, and before the next. */
static void test_between_pictures(void **state) {
    static double want[SLICE_PIXELS], got[SLICE_PIXELS], z[2][64 * 64];
    (void)state;
    slice_subject *x = slice_subject_of_field("sphere", NULL, 50, false);
    leafcast *free_one = fixture_open(x->path, NULL);
    field_random r = {11};
    const leafcast_slice_pixels s = slice_subject_slice(free_one, &r);
    (void)slice_subject_sample(free_one, &s, want);
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
                (void)slice_subject_sample(v, &s, got);
                assert_true(same_bits(want, got, SLICE_PIXELS));
            }
        }
        leafcast_frame_end(drawn);
    }
    assert_true(same_bits(z[0], z[1], sizeof z[0] / sizeof *z[0]));
    leafcast_close(v);
    slice_subject_free(x);
}

/* ---- What is read ---- */

/* Treelets of a grid with pixels in them; of a mesh those whose boxes hold a pixel and that come no
 * later than the tet at it. bytes: of the payloads; shells: and, once for each, of the shells that
 * they are in. */
static long cut_treelets(const slice_subject *x, const leafcast_slice_pixels *s, uint64_t *bytes,
                         uint64_t *shells) {
    static bool cut[1 << 16];
    const long treelets = x->mesh ? x->tets.treelets : x->grid.treelet_count;
    long count = 0;
    memset(cut, 0, sizeof cut);
    for (int i = 0; i < SLICE_PIXELS; i++) {
        double point[3];
        slice_subject_pixel(s, i, point);
        const naive_point truth = slice_subject_truth(x, (int)s->level, point);
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
    *bytes = *shells = 0;
    for (long t = 0; t < treelets; t++) {
        count += cut[t];
        if (!cut[t] || x->mesh)
            continue;
        const naive_treelet *g = &x->grid.treelets[t];
        *bytes += g->stored.size;
        *shells += g->parent < 0 ? 0 : x->grid.treelets[g->parent].shell.size;
    }
    return count;
}

static void test_treelets(void **state) {
    static double value[SLICE_PIXELS];
    (void)state;
    for (int which = 0; which < 3; which++) {
        slice_subject *x = slice_subject_one(which);
        field_random r = {13};
        for (int round = 0; round < (SLOW ? 2 : 6); round++) {
            const leafcast_options o = {.size = sizeof o,
                                        .threads = 2,
                                        .experiments = EXPERIMENTS(.treelet_limit = round % 2)};
            leafcast *v = fixture_open(x->path, &o);
            leafcast_slice_pixels s = slice_subject_slice(v, &r);
            s.level = (uint32_t)round / 2 % leafcast_describe(v).levels;
            uint64_t bytes, shells;
            const long cut = cut_treelets(x, &s, &bytes, &shells);
            const leafcast_stats stats = slice_subject_sample(v, &s, value);
            assert_int_equal(stats.treelets_active, cut);
            assert_int_equal(stats.treelets_loaded, cut); /* once, also one by one */
            if (!x->mesh)
                assert_in_range(stats.bytes_read, bytes, bytes + shells);
            assert_int_equal(stats.bytes_active > 0, stats.bytes_read > 0);
            if (round % 2 == 0)
                assert_int_equal(slice_subject_sample(v, &s, value).treelets_loaded, 0);
            leafcast_close(v);
        }
        slice_subject_free(x);
    }
}

/* Points in no order: each treelet is read once all the same. */
static void test_points_in_no_order(void **state) {
    enum { POINTS = SLOW ? 5000 : 20000 };
    static double points[POINTS][3];
    static leafcast_sample samples[POINTS];
    (void)state;
    slice_subject *x = slice_subject_one(0);
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
    slice_subject_free(x);
}

/* ---- What cannot be ---- */

static void refused(leafcast *v, const leafcast_slice_pixels *s, const char *said) {
    static double value[SLICE_PIXELS];
    assert_int_equal(leafcast_sample_slice(v, s, value, NULL, NULL, NULL), LEAFCAST_USAGE);
    if (!strstr(leafcast_error_text(), said))
        fail_msg("%s", leafcast_error_text());
}

static void test_refused(void **state) {
    static const double line[2][3] = {{1, 1, 1}, {1, 1, 1}}, odd[2][3] = {{1, 1, 1}, {2, NAN, 1}};
    (void)state;
    slice_subject *x = slice_subject_one(0);
    leafcast *v = fixture_open(x->path, NULL);
    leafcast_slice_pixels s = slice_subject_sized(4, 4), wrong;
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
    leafcast_slice_pixels layer = slice_subject_sized(0, 0);
    assert_int_equal(leafcast_layer_slice(v, 3, 0, &layer), LEAFCAST_USAGE);
    assert_int_equal(leafcast_layer_slice(v, 0, 1000, &layer), LEAFCAST_USAGE);
    leafcast_close(v);
    slice_subject_free(x);
    x = slice_subject_one(2);
    v = fixture_open(x->path, NULL);
    assert_int_equal(leafcast_layer_slice(v, 0, 0, &layer), LEAFCAST_USAGE);
    leafcast_close(v);
    slice_subject_free(x);
}

static bool stop_at_half(void *ctx, double done) {
    double *most = ctx;
    *most = done;
    return done < 0.5;
}

static void test_stopped(void **state) {
    static double value[SLICE_PIXELS];
    (void)state;
    slice_subject *x = slice_subject_one(0);
    const leafcast_options o = {
        .size = sizeof o, .threads = 2, .experiments = EXPERIMENTS(.treelet_limit = 1)};
    leafcast *v = fixture_open(x->path, &o);
    field_random r = {7};
    double most = 0.0;
    const leafcast_slice_pixels s = slice_subject_slice(v, &r);
    assert_int_equal(leafcast_sample_slice(v, &s, value, NULL, stop_at_half, &most),
                     LEAFCAST_STOPPED);
    assert_true(most >= 0.5 && most < 1.0);
    (void)slice_subject_sample(v, &s, value);
    leafcast_close(v);
    slice_subject_free(x);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_grids),     cmocka_unit_test(test_all_fields),
        cmocka_unit_test(test_turned),    cmocka_unit_test(test_meshes),
        cmocka_unit_test(test_as_probed), cmocka_unit_test(test_any_budget),
        cmocka_unit_test(test_rows),      cmocka_unit_test(test_between_pictures),
        cmocka_unit_test(test_treelets),  cmocka_unit_test(test_points_in_no_order),
        cmocka_unit_test(test_refused),   cmocka_unit_test(test_stopped),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
