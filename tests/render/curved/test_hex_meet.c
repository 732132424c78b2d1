/* test_hex_meet.c - isosurfaces in hexahedra without crossing their faces: the roots that crossings
 * give, and most cells take none of those.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

#include "formats/base/vec3.h"
#include "render/curved/hex_meet.h"
#include "tests/support/hex_lab.h"
#include "tests/support/watched.h"

enum { CELLS = HEX_LAB_CELLS * HEX_LAB_CELLS * HEX_LAB_CELLS };

typedef struct tally {
    long cells, roots, crossed, doubtful;
    double worst;
} tally;

static bool has(const hexahedron *h, double isovalue) {
    double lo = INFINITY, hi = -INFINITY;
    for (int c = 0; c < HEX_CORNERS; c++) {
        lo = real_min(lo, h->value[c]);
        hi = real_max(hi, h->value[c]);
    }
    return lo < isovalue && isovalue <= hi;
}

static void compare(const hex_lab *s, const hexahedron *h, const sheared_ray *r, tally *sum) {
    const int sense = hexahedron_sense(h->p);
    path_root want[PATH_ROOTS], got[PATH_ROOTS];
    path_counts all = {0}, crossed = {0};
    hex_path path;
    const int parts = hex_path_of(h, sense, r, &path);
    const int wanted = parts ? hex_roots(h, sense, &path, s->iso, want, &all) : 0;
    const int count = hex_meet_roots(h, sense, r, s->iso, got, &crossed);
    sum->cells++;
    sum->crossed += crossed.paths > 0;
    if (all.doubtful) {
        sum->doubtful++;
        return;
    }
    assert_int_equal(count, wanted);
    for (int i = 0; i < count; i++) {
        sum->roots++;
        sum->worst = real_max(sum->worst, fabs(got[i].t - want[i].t) / s->size);
        assert_int_equal(got[i].entering, want[i].entering);
        for (int a = 0; a < 3; a++)
            assert_true(got[i].at[a] >= 0.0 && got[i].at[a] <= 1.0);
    }
}

static void test_same_roots(void **state) {
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
                const hexahedron h = hex_lab_cell(&s, at);
                if (has(&h, s.iso))
                    compare(&s, &h, &sheared, &sum);
            }
        }
        print_message("%-10s %6ld cells, %5ld roots, %5ld crossed, %ld doubtful; t apart by %.1g\n",
                      s.name, sum.cells, sum.roots, sum.crossed, sum.doubtful, sum.worst);
        assert_true(sum.roots > 100 && sum.crossed * 20 < sum.cells);
        assert_true(sum.worst < 1e-13);
        assert_true(sum.doubtful * 200 < sum.cells);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_same_roots)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
