/* test_annotate.c - marks in pictures: lines, letters, the volume's box, the scale bar. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <math.h>
#include <string.h>

#include "render/app/annotate.h"
#include "tests/support/fields.h"

enum { WIDE = 240, HIGH = 160, PIXELS = WIDE * HIGH };

/* Black; what is drawn is brighter. */
typedef struct sheet {
    float r[PIXELS], g[PIXELS], b[PIXELS], a[PIXELS];
    double z[PIXELS];
    leafcast_image image;
    canvas on;
} sheet;

static sheet *blank(double z) {
    static sheet s;
    memset(&s, 0, sizeof s);
    for (int i = 0; i < PIXELS; i++)
        s.z[i] = z;
    s.image =
        (leafcast_image){.size = sizeof s.image, .r = s.r, .g = s.g, .b = s.b, .a = s.a, .z = s.z};
    s.on = (canvas){&s.image, WIDE, HIGH};
    return &s;
}

static int marked(const sheet *s) {
    int count = 0;
    for (int i = 0; i < PIXELS; i++)
        count += s->r[i] > 0.0f;
    return count;
}

/* Whether something bright is within a pixel of (x, y). */
static bool bright_at(const sheet *s, double x, double y) {
    float most = 0.0f;
    for (int k = 0; k < 9; k++) {
        const long i = (long)floor(x) + k % 3 - 1, j = (long)floor(y) + k / 3 - 1;
        if (i >= 0 && j >= 0 && i < WIDE && j < HIGH)
            most = fmaxf(most, s->r[j * WIDE + i]);
    }
    return most > 0.2f;
}

static mem memory;
static text_face *face;

static int open_face(void **state) {
    (void)state;
    mem_init(&memory, 0);
    if (text_face_open(&memory, NULL, &face) != ST_OK)
        print_message("# %s\n", status_text());
    return 0;
}

static int close_face(void **state) {
    (void)state;
    text_face_close(face);
    return memory.used == 0 ? 0 : -1;
}

static void need_face(void) {
    if (!face)
        skip();
}

/* ---- Words and numbers ---- */

static void test_parts(void **state) {
    (void)state;
    unsigned parts = 99;
    assert_int_equal(annotate_parts(NULL, &parts), ST_OK);
    assert_int_equal(parts, ANNOTATE_ALL);
    assert_int_equal(annotate_parts("scale,box", &parts), ST_OK);
    assert_int_equal(parts, ANNOTATE_BOX | ANNOTATE_SCALE);
    static const char *const bad[] = {"", "box,", ",box", "boxes", "bo", "box;axes"};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
        assert_int_equal(annotate_parts(bad[i], &parts), ST_USAGE);
}

static void test_round(void **state) {
    (void)state;
    static const double cases[][2] = {{1, 1},       {1.9, 1},       {2, 2},       {4.999, 2},
                                      {5, 5},       {9.9, 5},       {10, 10},     {0.3, 0.2},
                                      {1e-9, 1e-9}, {7.3e12, 5e12}, {0.05, 0.05}, {1000, 1000}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        assert_true(fabs(annotate_round(cases[i][0]) - cases[i][1]) <= 1e-12 * cases[i][1]);
}

/* ---- Lines ---- */

static void test_lines(void **state) {
    (void)state;
    sheet *s = blank(1.0);
    canvas_line line = {
        .from = {10.5, 20.5}, .to = {30.5, 20.5}, .width = 1.0, .rgb = {1, 1, 1}, .opacity = 1.0f};
    canvas_draw_line(&s->on, &line);
    for (int x = 0; x < 42; x++)
        for (int y = 18; y < 24; y++)
            assert_true(s->r[y * WIDE + x] == (x >= 10 && x <= 30 && y == 20 ? 1.0f : 0.0f));
    /* The same bits from either end, and turned by a right angle. */
    static float there[PIXELS];
    line = (canvas_line){
        .from = {3.2, 70.1}, .to = {120.7, 11.9}, .width = 2.5, .rgb = {1, 1, 1}, .opacity = 0.7f};
    s = blank(1.0);
    canvas_draw_line(&s->on, &line);
    memcpy(there, s->r, sizeof there);
    const double area = 2.5 * hypot(117.5, 58.2) * 0.7;
    double sum = 0.0;
    for (int i = 0; i < PIXELS; i++)
        sum += (double)there[i];
    assert_true(fabs(sum - area) < 0.05 * area);
    const canvas_line back = {
        .from = {120.7, 11.9}, .to = {3.2, 70.1}, .width = 2.5, .rgb = {1, 1, 1}, .opacity = 0.7f};
    s = blank(1.0);
    canvas_draw_line(&s->on, &back);
    assert_memory_equal(there, s->r, sizeof there);
    /* Far outside, endless, or without a length: nothing, or what is inside. */
    const double ends[][4] = {{-50, -50, -9, -9},
                              {-1e7, 50, 1e7, 51},
                              {5, 5, 5, 5},
                              {NAN, 0, 4, 4},
                              {0, 0, (double)INFINITY, 4}};
    for (size_t i = 0; i < sizeof ends / sizeof *ends; i++) {
        s = blank(1.0);
        memcpy(line.from, ends[i], sizeof line.from);
        memcpy(line.to, ends[i] + 2, sizeof line.to);
        canvas_draw_line(&s->on, &line);
        assert_true((marked(s) > WIDE) == (i == 1));
    }
}

/* ---- Letters ---- */

static void test_letters(void **state) {
    (void)state;
    need_face();
    static const text_style style = {{1, 1, 1}, {0.5f, 0.5f, 0.5f}};
    text_face_size(face, 20.0);
    assert_true(text_face_width(face, "") == 0.0);
    assert_true(text_face_width(face, "ii") < text_face_width(face, "WW"));
    assert_true(text_face_width(face, "\xc3\x85") == text_face_width(face, "\xc5")); /* an A */
    const double width = text_face_width(face, "Hello");
    sheet *s = blank(1.0);
    text_face_draw(face, &s->on, "Hello", 50.0, 60.0, &style);
    assert_true(marked(s) > 100);
    for (int i = 0; i < PIXELS; i++)
        if (s->r[i] > 0.0f)
            assert_true(i % WIDE >= 48 && i % WIDE <= 52 + width && i / WIDE >= 38 &&
                        i / WIDE <= 62);
    /* What is no UTF-8, and what lies outside. */
    text_face_draw(face, &s->on, "\xff\xe2\x82 \xf0\x9f", 230.0, 158.0, &style);
    text_face_draw(face, &s->on, "outside", -1e6, 1e6, &style);
    text_face *none = NULL;
    assert_int_equal(text_face_open(&memory, "/nowhere/at.ttf", &none), ST_USAGE);
    assert_non_null(strstr(status_text(), "/nowhere/at.ttf"));
    assert_null(none);
}

/* ---- The box and the scale ---- */

static const annotation box_alone = {.parts = ANNOTATE_BOX};

/* A view of the unit cube from a random place around it. */
static leafcast_camera view_of(field_random *r, bool parallel) {
    leafcast_camera c = {.size = sizeof c,
                         .look_at = {0.5, 0.5, 0.5},
                         .up = {0.1, 0.2, 1},
                         .fov = 40.0,
                         .width = WIDE,
                         .height = HIGH,
                         .ortho_height = parallel ? 2.5 : 0.0};
    for (int a = 0; a < 3; a++)
        c.eye[a] = 0.5 + field_random_in(r, 1.0, 2.0) * (field_random_below(r, 2) ? 1.0 : -1.0);
    return c;
}

/* Every corner is where the ray through its pixel says. */
static void test_box(void **state) {
    (void)state;
    need_face();
    field_random r = {.state = 5};
    for (int i = 0; i < 40; i++) {
        const leafcast_camera c = view_of(&r, i % 2);
        /* The corner next to the eye is put on a pixel's ray. */
        double origin[3], direction[3], bounds[2][3] = {{0, 0, 0}, {1, 1, 1}};
        const double x = 0.5 + floor(field_random_in(&r, 0.3, 0.7) * WIDE),
                     y = 0.5 + floor(field_random_in(&r, 0.3, 0.7) * HIGH);
        leafcast_pixel_ray(&c, x, y, origin, direction);
        double t = 0.0;
        for (int a = 0; a < 3; a++)
            t += (0.5 - origin[a]) * direction[a];
        bool inside = true;
        for (int a = 0; a < 3; a++) {
            const bool upper = c.eye[a] > 0.5;
            bounds[upper][a] = origin[a] + 0.8 * t * direction[a];
            inside = inside && bounds[0][a] < bounds[1][a];
        }
        if (!inside)
            continue;
        sheet *s = blank(INFINITY);
        annotate_draw(&s->image, &c, bounds, &box_alone, false, face);
        assert_true(bright_at(s, x, y));
        /* Behind a surface there is nothing, nor where one is as near as the corner. */
        s = blank(0.5 * t);
        annotate_draw(&s->image, &c, bounds, &box_alone, false, face);
        assert_int_equal(marked(s), 0);
        s = blank(0.8 * t * (1.0 - 1e-3));
        annotate_draw(&s->image, &c, bounds, &box_alone, false, face);
        assert_false(bright_at(s, x, y));
        s = blank(0.8 * t * (1.0 + 1e-3));
        annotate_draw(&s->image, &c, bounds, &box_alone, false, face);
        assert_true(bright_at(s, x, y));
    }
}

static void test_inside(void **state) {
    (void)state;
    need_face();
    static const double bounds[2][3] = {{0, 0, 0}, {1, 1, 1}};
    const annotation all = {.parts = ANNOTATE_ALL, .title = "inside", .unit = "mm"};
    leafcast_camera c = {.size = sizeof c,
                         .eye = {0.4, 0.5, 0.6},
                         .look_at = {3, 0.5, 0.6},
                         .up = {0, 0, 1},
                         .fov = 100.0,
                         .width = WIDE,
                         .height = HIGH};
    sheet *s = blank(INFINITY);
    annotate_draw(&s->image, &c, bounds, &all, true, face);
    assert_true(marked(s) > 200);
    c.up[0] = 1; /* along the view: no camera */
    c.up[2] = 0;
    s = blank(INFINITY);
    annotate_draw(&s->image, &c, bounds, &all, true, face);
    assert_int_equal(marked(s), 0);
}

/* The bar's pixels are as long as it says, and stand low on the right. */
static void test_scale(void **state) {
    (void)state;
    need_face();
    static const double bounds[2][3] = {{0, 0, 0}, {1, 1, 1}};
    const annotation scale = {.parts = ANNOTATE_SCALE};
    for (int i = 0; i < 20; i++) {
        const double height = 0.013 * pow(1.7, i);
        const leafcast_camera c = {
            .size = sizeof c,
            .eye = {0.5, -4, 0.5},
            .look_at = {0.5, 0.5, 0.5},
            .up = {0, 0, 1},
            .width = WIDE,
            .height = HIGH,
            .fov = i % 2 ? 0.0 : 2.0 * atan(0.5 * height / 4.5) * 57.29577951308232,
            .ortho_height = i % 2 ? height : 0.0};
        const double units = annotate_round(0.25 * WIDE * height / HIGH);
        sheet *s = blank(INFINITY);
        annotate_draw(&s->image, &c, bounds, &scale, false, face);
        int most = 0;
        for (int y = HIGH - 20; y < HIGH; y++) {
            int run = 0;
            for (int x = WIDE / 2; x < WIDE; x++) {
                run = s->r[y * WIDE + x] > 0.5f ? run + 1 : 0;
                most = run > most ? run : most;
            }
        }
        assert_true(fabs(most - units / height * HIGH) <= 2.5);
    }
}

/* Marks of planes that are not there, and of too small a picture, do no harm. */
static void test_planes(void **state) {
    (void)state;
    need_face();
    static const double bounds[2][3] = {{0, 0, 0}, {1, 1, 1}};
    const annotation all = {.parts = ANNOTATE_ALL, .title = "t"};
    field_random r = {.state = 3};
    leafcast_camera c = view_of(&r, false);
    sheet *s = blank(INFINITY);
    s->image.a = NULL;
    s->image.z = NULL;
    annotate_draw(&s->image, &c, bounds, &all, false, face);
    assert_true(marked(s) > 200 && s->a[0] == 0.0f);
    s = blank(INFINITY);
    c.width = 3;
    c.height = 2;
    annotate_draw(&s->image, &c, bounds, &all, false, face);
    for (int i = 6; i < PIXELS; i++)
        assert_true(s->r[i] == 0.0f);
    s->image.r = NULL;
    annotate_draw(&s->image, &c, bounds, &all, false, face);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_parts), cmocka_unit_test(test_round),
        cmocka_unit_test(test_lines), cmocka_unit_test(test_letters),
        cmocka_unit_test(test_box),   cmocka_unit_test(test_inside),
        cmocka_unit_test(test_scale), cmocka_unit_test(test_planes),
    };
    return cmocka_run_group_tests(tests, open_face, close_face);
}
