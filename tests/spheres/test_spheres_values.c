/* test_spheres_values.c - all that is not a surface, of balls: pieces, media, projections, slices,
 * points, at every step; and the gradients that media are shaded by.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <math.h>
#include <stdlib.h>

#include "tests/spheres/spheres.h"
#include "tests/spheres/spheres_truth.h"
#include "tests/support/cell_judge.h"
#include "tests/support/cells_file.h"
#include "tests/support/ray_stage.h"
#include "tests/support/scratch.h"
#include "tests/support/third_kind.h"

THIRD_KIND(SPHERES_KIND, spheres_geometry, spheres_kind)

enum { STEPS = 3, APART = 27 };

/* Balls that do not overlap, a place of its own for each; at each step they are elsewhere in it,
 * larger or smaller. */
typedef struct apart {
    sphere spheres[STEPS][8 * APART];
    uint32_t counts[8], count;
} apart;

static void make_apart(apart *all) {
    field_random r = {FIELD_SEED + 3};
    *all = (apart){.count = 8 * APART};
    for (uint32_t i = 0; i < STEPS * all->count; i++) {
        const uint32_t n = i % all->count, t = n / APART, of = n % APART;
        const uint32_t block[3] = {t % 2, t / 2 % 2, t / 4},
                       place[3] = {of % 3, of / 3 % 3, of / 9};
        sphere *x = &all->spheres[i / all->count][n];
        *x = (sphere){.radius = 1.5 + 2.5 * field_random_unit(&r),
                      .peak = 0.2 + 1.5 * field_random_unit(&r)};
        for (int a = 0; a < 3; a++)
            x->centre[a] = 30.0 * block[a] + 10.0 * place[a] + 0.9 * field_random_unit(&r);
        all->counts[t] = APART;
    }
}

static spheres_truth truth_of(const void *ctx, uint32_t step) {
    static const double rim = 0.0;
    const apart *all = ctx;
    return (spheres_truth){all->spheres[step], all->count, &rim, 1};
}

static int chords_of(const void *ctx, uint32_t step, const double origin[3],
                     const double direction[3], cell_chord out[CELL_CHORDS_MAX], bool *grazing) {
    const spheres_truth truth = truth_of(ctx, step);
    return spheres_truth_chords(&truth, origin, direction, out, grazing);
}

static bool value_at(const void *ctx, uint32_t step, const double point[3], long double *value,
                     bool *grazing) {
    const spheres_truth truth = truth_of(ctx, step);
    uint64_t number;
    const bool any = spheres_truth_at(&truth, point, &number, value);
    *grazing = any && *value < 1e-9L;
    return any;
}

static leaf_image apart_image(const apart *all) {
    return cells_file(&(cells_input){.kind = SPHERES_KIND,
                                     .name = "apart",
                                     .records = all->spheres,
                                     .counts = all->counts,
                                     .treelets = 8,
                                     .steps = STEPS});
}

static void test_values(void **state) {
    (void)state;
    static apart all;
    make_apart(&all);
    const leaf_image image = apart_image(&all);
    cell_judge(&image, &(cell_truth){&all, STEPS, 1.7, chords_of, value_at});
    free(image.bytes);
}

/* The gradient along a piece, by which media are shaded, against the ball's own. */
static int judge_piece(const apart *all, const tracer *tr, const ray *r, const segment *piece) {
    const sphere *x = &all->spheres[0][piece->cell];
    segment_gradient g;
    int wrong = 0;
    tr->kind->gradient(tr, loader_lookup(tr->treelets, piece->treelet), r, piece, &g);
    for (int i = 0; i < 5; i++) {
        const double t = piece->t0 + i / 4.0 * (piece->t1 - piece->t0);
        double got[3];
        segment_gradient_at(&g, i / 4.0, got);
        for (int a = 0; a < 3; a++) {
            const double slope = 2.0 * x->peak / (x->radius * x->radius);
            const double want = -slope * (r->o[a] + t * r->d[a] - x->centre[a]);
            wrong += !(fabs(got[a] - want) <= 1e-11 * slope * 100.0);
        }
    }
    return wrong;
}

static void test_gradients(void **state) {
    (void)state;
    static apart all;
    make_apart(&all);
    const leaf_image image = apart_image(&all);
    const leafcast_scene scene = leafcast_scene_default();
    ray_stage s;
    int pieces = 0, wrong = 0;
    ray_stage_open(&s, scratch_write("gradients.leaf", image.bytes, image.size), FIELD_SEED);
    ray_stage_show(&s, &scene);
    ray_stage_bring_in(&s, 0);
    for (int n = 0; n < 1000; n++) {
        segment ahead[8], piece;
        segments_state state_of = segments_begin(ahead, 8);
        ray_counters counters = {0};
        double origin[3], direction[3];
        ray r;
        for (int a = 0; a < 3; a++) {
            origin[a] = 160.0 * field_random_unit(&s.random) - 50.0;
            direction[a] = 60.0 * field_random_unit(&s.random) - origin[a];
        }
        if (!tracer_ray(&s.tr, origin, direction, 0.0, INFINITY, &r))
            continue;
        while (segments_next(&s.tr, &r, &state_of, &piece, &counters) == SEGMENTS_SOME) {
            wrong += judge_piece(&all, &s.tr, &r, &piece);
            pieces++;
        }
    }
    print_message("# %d pieces, %d wrong\n", pieces, wrong);
    assert_true(pieces > 100);
    assert_int_equal(wrong, 0);
    ray_stage_close(&s, "gradients");
    free(image.bytes);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_values),
        cmocka_unit_test(test_gradients),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
