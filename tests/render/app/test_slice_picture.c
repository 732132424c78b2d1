/* test_slice_picture.c - a slice's colours: greys in a window, isolines without gaps and nowhere
 * else. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <math.h>
#include <stdlib.h>

#include "render/app/slice_picture.h"
#include "render/look/picture_bytes.h"
#include "tests/support/fields.h"

enum { WIDTH = 90, HEIGHT = 70, PIXELS = WIDTH * HEIGHT };

static double value[PIXELS];
static float planes[4][PIXELS];

/* The red channel is the line's share: greys are made black by the window. */
static void fill(const slice_look *look) {
    const leafcast_image out = {
        .size = sizeof out, .r = planes[0], .g = planes[1], .b = planes[2], .a = planes[3]};
    slice_picture_fill(look, value, WIDTH, HEIGHT, &out);
}

/* From black at lo to white at hi. */
static slice_look grey_look(double lo, double hi) {
    static leafcast_transfer_point greys[256];
    const size_t count = sizeof greys / sizeof *greys;
    for (size_t i = 0; i < count; i++) {
        const double share = (double)i / (double)(count - 1);
        const float grey = (float)picture_linear(share);
        greys[i] = (leafcast_transfer_point){.value = (1 - share) * lo + share * hi,
                                             .rgb = {grey, grey, grey}};
    }
    return (slice_look){.colours = {.points = greys, .count = count}};
}

static slice_look line_look(const double *isovalues, int isos) {
    slice_look look = grey_look(1e8, 2e8);
    look.isovalues = isovalues;
    look.isos = isos;
    look.line[0] = look.line[1] = look.line[2] = 1;
    return look;
}

static void test_greys(void **state) {
    static byte_table bytes;
    (void)state;
    picture_bytes_init(&bytes);
    for (int i = 0; i < PIXELS; i++)
        value[i] = i % 7 == 0 ? (double)NAN : i % 300 - 20;
    const slice_look look = grey_look(0, 255);
    fill(&look);
    for (int i = 0; i < PIXELS; i++) {
        const bool none = isnan(value[i]);
        const int want = none || value[i] < 0 ? 0 : value[i] > 255 ? 255 : (int)value[i];
        assert_true(planes[3][i] == (none ? 0.0f : 1.0f));
        for (int c = 0; c < 3; c++)
            assert_int_equal(picture_byte(&bytes, planes[c][i]), want);
    }
}

/* A straight line at any angle is 1.5 pixels wide. */
static void test_straight_lines(void **state) {
    (void)state;
    for (int turn = 0; turn < 24; turn++) {
        const double angle = 0.13 + turn * 0.26, x = cos(angle), y = sin(angle);
        const double iso = 40 * x + 35 * y + 0.37, steps[2] = {fabs(x), fabs(y)};
        double along = 0.0;
        for (int i = 0; i < PIXELS; i++)
            value[i] = (i % WIDTH) * x + (i / WIDTH) * y;
        const slice_look look = line_look(&iso, 1);
        fill(&look);
        /* Across the line, in whole rows or columns. */
        const bool rows = steps[0] > steps[1];
        const int at = rows ? 35 : 40, count = rows ? WIDTH : HEIGHT;
        for (int k = 1; k + 1 < count; k++)
            along += (double)planes[0][rows ? at * WIDTH + k : k * WIDTH + at];
        assert_true(fabs(along * fmax(steps[0], steps[1]) - 1.5) < 0.12);
    }
}

static bool near_other_side(int x, int y, double iso) {
    for (int j = y - 2; j <= y + 2; j++)
        for (int i = x - 2; i <= x + 2; i++)
            if (i >= 0 && j >= 0 && i < WIDTH && j < HEIGHT && !isnan(value[j * WIDTH + i]) &&
                (value[j * WIDTH + i] >= iso) != (value[y * WIDTH + x] >= iso))
                return true;
    return false;
}

/* Of two neighbours on both sides one shows the line; far from any other side none is drawn. */
static void check_lines(const double *isos, int count) {
    int crossed = 0;
    for (int i = 0; i < PIXELS; i++) {
        const int x = i % WIDTH, y = i / WIDTH;
        bool near = false;
        for (int n = 0; n < count; n++) {
            near |= !isnan(value[i]) && near_other_side(x, y, isos[n]);
            for (int down = 0; down < 2; down++) {
                const int other = down ? i + WIDTH : i + 1;
                if (down ? y + 1 == HEIGHT : x + 1 == WIDTH)
                    continue;
                if (isnan(value[i]) || isnan(value[other]) ||
                    (value[i] >= isos[n]) == (value[other] >= isos[n]))
                    continue;
                crossed++;
                assert_true(fmaxf(planes[0][i], planes[0][other]) >= 0.75f);
            }
        }
        assert_true(near || planes[0][i] == 0.0f);
    }
    assert_true(crossed > 100);
}

static void test_no_gap(void **state) {
    (void)state;
    const double isos[] = {0.0, 0.81};
    const slice_look look = line_look(isos, 2);
    field_random r = {3};
    for (int kind = 0; kind < 3; kind++) {
        for (int i = 0; i < PIXELS; i++) {
            const double x = i % WIDTH, y = i / WIDTH, wave = sin(0.13 * x) * cos(0.11 * y + 1);
            value[i] = kind == 0   ? wave
                       : kind == 1 ? rint(2 * wave) + (x > 60 ? 1e-9 : 0)
                                   : field_random_in(&r, -1, 1);
            if (field_random_below(&r, 50) == 0)
                value[i] = (double)NAN;
        }
        fill(&look);
        check_lines(isos, 2);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_greys),
                                       cmocka_unit_test(test_straight_lines),
                                       cmocka_unit_test(test_no_gap)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
