/* test_coarse_faults.c - a preview whose coarse grid finds no memory is drawn without it, or
 * refused whole; the exact picture comes after either. One inside another that is damaged.
 */
/* marks: threads */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <stdio.h>
#include <stdlib.h>

#include "formats/base/fault.h"
#include "formats/leaf/leaf_file.h"
#include "tests/support/coarse_subjects.h"
#include "tests/support/fixture.h"
#include "tests/support/pictures.h"
#include "tests/support/scratch.h"

/* level: in a preview. */
static leafcast_status draw(leafcast *v, bool preview, uint32_t level) {
    static picture p;
    leafcast_scene scene = leafcast_scene_default();
    scene.preview = preview;
    scene.lod = level ? LEAFCAST_LOD_LEVEL : LEAFCAST_LOD_EXACT;
    scene.lod_level = level;
    const leafcast_camera view = leafcast_standard_view(v, 1.3, PICTURE_WIDTH, PICTURE_HEIGHT);
    const leafcast_image image = {.size = sizeof image, .z = p.z, .provisional = p.provisional};
    return leafcast_trace(v, &scene, &view, &image, NULL, NULL, NULL);
}

/* The k-th allocation fails. Returns false if it never came. */
static bool fail_at(long k, uint32_t level, int *drawn, int *refused) {
    const leafcast_surface s = leafcast_surface_default(0.4);
    leafcast *v = fixture_open(scratch_path("coarse.leaf"),
                               &(leafcast_options){.size = sizeof(leafcast_options), .threads = 1});
    assert_int_equal(leafcast_select(v, &s, 1), LEAFCAST_OK);
    fault_arm(FAULT_ALLOC, k);
    const leafcast_status st = draw(v, true, level);
    const bool fired = fault_fired(FAULT_ALLOC);
    fault_arm(FAULT_ALLOC, 0);
    assert_true(st == LEAFCAST_OK || st == LEAFCAST_NOMEM);
    *drawn += fired && st == LEAFCAST_OK;
    *refused += fired && st == LEAFCAST_NOMEM;
    assert_int_equal(draw(v, true, level), LEAFCAST_OK);
    assert_int_equal(draw(v, false, 0), LEAFCAST_OK);
    leafcast_close(v);
    return fired;
}

static void test_no_memory(void **state) {
    (void)state;
    for (subject of = TETS; of < SUBJECTS; of++) {
        mem m;
        mem_init(&m, 0);
        coarse_subjects_make(&m, of, "coarse.leaf", NULL, true);
        for (uint32_t level = 0; level < 3; level += 2) {
            int drawn = 0, refused = 0;
            for (long k = 1; fail_at(k, level, &drawn, &refused); k++)
                assert_true(k < 10000);
            assert_true(drawn > 5 && refused > 0);
        }
    }
}

static void damage(const char *path, uint64_t at) {
    FILE *f = fopen(path, "r+b");
    assert_non_null(f);
    assert_int_equal(fseek(f, (long)at, SEEK_SET), 0);
    const int byte = fgetc(f);
    assert_int_equal(fseek(f, (long)at, SEEK_SET), 0);
    assert_true(fputc(byte ^ 16, f) != EOF);
    assert_int_equal(fclose(f), 0);
}

/* A damaged directory of the grid inside a thinned one: its levels are none, or fail. All others
 * are drawn. */
static void test_inside(void **state) {
    (void)state;
    mem m;
    size_t size;
    leaf_file *f = NULL, *coarse = NULL;
    const leafcast_surface s = leafcast_surface_default(0.4);
    mem_init(&m, 0);
    coarse_subjects_make(&m, THINNED, "coarse.leaf", NULL, true);
    assert_int_equal(leaf_file_open(&m, scratch_path("coarse.leaf"), &f), ST_OK);
    assert_int_equal(leaf_file_open_coarse(&m, f, 0, &coarse), ST_OK);
    const uint64_t inside = f->coarse[0].offset + coarse->coarse[0].offset;
    leaf_file_close(coarse);
    leaf_file_close(f);
    char *bytes = scratch_read(scratch_path("coarse.leaf"), &size);
    for (uint64_t at = 0; at < 400; at += 13) {
        leafcast *v;
        bytes[inside + at] ^= 16;
        v = fixture_open(scratch_write("bad.leaf", bytes, size), NULL);
        assert_int_equal(leafcast_select(v, &s, 1), LEAFCAST_OK);
        assert_int_equal(draw(v, true, 1), LEAFCAST_OK);
        assert_int_equal(draw(v, true, 2), LEAFCAST_OK); /* the last level that there is */
        assert_int_equal(draw(v, true, 0), LEAFCAST_OK);
        assert_int_equal(draw(v, false, 0), LEAFCAST_OK);
        leafcast_close(v);
        bytes[inside + at] ^= 16;
    }
    /* Once the file is open, it is known that there is one. */
    leafcast *v = fixture_open(scratch_write("bad.leaf", bytes, size), NULL);
    assert_int_equal(leafcast_select(v, &s, 1), LEAFCAST_OK);
    damage(scratch_path("bad.leaf"), inside + 100);
    assert_int_equal(draw(v, true, 2), LEAFCAST_CORRUPT);
    leafcast_close(v);
    free(bytes);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_no_memory),
                                       cmocka_unit_test(test_inside)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
