/* test_trace.c - rays through whole volumes against the reference: every surface along the ray, in
 * order, in its cell, on its side; from outside, from inside, through vertices, edges and planes.
 */
/* marks: long */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

#include "tests/support/fixture.h"
#include "tests/support/ray_judge.h"

enum { RAYS = 300 };

static void check_field(const char *name, long n, uint32_t cells_log2, int iso_count) {
    field f;
    field_random random = {FIELD_SEED};
    ray_tally sum = {0};
    assert_true(field_make(&f, name, n, FIELD_SEED));
    const ref_volume v = field_volume(&f);
    leafcast *volume = fixture_open(fixture_leaf(&f, cells_log2, 1, false), NULL);
    const double isos[3] = {f.iso, f.iso * 1.1, f.iso * 0.9};
    leafcast_surface surfaces[3];
    for (int i = 0; i < iso_count; i++)
        surfaces[i] = leafcast_surface_default(isos[i]);
    assert_int_equal(leafcast_select(volume, surfaces, iso_count), LEAFCAST_OK);
    for (int i = 0; i < RAYS; i++) {
        ray_judge(&sum, volume, name, &v, field_random_ray(&v, &random, 20), isos, iso_count);
        ray_judge(&sum, volume, name, &v, field_random_ray(&v, &random, -1), isos, iso_count);
        ray_judge(&sum, volume, name, &v, field_exact_ray(&v, &random), isos, iso_count);
    }
    print_message("# %s: %d rays, %d surfaces, worst %.2g cells, %d grazing, %d faults\n", name,
                  sum.rays, sum.hits, sum.worst, sum.grazing, sum.faults);
    assert_int_equal(sum.faults, 0);
    leafcast_close(volume);
    field_release(&f);
}

static void test_every_field(void **state) {
    (void)state;
    for (int i = 0; i < field_count(); i++)
        check_field(field_name(i), 23, 4, 1);
}

static void test_several_isovalues(void **state) {
    (void)state;
    for (int i = 0; i < field_count(); i++)
        check_field(field_name(i), 19, 4, 3);
}

static void test_treelet_sizes(void **state) {
    (void)state;
    const long sizes[] = {2, 16, 17, 33, 34};
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++)
        for (uint32_t cells_log2 = 4; cells_log2 <= 6; cells_log2++)
            check_field("noise-u8", sizes[i], cells_log2, 1);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_every_field),
        cmocka_unit_test(test_several_isovalues),
        cmocka_unit_test(test_treelet_sizes),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
