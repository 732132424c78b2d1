/* test_doubtful_pieces.c - the pieces of rays in a preview: treelets that are not there are doubted
 * once, in order, and what stands in for them is no further off than it says. */
/* marks: threads */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <math.h>
#include <string.h>

#include "tests/support/ray_stage.h"
#include "tests/support/ref_pieces.h"

enum { NODES = 68 };
enum { ROOM = 64, PIECES_MAX = 4096 };

static size_t follow(const ray_stage *s, const ray *r, uint32_t room, segment *out) {
    static segment ahead[ROOM];
    ray_counters counters = {0};
    segments_state state = segments_begin(ahead, room);
    size_t count = 0;
    while (segments_next(&s->tr, r, &state, &out[count], &counters) == SEGMENTS_SOME)
        assert_true(++count < PIECES_MAX);
    return count;
}

/* What was met, of all rays. */
typedef struct doubts_seen {
    size_t doubts, bounded, guesses, off; /* off: somewhere by more than half of what was said */
} doubts_seen;

/* A guess that says how far the value may be off, against the finest data. */
static void check_guess(doubts_seen *seen, const segment *is, const ref_piece *of, size_t count) {
    bool far = false;
    assert_true(is->spread >= 0.0 && is->spread < (double)INFINITY);
    for (size_t i = 0; i < count; i++)
        for (int n = 0; n < 4; n++) {
            const long double t = of[i].t0 + (of[i].t1 - of[i].t0) * (2 * n + 1) / 8;
            if (!(t > is->t0 && t < is->t1))
                continue;
            const double at = (double)((t - is->t0) / ((long double)is->t1 - is->t0));
            const long double truth = ref_piece_at(of[i].k, t - of[i].t0),
                              off = truth - segment_at(is, at);
            if (!(fabsl(off) <= is->spread + 1e-9L * (1 + fabsl(truth))))
                fail_msg("at t %.17Lg the value is %.17Lg, %.17Lg off, but %.17g was said", t,
                         truth, off, is->spread);
            far |= fabsl(off) > 0.5L * is->spread;
        }
    seen->guesses++;
    seen->off += far;
}

/* Treelets that are not there are doubted once, in order, whatever room there is; in a grid, what
 * follows lies within. */
static size_t check_doubts(ray_stage *s, int rays, doubts_seen *seen) {
    static segment all[PIECES_MAX], few[PIECES_MAX];
    static ref_piece true_pieces[PIECES_MAX];
    for (int i = 0; i < rays; i++) {
        const ref_ray aim = ray_stage_aim(s);
        double last = -INFINITY, until = -INFINITY;
        size_t true_count = 0;
        bool bounded = false;
        ray r;
        if (!tracer_ray(&s->tr, aim.o, aim.d, 0.0, INFINITY, &r))
            continue;
        const size_t count = follow(s, &r, ROOM, all);
        if (s->world.samples)
            true_count = ref_grid_pieces(&s->world, &aim, NULL, true_pieces, PIECES_MAX);
        for (uint32_t room = 1; room < 6; room += 4) {
            assert_int_equal(follow(s, &r, room, few), count);
            for (size_t k = 0; k < count; k++)
                assert_memory_equal(&few[k], &all[k], sizeof all[k]);
        }
        for (size_t k = 0; k < count; k++) {
            const bool guessed = !loader_lookup(s->v->treelets, all[k].treelet) ||
                                 s->tr.layout->level_of[all[k].treelet] > s->tr.target_level;
            assert_true(all[k].t0 < all[k].t1 && all[k].t0 >= last);
            last = all[k].t0;
            if (all[k].spread == SEGMENT_GUESSED || all[k].spread == SEGMENT_BOUNDED) {
                assert_true(all[k].t0 >= until);
                until = all[k].t1;
                bounded = all[k].spread == SEGMENT_BOUNDED;
                seen->bounded += bounded;
            } else if (s->world.samples && guessed && !s->v->treelets->whole[all[k].treelet]) {
                assert_true(all[k].t1 <= until);
                if (bounded)
                    check_guess(seen, &all[k], true_pieces, true_count);
            }
            seen->doubts += all[k].spread < 0.0;
        }
    }
    return seen->doubts;
}

static void test_doubts(void **state) {
    (void)state;
    leafcast_scene scene = leafcast_scene_default();
    scene.preview = true;
    doubts_seen sum = {0};
    for (int i = 0; i < 8; i++) {
        doubts_seen seen = {0};
        static const char *const names[] = {"waves", "missing", "rectilinear", "noise-u8"};
        ray_stage s;
        field f;
        lab_mesh lab;
        const bool grid = i < 4;
        if (grid)
            assert_true(field_make(&f, names[i], NODES, FIELD_SEED));
        else
            assert_true(lab_mesh_make(&lab, "noise-jittered", 5, FIELD_SEED + (uint64_t)i));
        ray_stage_open(&s, grid ? fixture_leaf(&f, 4, 1, false) : lab_leaf_make(&lab, 30, false),
                       (uint64_t)i);
        s.homogeneous = true;
        if (grid)
            s.world = field_volume(&f);
        else
            s.lab = &lab;
        ray_stage_show(&s, &scene);
        s.tr.doubts = true;
        ray_stage_bring_in(&s, 2);
        assert_true(check_doubts(&s, 200, &seen) > 50);
        assert_true(!grid || i == 1 || seen.bounded > 20);
        sum.bounded += seen.bounded;
        sum.guesses += seen.guesses;
        sum.off += seen.off;
        ray_stage_close(&s, grid ? f.name : "mesh");
        if (grid)
            field_release(&f);
        else
            lab_mesh_release(&lab);
    }
    print_message("# %zu doubts with %zu guesses that say how far they are off, %zu tight\n",
                  sum.bounded, sum.guesses, sum.off);
    assert_true(sum.guesses > 1000 && sum.off > sum.guesses / 20);
}

/* Where the one treelet that is there has cells larger than what is missing, it is no guess. */
static void test_many_levels(void **state) {
    (void)state;
    enum { LONG = 540, WIDE = 5 };
    static float samples[LONG * WIDE * WIDE];
    field_random r = {1};
    field f = {.name = "long",
               .type = "u8",
               .dims = {LONG, WIDE, WIDE},
               .samples = samples,
               .spacing = {1, 1, 1}};
    leafcast_scene scene = leafcast_scene_default();
    loader_request root = {0, 0};
    ray_stage s;
    for (int i = 0; i < LONG * WIDE * WIDE; i++)
        samples[i] = (float)field_random_below(&r, 256);
    ray_stage_open(&s, fixture_leaf(&f, 4, 1, false), 1);
    scene.preview = true;
    s.world = field_volume(&f);
    ray_stage_show(&s, &scene);
    const interest all = interest_of_all();
    loader_select(s.v->treelets, &all);
    s.tr.doubts = true;
    loader_clear(s.v->treelets);
    loader_set_capacity(s.v->treelets, 1, 0);
    assert_int_equal(loader_admit(s.v->treelets, &root, 1), ST_OK);
    assert_int_equal(loader_settle(s.v->treelets), ST_OK);
    assert_true(s.tr.layout->levels > 6);
    doubts_seen seen = {0};
    assert_true(check_doubts(&s, 200, &seen) > 50);
    ray_stage_close(&s, f.name);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_doubts),
        /* Last: a mutant shows in memory that has been used. */
        cmocka_unit_test(test_many_levels),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
