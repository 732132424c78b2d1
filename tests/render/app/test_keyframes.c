/* test_keyframes.c - views between views: keys are met, distances and directions go evenly, what
 * cannot change stays. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <math.h>
#include <string.h>

#include "formats/base/vec3.h"
#include "render/app/keyframes.h"

static json_t *spread(const char *text, int frames) {
    json_t *keys = json_loads(text, 0, NULL), *path = NULL;
    assert_non_null(keys);
    assert_int_equal(keyframes_spread(keys, "path.json", frames, &path), ST_OK);
    assert_int_equal(json_array_size(path), (size_t)frames);
    json_decref(keys);
    return path;
}

static double number(const json_t *path, size_t frame, const char *key, size_t i) {
    const json_t *value = json_object_get(json_array_get(path, frame), key);
    return json_number_value(json_is_array(value) ? json_array_get(value, i) : value);
}

static const char *text(const json_t *path, size_t frame, const char *key) {
    return json_string_value(json_object_get(json_array_get(path, frame), key));
}

/* A quarter turn, twice as far at its end: on a circle, distances in one proportion. */
static void test_quarter(void **state) {
    (void)state;
    json_t *path = spread("[{\"eye\": [4,0,0], \"look-at\": [0,0,0]},"
                          " {\"camera\": {\"eye\": [0,8,0], \"look_at\": [0,0,0]}}]",
                          3);
    const double half = sqrt(32.0) * sqrt(0.5);
    assert_true(number(path, 0, "eye", 0) == 4.0 && number(path, 2, "eye", 1) == 8.0);
    assert_true(fabs(number(path, 1, "eye", 0) - half) < 1e-12);
    assert_true(fabs(number(path, 1, "eye", 1) - half) < 1e-12);
    assert_true(fabs(number(path, 1, "up", 2) - 1.0) < 1e-12);
    json_decref(path);
}

/* Keys of an even turn about z: the spline passes by each and has no corner there; all of it lies
 * on the circle. */
static void test_smooth(void **state) {
    (void)state;
    enum { PER = 50, FRAMES = 3 * PER + 1 };
    json_t *path = spread(
        "[{\"eye\": [5,0,0], \"look-at\": [0,0,0]}, {\"eye\": [0,5,0], \"look-at\": [0,0,0]},"
        " {\"eye\": [-5,0,0], \"look-at\": [0,0,0]}, {\"eye\": [0,-5,0], \"look-at\": [0,0,0]}]",
        FRAMES);
    double before[3] = {0};
    for (size_t i = 0; i < FRAMES; i++) {
        const double eye[3] = {number(path, i, "eye", 0), number(path, i, "eye", 1),
                               number(path, i, "eye", 2)};
        assert_true(fabs(vec3_length(eye) - 5.0) < 1e-9 && fabs(eye[2]) < 1e-9);
        double step[3], bend[3];
        vec3_sub(eye, before, step);
        memcpy(before, eye, sizeof before);
        if (i == 0)
            continue;
        /* A quarter is 7.9 long; eased in and out, no frame goes further than twice its share. */
        assert_true(vec3_length(step) < 2.0 * 7.9 / PER);
        static double last[3];
        vec3_sub(step, last, bend);
        memcpy(last, step, sizeof last);
        assert_true(i < 2 || vec3_length(bend) < 0.02);
    }
    assert_true(number(path, PER, "eye", 1) == 5.0 &&
                number(path, (size_t)2 * PER, "eye", 0) == -5.0);
    json_decref(path);
}

/* Between keys of an even turn, it is even: 50 degrees a quarter of the way from 40 to 80. */
static void test_even(void **state) {
    (void)state;
    static const double degree = 3.14159265358979323846 / 180.0;
    char keys[512] = "[";
    for (int i = 0; i < 4; i++)
        snprintf(keys + strlen(keys), sizeof keys - strlen(keys),
                 "%s{\"eye\": [%.17g,%.17g,0], \"look-at\": [0,0,0]}", i ? "," : "",
                 cos(40.0 * i * degree), sin(40.0 * i * degree));
    strcat(keys, "]");
    json_t *path = spread(keys, 13);
    for (size_t i = 4; i <= 8; i++) {
        const double angle = 10.0 * (double)i * degree;
        assert_true(fabs(number(path, i, "eye", 0) - cos(angle)) < 1e-12);
        assert_true(fabs(number(path, i, "eye", 1) - sin(angle)) < 1e-12);
    }
    json_decref(path);
}

static void test_values(void **state) {
    (void)state;
    json_t *path = spread(
        "[{\"iso\": [10, 20], \"color\": [\"#000000\", \"red\"], \"opacity\": [\"0:0,40:0.5\"], "
        "\"step\": 0,"
        "  \"shadows\": true, \"samples\": 1, \"tf\": \"a1\", \"clip_box\": [0,0,0,1,1,1], "
        "\"window\": [1, 2]},"
        " {\"iso\": [20, 40], \"colour\": [\"#204060\", \"blue\"], \"opacity\": [\"10:1,60:0\"], "
        "\"step\": 3,"
        "  \"shadows\": false, \"samples\": 4, \"tf\": \"a2\", \"clip-box\": [1,0,0,3,1,1], "
        "\"window\": [1, 2, "
        "3]}]",
        5);
    assert_true(number(path, 1, "iso", 0) == 12.5 && number(path, 2, "iso", 1) == 30.0);
    const json_t *colours = json_object_get(json_array_get(path, 2), "colour");
    assert_string_equal(json_string_value(json_array_get(colours, 0)), "#102030");
    assert_string_equal(json_string_value(json_array_get(colours, 1)), "red");
    const json_t *curve = json_object_get(json_array_get(path, 2), "opacity");
    assert_string_equal(json_string_value(json_array_get(curve, 0)), "5:0.5,50:0.25");
    assert_true(number(path, 1, "step", 0) == 0 && number(path, 2, "step", 0) == 1 &&
                number(path, 4, "step", 0) == 3);
    assert_true(json_is_true(json_object_get(json_array_get(path, 3), "shadows")));
    assert_true(number(path, 3, "samples", 0) == 1.0);
    assert_string_equal(text(path, 3, "tf"), "a1");
    assert_string_equal(text(path, 4, "tf"), "a2");
    assert_true(number(path, 2, "clip-box", 3) == 2.0);
    assert_true(number(path, 3, "window", 1) == 2.0);
    json_decref(path);
}

/* One key, opposite eyes, one frame; entries that are none. */
static void test_edges(void **state) {
    (void)state;
    json_t *path = spread("[{\"iso\": 3}]", 4);
    assert_true(number(path, 3, "iso", 0) == 3.0);
    json_decref(path);
    path = spread("[{\"iso\": 3}, {\"iso\": 5}]", 1);
    assert_true(number(path, 0, "iso", 0) == 3.0);
    json_decref(path);
    path = spread(
        "[{\"eye\": [2,0,0], \"look-at\": [0,0,0]}, {\"eye\": [-2,0,0], \"look-at\": [0,0,0]}]", 3);
    const double eye[3] = {number(path, 1, "eye", 0), number(path, 1, "eye", 1),
                           number(path, 1, "eye", 2)};
    assert_true(fabs(vec3_length(eye) - 2.0) < 1e-12 && fabs(eye[0]) < 1e-12);
    json_decref(path);
    json_t *bad = json_pack("[{},i]", 3), *none = NULL;
    assert_int_equal(keyframes_spread(bad, "path.json", 3, &none), ST_USAGE);
    assert_non_null(strstr(status_text(), "path.json: entry 2"));
    assert_null(none);
    json_decref(bad);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_quarter),
                                       cmocka_unit_test(test_smooth), cmocka_unit_test(test_even),
                                       cmocka_unit_test(test_values), cmocka_unit_test(test_edges)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
