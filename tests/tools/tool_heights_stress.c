/* tool_heights_stress.c - rays over terrains beside brute force (tests/support/heights_lab.h), at
 * length.
 *
 *   tool_heights_stress [COUNT [SHAPE]]
 *
 * COUNT rays of each shape of terrain, or of one: half of them first hits, half all hits. Prints a
 * table. Exit status 1 when there is a fault; the first ones are named. The seed is $SEED, else 1.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/support/fixture.h"
#include "tests/support/heights_lab.h"

enum { BATCH = 512, TOLD = 5 };

static uint64_t count = 10000, seed = 1;
static const char *only;
static int told;

static void tell(bool right, int shape, uint64_t of, const leafcast_ray *r) {
    if (right || told++ >= TOLD)
        return;
    printf("wrong: %s, terrain %llu, from %a %a %a along %a %a %a\n", heights_lab_name(shape),
           (unsigned long long)of, r->origin[0], r->origin[1], r->origin[2], r->direction[0],
           r->direction[1], r->direction[2]);
}

static void judge(int shape, uint64_t of, heights_tally *tally) {
    static leafcast_ray rays[BATCH];
    static leafcast_ray_hit hits[BATCH];
    field_random r = {of * 1000003 + (uint64_t)shape};
    heights_terrain t;
    const leafcast_scene scene = leafcast_scene_default();
    const leafcast_surface surface = leafcast_surface_default(0.0);
    heights_lab_make(&t, shape, of % 4 ? 20 : 90, of);
    leafcast *v = fixture_open(
        heights_lab_leaf(&t, 4 + (uint32_t)(of % 3), (uint32_t)(of / 2 % 2), of % 2), NULL);
    assert_int_equal(leafcast_select(v, &surface, 1), LEAFCAST_OK);
    bool through;
    for (int i = 0; i < BATCH; i++)
        rays[i] = heights_lab_ray(&t, i % HEIGHTS_RAYS, &r, &through);
    if (leafcast_trace_rays(v, &scene, rays, BATCH, hits) != LEAFCAST_OK)
        fail_msg("%s", leafcast_error_text());
    for (int i = 0; i < BATCH; i++)
        tell(heights_lab_judge_first(&t, &rays[i], &hits[i], tally), shape, of, &rays[i]);
    for (int i = 0; i < BATCH; i++) {
        const leafcast_ray one = heights_lab_ray(&t, i % HEIGHTS_RAYS, &r, &through);
        tell(heights_lab_judge(&t, v, &one, through, tally), shape, of, &one);
    }
    leafcast_close(v);
    heights_lab_release(&t);
}

static void run(void **state) {
    uint64_t faults = 0;
    (void)state;
    printf("%-10s %9s %9s %8s %7s %7s %7s %7s %7s %7s %9s\n", "terrain", "rays", "hits", "grazing",
           "missed", "false", "wrong t", "sides", "order", "leaks", "worst");
    for (int shape = 0; shape < HEIGHTS_SHAPES; shape++) {
        heights_tally t = {0};
        if (only && strcmp(only, heights_lab_name(shape)) != 0)
            continue;
        for (uint64_t of = seed; t.rays < count; of++)
            judge(shape, of, &t);
        printf("%-10s %9llu %9llu %8llu %7llu %7llu %7llu %7llu %7llu %7llu %9.1e\n",
               heights_lab_name(shape), (unsigned long long)t.rays, (unsigned long long)t.hits,
               (unsigned long long)t.grazing, (unsigned long long)t.missed,
               (unsigned long long)t.false_hits, (unsigned long long)t.wrong_t,
               (unsigned long long)t.wrong_side, (unsigned long long)t.wrong_order,
               (unsigned long long)t.leaks, t.worst);
        fflush(stdout);
        faults += heights_lab_faults(&t);
    }
    assert_int_equal(faults, 0);
}

int main(int argc, char **argv) {
    const char *given = getenv("SEED");
    if (argc > 1)
        count = strtoull(argv[1], NULL, 10);
    if (argc > 2)
        only = argv[2];
    if (given)
        seed = strtoull(given, NULL, 10);
    const struct CMUnitTest tests[] = {cmocka_unit_test(run)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
