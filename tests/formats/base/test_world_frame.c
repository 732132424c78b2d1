/* test_world_frame.c - what the world's axes mean: names, turns, texts, and the section of a
 * treelet file that keeps them, damaged in each way.
 */
/* marks: plain */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <stdlib.h>
#include <string.h>

#include "tests/support/leaf_files.h"
#include "tests/support/leaf_image.h"
#include "tests/support/scratch.h"

static mem m;

static void test_names(void **state) {
    (void)state;
    world_axes axes;
    for (uint32_t i = WORLD_UNTOLD + 1; i < WORLD_AXES; i++) {
        assert_true(world_axes_find(world_axes_name(i), &axes));
        assert_int_equal(axes, i);
        for (int a = 0; a < 3; a++)
            assert_int_not_equal(world_axes_end(i, a, false), world_axes_end(i, a, true));
    }
    assert_true(world_axes_find("lps", &axes) && axes == WORLD_LPS);
    assert_true(world_axes_find("NONE", &axes) && axes == WORLD_UNTOLD);
    assert_false(world_axes_find("", &axes));
    assert_false(world_axes_find("LPI", &axes));
    assert_int_equal(world_axes_end(WORLD_LPS, 0, true), 'L');
    assert_int_equal(world_axes_end(WORLD_RAS, 1, true), 'A');
    assert_int_equal(world_axes_end(WORLD_UNTOLD, 0, true), 0);
    assert_int_equal(world_axes_end(WORLD_AXES, 2, false), 0);
    assert_string_equal(world_axes_name(WORLD_AXES), "");
}

static void test_turn(void **state) {
    (void)state;
    const double map[3][4] = {{1, 0, 2, 3}, {0, -4, 0, 5}, {6, 0, 7, 8}};
    const double other[3][4] = {{-1, 0, -2, -3}, {0, 4, 0, -5}, {6, 0, 7, 8}};
    double turned[3][4];
    memcpy(turned, map, sizeof turned);
    assert_true(world_axes_turn(WORLD_LPS, WORLD_LPS, turned));
    assert_memory_equal(turned, map, sizeof map);
    assert_false(world_axes_turn(WORLD_UNTOLD, WORLD_RAS, turned));
    assert_false(world_axes_turn(WORLD_RAS, WORLD_UNTOLD, turned));
    assert_memory_equal(turned, map, sizeof map);
    assert_true(world_axes_turn(WORLD_LPS, WORLD_RAS, turned));
    assert_memory_equal(turned, other, sizeof other); /* to the bit: no -0 */
    assert_true(world_axes_turn(WORLD_RAS, WORLD_LPS, turned));
    assert_memory_equal(turned, map, sizeof map);
}

static void test_texts(void **state) {
    (void)state;
    world_frame f = {0};
    char text[WORLD_FRAME_TEXT], units[WORLD_UNITS_TEXT];
    assert_false(world_frame_is_told(&f));
    assert_string_equal(world_frame_print(&f, text), "");
    world_frame_set(&f, WORLD_UNTOLD, "mm");
    assert_true(world_frame_is_told(&f));
    assert_string_equal(world_frame_print(&f, text), "mm");
    world_frame_set_unit(&f, 2, "");
    assert_string_equal(world_frame_unit(&f), "");
    assert_string_equal(world_frame_units_print(&f, units), "mm, mm, -");
    world_frame_set_unit(&f, 0, "a unit with \"quotes\", longer than there is room for");
    assert_int_equal(strlen(f.unit[0]), WORLD_UNIT - 1);
    assert_null(strchr(f.unit[0], '"'));
    world_frame_set_unit(&f, 0, "m"); /* nothing stays of the longer one */
    for (int i = 1; i < WORLD_UNIT; i++)
        assert_int_equal(f.unit[0][i], 0);
    world_frame_set(&f, WORLD_LPS, "um");
    assert_string_equal(world_frame_print(&f, text),
                        "LPS (x to the left, y to the back, z to the head), um");
}

static status opens(const void *bytes, size_t size) {
    leaf_file *f = NULL;
    const status st = leaf_file_open_memory(&m, "world.leaf", bytes, size, &f);
    leaf_file_close(f);
    return st;
}

static leaf_image make(world_axes axes, const char *unit) {
    leaf_case c = leaf_files_case(20, 10, 8, SAMPLE_U8);
    void *samples = leaf_files_random(&c, 3, 0);
    c.samples = samples;
    c.axes = axes;
    c.unit = unit;
    size_t size = 0;
    char *bytes = scratch_read(leaf_files_make(&c, "world.leaf"), &size);
    free(samples);
    return leaf_image_of(bytes, size);
}

static void test_file(void **state) {
    (void)state;
    leaf_image i = make(WORLD_RAS, "mm");
    leaf_file *f = NULL;
    assert_int_equal(leaf_file_open_memory(&m, "world.leaf", i.bytes, i.size, &f), ST_OK);
    assert_int_equal(f->frame.axes, WORLD_RAS);
    assert_string_equal(world_frame_unit(&f->frame), "mm");
    leaf_file_close(f);
    free(i.bytes);
    i = make(WORLD_UNTOLD, NULL);
    assert_null(leaf_image_section(&i, LEAF_SECTION_WORLD));
    free(i.bytes);
}

/* Sealed again, so that nothing but the section is wrong. */
static void test_damage(void **state) {
    (void)state;
    leaf_image i = make(WORLD_LPS, "mm");
    world_frame *frame = leaf_image_section(&i, LEAF_SECTION_WORLD);
    assert_non_null(frame);
    const world_frame sound = *frame;
    for (size_t at = 0; at < sizeof sound; at++) {
        ((char *)frame)[at] ^= 0x40;
        leaf_image_seal(&i);
        /* Letters are others then, and behind a text's end, but for its last byte, lies nothing. */
        const bool letter = at >= 8 && at < 104 && (at - 8) % WORLD_UNIT < 3;
        const bool begins = at == 104;
        if (opens(i.bytes, i.size) != (letter || begins ? ST_OK : ST_CORRUPT))
            fail_msg("byte %zu of the section was changed: %s", at,
                     letter || begins ? "refused" : "nobody noticed");
        *frame = sound;
    }
    *frame = (world_frame){0};
    leaf_image_seal(&i);
    assert_int_equal(opens(i.bytes, i.size), ST_CORRUPT);
    *frame = sound;
    leaf_image_seal(&i);
    assert_int_equal(opens(i.bytes, i.size), ST_OK);
    free(i.bytes);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_names), cmocka_unit_test(test_turn),   cmocka_unit_test(test_texts),
        cmocka_unit_test(test_file),  cmocka_unit_test(test_damage),
    };
    mem_init(&m, 0);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
