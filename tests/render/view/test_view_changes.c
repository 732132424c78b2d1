/* test_view_changes.c - what a page may change of a scene's objects, and what is refused. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <string.h>

#include "render/view/view_changes.h"
#include "render/view/view_state.h"

enum { OBJECTS = 3 };

static mem budget;
static view_options views[OBJECTS], all;

/* The second object names files: a curve beside the scene file, a map elsewhere, and what colours
 * it. */
static view_scene scene_of(void) {
    static view_scene s;
    s = (view_scene){.path = "in/scene.json", .count = OBJECTS, .views = views};
    for (int i = 0; i < OBJECTS; i++) {
        view_options_init(&views[i]);
        views[i].isos = 1;
        views[i].surfaces[0].isovalue = i;
    }
    strcpy(views[1].medium.tf, "in/curve.txt");
    strcpy(views[1].medium.colour_map, "/maps/hot.json#Hot");
    strcpy(views[1].colour_by, "p.leaf:heat");
    views[1].colour_by_from = s.path;
    strcpy(s.picture_view.caps.colour_map, "in/caps.txt");
    return s;
}

static status apply(const view_scene *s, const char *text, view_changes **out) {
    json_t *object = NULL;
    status st = view_state_parse(text, strlen(text), &object);
    if (st == ST_OK)
        st = view_changes_apply(&budget, object, s, &all, out);
    json_decref(object);
    return st;
}

static void test_taken(void **state) {
    (void)state;
    const view_scene s = scene_of();
    view_changes *c = NULL;
    assert_int_equal(apply(&s, "{\"eye\": [1, 2, 3]}", &c), ST_OK);
    assert_true(!view_changes_any(c) && all.eye && all.camera.eye[2] == 3.0 && all.isos == 0);
    assert_ptr_equal(view_changes_view(c, &s, 2), &views[2]);
    view_changes_drop(c);
    assert_int_equal(apply(&s,
                           "{\"shadows\": true, \"objects\": [{\"index\": 2, \"hidden\": true},"
                           " {\"index\": 0, \"hidden\": false, \"page\": {\"x\": 1},"
                           " \"flags\": {\"iso\": [5, 6], \"opacity\": [0.5, 1]}}]}",
                           &c),
                     ST_OK);
    assert_true(view_changes_any(c) && all.scene.shadows);
    assert_true(view_changes_hides(c, 2) && !view_changes_hides(c, 0) && !view_changes_hides(c, 1));
    assert_ptr_equal(view_changes_view(c, &s, 2), &views[2]); /* hidden, but as the file says */
    const view_options *v = view_changes_view(c, &s, 0);
    assert_true(v->isos == 2 && v->surfaces[1].isovalue == 6.0 && v->surfaces[0].opacity == 0.5f);
    /* Held twice: the second one to let go frees it (which a sanitizer sees). */
    assert_ptr_equal(view_changes_hold(c), c);
    view_changes_drop(c);
    assert_true(view_changes_hides(c, 2));
    view_changes_drop(c);
    assert_null(view_changes_hold(NULL));
    assert_int_equal(mem_used(&budget), 0);
}

/* Names of files as the scene file has them for that object lead where they did. */
static void test_own_files(void **state) {
    (void)state;
    const view_scene s = scene_of();
    view_changes *c = NULL;
    assert_int_equal(apply(&s,
                           "{\"caps\": \"caps.txt\", \"objects\": [{\"index\": 1, \"flags\":"
                           " {\"iso\": 3, \"tf\": \"curve.txt\", \"color_map\":"
                           " \"/maps/hot.json#Hot\", \"colour-by\": \"p.leaf:heat\"}}]}",
                           &c),
                     ST_OK);
    const view_options *v = view_changes_view(c, &s, 1);
    assert_string_equal(v->medium.tf, "in/curve.txt");
    assert_string_equal(v->medium.colour_map, "/maps/hot.json#Hot");
    assert_string_equal(v->colour_by, "p.leaf:heat");
    assert_ptr_equal(v->colour_by_from, s.path);
    assert_true(v->isos == 1 && all.scene.caps);
    assert_string_equal(all.caps.colour_map, "in/caps.txt");
    view_changes_drop(c);
    assert_int_equal(apply(&s, "{\"objects\": [{\"index\": 1, \"flags\": {\"tf\": \"ct\"}}]}", &c),
                     ST_OK);
    assert_string_equal(view_changes_view(c, &s, 1)->medium.tf, "ct");
    assert_string_equal(view_changes_view(c, &s, 1)->colour_by, "");
    view_changes_drop(c);
    assert_int_equal(mem_used(&budget), 0);
}

static void test_refused(void **state) {
    (void)state;
    static const char *const texts[] = {
        "{\"iso\": 3}",
        "{\"isovalues\": [3]}",
        "{\"colour-by\": \"p\"}",
        "{\"tf\": \"auto\"}",
        "{\"camera\": {\"iso\": 3}}",
        "{\"camera\": {\"eye\": [1, 2, 3]}}",
        "{\"output\": \"x.png\"}",
        "{\"caps\": \"in/caps.txt\"}",
        "{\"caps\": \"/etc/passwd\"}",
        "{\"nothing\": 1}",
        "{\"objects\": 7}",
        "{\"objects\": {}}",
        "{\"objects\": null}",
        "{\"objects\": \"0\"}",
        "{\"objects\": [7]}",
        "{\"objects\": [null]}",
        "{\"objects\": [[]]}",
        "{\"objects\": [{}]}",
        "{\"objects\": [{\"index\": -1}]}",
        "{\"objects\": [{\"index\": 3}]}",
        "{\"objects\": [{\"index\": 4294967296}]}",
        "{\"objects\": [{\"index\": 9223372036854775807}]}",
        "{\"objects\": [{\"index\": 1.5}]}",
        "{\"objects\": [{\"index\": 1.0}]}",
        "{\"objects\": [{\"index\": \"1\"}]}",
        "{\"objects\": [{\"index\": true}]}",
        "{\"objects\": [{\"hidden\": true}]}",
        "{\"objects\": [{\"index\": 1}, {\"index\": 1}]}",
        "{\"objects\": [{\"index\": 0}, {\"index\": 1}, {\"index\": 2}, {\"index\": 0}]}",
        "{\"objects\": [{\"index\": 1, \"hidden\": 1}]}",
        "{\"objects\": [{\"index\": 1, \"hidden\": null}]}",
        "{\"objects\": [{\"index\": 1, \"file\": \"/etc/passwd\"}]}",
        "{\"objects\": [{\"index\": 1, \"transform\": [1]}]}",
        "{\"objects\": [{\"index\": 1, \"page\": 1}]}",
        "{\"objects\": [{\"index\": 1, \"flags\": 7}]}",
        "{\"objects\": [{\"index\": 1, \"flags\": []}]}",
        "{\"objects\": [{\"index\": 1, \"flags\": {\"eye\": [1, 2, 3]}}]}",
        "{\"objects\": [{\"index\": 1, \"flags\": {\"camera\": {}}}]}",
        "{\"objects\": [{\"index\": 1, \"flags\": {\"output\": \"x.png\"}}]}",
        "{\"objects\": [{\"index\": 1, \"flags\": {\"file\": \"x.leaf\"}}]}",
        "{\"objects\": [{\"index\": 1, \"flags\": {\"surfaces\": []}}]}",
        "{\"objects\": [{\"index\": 1, \"flags\": {\"tf\": \"in/curve.txt\"}}]}",
        "{\"objects\": [{\"index\": 0, \"flags\": {\"tf\": \"curve.txt\"}}]}",
        "{\"objects\": [{\"index\": 0, \"flags\": {\"tf\": \"\"}}]}",
        "{\"objects\": [{\"index\": 1, \"flags\": {\"colour-map\": \"curve.txt\"}}]}",
        "{\"objects\": [{\"index\": 0, \"flags\": {\"iso\": 1, \"colour-by\": \"p.leaf:heat\"}}]}",
        "{\"objects\": [{\"index\": 1, \"flags\": {\"iso\": 1, \"colour-by\": \"0\"}}]}",
        "{\"objects\": [{\"index\": 1, \"flags\": {\"iso\": \"x\"}}]}",
        ("{\"objects\": [{\"index\": 0, \"hidden\": true}, {\"index\": 1, \"hidden\": true},"
         " {\"index\": 2, \"hidden\": true}]}")};
    const view_scene s = scene_of();
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
        view_changes *c = NULL;
        if (apply(&s, texts[i], &c) != ST_USAGE || c)
            fail_msg("taken: %s", texts[i]);
    }
    assert_int_equal(mem_used(&budget), 0);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_taken),
                                       cmocka_unit_test(test_own_files),
                                       cmocka_unit_test(test_refused)};
    mem_init(&budget, 0);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
