/* test_mesh_naive.c - what convert makes of meshes, as a second reader written from FORMAT.md alone
 * sees it. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <math.h>

#include "tests/support/fields.h"
#include "tests/support/mesh_cases.h"
#include "tests/support/naive_mesh.h"
#include "tests/support/scratch.h"

static mem m;

static void check_case(const mesh_case *c, const char *what) {
    mesh_result r;
    naive_mesh naive;
    if (mesh_cases_convert(&m, c, "naive.leaf", 0, &r) != ST_OK)
        fail_msg("%s: %s", what, status_text());
    m.limit = 0;
    if (!naive_mesh_load(&naive, scratch_path("naive.leaf")))
        fail_msg("%s: %s", what, naive.why);
    assert_int_equal(naive.tets + (long)r.header.repeated + (long)r.header.bad, c->tet_count);
    naive_mesh_release(&naive);
}

static void test_cubes(void **state) {
    (void)state;
    static const uint32_t sizes[][2] = {{1, 1}, {5, 5}, {64, 1}, {300, 12}, {4096, 8}, {16384, 64}};
    for (size_t i = 0; i < sizeof sizes / sizeof sizes[0]; i++)
        for (int zstd = 0; zstd < 2; zstd++) {
            mesh_case c = mesh_cases_kuhn(i ? 11 : 2, 7, 5);
            mesh_cases_shuffle(&c, i);
            c.options.treelet_tets = sizes[i][0];
            c.options.leaf_tets = sizes[i][1];
            c.options.file.codec = zstd ? LEAF_CODEC_ZSTD : LEAF_CODEC_RAW;
            c.options.file.zstd_level = 1;
            check_case(&c, "cube");
            mesh_cases_free(&c);
        }
}

/* Overlapping tets of random vertices, some of them flat; values missing. */
static void test_soups(void **state) {
    (void)state;
    for (uint64_t seed = 1; seed < 6; seed++) {
        mesh_case c = mesh_cases_soup(40 * seed * seed, 300 * seed * seed, seed);
        c.options.treelet_tets = 200;
        check_case(&c, "soup");
        mesh_cases_free(&c);
    }
}

/* Far from the origin, where planes coincide; tiny; huge; flat as a whole. */
static void test_places(void **state) {
    (void)state;
    static const float places[][4] = {{1e7F, 1, 1, 1},
                                      {0, 1e-36F, 1e-36F, 1e-40F},
                                      {0, 1e37F, 3e37F, 1},
                                      {-3, 1, 0, 1},
                                      {5, 0, 0, 1}};
    for (size_t i = 0; i < sizeof places / sizeof places[0]; i++) {
        mesh_case c = mesh_cases_kuhn(6, 6, 6);
        for (size_t v = 0; v < c.point_count; v++)
            for (int a = 0; a < 3; a++)
                c.points[v][a] = places[i][0] + places[i][a + 1] * c.points[v][a];
        c.options.treelet_tets = 100;
        check_case(&c, "place");
        mesh_cases_free(&c);
    }
}

static int set_up(void **state) {
    (void)state;
    mem_init(&m, 0);
    return 0;
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup(test_cubes, set_up),
        cmocka_unit_test_setup(test_soups, set_up),
        cmocka_unit_test_setup(test_places, set_up),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
