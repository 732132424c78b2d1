/* test_medium_options.c - presets from histograms, the legend's pixels, media in lines of a script.
 */
/* marks: bits */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "render/app/legend.h"
#include "render/app/render_script.h"
#include "render/app/transfer_preset.h"

static mem budget; /* of the tests */
static const char *const PRESETS[] = {"auto", "ct", "mr"};

/* ---- Presets ---- */

/* Bins of width 1 from 0 on. */
static leafcast_histogram histogram_of(const uint32_t *samples, uint32_t bins) {
    leafcast_histogram h = {.bins = bins, .end = bins, .aside = (double)NAN};
    for (uint32_t i = 0; i <= bins; i++)
        h.edges[i] = i;
    for (uint32_t i = 0; i < bins; i++) {
        h.samples[i] = samples[i];
        h.drawn += samples[i];
    }
    return h;
}

static void make(const char *name, const leafcast_histogram *h, double length,
                 transfer_list *colours, transfer_list *extinctions) {
    *colours = *extinctions = (transfer_list){.m = &budget};
    assert_int_equal(transfer_preset_make(name, h, length, colours, extinctions), ST_OK);
    for (size_t i = 0; i < extinctions->count; i++) {
        assert_true(isfinite(extinctions->points[i].extinction));
        assert_true(extinctions->points[i].extinction >= 0.0);
        assert_true(i == 0 || extinctions->points[i - 1].value <= extinctions->points[i].value);
    }
    for (size_t i = 1; i < colours->count; i++)
        assert_true(colours->points[i - 1].value <= colours->points[i].value);
}

/* Sum over the samples: what a way as long as `length` swallows on average. */
static double depth_of(const leafcast_histogram *h, const transfer_list *t, double length) {
    double sum = 0.0;
    for (uint32_t i = 0; i < h->bins; i++)
        sum += h->samples[i] * transfer_list_at(t, i + 0.5, true).extinction;
    return sum / (double)h->drawn * length;
}

/* A background, tissue, bone: each is told from the others, wherever they lie. */
static void test_three_kinds(void **state) {
    (void)state;
    const double depths[] = {2.0, 4.0, 3.0};
    uint32_t samples[100] = {0};
    for (int i = 0; i < 10; i++) {
        samples[i] = 6000;
        samples[40 + i] = 3000;
        samples[85 + i] = 500;
    }
    const leafcast_histogram h = histogram_of(samples, 100);
    for (int k = 0; k < 3; k++) {
        transfer_list c, e;
        make(PRESETS[k], &h, 7.0, &c, &e);
        assert_true(transfer_list_at(&e, 9.5, true).extinction == 0.0);
        assert_true(e.points[0].value >= 10.0 && e.points[0].value <= 40.0);
        assert_true(transfer_list_at(&e, 45.0, true).extinction > 0.0);
        assert_true(transfer_list_at(&e, 90.0, true).extinction >
                    2.0 * transfer_list_at(&e, 45.0, true).extinction);
        if (!(fabs(depth_of(&h, &e, 7.0) - depths[k]) < 1e-9))
            fail_msg("%s: a depth of %g, not %g", PRESETS[k], depth_of(&h, &e, 7.0), depths[k]);
        transfer_list_release(&c);
        transfer_list_release(&e);
    }
    transfer_list c, e;
    make("ct", &h, 7.0, &c, &e);
    assert_true(e.points[2].value >= 50.0 && e.points[2].value <= 85.0); /* where bone begins */
    transfer_list_release(&c);
    transfer_list_release(&e);
}

/* No value, one value, one value in a million, no length. */
static void test_odd_histograms(void **state) {
    (void)state;
    uint32_t one[1] = {5}, sparse[100] = {1000000};
    sparse[99] = 1;
    const leafcast_histogram odd[] = {{.bins = 0}, histogram_of(one, 1), histogram_of(sparse, 100)};
    for (int k = 0; k < 9; k++) {
        transfer_list c, e;
        make(PRESETS[k % 3], &odd[k / 3], 2.0, &c, &e);
        assert_true(c.count > 0 && e.count > 0);
        /* Nearly all on a 500th of the way at most. */
        for (size_t i = 0; i < e.count; i++)
            assert_true(e.points[i].extinction * 2.0 <= 2500.0 * 1.0000001);
        transfer_list_release(&c);
        transfer_list_release(&e);
        make(PRESETS[k % 3], &odd[k / 3], 0.0, &c, &e);
        for (size_t i = 0; i < e.count; i++)
            assert_true(e.points[i].extinction == 0.0);
        transfer_list_release(&c);
        transfer_list_release(&e);
    }
}

/* Beside a value that may stand for missing data, however much of it there is: the same functions.
 */
static void test_aside(void **state) {
    (void)state;
    uint32_t samples[50];
    for (int i = 0; i < 50; i++)
        samples[i] = (uint32_t)(1000 / (1 + i % 17));
    const leafcast_histogram plain = histogram_of(samples, 50);
    leafcast_histogram beside = plain;
    beside.bins = 52;
    beside.first = 2;
    beside.end = 52;
    beside.aside = beside.edges[0] = -9999.0;
    beside.edges[1] = nextafter(-9999.0, 0.0);
    memcpy(beside.edges + 2, plain.edges, 51 * sizeof *plain.edges);
    memcpy(beside.samples + 2, plain.samples, 50 * sizeof *plain.samples);
    beside.samples[0] = 1000000;
    beside.samples[1] = 0;
    for (int k = 0; k < 3; k++) {
        transfer_list c, e, d, f;
        make(PRESETS[k], &plain, 3.0, &c, &e);
        make(PRESETS[k], &beside, 3.0, &d, &f);
        assert_int_equal(c.count, d.count);
        assert_int_equal(e.count, f.count);
        for (size_t i = 0; i < e.count; i++)
            assert_true(e.points[i].value == f.points[i].value &&
                        e.points[i].extinction == f.points[i].extinction);
        transfer_list_release(&c);
        transfer_list_release(&d);
        transfer_list_release(&e);
        transfer_list_release(&f);
    }
}

/* The same histogram elsewhere gives the same function there. */
static void test_moved(void **state) {
    (void)state;
    uint32_t samples[200];
    srand48(4);
    for (int i = 0; i < 200; i++)
        samples[i] = (uint32_t)(drand48() * 1000 * exp(-i / 40.0)) + 1;
    const leafcast_histogram h = histogram_of(samples, 200);
    leafcast_histogram moved = h;
    for (uint32_t i = 0; i <= h.bins; i++)
        moved.edges[i] = 1048576.0 + 0.25 * h.edges[i];
    for (int k = 0; k < 3; k++) {
        transfer_list c, e, d, f;
        make(PRESETS[k], &h, 3.0, &c, &e);
        make(PRESETS[k], &moved, 3.0, &d, &f);
        assert_true(e.count == f.count && c.count == d.count);
        for (size_t i = 0; i < e.count; i++) {
            assert_true(fabs(1048576.0 + 0.25 * e.points[i].value - f.points[i].value) < 1e-6);
            assert_true(fabs(e.points[i].extinction - f.points[i].extinction) <
                        1e-6 * (1.0 + e.points[i].extinction));
        }
        transfer_list_release(&c);
        transfer_list_release(&d);
        transfer_list_release(&e);
        transfer_list_release(&f);
    }
}

static void test_names(void **state) {
    (void)state;
    char names[64] = "";
    for (int k = 0; k < 3; k++) {
        assert_true(transfer_preset_is(PRESETS[k]));
        strcat(strcat(names, k ? "|" : ""), PRESETS[k]);
    }
    assert_string_equal(names, transfer_preset_names());
    assert_false(transfer_preset_is("CT"));
}

/* ---- The legend ---- */

enum { WIDE = 200, HIGH = 150 };
static float planes[4][WIDE * HIGH];

static void clear_planes(void) {
    for (int c = 0; c < 4; c++)
        for (int i = 0; i < WIDE * HIGH; i++)
            planes[c][i] = 0.25f;
}

static const leafcast_transfer_point RAMP[] = {{-2.0, {0.0f, 0.5f, 1.0f}, 0.0},
                                               {6.0, {1.0f, 0.5f, 0.0f}, 0.0}};
static const transfer_list BAR = {.points = (leafcast_transfer_point *)RAMP, .count = 2};

/* Red rises from below to above by as much a row, in a bar half as high as the picture. */
static void test_bar(void **state) {
    (void)state;
    const leafcast_image image = {.r = planes[0], .g = planes[1], .b = planes[2], .a = planes[3]};
    clear_planes();
    legend_draw(&image, WIDE, HIGH, &BAR, (const double[2]){-2.0, 6.0}, "", NULL);
    int x = WIDE - 1, rows = 0;
    while (x > 0 &&
           !(planes[1][HIGH / 2 * WIDE + x] == 0.5f && planes[3][HIGH / 2 * WIDE + x] == 1.0f))
        x--;
    assert_true(x > WIDE - 20);
    float before = 2.0f;
    for (int y = 0; y < HIGH; y++) {
        const int at = y * WIDE + x;
        if (planes[1][at] != 0.5f)
            continue;
        rows++;
        assert_true(planes[0][at] < before && fabsf(planes[0][at] + planes[2][at] - 1.0f) < 1e-6f);
        before = planes[0][at];
    }
    assert_int_equal(rows, HIGH / 2);
    assert_true(fabsf(before - 0.5f / (float)rows) < 1e-6f);
    /* Left of the frame all is as it was; the values beside the bar are white. */
    int white = 0;
    for (int i = 0; i < WIDE * HIGH; i++) {
        if (i % WIDE < WIDE / 2)
            assert_true(planes[0][i] == 0.25f);
        white += planes[0][i] == 1.0f && planes[1][i] == 1.0f && planes[2][i] == 1.0f;
    }
    assert_int_equal(white, 3 + 15 + 15 + 15); /* dots of "-2", "2", "6" */
}

/* Planes that are not there are left out, and a picture too small stays as it was. */
static void test_no_room(void **state) {
    (void)state;
    const leafcast_image image = {.r = planes[0], .g = planes[1], .b = planes[2], .a = planes[3]};
    const leafcast_image opaque = {.r = planes[0], .g = planes[1], .b = planes[2]};
    static float before[4][WIDE * HIGH];
    clear_planes();
    memcpy(before, planes, sizeof planes);
    for (uint32_t w = 1; w < 30; w++)
        legend_draw(&image, w, 30, &BAR, (const double[2]){-2.0, 6.0}, "", NULL);
    legend_draw(&image, WIDE, 20, &BAR, (const double[2]){-2.0, 6.0}, "", NULL);
    legend_draw(&(leafcast_image){0}, WIDE, HIGH, &BAR, (const double[2]){-2.0, 6.0}, "", NULL);
    assert_memory_equal(before, planes, sizeof planes);
    legend_draw(&opaque, WIDE, HIGH, &BAR, (const double[2]){-2.0, 6.0}, "", NULL);
    assert_memory_equal(before[3], planes[3], sizeof planes[3]);
    assert_memory_not_equal(before[0], planes[0], sizeof planes[0]);
}

/* ---- Lines of a script ---- */

static script_frame start(void) {
    script_frame frame = {.file = {""}};
    view_options_init(&frame.view);
    frame.view.takes_media = true;
    return frame;
}

static status apply(script_frame *frame, const char *line) {
    return script_parse(frame, line, strlen(line), "line 1");
}

static void test_script(void **state) {
    (void)state;
    script_frame f = start();
    assert_int_equal(apply(&f, "{\"colour-map\": \"magma\", \"window\": [-1, 4.5], \"opacity\":"
                               " [\"0:0.25\", \"1:0.5,2:0.75\"], \"opacity_length\": 3,"
                               " \"legend\": true, \"error\": \"1/510\", \"error_f64\": \"e\"}"),
                     ST_OK);
    const medium_options *m = &f.view.medium;
    assert_string_equal(m->colour_map, "magma");
    assert_true(m->windowed && m->window[0] == -1.0 && m->window[1] == 4.5);
    assert_true(m->opacities == 3 && m->opacity[2][0] == 2.0 && m->opacity[2][1] == 0.75);
    assert_true(m->opacity_length == 3.0 && f.view.legend && f.view.scene.error == 1.0 / 510);
    assert_string_equal(f.file[FRAME_RAW + IMAGE_ERROR], "e");
    assert_int_equal(view_options_check(&f.view), ST_OK);
    /* A key replaces what was said for its flag. */
    assert_int_equal(apply(&f, "{\"opacity\": \"5:0.5\", \"tf\": \"ct\", \"legend\": false}"),
                     ST_OK);
    assert_true(m->opacities == 1 && m->opacity[0][0] == 5.0 && !f.view.legend);
    assert_int_equal(view_options_check(&f.view), ST_USAGE); /* --tf would change nothing */
    f = start();
    assert_int_equal(apply(&f, "{\"project\": \"first=-3.5\", \"value_f64\": \"v\"}"), ST_OK);
    assert_true(f.view.scene.project == LEAFCAST_PROJECT_FIRST &&
                f.view.scene.project_value == -3.5);
    assert_int_equal(view_options_check(&f.view), ST_OK);
    assert_int_equal(apply(&f, "{\"iso\": 3}"), ST_OK);
    assert_int_equal(view_options_check(&f.view), ST_USAGE);
    /* Surfaces' opacities and a medium's are one flag. */
    f = start();
    assert_int_equal(apply(&f, "{\"iso\": 3, \"opacity\": [\"0.5\", \"1:0.25\"]}"), ST_OK);
    assert_true(f.view.opacities == 1 && m->opacities == 1);
    assert_int_equal(view_options_check(&f.view), ST_OK);
    /* A verb without media knows none of its flags' values. */
    f.view.takes_media = false;
    assert_int_equal(apply(&f, "{\"opacity\": \"1:0.25\"}"), ST_USAGE);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_three_kinds), cmocka_unit_test(test_odd_histograms),
        cmocka_unit_test(test_aside),       cmocka_unit_test(test_moved),
        cmocka_unit_test(test_names),       cmocka_unit_test(test_bar),
        cmocka_unit_test(test_no_room),     cmocka_unit_test(test_script),
    };
    mem_init(&budget, 0);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
