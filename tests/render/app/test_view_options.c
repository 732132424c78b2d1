/* test_view_options.c - colours, the flags of a view, and the same from JSON. */
/* marks: bits */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "render/app/colour.h"
#include "render/app/render_job.h"
#include "render/app/render_script.h"

static void test_colours(void **state) {
    (void)state;
    float rgb[3], alpha;
    assert_int_equal(colour_parse("0.25,1,3.5", "c", rgb, NULL), ST_OK);
    assert_true(rgb[0] == 0.25f && rgb[1] == 1.0f && rgb[2] == 3.5f);
    assert_int_equal(colour_parse("#00FFff80", "c", rgb, &alpha), ST_OK);
    assert_true(rgb[0] == 0.0f && rgb[1] == 1.0f && rgb[2] == 1.0f && alpha == 128 / 255.0f);
    for (int byte = 0; byte < 256; byte++) {
        char text[8];
        snprintf(text, sizeof text, "#%02x0000", byte);
        assert_int_equal(colour_parse(text, "c", rgb, NULL), ST_OK);
        const double x = byte / 255.0;
        const double want = x <= 0.04045 ? x / 12.92 : pow((x + 0.055) / 1.055, 2.4);
        if (fabs((double)rgb[0] - want) > 1e-7 * want)
            fail_msg("%s is %.9g, not %.9g", text, (double)rgb[0], want);
    }
    const char *wrong[] = {"",       "#12345",  "#12345g", "#1234567", "#12345678", "1,2",
                           "1,2,-3", "1,2,nan", "1,2,3,1", "redd",     "1,2,3,"};
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++)
        assert_int_equal(colour_parse(wrong[i], "c", rgb, NULL), ST_USAGE);
    assert_int_equal(colour_parse("1,1,1,1.5", "c", rgb, &alpha), ST_USAGE);
}

/* A frame from what the command line would say, then a line of a script. */
static status apply(script_frame *frame, const char *line) {
    return script_parse(frame, line, strlen(line), "line 1");
}

static script_frame start(void) {
    script_frame frame = {.file = {""}};
    view_options_init(&frame.view);
    return frame;
}

static void test_script_says_all(void **state) {
    (void)state;
    script_frame f = start();
    assert_int_equal(
        apply(&f, "{\"iso\": [80, 1.5], \"color\": [\"#ffffff\", [0, 0.5, 1]], \"opacity\": 0.25,"
                  " \"camera\": {\"eye\": [1, 2, 3], \"look_at\": \"4,5,6\", \"up\": [0, 1, 0],"
                  " \"fov\": 30}, \"size\": [640, 480], \"light\": [1, 0, 0],"
                  " \"point-light\": [[1, 2, 3], \"4,5,6,0.5,0.5,0.5\"], \"shadows\": true,"
                  " \"shading\": \"phong\", \"lod\": 2, \"clip_plane\": [[0, 0, 1, -5]],"
                  " \"background\": [0, 0, 0, 1], \"output\": \"a.png\", \"depth_f64\": \"a\"}"),
        ST_OK);
    assert_int_equal(view_options_check(&f.view), ST_OK);
    const view_options *v = &f.view;
    assert_true(v->isos == 2 && v->surfaces[0].isovalue == 80 && v->surfaces[1].isovalue == 1.5);
    assert_true(v->surfaces[0].opacity == 0.25f && v->surfaces[1].opacity == 1.0f);
    assert_true(v->surfaces[1].rgb[1] == 0.5f);
    assert_true(v->eye && v->camera.eye[2] == 3 && v->camera.look_at[0] == 4 && v->up && v->fov);
    assert_true(v->camera.width == 640 && v->camera.height == 480 && v->camera.fov == 30);
    assert_int_equal(v->scene.light_count, 3);
    assert_true(!v->scene.lights[0].point && v->scene.lights[2].rgb[0] == 0.5f);
    assert_true(v->scene.shadows && v->scene.shading == LEAFCAST_SHADING_PHONG);
    assert_true(v->scene.lod == LEAFCAST_LOD_LEVEL && v->scene.lod_level == 2);
    assert_true(v->scene.clip_plane_count == 1 && v->scene.clip_planes[0][3] == -5);
    assert_true(v->scene.background[3] == 1.0f);
    assert_string_equal(f.file[FRAME_PICTURE], "a.png");
    assert_string_equal(f.file[FRAME_RAW + IMAGE_DEPTH], "a");
}

/* A key replaces what the command line said for its flag, and nothing else. */
static void test_script_replaces(void **state) {
    (void)state;
    script_frame f = start();
    assert_int_equal(apply(&f, "{\"iso\": [1, 2, 3], \"light\": [1, 0, 0], \"shadows\": true,"
                               " \"point_light\": [9, 9, 9]}"),
                     ST_OK);
    assert_int_equal(apply(&f, "{\"isovalues\": [7], \"light\": [0, 1, 0], \"shadows\": false}"),
                     ST_OK);
    assert_true(f.view.isos == 1 && f.view.surfaces[0].isovalue == 7);
    assert_true(f.view.scene.light_count == 2 && f.view.scene.lights[0].point);
    assert_true(f.view.scene.lights[1].vector[1] == 1 && !f.view.scene.shadows);
}

/* Field and step: a line's own, or the command line's again. */
/* Of both flags the most counts; that of one goes with it. Glass that asks for none has 4. */
static void test_bounces(void **state) {
    (void)state;
    static const struct {
        const char *line;
        int bounces;
    } rows[] = {{"{\"iso\": [1, 2], \"opacity\": 0.5, \"refract\": [\"1.5,3\", 1]}", 3},
                {"{\"reflect\": \"0.5,6\"}", 6},
                {"{\"reflect\": 0.5}", 3},
                {"{\"refract\": 1.5}", 4},
                {"{\"refract\": [\"1.5\", \"1.3,7\"]}", 7},
                {"{\"refract\": [[1.5, 6], 1.3]}", 6},
                {"{\"refract\": [1.5, 2], \"reflect\": [0, 0.25]}", 4},
                {"{\"refract\": \"1.5,2\", \"reflect\": [\"0\", \"0.5,1\"]}", 2}};
    script_frame f = start();
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        assert_int_equal(apply(&f, rows[i].line), ST_OK);
        assert_int_equal(view_options_check(&f.view), ST_OK);
        assert_int_equal(f.view.scene.bounces, rows[i].bounces);
    }
    assert_int_equal(apply(&f, "{\"refract\": [1.5, 2], \"reflect\": [0, 0.25]}"), ST_OK);
    assert_true(f.view.surfaces[0].refraction == 1.5f && f.view.surfaces[1].refraction == 2.0f);
    assert_true(f.view.surfaces[1].reflectivity == 0.25f);
    assert_int_equal(apply(&f, "{\"refract\": \"1.5,2\", \"reflect\": [0, 0.5]}"), ST_OK);
    assert_int_equal(view_options_check(&f.view), ST_OK);
    assert_true(f.view.surfaces[0].refraction == 1.5f && f.view.surfaces[1].refraction == 0.0f);
    assert_true(f.view.surfaces[1].reflectivity == 0.5f);
}

static void test_script_steps(void **state) {
    (void)state;
    script_frame f = start();
    assert_true(f.view.step == 0 && !f.view.field[0]);
    assert_int_equal(apply(&f, "{\"field\": \"speed of it\", \"step\": 12}"), ST_OK);
    assert_string_equal(f.view.field, "speed of it");
    assert_int_equal(f.view.step, 12);
    assert_int_equal(apply(&f, "{\"field\": 3, \"step\": \"7\"}"), ST_OK);
    assert_string_equal(f.view.field, "3");
    assert_int_equal(f.view.step, 7);
}

static void test_script_refuses(void **state) {
    (void)state;
    const char *wrong[][2] = {
        {"", "line 1"},
        {"[]", "not a JSON object"},
        {"{\"a\": 1, \"a\": 2}", "duplicate"},
        {"{\"eyes\": 1}", "there is no \"eyes\""},
        {"{\"iso\": \"nan\"}", "line 1: --iso: nan is not a finite number"},
        {"{\"iso\": {}}", "numbers or text"},
        {"{\"eye\": [1, 2]}", "--eye"},
        {"{\"shadows\": 1}", "true or false"},
        {"{\"output\": 3}", "a file's name"},
        {"{\"camera\": {\"camera\": {\"camera\": {\"camera\": {}}}}}", "not a JSON object"},
        {"{\"opacity\": [0]}", "--opacity"},
        {"{\"light\": [0, 0, 0]}", "--light"},
        {"{\"field\": \"\"}", "--field"},
        {"{\"step\": -1}", "--step"},
        {"{\"step\": 1.5}", "--step"},
    };
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        script_frame f = start();
        assert_int_equal(apply(&f, wrong[i][0]), ST_USAGE);
        if (!strstr(status_text(), wrong[i][1]))
            fail_msg("%s: \"%s\" does not say \"%s\"", wrong[i][0], status_text(), wrong[i][1]);
    }
}

/* Lines as a pipe delivers them: in pieces, without an end, with blank ones between. */
static void test_lines(void **state) {
    (void)state;
    int ends[2];
    char path[64];
    mem m;
    script_reader *r = NULL;
    mem_init(&m, 0);
    assert_int_equal(pipe(ends), 0);
    snprintf(path, sizeof path, "/proc/self/fd/%d", ends[0]);
    assert_int_equal(script_open(&m, path, &r), ST_OK);
    assert_int_equal(write(ends[1], "one\n \n\ntwo\r\nthr", 15), 15);
    const char *line;
    size_t size;
    long number;
    const char *want[] = {"one", "two\r", "three"};
    const long numbers[] = {1, 4, 5};
    for (int i = 0; i < 3; i++) {
        if (i == 2) {
            assert_int_equal(write(ends[1], "ee", 2), 2);
            close(ends[1]);
        }
        assert_int_equal(script_line(r, NULL, NULL, &line, &size, &number), ST_OK);
        assert_int_equal(size, strlen(want[i]));
        assert_memory_equal(line, want[i], size);
        assert_int_equal(number, numbers[i]);
    }
    assert_int_equal(script_line(r, NULL, NULL, &line, &size, &number), ST_OK);
    assert_null(line);
    script_close(r);
    close(ends[0]);
    assert_int_equal(mem_used(&m), 0);
    assert_int_equal(script_open(&m, "/nowhere/at/all", &r), ST_IO);
}

static bool yes(void *ctx) {
    (void)ctx;
    return true;
}

static void test_a_waiting_reader_stops(void **state) {
    (void)state;
    int ends[2];
    char path[64];
    mem m;
    script_reader *r = NULL;
    mem_init(&m, 0);
    assert_int_equal(pipe(ends), 0);
    snprintf(path, sizeof path, "/proc/self/fd/%d", ends[0]);
    assert_int_equal(script_open(&m, path, &r), ST_OK);
    const char *line;
    size_t size;
    long number;
    assert_int_equal(script_line(r, yes, NULL, &line, &size, &number), ST_STOPPED);
    script_close(r);
    close(ends[0]);
    close(ends[1]);
}

static void test_median(void **state) {
    (void)state;
    leafcast_stats all[4] = {{.render_s = 3}, {.render_s = 1}, {.render_s = 2}, {.render_s = 2}};
    assert_int_equal(render_stats_median(all, 1), 0);
    assert_int_equal(render_stats_median(all, 3), 2);
    assert_int_equal(render_stats_median(all, 4), 2);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_colours),         cmocka_unit_test(test_script_says_all),
        cmocka_unit_test(test_script_replaces), cmocka_unit_test(test_bounces),
        cmocka_unit_test(test_script_steps),    cmocka_unit_test(test_script_refuses),
        cmocka_unit_test(test_lines),           cmocka_unit_test(test_a_waiting_reader_stops),
        cmocka_unit_test(test_median),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
