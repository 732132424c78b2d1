/* test_stepping.c - media in equal steps, by their middles and pre-integrated: the former against
 * the same sums over the reference's pieces in long double; the latter near to exact where the
 * value rises evenly; exact where the medium is constant; nearer to the certified picture, and as
 * fast as it ought to be, with smaller steps; the same bits however they are drawn; no error is
 * claimed.
 */
/* marks: threads, bits */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "formats/base/cpu.h"
#include "tests/support/fixture.h"
#include "tests/support/medium_lab.h"
#include "tests/support/pictures.h"
#include "tests/support/watched.h"

typedef long double real;

enum { WIDTH = 13, HEIGHT = 9, PIXELS = WIDTH * HEIGHT, PIECES_MAX = 4096, POINTS = 7 };

typedef struct shot {
    const medium_body *body;
    leafcast_transfer_point points[POINTS];
    leafcast_medium medium;
    leafcast_surface surface;
    leafcast_shown shown;
    leafcast_scene_experiments how;
    leafcast_scene scene;
    leafcast_camera camera;
    double rgba[PIXELS][4], error[PIXELS];
    leafcast_stats stats;
} shot;

/* The k-th point of the transfer function, `share` of the way through the values. */
static void put(shot *s, double share, double depth) {
    const transfer_range *of = &s->body->range;
    const int k = s->medium.count++;
    s->points[k] = (leafcast_transfer_point){.value = of->least + share * (of->most - of->least),
                                             .rgb = {0.2 + 0.1 * k, 1.0 - 0.1 * k, 0.5},
                                             .extinction = depth / of->length};
}

/* In steps that are no round number of cells, before a background. */
static void shot_begin(shot *s, const medium_body *b, int view) {
    field_random r = {(uint64_t)view + 11};
    *s = (shot){
        .body = b,
        .shown = {.volume = b->volume},
        .how = {.size = sizeof s->how, .summing = LEAFCAST_STEPS, .step = 0.37, .opaque = 1.0}};
    s->scene = leafcast_scene_default();
    s->camera = pictures_view(b->volume, view, &r);
    s->camera.width = WIDTH;
    s->camera.height = HEIGHT;
    for (int c = 0; c < 4; c++)
        s->scene.background[c] = 0.1F + 0.2F * (float)c;
}

static leafcast_status shot_draw(shot *s) {
    const leafcast_image image = {.size = sizeof image, .rgba = s->rgba[0], .error = s->error};
    s->stats.size = sizeof s->stats;
    s->medium.points = s->points;
    s->shown.volume = s->body->volume;
    s->scene.volumes = &s->shown;
    s->scene.volume_count = 1;
    s->scene.media = &s->medium;
    s->scene.media_count = 1;
    s->scene.experiments = &s->how;
    return leafcast_trace(s->body->volume, &s->scene, &s->camera, &image, &s->stats, NULL, NULL);
}

/* The certified picture; returns its own error. */
static double shot_certify(shot *s) {
    double most = 0.0;
    s->how.summing = LEAFCAST_CERTIFIED;
    s->scene.error = 1e-7;
    assert_int_equal(shot_draw(s), LEAFCAST_OK);
    for (int i = 0; i < PIXELS; i++)
        most = fmax(most, s->error[i]);
    return most;
}

static int body_named(const char *name) {
    for (int i = 0; i < medium_body_count(); i++)
        if (strcmp(medium_body_name(i), name) == 0)
            return i;
    fail_msg("no volume %s", name);
    return -1;
}

static double distance(const shot *a, const shot *b, double *rms) {
    double most = 0.0, sum = 0.0;
    for (int i = 0; i < PIXELS; i++)
        for (int c = 0; c < 4; c++) {
            const double off = fabs(a->rgba[i][c] - b->rgba[i][c]);
            most = off <= most ? most : off;
            sum += off * off;
        }
    *rms = sqrt(sum / (4.0 * PIXELS));
    return most;
}

/* ---- The same sums ---- */

/* Where the ray is in the volume's box. */
static bool cut(const leafcast_info *info, const ref_ray *ray, real *from, real *to) {
    *from = 0;
    *to = INFINITY;
    for (int a = 0; a < 3; a++) {
        real near = ((real)info->bounds[0][a] - ray->o[a]) / ray->d[a];
        real far = ((real)info->bounds[1][a] - ray->o[a]) / ray->d[a];
        *from = fmaxl(*from, fminl(near, far));
        *to = fminl(*to, fmaxl(near, far));
    }
    return *from < *to;
}

static void sum_up(const shot *s, int pixel, real rgba[4]) {
    static ref_piece pieces[PIECES_MAX];
    const leafcast_info info = leafcast_describe(s->body->volume);
    const ref_clip clip = {.t1 = INFINITY};
    const real step = (real)(s->how.step * info.cell_size);
    real from, to, through = 1;
    ref_ray ray;
    leafcast_pixel_ray(&s->camera, pixel % WIDTH + 0.5, pixel / WIDTH + 0.5, ray.o, ray.d);
    const size_t count = medium_body_pieces(s->body, &ray, &clip, pieces, PIECES_MAX);
    memset(rgba, 0, 4 * sizeof *rgba);
    const bool inside = cut(&info, &ray, &from, &to);
    for (long n = 0; inside && from + (real)n * step < to; n++) {
        const real begin = from + (real)n * step, end = fminl(begin + step, to),
                   at = (begin + end) / 2;
        for (size_t i = 0; i < count; i++) {
            if (!(at >= pieces[i].t0 && at < pieces[i].t1))
                continue;
            real rgb[3], k;
            ref_transfer(s->points, s->medium.count, ref_piece_at(pieces[i].k, at - pieces[i].t0),
                         rgb, &k);
            for (int c = 0; c < 3; c++)
                rgba[c] += through * rgb[c] * -expm1l(-k * (end - begin));
            through *= expl(-k * (end - begin));
            break;
        }
    }
    const real rest = through * (real)s->scene.background[3];
    for (int c = 0; c < 3; c++)
        rgba[c] += rest * (real)s->scene.background[c];
    rgba[3] = 1 - through + rest;
}

static void fill_smoothly(shot *s) {
    put(s, 0.1, 0.0);
    put(s, 0.25, 0.0);
    put(s, 0.4, 6.0);
    put(s, 0.55, 0.0);
    put(s, 0.7, 0.0);
    put(s, 1.0, 2.0);
}

static void test_sums(void **state) {
    static const char *const bodies[] = {"waves",       "noise-u8",   "rectilinear", "mirrored",
                                         "tets-sphere", "tets-noise", "tets-waves"};
    static shot s;
    (void)state;
    skip_under_thread();
    for (size_t n = 0; n < sizeof bodies / sizeof *bodies; n++) {
        medium_body b;
        double most = 0.0;
        medium_body_make(&b, body_named(bodies[n]), NULL);
        shot_begin(&s, &b, (int)n % 3); /* no rays in faces */
        fill_smoothly(&s);
        assert_int_equal(shot_draw(&s), LEAFCAST_OK);
        for (int i = 0; i < PIXELS; i += SLOW ? 5 : 1) {
            real want[4];
            sum_up(&s, i, want);
            for (int c = 0; c < 4; c++)
                most = fmax(most, fabs((double)(want[c] - (real)s.rgba[i][c])));
        }
        if (!(most < 1e-9))
            fail_msg("%s: %g off", bodies[n], most);
        medium_body_release(&b);
    }
}

/* ---- How far off they are ---- */

static const leafcast_summing ways[] = {LEAFCAST_STEPS, LEAFCAST_PREINTEGRATED};

static void test_constant(void **state) {
    static const char *const bodies[] = {"waves", "noise-u8", "rectilinear", "mirrored"};
    static const double steps[] = {40.0, 1.0, 0.3, 0.01};
    static shot want, got;
    double rms;
    (void)state;
    skip_under_thread();
    for (size_t n = 0; n < sizeof bodies / sizeof *bodies; n++) {
        medium_body b;
        medium_body_make(&b, body_named(bodies[n]), NULL);
        shot_begin(&want, &b, (int)n);
        put(&want, 0.3, 1.7);
        got = want;
        const double error = shot_certify(&want);
        assert_true(error <= 1e-7);
        for (size_t i = 0; i < 2 * sizeof steps / sizeof *steps; i++) {
            got.how.summing = ways[i % 2];
            got.how.step = steps[i / 2];
            assert_int_equal(shot_draw(&got), LEAFCAST_OK);
            const double most = distance(&want, &got, &rms);
            if (!(most < error + (i % 2 ? 1e-4 : 1e-12))) /* floats */
                fail_msg("%s, step %g: %g off", bodies[n], got.how.step, most);
        }
        medium_body_release(&b);
    }
}

/* A quarter of the step: in a grid, whose value has no jumps, about a sixteenth of the error; in a
 * mesh, whose box is not filled, at least much less than half of it. */
static void check_order(const medium_body *b, int view, leafcast_summing way, double less) {
    static shot want, coarse, fine;
    double first, second;
    shot_begin(&want, b, view);
    put(&want, 0.0, 0.5);
    put(&want, 1.0, 3.0);
    want.how.table = 512;
    coarse = fine = want;
    const double error = shot_certify(&want);
    coarse.how.summing = fine.how.summing = way;
    coarse.how.step = 0.4;
    fine.how.step = 0.1;
    assert_int_equal(shot_draw(&coarse), LEAFCAST_OK);
    assert_int_equal(shot_draw(&fine), LEAFCAST_OK);
    (void)distance(&want, &coarse, &first);
    (void)distance(&want, &fine, &second);
    print_message("%s: error %.3g, rms %.3g, %.3g\n", b->name, error, first, second);
    if (!(first > 3.0 * error && second < first / less))
        fail_msg("%s: rms %g, with a quarter of the step %g", b->name, first, second);
}

static void test_converges(void **state) {
    static const struct {
        const char *name;
        double less[2];
    } bodies[] = {{"waves", {10.0, 10.0}},
                  {"rectilinear", {10.0, 10.0}},
                  {"mirrored", {10.0, 10.0}},
                  {"tets-waves", {2.0, 8.0}},
                  {"tets-sphere", {2.0, 8.0}}};
    (void)state;
    skip_under_thread();
    for (size_t n = 0; n < sizeof bodies / sizeof *bodies; n++) {
        medium_body b;
        medium_body_make(&b, body_named(bodies[n].name), NULL);
        for (int way = 0; way < 2; way++)
            check_order(&b, (int)n % 2, ways[way], bodies[n].less[way]);
        medium_body_release(&b);
    }
}

/* In a step along which the value rises evenly, whatever it passes is in the table. */
static void test_even(void **state) {
    static shot want, got;
    double rms, stepped;
    medium_body b;
    (void)state;
    medium_body_make(&b, body_named("linear"), NULL);
    shot_begin(&want, &b, 0);
    fill_smoothly(&want);
    got = want;
    (void)shot_certify(&want);
    got.how.step = 5.0;
    got.how.table = 512;
    assert_int_equal(shot_draw(&got), LEAFCAST_OK);
    (void)distance(&want, &got, &stepped);
    got.how.summing = LEAFCAST_PREINTEGRATED;
    assert_int_equal(shot_draw(&got), LEAFCAST_OK);
    const double most = distance(&want, &got, &rms);
    print_message("linear: rms %.3g in steps, %.3g pre-integrated, worst %.3g\n", stepped, rms,
                  most);
    assert_true(most < 0.02 && rms < 0.1 * stepped);
    medium_body_release(&b);
}

/* Rays end at the opacity that was told: no further off than what is left. */
static void test_ends(void **state) {
    static shot all, some;
    double rms;
    medium_body b;
    (void)state;
    medium_body_make(&b, body_named("waves"), NULL);
    shot_begin(&all, &b, 0);
    put(&all, 0.0, 5.0);
    put(&all, 1.0, 40.0);
    some = all;
    some.how.opaque = 0.9;
    assert_int_equal(shot_draw(&all), LEAFCAST_OK);
    assert_int_equal(shot_draw(&some), LEAFCAST_OK);
    const double most = distance(&all, &some, &rms);
    assert_true(most > 1e-3 && most <= 0.1);
    medium_body_release(&b);
}

/* ---- The same bits ---- */

static void check_same(const shot *want, shot *got, const char *how) {
    assert_int_equal(shot_draw(got), LEAFCAST_OK);
    for (int i = 0; i < PIXELS; i++)
        if (memcmp(want->rgba[i], got->rgba[i], sizeof got->rgba[i]) != 0)
            fail_msg("%s, %s, pixel %d: %a %a %a %a, not %a %a %a %a", want->body->name, how, i,
                     got->rgba[i][0], got->rgba[i][1], got->rgba[i][2], got->rgba[i][3],
                     want->rgba[i][0], want->rgba[i][1], want->rgba[i][2], want->rgba[i][3]);
}

static void check_bits(medium_body *b, leafcast_summing way) {
    static shot want, got;
    const leafcast_options one = {.size = sizeof one, .isa = "scalar", .threads = 1};
    assert_int_equal(medium_body_reopen(b, &one), LEAFCAST_OK);
    shot_begin(&want, b, 1);
    fill_smoothly(&want);
    put(&want, 1.0, 0.5); /* a step at the end */
    want.how.summing = way;
    want.how.table = 40;
    got = want;
    assert_int_equal(shot_draw(&want), LEAFCAST_OK);
    for (int isa = 0; isa <= (int)cpu_best(); isa++)
        for (int threads = 1; threads <= 2; threads++) {
            const leafcast_options o = {
                .size = sizeof o, .isa = cpu_isa_name((cpu_isa)isa), .threads = threads};
            assert_int_equal(medium_body_reopen(b, &o), LEAFCAST_OK);
            check_same(&want, &got, o.isa);
        }
    const leafcast_experiments few = {.size = sizeof few, .treelet_limit = 1};
    const leafcast_options o = {.size = sizeof o, .threads = 2, .experiments = &few};
    assert_int_equal(medium_body_reopen(b, &o), LEAFCAST_OK);
    check_same(&want, &got, "a treelet at a time");
}

static void test_same_bits(void **state) {
    static const char *const bodies[] = {"noise-u8", "missing", "far", "tets-noise", "tets-holes"};
    (void)state;
    for (size_t n = 0; n < sizeof bodies / sizeof *bodies; n++) {
        medium_body b;
        medium_body_make(&b, body_named(bodies[n]), NULL);
        for (int way = 0; way < 2; way++)
            check_bits(&b, ways[way]);
        medium_body_release(&b);
    }
}

/* ---- What is said ---- */

static void refused(shot *s, const char *why) {
    assert_int_equal(shot_draw(s), LEAFCAST_USAGE);
    if (!strstr(leafcast_error_text(), why))
        fail_msg("\"%s\" does not say \"%s\"", leafcast_error_text(), why);
}

static void test_claims(void **state) {
    static const double wrong[] = {0.0, -1.0, 1e5, (double)NAN};
    static shot s;
    medium_body b;
    (void)state;
    medium_body_make(&b, body_named("waves"), NULL);
    shot_begin(&s, &b, 0);
    put(&s, 0.0, 1.0);
    assert_int_equal(shot_draw(&s), LEAFCAST_OK);
    assert_int_equal(s.stats.uncertified_pixels, PIXELS);
    for (int i = 0; i < PIXELS; i++)
        assert_true(isinf(s.error[i]) && s.error[i] > 0.0);
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        s.how.step = wrong[i];
        refused(&s, "experiments.step");
    }
    s.how.step = 1.0;
    s.how.opaque = 1.5;
    refused(&s, "experiments.opaque");
    s.how.opaque = 0.0;
    for (int table = 15; table < 4000; table += 2034) {
        s.how.table = table;
        refused(&s, "experiments.table");
    }
    s.how.table = 0;
    s.how.summing = (leafcast_summing)17;
    refused(&s, "experiments.summing");
    s.how.summing = LEAFCAST_STEPS;
    s.surface = leafcast_surface_default(b.field.iso);
    s.shown.surfaces = &s.surface;
    s.shown.count = 1;
    refused(&s, "without isosurfaces");
    medium_body_release(&b);
}

int main(int argc, char **argv) {
    if (argc == 2)
        cmocka_set_test_filter(argv[1]);
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_sums),      cmocka_unit_test(test_constant),
        cmocka_unit_test(test_converges), cmocka_unit_test(test_even),
        cmocka_unit_test(test_ends),      cmocka_unit_test(test_same_bits),
        cmocka_unit_test(test_claims)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
