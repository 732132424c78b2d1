/* The tree over treelets and time steps: whatever the order of its splits, every question has the
 * answer of a look at all ranges, one by one. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "formats/base/fault.h"
#include "formats/leaf/leaf_geometry.h"
#include "formats/leaf/time_tree.h"
#include "tests/support/fields.h"

/* A directory of ranges, and nothing else of a file. */
typedef struct subject {
    mem m;
    leaf_file f;
    uint32_t first, count; /* treelets of level 0 */
    field_random r;
} subject;

typedef struct shape {
    uint32_t dims[3]; /* of a grid; 0, 0, 0: flat, of so many treelets */
    uint32_t treelets, fields, steps;
} shape;

static const shape shapes[] = {{{33, 33, 33}, 0, 1, 1},
                               {{33, 33, 33}, 0, 1, 7},
                               {{200, 100, 70}, 0, 1, 1},
                               {{200, 100, 70}, 0, 2, 5},
                               {{65, 300, 34}, 0, 1, 16},
                               {{130, 130, 130}, 0, 3, 33},
                               {{0}, 1, 1, 1},
                               {{0}, 1, 2, 9},
                               {{0}, 7, 1, 3},
                               {{0}, 8, 1, 8},
                               {{0}, 9, 1, 2},
                               {{0}, 700, 2, 11}};
enum { SHAPES = sizeof shapes / sizeof *shapes };

/* Ranges that drift from step to step, around a value that depends on the treelet; some are empty,
 * some of one value. */
static void fill(subject *s) {
    const leaf_layout *l = &s->f.layout;
    for (uint32_t set = 0; set < l->sets; set++)
        for (uint32_t t = 0; t < l->treelets; t++) {
            float *own = s->f.own[(size_t)set * l->treelets + t];
            const float at = sinf((float)t * 0.1f + (float)set * 0.3f);
            const float half = (float)(field_random_bits(&s->r) % 5) * 0.03f;
            const bool empty = field_random_bits(&s->r) % 11 == 0;
            own[0] = empty ? INFINITY : at - half;
            own[1] = empty ? -INFINITY : at + half;
        }
}

static void begin(subject *s, const shape *of, uint64_t seed) {
    *s = (subject){.r = {seed}};
    mem_init(&s->m, 0);
    leaf_layout *l = &s->f.layout;
    if (of->treelets) {
        leaf_layout_flat(l, leaf_geometry_of(LEAF_KIND_MESH), of->treelets, 1);
        assert_int_equal(leaf_layout_init_flat(l, &s->m), ST_OK);
    } else {
        assert_int_equal(leaf_layout_init(l, &s->m, of->dims, 5, 0, SAMPLE_F32), ST_OK);
    }
    l->steps = of->steps;
    l->sets = of->fields * of->steps;
    s->first = l->level[0].first;
    s->count = l->level[0].count;
    s->f.own = mem_array(&s->m, (size_t)l->sets * l->treelets, sizeof *s->f.own);
    assert_non_null(s->f.own);
    fill(s);
}

static void end(subject *s) {
    mem_free(&s->m, s->f.own);
    leaf_layout_release(&s->f.layout);
    assert_int_equal(mem_used(&s->m), 0);
}

static bool meets(const subject *s, uint32_t of_field, uint32_t t, uint32_t step,
                  const value_limits *at, int count) {
    const leaf_layout *l = &s->f.layout;
    const float *own = s->f.own[(size_t)leaf_layout_set(l, of_field, step) * l->treelets + t];
    bool any = false;
    for (int i = 0; i < count; i++)
        any |= own[0] < at[i].beyond && at[i].reach <= own[1];
    return any;
}

/* ---- which treelets, which steps ---- */

typedef struct seen {
    const subject *s;
    uint8_t *times; /* per step and treelet */
} seen;

static void note(time_query *q, uint32_t treelet, uint32_t step) {
    const seen *x = q->ctx;
    x->times[(size_t)step * x->s->f.layout.treelets + treelet]++;
}

static void check_pairs(subject *s, const time_tree *t, uint32_t of_field, const value_limits *at,
                        int count, uint32_t first, uint32_t last) {
    const leaf_layout *l = &s->f.layout;
    seen x = {s, calloc((size_t)l->steps * l->treelets, 1)};
    time_query q = {
        .limits = at, .count = count, .first = first, .end = last, .met = note, .ctx = &x};
    time_tree_ask(t, &q);
    uint64_t met = 0;
    for (uint32_t step = 0; step < l->steps; step++)
        for (uint32_t i = 0; i < l->treelets; i++) {
            const bool want = i >= s->first && step >= first && step < last &&
                              meets(s, of_field, i, step, at, count);
            assert_int_equal(x.times[(size_t)step * l->treelets + i], want);
            met += want;
        }
    assert_true(q.visited >= met);
    free(x.times);
}

static void check_steps(subject *s, const time_tree *t, uint32_t of_field, value_limits at,
                        uint32_t first, uint32_t last) {
    uint8_t *has = malloc(last - first + 1);
    uint32_t earliest = last;
    has[last - first] = 77;
    uint64_t visited = 0;
    time_tree_steps(t, at, first, last, has, &visited);
    assert_true(visited > 0 || first == last);
    for (uint32_t step = last; step-- > first;) {
        bool any = false;
        for (uint32_t i = 0; i < s->count; i++)
            any |= meets(s, of_field, s->first + i, step, &at, 1);
        assert_int_equal(has[step - first], any);
        earliest = any ? step : earliest;
    }
    assert_int_equal(has[last - first], 77);
    assert_int_equal(time_tree_first(t, at, first, last, &visited), earliest);
    free(has);
}

static void test_answers(void **state) {
    (void)state;
    for (int i = 0; i < SHAPES; i++) {
        subject s;
        begin(&s, &shapes[i], 7 + (uint64_t)i);
        for (int order = 0; order < TIME_ORDERS; order++) {
            const uint32_t of_field = (uint32_t)order % shapes[i].fields;
            time_tree *t = NULL;
            assert_int_equal(time_tree_create(&s.m, &s.f, of_field, (time_order)order, &t), ST_OK);
            for (int k = 0; k < 12; k++) {
                const uint32_t first = (uint32_t)(field_random_bits(&s.r) % shapes[i].steps),
                               last = first + (uint32_t)(field_random_bits(&s.r) %
                                                         (shapes[i].steps - first + 1));
                const value_limits at[] = {value_limits_of_isovalue(-1.4 + 0.25 * k),
                                           {0.5f, 0.5f + 0.1f * (float)k}};
                check_pairs(&s, t, of_field, at, 1 + k % 2, k ? first : 0,
                            k ? last : shapes[i].steps);
                check_steps(&s, t, of_field, at[0], k ? first : 0, k ? last : shapes[i].steps);
            }
            time_tree_destroy(t);
        }
        end(&s);
    }
}

/* Steps that nobody asks for any more are not looked at. */
static void settle_odd(time_query *q, uint32_t treelet, uint32_t step) {
    (void)treelet;
    assert_int_equal(step % 2, 0);
    ++*(uint64_t *)q->ctx;
}

static void test_settled(void **state) {
    (void)state;
    subject s;
    begin(&s, &shapes[3], 3);
    for (int order = 0; order < TIME_ORDERS; order++) {
        time_tree *t = NULL;
        uint8_t settled[] = {1, 0, 1, 0};
        uint64_t met = 0, want = 0;
        const value_limits at = value_limits_of_isovalue(0.1);
        assert_int_equal(time_tree_create(&s.m, &s.f, 1, (time_order)order, &t), ST_OK);
        time_query q = {.limits = &at, .count = 1, .first = 1, .end = 5, .met = settle_odd};
        q.ctx = &met;
        q.settled = settled;
        time_tree_ask(t, &q);
        for (uint32_t i = 0; i < s.count; i++)
            want += (uint64_t)meets(&s, 1, s.first + i, 2, &at, 1) +
                    meets(&s, 1, s.first + i, 4, &at, 1);
        assert_int_equal(met, want);
        time_tree_destroy(t);
    }
    end(&s);
}

/* ---- what is skipped ---- */

/* A value that is in the last step alone, in one treelet: what a tree over time is there for. */
static void test_skips(void **state) {
    (void)state;
    const shape of = {{513, 513, 257}, 0, 1, 64};
    subject s;
    begin(&s, &of, 1);
    const leaf_layout *l = &s.f.layout;
    for (size_t i = 0; i < (size_t)l->sets * l->treelets; i++) {
        s.f.own[i][0] = 0.0f;
        s.f.own[i][1] = 1.0f;
    }
    s.f.own[(size_t)63 * l->treelets + s.first + 100][1] = 2.0f;
    const value_limits at = value_limits_of_isovalue(1.5);
    for (int order = 0; order < TIME_ORDERS; order++) {
        time_tree *t = NULL;
        uint64_t met = 0;
        assert_int_equal(time_tree_create(&s.m, &s.f, 0, (time_order)order, &t), ST_OK);
        time_query q = {.limits = &at, .count = 1, .end = 64, .met = settle_odd, .ctx = &met};
        q.settled = (uint8_t[64]){0};
        uint64_t visited = 0;
        assert_int_equal(time_tree_first(t, at, 0, 64, &visited), 63);
        assert_int_equal(time_tree_first(t, at, 0, 63, &visited), 63);
        q.met = note;
        seen x = {&s, calloc((size_t)64 * l->treelets, 1)};
        q.ctx = &x;
        time_tree_ask(t, &q);
        /* One node a split, and its brothers; or a root for each step. */
        assert_in_range(q.visited, 1, order == TIME_ORDER_STEPS ? 64 + 8 * 5 : 2 * 6 + 8 * 5 + 1);
        free(x.times);
        time_tree_destroy(t);
    }
    end(&s);
}

/* M08's order splits first where children are alike, the other one where they are not. */
static void test_orders(void **state) {
    (void)state;
    const shape of = {{257, 257, 257}, 0, 1, 8};
    for (int still = 0; still < 2; still++) {
        subject s;
        begin(&s, &of, 1);
        const leaf_layout *l = &s.f.layout;
        /* Ranges that follow either the treelet or the step. */
        for (uint32_t set = 0; set < l->sets; set++)
            for (uint32_t t = 0; t < l->treelets; t++) {
                float *own = s.f.own[(size_t)set * l->treelets + t];
                own[0] = still ? (float)t : (float)set;
                own[1] = own[0] + 0.5f;
            }
        size_t bytes[TIME_ORDERS];
        for (int order = 0; order < TIME_ORDERS; order++) {
            time_tree *t = NULL;
            assert_int_equal(time_tree_create(&s.m, &s.f, 0, (time_order)order, &t), ST_OK);
            bytes[order] = time_tree_bytes(t);
            time_tree_destroy(t);
        }
        /* Split in time at last, it has a row for 2, 4, 8 steps of all treelets; split in space at
         * last, of the coarser ones alone. */
        const int space_first = still ? TIME_ORDER_LEAST : TIME_ORDER_MOST,
                  time_first = still ? TIME_ORDER_MOST : TIME_ORDER_LEAST;
        assert_int_equal(bytes[time_first], ((64 + 8 + 1) * 8 + 7) * sizeof(float[2]));
        assert_int_equal(bytes[space_first], (512 * 7 + 64 + 8 + 1) * sizeof(float[2]));
        assert_int_equal(bytes[TIME_ORDER_STEPS], (64 + 8 + 1) * 8 * sizeof(float[2]));
        end(&s);
    }
}

static void test_faults(void **state) {
    (void)state;
    subject s;
    begin(&s, &shapes[4], 5);
    status st = ST_NOMEM;
    for (long k = 1; st != ST_OK; k++) {
        time_tree *t = NULL;
        fault_arm(FAULT_ALLOC, k);
        st = time_tree_create(&s.m, &s.f, 0, TIME_ORDER_MOST, &t);
        fault_arm(FAULT_ALLOC, 0);
        assert_true(st == ST_OK || st == ST_NOMEM);
        assert_int_equal(t != NULL, st == ST_OK);
        time_tree_destroy(t);
    }
    end(&s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_answers), cmocka_unit_test(test_settled),
        cmocka_unit_test(test_skips),   cmocka_unit_test(test_orders),
        cmocka_unit_test(test_faults),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
