/* test_medium_whole.c - nodes and treelets of a medium that are taken whole: what is seen of a
 * range of values is true of every way through it and keeps the rule of medium_whole.h; pictures of
 * a volume with quiet regions are within their bounds, for which fewer cells are visited and fewer
 * treelets are read.
 */
/* marks: threads */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "formats/base/cpu.h"
#include "render/medium/medium_whole.h"
#include "tests/support/fixture.h"
#include "tests/support/hostile_transfer.h"
#include "tests/support/ref_media.h"

typedef long double real;

/* ---- Ranges ---- */

enum { PARTS = 6, TRANSFERS = 60, RANGES = 300 };

typedef struct bench {
    mem m;
    leafcast_transfer_point points[HOSTILE_POINTS_MAX];
    leafcast_medium medium;
    transfer t;
    medium_whole_rule whole;
    medium_rule rule;
    transfer_range values;
    field_random random;
} bench;

static void bench_begin(bench *b, int kind, uint64_t seed) {
    static const float samples[2] = {-3.0f, 252.0f};
    *b = (bench){.random = {seed}};
    b->values = transfer_range_of(samples, 2, 100.0, &b->random);
    b->medium.points = b->points;
    b->medium.count = hostile_transfer(kind, &b->values, &b->random, b->points);
    mem_init(&b->m, 0);
    assert_int_equal(transfer_init(&b->t, &b->m, &b->medium), ST_OK);
    const double error = pow(10.0, field_random_in(&b->random, -4.0, -1.0));
    b->whole = (medium_whole_rule){.transfer = &b->t,
                                   .share = 0.5 * error,
                                   .per_length = 0.3 * error / b->values.length,
                                   .brightest = fmax(1.0, b->t.most_rgb)};
    b->rule = (medium_rule){
        .transfer = &b->t, .share = b->whole.share, .per_length = b->whole.per_length};
}

static void bench_end(bench *b) {
    transfer_release(&b->t, &b->m);
}

static void random_range(bench *b, bool integers, double range[2]) {
    field_random *r = &b->random;
    const double size = b->values.most - b->values.least;
    range[0] = b->values.least + size * field_random_unit(r);
    range[1] = range[0] + (b->values.most - range[0]) * pow(field_random_unit(r), 3.0);
    for (int i = 0; integers && i < 2; i++)
        range[i] = floor(range[i]);
}

/* Against a way on which the value jumps about in the range. */
static void check_truth(bench *b, const double range[2], double length, const medium_stretch *s) {
    real rgb[3] = {0}, through = 1;
    for (int i = 0; i < PARTS; i++) {
        const real part = (real)length / PARTS;
        real colour[3], k;
        double value = field_random_below(&b->random, 3) > 0
                           ? range[field_random_below(&b->random, 2)]
                           : range[0] + (range[1] - range[0]) * field_random_unit(&b->random);
        value = fmin(value, range[1]);
        ref_transfer(b->points, b->medium.count, value, colour, &k);
        for (int c = 0; c < 3; c++)
            rgb[c] += through * colour[c] * -expm1l(-k * part);
        through *= expl(-k * part);
    }
    assert_true(fabsl(through - s->through) <= s->through_error + 1e-290L);
    for (int c = 0; c < 3; c++)
        if (!(fabsl(rgb[c] - s->rgb[c]) <= s->rgb_error + 1e-290L)) /* denormal numbers */
            fail_msg("values %a to %a, length %a: light %.17Lg, not %.17g +- %.3g", range[0],
                     range[1], length, rgb[c], s->rgb[c], s->rgb_error);
}

/* What is spent is allowed, whatever the length. */
static void check_rule(const bench *b, const medium_stretch *s, double length) {
    const double spent = s->rgb_error + b->whole.brightest * s->through_error;
    const double rounding = 1e-13 * b->whole.brightest;
    assert_true(spent <=
                b->whole.share * (1.0 - s->through) + b->whole.per_length * length + rounding);
}

static void test_ranges(void **state) {
    (void)state;
    size_t wide = 0, refused = 0;
    for (int i = 0; i < TRANSFERS; i++) {
        bench b;
        bench_begin(&b, i % hostile_transfer_kinds(), (uint64_t)i);
        const double all[2] = {b.values.least, b.values.most};
        for (int n = 0; n < RANGES; n++) {
            const bool integers = n % 2;
            const homogeneous h = medium_whole(&b.whole, all, integers);
            double range[2];
            random_range(&b, integers, range);
            const double length = b.values.length * pow(10.0, field_random_in(&b.random, -6, 0));
            const medium_stretch s = medium_of_range(&b.rule, range, length);
            check_truth(&b, range, length, &s);
            if (homogeneous_holds(&h, range[0], range[1]))
                check_rule(&b, &s, length);
            wide += homogeneous_holds(&h, range[0], range[1]) && range[0] < range[1];
            refused += !homogeneous_holds(&h, range[0], range[1]);
            n += 9; /* the table is dear */
        }
        bench_end(&b);
    }
    assert_true(wide > 20 && refused > 20);
}

/* A plateau between two ramps: the ranges on it, and no other. */
static void test_plateau(void **state) {
    (void)state;
    const leafcast_transfer_point points[] = {{0.0, {0.0f, 0.0f, 0.0f}, 0.0},
                                              {50.0, {0.5f, 0.5f, 0.5f}, 0.1},
                                              {90.0, {0.5f, 0.5f, 0.5f}, 0.1},
                                              {255.0, {1.0f, 1.0f, 1.0f}, 1.0}};
    const leafcast_medium medium = {points, 4};
    const double all[2] = {0.0, 255.0};
    mem m;
    transfer t;
    mem_init(&m, 0);
    assert_int_equal(transfer_init(&t, &m, &medium), ST_OK);
    const medium_whole_rule rule = {&t, 1e-3, 1e-6, 1.0, 0.0};
    homogeneous h = medium_whole(&rule, all, true);
    for (int lo = 0; lo < 256; lo++)
        for (int hi = lo; hi < 256; hi++)
            assert_int_equal(homogeneous_holds(&h, lo, hi), lo == hi || (lo >= 50 && hi <= 90));
    homogeneous_except(&h, 70.0);
    assert_true(homogeneous_holds(&h, 50, 69) && homogeneous_holds(&h, 71, 90));
    assert_false(homogeneous_holds(&h, 50, 70) || homogeneous_holds(&h, 69, 71));
    transfer_release(&t, &m);
}

/* ---- Pictures ---- */

enum { NODES = 72, SIDE = 12, PIXELS = SIDE * SIDE, PIECES = 1024 };

/* Noise of a few values with a body in it. */
typedef struct scene {
    field f;
    ref_volume world;
    const char *path;
    leafcast_scene of;
    leafcast_camera camera;
    leafcast_medium medium;
    leafcast_scene_experiments experiments;
    double rgba[PIXELS][4], error[PIXELS];
    leafcast_stats stats;
} scene;

/* Nearly flat up to 12. */
static const leafcast_transfer_point quiet[] = {{0.0, {0.3f, 0.4f, 0.5f}, 0.0200},
                                                {12.0, {0.3f, 0.4f, 0.5f}, 0.0202},
                                                {60.0, {0.9f, 0.5f, 0.2f}, 0.1},
                                                {255.0, {0.9f, 0.9f, 0.8f}, 0.4}};

static bool in_body(const field *f, long i) {
    double square = 0.0;
    for (int a = 0; a < 3; a++) {
        const double at = (double)(i % f->dims[a]) - 0.4 * (double)f->dims[a];
        square += at * at;
        i /= f->dims[a];
    }
    return square < 0.04 * NODES * NODES;
}

static void scene_begin(scene *s) {
    *s = (scene){.medium = {quiet, 4}};
    assert_true(field_make(&s->f, "noise-u8", NODES, FIELD_SEED));
    const field *f = &s->f;
    for (long i = 0; i < f->dims[0] * f->dims[1] * f->dims[2]; i++)
        f->samples[i] =
            in_body(f, i) ? 100.0f + floorf(f->samples[i] / 2.0f) : floorf(f->samples[i] / 24.0f);
    s->world = field_volume(f);
    s->path = fixture_leaf(f, 4, 1, false);
    s->of = leafcast_scene_default();
    s->of.media = &s->medium;
    s->of.media_count = 1;
    s->of.experiments = &s->experiments;
    s->of.background[1] = 0.7f;
    s->of.background[3] = 1.0f;
    s->experiments.size = sizeof s->experiments;
}

static void scene_end(scene *s) {
    field_release(&s->f);
}

static void draw(scene *s, const leafcast_options *options, const leafcast_surface *surface) {
    leafcast *v = fixture_open(s->path, options);
    const leafcast_shown shown = {.volume = v, .surfaces = surface, .count = surface != NULL};
    const leafcast_image image = {.size = sizeof image, .rgba = s->rgba[0], .error = s->error};
    s->of.volumes = &shown;
    s->of.volume_count = 1;
    s->camera = leafcast_standard_view(v, 1.3, SIDE, SIDE);
    s->stats = (leafcast_stats){.size = sizeof s->stats};
    assert_int_equal(leafcast_trace(v, &s->of, &s->camera, &image, &s->stats, NULL, NULL),
                     LEAFCAST_OK);
    leafcast_close(v);
}

/* Every pixel is within its bound; returns the greatest bound. */
static double check_picture(const scene *s) {
    static ref_piece pieces[PIECES];
    double most = 0.0;
    for (int i = 0; i < PIXELS; i++) {
        ref_ray r;
        leafcast_pixel_ray(&s->camera, i % SIDE + 0.5, i / SIDE + 0.5, r.o, r.d);
        const size_t count = ref_grid_pieces(&s->world, &r, NULL, pieces, PIECES);
        const ref_medium of = {pieces, count, quiet, 4};
        ref_media m = {.of = &of, .count = 1};
        memcpy(m.background, s->of.background, sizeof m.background);
        const ref_colour truth = ref_media_colour(&m);
        real off = fabsl(s->rgba[i][3] - truth.alpha);
        for (int c = 0; c < 3; c++)
            off = fmaxl(off, fabsl(s->rgba[i][c] - truth.rgb[c]));
        if (!(off <= s->error[i]))
            fail_msg("pixel %d is off by %.3Lg, its bound is %.3g", i, off, s->error[i]);
        most = fmax(most, s->error[i]);
    }
    return most;
}

/* Whatever the error that is asked for; and the more it is, the more is taken whole. */
static void test_quiet_regions(void **state) {
    (void)state;
    static scene s;
    leafcast_stats stats[3];
    scene_begin(&s);
    for (int i = 0; i < 3; i++) {
        s.of.error = i < 2 ? 1.0 / 510.0 : 1.0 / 16.0;
        s.experiments.homogeneous =
            i == 0 ? 1e-300 : 0.0; /* then nothing is but what is constant */
        draw(&s, NULL, NULL);
        assert_true(check_picture(&s) <= s.of.error);
        assert_int_equal(s.stats.uncertified_pixels, 0);
        stats[i] = s.stats;
    }
    assert_true(stats[1].cells <= stats[0].cells);
    assert_true(stats[2].cells < stats[1].cells / 3);
    assert_true(stats[2].treelets_loaded < stats[1].treelets_loaded / 2);
    assert_true(stats[2].bytes_read < stats[1].bytes_read / 2);
    assert_true(stats[2].treelets_active < stats[1].treelets_active);
    scene_end(&s);
}

/* In treelets that are not quiet as a whole, but seven eighths of which are. */
static void test_quiet_nodes(void **state) {
    (void)state;
    static scene s;
    leafcast_stats stats[2];
    scene_begin(&s);
    const long *n = s.f.dims;
    for (long z = 4; z < n[2]; z += 16)
        for (long y = 4; y < n[1]; y += 16)
            for (long x = 4; x < n[0]; x += 16)
                s.f.samples[(z * n[1] + y) * n[0] + x] = 200.0f;
    s.path = fixture_leaf(&s.f, 4, 1, false);
    s.of.error = 1.0 / 16.0;
    for (int i = 0; i < 2; i++) {
        s.experiments.homogeneous = i == 0 ? 1e-300 : 0.0;
        draw(&s, NULL, NULL);
        assert_true(check_picture(&s) <= s.of.error);
        stats[i] = s.stats;
    }
    assert_true(stats[1].cells < stats[0].cells / 2);
    assert_true(stats[1].treelets_loaded > stats[0].treelets_loaded / 2);
    scene_end(&s);
}

/* M08's threshold promises nothing; but it is said what comes of it. */
static void test_threshold(void **state) {
    (void)state;
    static scene s;
    uint64_t cells = UINT64_MAX;
    scene_begin(&s);
    for (int i = 0; i < 3; i++) {
        s.experiments.homogeneous = i == 0 ? 4.0 : i == 1 ? 12.0 : 300.0;
        draw(&s, NULL, NULL);
        const double most = check_picture(&s);
        assert_true(s.stats.cells < cells);
        assert_int_equal(most > 1.0 / 510.0, s.stats.uncertified_pixels > 0);
        cells = s.stats.cells;
    }
    assert_true(s.stats.uncertified_pixels > 0);
    assert_int_equal(s.stats.treelets_loaded, 0);
    s.experiments.homogeneous = -1.0;
    leafcast *v = fixture_open(s.path, NULL);
    const leafcast_image image = {.size = sizeof image, .rgba = s.rgba[0]};
    s.of.volume_count = 0;
    assert_int_equal(leafcast_trace(v, &s.of, &s.camera, &image, &s.stats, NULL, NULL),
                     LEAFCAST_USAGE);
    leafcast_close(v);
    scene_end(&s);
}

/* The same bits, whatever the kernels, the threads, the memory; also with a surface and a clip. */
static void test_bits(void **state) {
    (void)state;
    static scene s, other;
    const leafcast_surface surface = leafcast_surface_default(80.0);
    scene_begin(&s);
    s.of.error = 1.0 / 16.0;
    s.of.clip_plane_count = 1;
    memcpy(s.of.clip_planes[0], (const double[4]){1.0, 0.3, 0.0, -0.3 * NODES}, 4 * sizeof(double));
    for (int with = 0; with < 2; with++) {
        draw(&s, NULL, with ? &surface : NULL);
        for (int isa = 0; isa <= (int)cpu_best(); isa++) {
            const leafcast_options o = {.size = sizeof o,
                                        .isa = cpu_isa_name((cpu_isa)isa),
                                        .threads = 1 + isa % 3,
                                        .experiments = EXPERIMENTS(.treelet_limit = with ? 2 : 0)};
            other = s;
            other.of.media = &other.medium;
            other.of.experiments = &other.experiments;
            draw(&other, &o, with ? &surface : NULL);
            assert_memory_equal(other.rgba, s.rgba, sizeof s.rgba);
            assert_memory_equal(other.error, s.error, sizeof s.error);
        }
    }
    scene_end(&s);
}

/* A surface is where it is, also at a value of what is quiet. */
static void test_surfaces(void **state) {
    (void)state;
    static scene s, closely;
    leafcast_surface surface = leafcast_surface_default(5.5);
    surface.opacity = 0.1f;
    scene_begin(&s);
    s.of.error = 1.0 / 16.0;
    for (int i = 0; i < 2; i++) {
        surface.isovalue = i ? 5.5 : 80.0;
        closely = s;
        closely.of.media = &closely.medium;
        closely.of.experiments = &closely.experiments;
        closely.experiments.homogeneous = 1e-300;
        draw(&s, NULL, &surface);
        draw(&closely, NULL, &surface);
        assert_true(s.stats.covered_pixels > 0);
        assert_true(i == 1 || s.stats.cells < closely.stats.cells / 2);
        for (int k = 0; k < PIXELS; k++)
            for (int c = 0; c < 4; c++)
                assert_true(fabs(s.rgba[k][c] - closely.rgba[k][c]) <=
                            s.error[k] + closely.error[k]);
    }
    scene_end(&s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_ranges),        cmocka_unit_test(test_plateau),
        cmocka_unit_test(test_quiet_regions), cmocka_unit_test(test_threshold),
        cmocka_unit_test(test_quiet_nodes),   cmocka_unit_test(test_bits),
        cmocka_unit_test(test_surfaces),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
