/* tool_triangle_stress.c - surfaces of triangles beside brute force in long double
 * (tests/support/triangle_truth.h), at length.
 *
 *   tool_triangle_stress [COUNT [CASE]]
 *
 * COUNT rays of each surface of tests/support/triangle_lab.c, or of one: first hits, and any hits.
 * Prints a table, and the rays with a fault. Exit status 1 when there is one. The seed is $SEED,
 * else 1.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/support/fixture.h"
#include "tests/support/scratch.h"
#include "tests/support/triangle_truth.h"

enum { BATCH = 4096, TREELET = 64 };

static uint64_t count = 10000, seed = 1;
static const char *only;
static uint64_t faults;
static triangle_lab lab;

static void stress(int n) {
    static leafcast_ray rays[BATCH];
    static leafcast_ray_hit hits[BATCH];
    static uint8_t occluded[BATCH];
    const leafcast_surface surface = leafcast_surface_default(0.0);
    const leafcast_scene scene = leafcast_scene_default();
    triangle_tally t = {0};
    mesh_result result;
    field_random r = {seed + 1000 * (uint64_t)n};
    triangle_lab_convert(&lab, scratch_path("stress.leaf"), TREELET, "f", n % 2, &result);
    leafcast *v = fixture_open(scratch_path("stress.leaf"), NULL);
    assert_int_equal(leafcast_select(v, &surface, 1), LEAFCAST_OK);
    while (t.rays < count) {
        for (int i = 0; i < BATCH; i++) {
            rays[i] = (leafcast_ray){.t1 = (double)INFINITY};
            triangle_lab_ray(&lab, &r, rays[i].origin, rays[i].direction);
        }
        assert_int_equal(leafcast_trace_rays(v, &scene, rays, BATCH, hits), LEAFCAST_OK);
        assert_int_equal(leafcast_occluded_rays(v, &scene, rays, BATCH, occluded), LEAFCAST_OK);
        for (int i = 0; i < BATCH; i++) {
            const bool right =
                triangle_truth_judge(&lab, rays[i].origin, rays[i].direction, hits[i].t, &t) &&
                occluded[i] == !isinf(hits[i].t);
            faults += !right;
            if (!right)
                printf("  %s: from %a %a %a along %a %a %a: %.17g\n", lab.name, rays[i].origin[0],
                       rays[i].origin[1], rays[i].origin[2], rays[i].direction[0],
                       rays[i].direction[1], rays[i].direction[2], hits[i].t);
        }
    }
    leafcast_close(v);
    printf("%-10s %10llu %10llu %10llu %6llu %6llu %6llu  %.1e\n", lab.name,
           (unsigned long long)t.rays, (unsigned long long)t.doubtful,
           (unsigned long long)t.surfaces, (unsigned long long)t.missed,
           (unsigned long long)t.invented, (unsigned long long)t.wrong, t.worst);
    fflush(stdout);
}

static void test_all(void **state) {
    (void)state;
    printf("%-10s %10s %10s %10s %6s %6s %6s  %s\n", "surface", "rays", "doubtful", "surfaces",
           "missed", "false", "wrong", "worst, edges");
    for (int n = 0; n < triangle_lab_count(); n++) {
        triangle_lab_make(&lab, n, seed);
        if (!only || strcmp(only, lab.name) == 0)
            stress(n);
    }
    assert_int_equal(faults, 0);
}

int main(int argc, char **argv) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_all)};
    const char *text = getenv("SEED");
    seed = text ? strtoull(text, NULL, 10) : 1;
    if (argc > 1)
        count = strtoull(argv[1], NULL, 10);
    only = argc > 2 ? argv[2] : NULL;
    return cmocka_run_group_tests(tests, NULL, NULL) > 0;
}
