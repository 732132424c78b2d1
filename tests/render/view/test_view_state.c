/* test_view_state.c - what a page may say of a view, and what is refused; tokens, hosts and
 * origins.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <stdio.h>
#include <string.h>

#include "render/view/view_access.h"
#include "render/view/view_crowd.h"
#include "render/view/view_slice_state.h"
#include "render/view/view_state.h"

static mem budget;

static status apply(const char *text, view_options *v) {
    json_t *object = NULL;
    status st = view_state_parse(text, strlen(text), &object);
    if (st == ST_OK)
        st = view_state_apply(&budget, object, v);
    json_decref(object);
    return st;
}

static void test_taken(void **state) {
    (void)state;
    view_options v;
    assert_int_equal(
        apply("{\"iso\": [37, 120], \"eye\": [3, 2, 1], \"fov\": 35, \"opacity\": [0.5, 1],"
              " \"shadows\": true, \"light\": [[1, 1, 2]], \"clip_box\": [0, 0, 0, 9, 9, 4]}",
              &v),
        ST_OK);
    assert_int_equal(v.isos, 2);
    assert_true(v.surfaces[1].isovalue == 120.0 && v.surfaces[0].opacity == 0.5f);
    assert_true(v.eye && v.camera.eye[0] == 3.0 && v.fov && v.camera.fov == 35.0);
    assert_true(v.scene.shadows && v.scene.light_count == 1 && v.scene.clip_box);
    assert_int_equal(apply("{\"tf\": \"auto\", \"colour-map\": \"viridis\", \"error\": 0.01}", &v),
                     ST_OK);
    assert_string_equal(v.medium.colour_map, "viridis");
    assert_int_equal(v.isos, 0); /* nothing of the state before */
    assert_int_equal(apply("{}", &v), ST_OK);
    assert_false(medium_options_given(&v.medium));
    assert_int_equal(apply("{\"iso\": 3, \"page\": {\"slices\": {\"output\": 7}}}", &v), ST_OK);
    assert_int_equal(v.isos, 1); /* what is the page's own is skipped */
    assert_int_equal(apply("{\"page\": \"x\"}", &v), ST_USAGE);
    assert_int_equal(apply("{\"annotate\": \"box,scale\", \"title\": \"A\", \"unit\": \"mm\"}", &v),
                     ST_OK);
    assert_int_equal(v.annotation.parts, ANNOTATE_BOX | ANNOTATE_SCALE);
    assert_string_equal(v.annotation.title, "A");
    assert_string_equal(v.annotation.unit, "mm");
}

/* ---- Slices ---- */

static status slice(const char *text, slice_request *r) {
    json_t *object = json_loads(text, JSON_DECODE_ANY, NULL);
    const status st = view_slice_state_apply(&budget, object, r);
    json_decref(object);
    return st;
}

static void test_slices_taken(void **state) {
    (void)state;
    slice_request r;
    assert_int_equal(slice("{}", &r), ST_OK);
    assert_true(r.place.way == SLICE_ACROSS && r.place.axis == 2 && r.look.isos == 0 && !r.step);
    assert_int_equal(
        slice("{\"axis\": \"y\", \"at\": -3.5, \"nearest\": true, \"level\": 2, \"step\": 4,"
              " \"iso\": [1, 2, 3.5], \"color\": \"#ff0000\", \"field\": \"p\"}",
              &r),
        ST_OK);
    assert_true(r.place.axis == 1 && r.place.at == -3.5 && r.place.slice.level == 2);
    assert_true(r.place.slice.interpolation == LEAFCAST_INTERPOLATION_NEAREST);
    assert_true(r.look.isos == 3 && r.isovalues[2] == 3.5 && r.look.line[0] == 1.0f &&
                r.look.line[1] == 0.0f);
    assert_string_equal(r.field, "p");
    assert_int_equal(r.step, 4);
    assert_int_equal(slice("{\"plane\": [1, 2, 3, -4], \"colour_map\": \"viridis\","
                           " \"window\": [0, 9], \"legend\": true, \"nearest\": false}",
                           &r),
                     ST_OK);
    assert_true(r.place.way == SLICE_PLANE && r.place.plane[3] == -4.0 && r.legend);
    assert_true(r.medium.windowed && r.medium.window[1] == 9.0);
    assert_true(r.place.slice.interpolation ==
                LEAFCAST_INTERPOLATION_LINEAR); /* nothing of before */
}

static void test_slices_refused(void **state) {
    (void)state;
    static const char *const texts[] = {"7",
                                        "[]",
                                        "null",
                                        "{\"axis\": \"q\"}",
                                        "{\"axis\": 1}",
                                        "{\"at\": \"x\"}",
                                        "{\"at\": {}}",
                                        "{\"at\": 1, \"index\": 2}",
                                        "{\"u\": [1, 0, 0]}",
                                        "{\"plane\": [1, 0, 0]}",
                                        "{\"line\": \"0,0,0;1,1,1\", \"sweep\": [0, 0, 1]}",
                                        "{\"sweep\": [0, 0, 1]}",
                                        "{\"size\": \"9x9\"}",
                                        "{\"output\": \"x.png\"}",
                                        "{\"value-f64\": \"x\"}",
                                        "{\"stats\": \"x\"}",
                                        "{\"nearest\": 1}",
                                        "{\"color\": \"red\"}",
                                        "{\"iso\": [[1]]}",
                                        "{\"tf\": \"/etc/passwd\"}",
                                        "{\"tf\": \"auto|ct\"}",
                                        "{\"colour-map\": \"/etc/passwd\"}",
                                        "{\"color_map\": \"./grey\"}",
                                        "{\"colour-map\": \"greyy\"}",
                                        "{\"window\": [2, 1]}"};
    slice_request r;
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++)
        if (slice(texts[i], &r) != ST_USAGE)
            fail_msg("taken: %s", texts[i]);
}

/* As large as fits, at the slice's proportions; at least a pixel. */
static void test_slices_fit(void **state) {
    static const struct {
        double u, v;
        uint32_t box[2], width, height;
    } cases[] = {{4, 2, {400, 400}, 400, 200}, {2, 4, {400, 400}, 200, 400},
                 {4, 2, {400, 100}, 200, 100}, {1000, 1, {50, 50}, 50, 1},
                 {1, 1e9, {50, 40}, 1, 40},    {3, 3, {1, 1}, 1, 1}};
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        leafcast_slice_pixels s = {.u = {0, cases[i].u, 0}, .v = {0, 0, -cases[i].v}};
        view_slice_state_fit(&s, cases[i].box);
        assert_int_equal(s.width, cases[i].width);
        assert_int_equal(s.height, cases[i].height);
    }
}

static void test_names_of_files(void **state) {
    (void)state;
    static const char *const texts[] = {
        "{\"output\": \"x.png\"}",
        "{\"depth-f64\": \"x\"}",
        "{\"depth_f64\": \"x\"}",
        "{\"rgba-f64\": \"x\"}",
        "{\"error-f64\": \"x\"}",
        "{\"value-f64\": \"x\"}",
        "{\"write-tf\": \"x\"}",
        "{\"camera\": {\"output\": \"x.png\"}}",
        "{\"tf\": \"/etc/passwd\"}",
        "{\"tf\": \"auto \"}",
        "{\"tf\": \"auto|ct\"}",
        "{\"colour-map\": \"/etc/passwd\"}",
        "{\"color-map\": \"./grey\"}",
        "{\"colour-map\": \"gre\"}",
        "{\"colour-map\": \"greyy\"}",
        "{\"colour-map\": \"grey|viridis\"}",
        "{\"colour-map\": \"|\"}",
        "{\"iso\": 1, \"clip-plane\": [0, 0, 1, 0], \"caps\": \"/etc/passwd\"}"};
    view_options v;
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++)
        if (apply(texts[i], &v) != ST_USAGE)
            fail_msg("taken: %s", texts[i]);
}

static void test_rubbish(void **state) {
    (void)state;
    static const char *const texts[] = {
        "",
        "7",
        "[]",
        "null",
        "{",
        "{\"iso\": 1, \"iso\": 2}",
        "{\"nothing\": 1}",
        "{\"threads\": 9}",
        "{\"memory\": \"9G\"}",
        "{\"script\": \"-\"}",
        "{\"state\": \"x\"}",
        "{\"iso\": 1e999}",
        "{\"iso\": {}}",
        "{\"iso\": [[[1]]]}",
        "{\"iso\": true}",
        "{\"shadows\": 1}",
        "{\"fov\": 1e300}",
        "{\"eye\": [1, 2]}",
        "{\"eye\": [1, 2, \"x\"]}",
        "{\"step\": -1}",
        "{\"step\": 99999999999}",
        "{\"samples\": 100000}",
        "{\"camera\": {\"camera\": {\"camera\": {\"camera\": {\"fov\": 3}}}}}",
        "{\"camera\": 3}"};
    view_options v;
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++)
        if (apply(texts[i], &v) != ST_USAGE)
            fail_msg("taken: %s", texts[i]);
}

/* Deeper and longer than anything that is meant. */
static void test_large(void **state) {
    (void)state;
    enum { ROOM = 60000 };
    static char text[ROOM + 64];
    view_options v;
    memset(text, '[', ROOM);
    text[ROOM] = 0;
    assert_int_equal(apply(text, &v), ST_USAGE);
    const int head = sprintf(text, "{\"iso\": [1");
    for (int at = head; at < ROOM; at += 2)
        memcpy(text + at, ",1", 2);
    strcpy(text + ROOM, "]}");
    assert_int_equal(apply(text, &v), ST_USAGE);
    const int name = sprintf(text, "{\"tf\": \"");
    memset(text + name, 'a', ROOM);
    strcpy(text + name + ROOM, "\"}");
    assert_int_equal(apply(text, &v), ST_USAGE);
}

static void test_tokens(void **state) {
    (void)state;
    char a[VIEW_TOKEN_TEXT], b[VIEW_TOKEN_TEXT], wrong[VIEW_TOKEN_TEXT + 1];
    assert_int_equal(view_access_token(a), ST_OK);
    assert_int_equal(view_access_token(b), ST_OK);
    assert_int_equal(strspn(a, "0123456789abcdef"), 2 * VIEW_TOKEN_BYTES);
    assert_true(view_access_same(a, a));
    assert_false(view_access_same(a, b));
    assert_false(view_access_same(a, ""));
    for (size_t i = 0; i < 2 * VIEW_TOKEN_BYTES; i++) {
        strcpy(wrong, a);
        wrong[i] = a[i] == '0' ? '1' : '0';
        assert_false(view_access_same(a, wrong));
        strcpy(wrong, a);
        wrong[i] = 0;
        assert_false(view_access_same(a, wrong));
    }
    snprintf(wrong, sizeof wrong, "%s0", a);
    assert_false(view_access_same(a, wrong));
}

static void test_hosts(void **state) {
    (void)state;
    static const char *const good[] = {"localhost", "LocalHost:80", "127.0.0.1", "127.0.0.1:65535",
                                       "[::1]",     "[::1]:8080",   "box",       "box:1"};
    static const char *const bad[] = {"",
                                      ":80",
                                      "evil",
                                      "localhost.evil",
                                      "localhost:",
                                      "localhost:x",
                                      "localhost:80:80",
                                      "localhost:123456",
                                      "127.0.0.1.evil:80",
                                      "127.0.0.11",
                                      "[::1",
                                      "[::1]evil",
                                      "::1",
                                      "localhost@evil",
                                      "evil@localhost",
                                      "box2",
                                      "bo"};
    for (size_t i = 0; i < sizeof good / sizeof *good; i++)
        assert_true(view_access_host(good[i], "box"));
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
        if (view_access_host(bad[i], "box"))
            fail_msg("taken: %s", bad[i]);
    assert_false(view_access_host("box", NULL));
    assert_true(view_access_origin("http://localhost:80", "localhost:80"));
    assert_true(view_access_origin("HTTP://LOCALHOST:80", "localhost:80"));
    assert_false(view_access_origin("http://localhost:81", "localhost:80"));
    assert_false(view_access_origin("http://localhost", "localhost:80"));
    assert_false(view_access_origin("https://localhost:80", "localhost:80"));
    assert_false(view_access_origin("http://localhost:80.evil", "localhost:80"));
    assert_false(view_access_origin("null", "localhost:80"));
    assert_false(view_access_origin("", "localhost:80"));
}

static void test_crowd(void **state) {
    (void)state;
    static char who[2 * VIEW_CROWD_MAX + 1];
    static view_crowd crowd;
    for (int i = 0; i < VIEW_CROWD_MAX; i++)
        assert_null(view_crowd_enter(&crowd, who + i));
    view_crowd_leave(&crowd, who + 1); /* it has shown the token */
    view_crowd_leave(&crowd, who + 2 * VIEW_CROWD_MAX);
    assert_null(view_crowd_enter(&crowd, who + VIEW_CROWD_MAX));
    assert_ptr_equal(view_crowd_enter(&crowd, who + VIEW_CROWD_MAX + 1), who);
    for (int i = 2; i < VIEW_CROWD_MAX; i++)
        assert_ptr_equal(view_crowd_enter(&crowd, who + VIEW_CROWD_MAX + i), who + i);
    assert_int_equal(crowd.count, VIEW_CROWD_MAX);
    view_crowd_leave(&crowd, who + 2 * VIEW_CROWD_MAX - 1); /* the newest */
    assert_int_equal(crowd.count, VIEW_CROWD_MAX - 1);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_taken),        cmocka_unit_test(test_names_of_files),
        cmocka_unit_test(test_slices_taken), cmocka_unit_test(test_slices_refused),
        cmocka_unit_test(test_slices_fit),   cmocka_unit_test(test_rubbish),
        cmocka_unit_test(test_large),        cmocka_unit_test(test_tokens),
        cmocka_unit_test(test_hosts),        cmocka_unit_test(test_crowd)};
    mem_init(&budget, 0);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
