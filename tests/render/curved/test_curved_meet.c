/* test_curved_meet.c - isosurfaces in curved cells without crossing their faces: the roots that
 * crossings give, and most cells take none of those.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

#include "formats/base/vec3.h"
#include "render/curved/curved_meet.h"
#include "tests/support/hex_lab.h"
#include "tests/support/quadratic_lab.h"
#include "tests/support/watched.h"

enum { CELLS = HEX_LAB_CELLS * HEX_LAB_CELLS * HEX_LAB_CELLS };

typedef struct tally {
    long cells, roots, crossed, doubtful;
    double worst;
} tally;

static void compare(curved_cell *cell, double isovalue, double size, const sheared_ray *r,
                    tally *sum) {
    path_root want[PATH_ROOTS], got[PATH_ROOTS];
    path_counts all = {0}, crossed = {0};
    double range[2];
    curved_cell_range(cell, range);
    if (!(range[0] < isovalue && isovalue <= range[1]))
        return;
    cell->sense = curved_cell_sense(cell);
    const int wanted = curved_meet_crossed(cell, r, isovalue, want, &all);
    const int count = curved_meet_roots(cell, r, isovalue, got, &crossed);
    sum->cells++;
    sum->crossed += crossed.paths > 0;
    if (all.doubtful) {
        sum->doubtful++;
        return;
    }
    assert_int_equal(count, wanted);
    for (int i = 0; i < count; i++) {
        sum->roots++;
        sum->worst = real_max(sum->worst, fabs(got[i].t - want[i].t) / size);
        assert_int_equal(got[i].entering, want[i].entering);
        for (int a = 0; a < 3; a++)
            assert_true(got[i].at[a] >= 0.0 && got[i].at[a] <= 1.0);
    }
}

static void judge(const char *name, const tally *sum) {
    print_message("%-10s %6ld cells, %5ld roots, %5ld crossed, %ld doubtful; t apart by %.1g\n",
                  name, sum->cells, sum->roots, sum->crossed, sum->doubtful, sum->worst);
    assert_true(sum->roots > 100 && sum->crossed * 20 < sum->cells);
    assert_true(sum->worst < 1e-13);
    assert_true(sum->doubtful * 200 < sum->cells);
}

static void test_hexahedra(void **state) {
    enum { RAYS = SLOW ? 300 : 2000 };
    (void)state;
    for (int n = 0; n < hex_lab_count(); n++) {
        hex_lab s;
        field_random random = {FIELD_SEED + (uint64_t)n};
        tally sum = {0};
        hex_lab_make(&s, n, FIELD_SEED);
        for (int i = 0; i < RAYS; i++) {
            bool special;
            const ray r = hex_lab_ray(&s, &random, &special);
            const sheared_ray sheared = sheared_ray_of(r.o, r.d);
            for (int c = 0; c < CELLS && !special; c++) {
                const int at[3] = {c % HEX_LAB_CELLS, c / HEX_LAB_CELLS % HEX_LAB_CELLS,
                                   c / (HEX_LAB_CELLS * HEX_LAB_CELLS)};
                curved_cell cell = {.quadratic = false, .hexahedron = hex_lab_cell(&s, at)};
                compare(&cell, s.iso, s.size, &sheared, &sum);
            }
        }
        judge(s.name, &sum);
    }
}

static void test_quadratic_tets(void **state) {
    enum { RAYS = SLOW ? 300 : 2000 };
    (void)state;
    for (int n = 0; n < quadratic_lab_count(); n++) {
        quadratic_lab s;
        field_random random = {FIELD_SEED + (uint64_t)n};
        tally sum = {0};
        quadratic_lab_make(&s, n, FIELD_SEED);
        for (int i = 0; i < RAYS; i++) {
            bool special;
            const ray r = quadratic_lab_ray(&s, &random, &special);
            const sheared_ray sheared = sheared_ray_of(r.o, r.d);
            for (int c = 0; c < QUADRATIC_LAB_CELLS && !special; c++) {
                curved_cell cell = {.quadratic = true, .tet = quadratic_lab_cell(&s, c, NULL)};
                compare(&cell, s.iso, s.size, &sheared, &sum);
            }
        }
        judge(s.name, &sum);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_hexahedra),
                                       cmocka_unit_test(test_quadratic_tets)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
