/* test_transfer_colours.c - colours of transfer functions are doubles, whichever way they come in:
 * no bound counts what a float would round off, neither of 12345.678 nor of 1/10.
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <stdio.h>
#include <string.h>

#include "formats/leaf/histogram.h"
#include "render/app/colour_map.h"
#include "render/app/transfer_file.h"
#include "render/app/transfer_preset.h"
#include "render/look/picture_bytes.h"
#include "tests/support/medium_lab.h"
#include "tests/support/scratch.h"

static mem budget; /* of the tests */

/* ---- The ways in: each makes a list, and says which colour is at which value of it ---- */

typedef struct expected {
    double value, rgb[3];
} expected;

static void copy_points(const transfer_list *from, transfer_list *to) {
    for (size_t i = 0; i < from->count; i++)
        assert_int_equal(transfer_list_add(to, from->points[i]), ST_OK);
}

static void read_file(const char *name, const char *text, transfer_list *out) {
    transfer_file f = {0};
    assert_int_equal(transfer_file_read(&budget, scratch_text(name, text), &f), ST_OK);
    copy_points(&f.colours, out);
    transfer_file_release(&f);
}

static expected from_text(transfer_list *out) {
    read_file("c.txt", "0 0.1 0.7 12345.678 1\n1 0.1 0.7 12345.678 1\n", out);
    return (expected){0.0, {0.1, 0.7, 12345.678}};
}

static expected printed_again(transfer_list *out) {
    const leafcast_transfer_point p = {1.0 / 3.0, {0.1, 1e-39, 12345.678}, 1.0};
    transfer_file f = {0};
    const char *path = scratch_path("again.txt");
    FILE *file = fopen(path, "w");
    transfer_file_print(&p, 1, file);
    fclose(file);
    assert_int_equal(transfer_file_read(&budget, path, &f), ST_OK);
    copy_points(&f.colours, out);
    transfer_file_release(&f);
    return (expected){p.value, {p.rgb[0], p.rgb[1], p.rgb[2]}};
}

/* ParaView's are as a screen shows them. */
static expected from_json(transfer_list *out) {
    read_file("c.json", "[{\"ColorSpace\": \"RGB\", \"RGBPoints\": [0, 0.1, 0.2, 0.7]}]", out);
    return (expected){0.0, {picture_linear(0.1), picture_linear(0.2), picture_linear(0.7)}};
}

static expected from_xml(transfer_list *out) {
    read_file("c.xml", "<ColorMap space='RGB'><Point x='0' r='0.1' g='0.2' b='0.7'/></ColorMap>",
              out);
    return (expected){0.0, {picture_linear(0.1), picture_linear(0.2), picture_linear(0.7)}};
}

/* Viridis begins with #440154. */
static expected by_name(transfer_list *out) {
    assert_int_equal(colour_map_named("viridis", out), ST_OK);
    return (expected){
        0.0,
        {picture_linear(0x44 / 255.0), picture_linear(0x01 / 255.0), picture_linear(0x54 / 255.0)}};
}

/* The first row of `ct`. */
static expected by_preset(transfer_list *out) {
    const leafcast_histogram h = {
        .bins = 4, .end = 4, .edges = {0.0, 1.0, 2.0, 3.0, 4.0}, .samples = {90, 1, 30, 20}};
    transfer_list extinctions = {.m = &budget};
    assert_int_equal(transfer_preset_make("ct", &h, 1.0, out, &extinctions), ST_OK);
    transfer_list_release(&extinctions);
    return (expected){out->points[0].value, {0.40, 0.10, 0.05}};
}

/* Where extinctions have a point, and colours have none. */
static expected joined(transfer_list *out) {
    transfer_list colours = {.m = &budget}, extinctions = {.m = &budget};
    read_file("j.txt", "0 0.1 0 3 0\n3 0.8 1 12345.678 0\n", &colours);
    read_file("e.txt", "1 0 0 0 1\n", &extinctions);
    assert_int_equal(transfer_list_join(out, &colours, &extinctions, 1.0), ST_OK);
    const double s = (0.5 * 1.0 - 0.5 * 0.0) / (0.5 * 3.0 - 0.5 * 0.0);
    transfer_list_release(&colours);
    transfer_list_release(&extinctions);
    return (expected){1.0, {(1.0 - s) * 0.1 + s * 0.8, s, (1.0 - s) * 3.0 + s * 12345.678}};
}

static const struct {
    const char *name;
    expected (*make)(transfer_list *out);
} WAYS[] = {{"text", from_text},         {"printed", printed_again}, {"ParaView, JSON", from_json},
            {"ParaView, XML", from_xml}, {"a name", by_name},        {"a preset", by_preset},
            {"joined", joined}};

static void test_ways_in(void **state) {
    (void)state;
    for (size_t i = 0; i < sizeof WAYS / sizeof *WAYS; i++) {
        transfer_list t = {.m = &budget};
        const expected want = WAYS[i].make(&t);
        const leafcast_transfer_point p = transfer_list_at(&t, want.value, true);
        for (int c = 0; c < 3; c++)
            if (p.rgb[c] != want.rgb[c])
                fail_msg("%s, component %d: %a, not %a", WAYS[i].name, c, p.rgb[c], want.rgb[c]);
        transfer_list_release(&t);
    }
}

/* ---- The picture ---- */

enum { SIDE = 4 };

/* 2^3 samples of 0: a cube of size 1 before an orthographic camera, all of one colour. */
static void test_picture(void **state) {
    static const uint8_t samples[8] = {0};
    static const long dims[3] = {2, 2, 2};
    static const double rgb[3] = {0.1, 0.7, 12345.678};
    (void)state;
    medium_body b;
    medium_body_of_bytes(&b, "one", dims, samples);
    for (double asked = 1e-2; asked > 5e-10; asked *= 0.1) {
        const leafcast_transfer_point p = {.rgb = {rgb[0], rgb[1], rgb[2]}, .extinction = 2.0};
        const leafcast_medium medium = {&p, 1};
        double rgba[SIDE * SIDE][4], error[SIDE * SIDE];
        const leafcast_image image = {.size = sizeof image, .rgba = rgba[0], .error = error};
        leafcast_scene scene = leafcast_scene_default();
        const leafcast_camera camera = {.size = sizeof camera,
                                        .eye = {0.5, 0.5, -3.0},
                                        .look_at = {0.5, 0.5, 0.5},
                                        .up = {0.0, 1.0, 0.0},
                                        .width = SIDE,
                                        .height = SIDE,
                                        .ortho_height = 0.5};
        scene.background[3] = 0.0F;
        scene.media = &medium;
        scene.media_count = 1;
        scene.error = asked;
        assert_int_equal(leafcast_trace(b.volume, &scene, &camera, &image, NULL, NULL, NULL),
                         LEAFCAST_OK);
        for (int i = 0; i < SIDE * SIDE; i++)
            for (int c = 0; c < 3; c++) {
                const double off = fabs(rgba[i][c] - rgb[c] * -expm1(-2.0));
                if (!(off <= error[i]))
                    fail_msg("asked %g, component %d: off by %g, bound %g", asked, c, off,
                             error[i]);
            }
    }
    medium_body_release(&b);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_ways_in),
                                       cmocka_unit_test(test_picture)};
    mem_init(&budget, 0);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
