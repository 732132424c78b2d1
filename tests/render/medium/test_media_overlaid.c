/* test_media_overlaid.c - several media at one place: extinctions add, and so does what is emitted.
 * Every channel of every pixel is within its own bound of the reference.
 *
 *   test_media_overlaid                        LEAFCAST_STRESS (1) pictures of each pair and kind
 *   test_media_overlaid NAME                   one of the tests below; * is any text
 *   test_media_overlaid VOLUME KIND SEED       one picture, every pixel; VOLUME is the first one
 */
/* marks: threads, long */
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

enum { EVERY = WATCHED ? 27 : 3, FIRST_BITS = WATCHED ? 0 : 2, EVERY_BITS = WATCHED ? 99 : 11 };

static const char *program;

static uint64_t number_of(const char *name) {
    const char *text = getenv(name);
    return text ? strtoull(text, NULL, 10) : 1;
}

/* ---- Pairs of hostile volumes ---- */

/* Two bodies on one device. */
typedef struct pair {
    leafcast_device *device;
    medium_body of[2];
} pair;

static void pair_make(pair *p, int index, const leafcast_options *device) {
    const int second = (index * 7 + 3) % medium_body_count();
    assert_int_equal(leafcast_device_create(device, &p->device), LEAFCAST_OK);
    const leafcast_options o = {.size = sizeof o, .device = p->device};
    medium_body_make(&p->of[0], index, &o);
    medium_body_make(&p->of[1], second, &o);
}

/* On another device. Its memory may be too little. */
static leafcast_status pair_reopen(pair *p, const leafcast_options *device) {
    leafcast_device *d;
    assert_int_equal(leafcast_device_create(device, &d), LEAFCAST_OK);
    const leafcast_options o = {.size = sizeof o, .device = d};
    leafcast_status st = medium_body_reopen(&p->of[0], &o);
    if (st == LEAFCAST_OK)
        st = medium_body_reopen(&p->of[1], &o);
    leafcast_device_destroy(p->device);
    p->device = d;
    return st;
}

static void pair_release(pair *p) {
    medium_body_release(&p->of[0]);
    medium_body_release(&p->of[1]);
    leafcast_device_destroy(p->device);
}

static medium_job job_of(const pair *p, int kind, uint64_t seed, bool tell_all) {
    return (medium_job){&p->of[0], &p->of[1], kind, seed, program, tell_all};
}

/* Mutants need not do more than be found out. */
static void stop_at(const medium_tally *t) {
    if (medium_tally_faults(t) > 0 && getenv("LEAFCAST_STRESS_STOP"))
        exit(1);
}

static void check_pair(int index, medium_tally *all) {
    pair p;
    medium_tally t = {0};
    pair_make(&p, index, NULL);
    for (int kind = 0; kind < hostile_transfer_kinds(); kind++)
        for (uint64_t i = 0; i < number_of("LEAFCAST_STRESS"); i++) {
            const uint64_t seed = (number_of("LEAFCAST_SEED") + i) * 1000 + (uint64_t)kind;
            const medium_job job = job_of(&p, kind, seed, false);
            medium_lab_draw(&job, &t);
            stop_at(&t);
        }
    medium_tally_print(p.of[0].name, p.of[1].name, &t);
    medium_tally_add(all, &t);
    pair_release(&p);
}

static void test_within_the_bound(void **state) {
    (void)state;
    skip_under_thread();
    medium_tally all = {0};
    for (int i = 0; i < medium_body_count(); i += EVERY)
        check_pair(i, &all);
    medium_tally_print("all", "all", &all);
    if (medium_tally_faults(&all) > 0)
        fail_msg("%llu faults", (unsigned long long)medium_tally_faults(&all));
    assert_true(all.seen > all.rays / 4);
    assert_true(all.grazing < all.rays / 50);
    assert_true(all.worst > 0.01);
}

/* ---- The same bits ---- */

/* Whether there was memory for it. */
static bool draw_with(pair *p, const leafcast_options *o, int kind, medium_planes *planes) {
    leafcast_status st = pair_reopen(p, o);
    const medium_job job = job_of(p, kind, 7, false);
    if (st == LEAFCAST_OK)
        st = medium_lab_planes(&job, planes);
    assert_true(st == LEAFCAST_OK || st == LEAFCAST_NOMEM);
    return st == LEAFCAST_OK;
}

static void check_same(const medium_planes *want, const medium_planes *got, const char *how) {
    for (int i = 0; i < MEDIUM_PIXELS; i++)
        if (memcmp(want->rgba[i], got->rgba[i], sizeof got->rgba[i]) != 0 ||
            memcmp(&want->error[i], &got->error[i], sizeof got->error[i]) != 0)
            fail_msg("%s, pixel %d: %a %a, not %a %a", how, i, got->rgba[i][0], got->rgba[i][3],
                     want->rgba[i][0], want->rgba[i][3]);
}

/* Whatever the threads, the kernels, the memory. */
static void check_bits(int index) {
    static medium_planes want, got;
    pair p;
    const int kind = index % hostile_transfer_kinds();
    leafcast_options o = {.size = sizeof o, .isa = "scalar", .threads = 1};
    pair_make(&p, index, NULL);
    assert_true(draw_with(&p, &o, kind, &want));
    o = (leafcast_options){.size = sizeof o, .isa = cpu_isa_name(cpu_best()), .threads = 2};
    assert_true(draw_with(&p, &o, kind, &got));
    check_same(&want, &got, "two threads");
    int budgets = 0;
    for (o.memory = 64 << 20; budgets < (WATCHED ? 2 : 99) && draw_with(&p, &o, kind, &got);
         o.memory /= 2, budgets++)
        check_same(&want, &got, "little memory");
    assert_true(budgets > 1);
    pair_release(&p);
}

static void test_same_bits(void **state) {
    (void)state;
    for (int i = FIRST_BITS; i < medium_body_count(); i += EVERY_BITS)
        check_bits(i);
}

/* ---- What can be worked out by hand ---- */

/* A box of n^3 nodes with its lower corner at (0, 0, z), everywhere of value 1 but for its first
 * sample, which makes it no empty file. */
static leafcast *box_at(double z, const leafcast_options *o) {
    field f;
    assert_true(field_make(&f, "linear", 12, 1));
    const size_t count = (size_t)(f.dims[0] * f.dims[1] * f.dims[2]);
    for (size_t i = 0; i < count; i++)
        f.samples[i] = i == 0 ? 0.0F : 1.0F;
    f.type = "f32";
    f.origin[2] = z;
    leafcast *v = fixture_open(fixture_leaf(&f, 4, 1, false), o);
    field_release(&f);
    return v;
}

/* A constant medium: what two of them make of a length. */
typedef struct constant {
    double rgb[3], k;
} constant;

static void look_through(const constant of[], int count, double length, double seen[4]) {
    double k = 0.0, q[3] = {0.0};
    for (int i = 0; i < count; i++) {
        k += of[i].k;
        for (int c = 0; c < 3; c++)
            q[c] += of[i].rgb[c] * of[i].k;
    }
    const double through = exp(-k * length);
    for (int c = 0; c < 3; c++)
        seen[c] += seen[3] * q[c] / k * (1.0 - through);
    seen[3] *= through;
}

/* Two boxes that overlap by a part, looked at along z. */
static void test_two_constant_boxes(void **state) {
    (void)state;
    enum { PIXELS = 9 };
    double rgba[PIXELS][4], error[PIXELS];
    const constant of[2] = {{{0.9, 0.2, 0.1}, 0.07}, {{0.1, 0.3, 0.8}, 0.2}};
    leafcast_transfer_point points[2];
    leafcast_medium media[2];
    leafcast_shown shown[2] = {{0}};
    leafcast_device *device;
    leafcast_scene scene = leafcast_scene_default();
    assert_int_equal(leafcast_device_create(NULL, &device), LEAFCAST_OK);
    const leafcast_options o = {.size = sizeof o, .device = device};
    for (int i = 0; i < 2; i++) {
        points[i] = (leafcast_transfer_point){.value = 0.0, .extinction = of[i].k};
        for (int c = 0; c < 3; c++)
            points[i].rgb[c] = of[i].rgb[c];
        media[i] = (leafcast_medium){&points[i], 1};
        shown[i].volume = box_at(5.5 * i, &o);
    }
    const leafcast_info info = leafcast_describe(shown[0].volume);
    const double length = info.bounds[1][2] - info.bounds[0][2];
    field_random r = {1};
    leafcast_camera camera = pictures_view(shown[0].volume, 0, &r);
    for (int a = 0; a < 3; a++)
        camera.look_at[a] = camera.eye[a] = 0.5 * (info.bounds[0][a] + info.bounds[1][a]);
    camera.eye[2] = info.bounds[0][2] - 30.0;
    camera.up[0] = 0.0;
    camera.up[1] = 1.0;
    camera.up[2] = 0.0;
    camera.ortho_height = 3.0;
    camera.width = camera.height = 3;
    scene.volumes = shown;
    scene.volume_count = scene.media_count = 2;
    scene.media = media;
    scene.error = 1e-7;
    const leafcast_image image = {.size = sizeof image, .rgba = rgba[0], .error = error};
    assert_int_equal(leafcast_trace(shown[0].volume, &scene, &camera, &image, NULL, NULL, NULL),
                     LEAFCAST_OK);
    double want[4] = {0.0, 0.0, 0.0, 1.0};
    look_through(&of[0], 1, 5.5, want);
    look_through(of, 2, length - 5.5, want);
    look_through(&of[1], 1, 5.5, want);
    want[3] = 1.0 - want[3];
    for (int i = 0; i < PIXELS; i++) {
        assert_true(error[i] <= 1e-7);
        for (int c = 0; c < 4; c++)
            assert_true(fabs(rgba[i][c] - want[c]) <= error[i]);
    }
    leafcast_close(shown[0].volume);
    leafcast_close(shown[1].volume);
    leafcast_device_destroy(device);
}

/* ---- */

static int rerun(char **argv) {
    for (int i = 0; i < medium_body_count(); i++) {
        if (strcmp(medium_body_name(i), argv[0]) != 0)
            continue;
        pair p;
        medium_tally t = {0};
        pair_make(&p, i, NULL);
        const medium_job job = job_of(&p, atoi(argv[1]), strtoull(argv[2], NULL, 10), true);
        medium_lab_draw(&job, &t);
        medium_tally_print(p.of[0].name, p.of[1].name, &t);
        pair_release(&p);
        return medium_tally_faults(&t) > 0;
    }
    return 2;
}

int main(int argc, char **argv) {
    program = argv[0];
    if (argc == 4)
        return rerun(argv + 1);
    if (argc == 2)
        cmocka_set_test_filter(argv[1]);
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_two_constant_boxes),
                                       cmocka_unit_test(test_within_the_bound),
                                       cmocka_unit_test(test_same_bits)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
