/* test_render_ahead.c - what a volume reads ahead for the pictures that come.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <stdio.h>
#include <string.h>

#include "render/app/render_ahead.h"
#include "render/door/leafcast_volume.h"
#include "stream/loader_private.h"
#include "tests/support/between_lab.h"

static view_options *moment(uint32_t step, double between) {
    static view_options v[16];
    static int used;
    view_options *of = &v[used++ % 16];
    view_options_init(of);
    of->step = step;
    of->time.between = between;
    return of;
}

static uint32_t expected(const leafcast *v) {
    return v->treelets->hidden->expected;
}

/* The first step that is another one; the first time between others; a field or step that is not
 * there is passed over. */
static void test_note(void **state) {
    (void)state;
    static picture p;
    between_lab *s = between_lab_make(&between_kinds[0]);
    leafcast *v = between_lab_open(s->series, NULL, s->iso);
    const leafcast_scene scene = between_lab_scene(s, SURFACE);
    render_ahead a = {.volume = v, .now = moment(1, 0)};
    assert_true(render_ahead_note(&a, moment(1, 0)));
    assert_int_equal(expected(v), TREELET_NO_SET);
    assert_true(render_ahead_note(&a, moment(BETWEEN_STEPS, 0)));
    view_options *other = moment(3, 0);
    snprintf(other->field, sizeof other->field, "nix");
    assert_true(render_ahead_note(&a, other));
    assert_int_equal(expected(v), TREELET_NO_SET);
    assert_true(render_ahead_note(&a, moment(4, 0)));
    assert_int_equal(expected(v), 4);
    assert_true(render_ahead_note(&a, moment(2, 0)));
    assert_int_equal(expected(v), 4);

    /* Both kinds; of its own, another step than the picture's. */
    between_lab_fine(leafcast_select_between(v, 0, 0, 0.5));
    pictures_draw(v, &scene, &s->view, &p, NULL);
    a = (render_ahead){.volume = v, .now = moment(0, 0.5)};
    assert_true(render_ahead_note(&a, moment(0, 0.75)));
    assert_int_equal(expected(v->between), TREELET_NO_SET);
    assert_true(render_ahead_note(&a, moment(0, 0)));
    assert_int_equal(expected(v), 0);
    assert_false(render_ahead_note(&a, moment(1, 0.25)));
    assert_true(expected(v->between) != TREELET_NO_SET);
    assert_int_equal(expected(v), 0);

    /* Of the other kind, the same step, too. */
    a = (render_ahead){.volume = v, .now = moment(1, 0)};
    loader_expect(v->between->treelets, TREELET_NO_SET);
    assert_true(render_ahead_note(&a, moment(1, 0.25)));
    assert_true(expected(v->between) != TREELET_NO_SET);
    leafcast_close(v);
    between_lab_free(s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_note),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
