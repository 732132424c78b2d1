/* What an isovalue needs of a series: which steps and treelets have it, and the bytes of these,
 * each counted once; and what a single set needs. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <stdlib.h>
#include <string.h>

#include "formats/base/fault.h"
#include "formats/leaf/leaf_stats.h"
#include "tests/support/leaf_steps.h"
#include "tests/support/scratch.h"

/* Places in the file that were counted. */
typedef struct places {
    const leaf_file *f;
    uint64_t *at;
    size_t count;
    uint64_t bytes;
} places;

static void visit(places *p, uint32_t payload) {
    const uint64_t at = p->f->offsets[payload];
    for (size_t i = 0; i < p->count; i++)
        if (p->at[i] == at)
            return;
    if (p->f->sizes[payload] > 0) {
        p->at[p->count++] = at;
        p->bytes += p->f->sizes[payload];
    }
}

/* A treelet's code, that of its family, and what they are differences to. */
static void visit_treelet(places *p, uint32_t set, uint32_t t) {
    const leaf_layout *l = &p->f->layout;
    uint32_t chain[LEAF_CHAIN_MAX];
    for (int i = leaf_file_chain(p->f, set * l->treelets + t, chain); i-- > 0;)
        visit(p, chain[i]);
    if (!l->shells || t == 0)
        return;
    uint32_t parent = 0; /* the last treelet whose first child is not behind t */
    for (uint32_t q = 0; q < l->shells; q++)
        parent = l->first_child[q] <= t ? q : parent;
    for (int i = leaf_file_chain(p->f, leaf_layout_shell(l, set, parent), chain); i-- > 0;)
        visit(p, chain[i]);
}

static bool has(const leaf_file *f, uint32_t set, uint32_t t, double iso) {
    const float *own = f->own[(size_t)set * f->layout.treelets + t];
    return (double)own[0] < iso && iso <= (double)own[1];
}

static void check_presence(mem *m, const leaf_file *f, const time_tree *tree, double iso,
                           const uint8_t *asked) {
    const leaf_layout *l = &f->layout;
    uint8_t found[LEAF_STEPS] = {0};
    leaf_presence got, want = {0};
    places p = {.f = f, .at = malloc(l->payloads * sizeof *p.at)};
    assert_int_equal(leaf_stats_presence(m, f, tree, 0, iso, asked, found, &got), ST_OK);
    uint8_t *seen = calloc(l->treelets, 1);
    for (uint32_t step = 0; step < l->steps; step++) {
        uint64_t active = 0;
        for (uint32_t t = l->level[0].first; t < l->treelets && asked[step]; t++)
            if (has(f, step, t, iso)) {
                active++;
                want.treelets += !seen[t];
                seen[t] = 1;
                visit_treelet(&p, step, t);
            }
        assert_int_equal(found[step], active > 0);
        want.steps += active > 0;
        if (active > want.most) {
            want.most = active;
            want.step_of_most = step;
        }
    }
    assert_int_equal(got.steps, want.steps);
    assert_int_equal(got.treelets, want.treelets);
    assert_int_equal(got.most, want.most);
    assert_int_equal(got.step_of_most, want.step_of_most);
    assert_int_equal(got.bytes, p.bytes);
    free(seen);
    free(p.at);
}

/* What a step needs is what it needs in the file that has it alone, but for the bytes. */
static void check_activity(mem *m, leaf_file *f, const leaf_steps *s, double iso) {
    leaf_activity here[LEAF_LEVELS_MAX], there[LEAF_LEVELS_MAX];
    for (uint32_t step = 0; step < f->layout.steps; step += 5) {
        leaf_unpacker *u = NULL;
        leaf_file *alone = leaf_steps_open(m, leaf_steps_alone(s, (int)step, "alone.leaf"), &u);
        places p = {.f = f, .at = malloc(f->layout.payloads * sizeof *p.at)};
        assert_int_equal(leaf_stats_activity(m, f, step, iso, 2, NULL, here), ST_OK);
        assert_int_equal(leaf_stats_activity(m, alone, 0, iso, 2, NULL, there), ST_OK);
        for (uint32_t level = 0; level < f->layout.levels; level++) {
            const leaf_level *v = &f->layout.level[level];
            assert_int_equal(here[level].treelets, there[level].treelets);
            assert_int_equal(here[level].cells, there[level].cells);
            for (uint32_t t = v->first; t < v->first + v->count; t++)
                if (has(f, step, t, iso))
                    visit_treelet(&p, step, t);
        }
        uint64_t sum = 0;
        for (uint32_t level = 0; level < f->layout.levels; level++)
            sum += here[level].bytes;
        assert_int_equal(sum, p.bytes);
        free(p.at);
        leaf_unpacker_destroy(u);
        leaf_file_close(alone);
    }
}

static void test_series(void **state) {
    (void)state;
    leaf_steps s;
    leaf_steps_make(&s, 50, 40, 34, SAMPLE_U8);
    for (int codec = 0; codec < 2; codec++) {
        mem m;
        leaf_unpacker *u = NULL;
        time_tree *tree = NULL;
        mem_init(&m, 0);
        leaf_steps_use(&s, codec ? LEAF_CODEC_ZSTD : LEAF_CODEC_RAW);
        leaf_file *f =
            leaf_steps_open(&m, leaf_files_series(&s.of, &s.c.options, "series.leaf"), &u);
        assert_int_equal(time_tree_create(&m, f, 0, TIME_ORDER_MOST, &tree), ST_OK);
        const double lo = f->header.value_min, hi = f->header.value_max;
        for (int i = -1; i < 9; i++) {
            const double iso = lo + (hi - lo) * (i + 0.3) / 8;
            uint8_t asked[LEAF_STEPS];
            memset(asked, 1, sizeof asked);
            check_presence(&m, f, tree, iso, asked);
            for (int step = 0; step < LEAF_STEPS; step++)
                asked[step] = step % 3 == 1 && step > i;
            check_presence(&m, f, tree, iso, asked);
            if (i % 4 == 1)
                check_activity(&m, f, &s, iso);
        }
        time_tree_destroy(tree);
        leaf_unpacker_destroy(u);
        leaf_file_close(f);
        assert_int_equal(mem_used(&m), 0);
    }
    leaf_steps_release(&s);
}

static void test_faults(void **state) {
    (void)state;
    leaf_steps s;
    leaf_steps_make(&s, 20, 19, 18, SAMPLE_U8);
    leaf_steps_use(&s, LEAF_CODEC_ZSTD);
    mem m;
    leaf_unpacker *u = NULL;
    time_tree *tree = NULL;
    mem_init(&m, 0);
    leaf_file *f = leaf_steps_open(&m, leaf_files_series(&s.of, &s.c.options, "series.leaf"), &u);
    assert_int_equal(time_tree_create(&m, f, 0, TIME_ORDER_MOST, &tree), ST_OK);
    const size_t used = mem_used(&m);
    uint8_t asked[LEAF_STEPS], found[LEAF_STEPS];
    memset(asked, 1, sizeof asked);
    status st = ST_NOMEM;
    for (long k = 1; st != ST_OK; k++) {
        leaf_presence got;
        leaf_activity levels[LEAF_LEVELS_MAX];
        fault_arm(FAULT_ALLOC, k);
        st = leaf_stats_presence(&m, f, tree, 0, 9.5, asked, found, &got);
        if (st == ST_OK)
            st = leaf_stats_activity(&m, f, 3, 9.5, 1, NULL, levels);
        fault_arm(FAULT_ALLOC, 0);
        assert_true(st == ST_OK || st == ST_NOMEM);
        assert_int_equal(mem_used(&m), used);
    }
    time_tree_destroy(tree);
    leaf_unpacker_destroy(u);
    leaf_file_close(f);
    leaf_steps_release(&s);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_series),
                                       cmocka_unit_test(test_faults)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
