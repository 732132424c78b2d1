/* test_triangle_batch.c - rays of all sorts through surfaces of triangles in batches: each has the
 * answer of tracer_next() to the bit, whatever goes with it, the ISA, the treelets and which of
 * them are there. */
/* marks: long */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <stdlib.h>
#include <string.h>

#include "tests/support/batch_stage.h"
#include "tests/support/fixture.h"
#include "tests/support/scratch.h"
#include "tests/support/triangle_batch_wide.h"
#include "tests/support/triangle_lab.h"

#ifdef __SANITIZE_ADDRESS__
enum { BATCHES = 4 };
#else
enum { BATCHES = 20 };
#endif

static triangle_lab lab;

static void line_of_lab(const void *of, field_random *random, double o[3], double d[3]) {
    triangle_lab_ray(of, random, o, d);
}

static void stage_open(batch_stage *s, int n, uint32_t most) {
    const leafcast_surface surface = leafcast_surface_default(0.0);
    mesh_result result;
    triangle_lab_make(&lab, n, FIELD_SEED);
    triangle_lab_convert(&lab, scratch_path("lab.leaf"), most, n % 2 ? "rgb" : "f", false, &result);
    *s = (batch_stage){
        .name = lab.name, .wide = triangle_batch_wide, .line = line_of_lab, .lab = &lab};
    for (int a = 0; a < 3; a++)
        s->size[a] = lab.size;
    s->v = fixture_open(scratch_path("lab.leaf"), NULL);
    batch_stage_set(s, &surface, 1, false);
}

static void test_every_surface(void **state) {
    (void)state;
    static ray_batch b;
    uint64_t rays = 0, hits = 0;
    for (int n = 0; n < triangle_lab_count(); n++) {
        batch_stage s;
        stage_open(&s, n, n % 2 ? 300 : 60);
        batch_stage_load(&s, true);
        for (int i = 0; i < BATCHES; i++) {
            batch_stage_fill(&s, &b);
            batch_stage_check(&s, &b, true);
        }
        rays += s.rays;
        hits += s.hits;
        assert_int_equal(s.blocked, 0);
        batch_stage_close(&s);
    }
    print_message("%llu rays, %llu hits\n", (unsigned long long)rays, (unsigned long long)hits);
    assert_true(hits > rays / 8);
}

/* The same results while treelets are absent, and what single rays have left is gone on with. */
static void test_absent_treelets(void **state) {
    (void)state;
    static ray_batch b, left;
    uint64_t blocked = 0;
    for (int n = 0; n < triangle_lab_count(); n++) {
        batch_stage s;
        stage_open(&s, n, 50);
        for (int i = 0; i < BATCHES; i++) {
            batch_stage_load(&s, true);
            batch_stage_fill(&s, &b);
            batch_stage_load(&s, false);
            batch_stage_check(&s, &b, false);
            batch_stage_single(&s, &b, &left);
            for (unsigned k = 0; k < left.count; k++)
                if (left.results[k] == TRACE_BLOCKED)
                    b.states[k] = left.states[k];
            batch_stage_load(&s, i % 2 == 0);
            batch_stage_check(&s, &b, i % 2 == 0);
        }
        blocked += s.blocked;
        batch_stage_close(&s);
    }
    print_message("%llu rays waited\n", (unsigned long long)blocked);
    assert_true(blocked > 1000);
}

/* A batch of neighbours visits fewer nodes than its rays do one by one. */
static void test_together(void **state) {
    (void)state;
    static ray_batch b;
    batch_stage s;
    stage_open(&s, 0, 300);
    batch_stage_load(&s, true);
    b.count = RAY_BATCH;
    for (unsigned i = 0; i < RAY_BATCH; i++) {
        const hit before = hit_before_all();
        const double d[3] = {1.0, 0.01, 0.02};
        const double o[3] = {lab.middle[0] - 2.0 * lab.size,
                             lab.middle[1] + lab.size * (-0.05 + 0.001 * (double)(i % 16)),
                             lab.middle[2] + lab.size * (-0.05 + 0.001 * (double)(i / 16))};
        assert_true(tracer_ray(&s.tr, o, d, 0.0, (double)INFINITY, &b.rays[i]));
        b.states[i] = trace_begin(&before);
    }
    batch_stage_check(&s, &b, true);
    assert_true(batch_stage_together(&s, &b) > 10.0);
    batch_stage_close(&s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_every_surface),
        cmocka_unit_test(test_absent_treelets),
        cmocka_unit_test(test_together),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
