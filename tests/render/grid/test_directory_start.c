/* test_directory_start.c - a walk that begins at a treelet meets that treelet and all behind it, in
 * the same order as the whole walk, and none before it; of several, the first is chosen.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <string.h>

#include "render/grid/directory_start.h"
#include "tests/support/fields.h"

enum { PLANES = 512, MOST = 4096 };

typedef struct grid {
    mem m;
    leaf_layout layout;
    level_planes levels[LEAF_LEVELS_MAX];
    double planes[LEAF_LEVELS_MAX][PLANES + 1];
    double eye[3];
    uint32_t coarse; /* this treelet is drawn itself, not those below it; LEAF_NO_TREELET: none */
    directory_start start;
    uint32_t met[MOST], count;
} grid;

static void grid_make(grid *g, const uint32_t dims[3]) {
    mem_init(&g->m, 0);
    assert_int_equal(leaf_layout_init(&g->layout, &g->m, dims, 4, 1, SAMPLE_U8), ST_OK);
    for (uint32_t v = 0; v < g->layout.levels; v++)
        for (uint32_t i = 0; i <= PLANES; i++) {
            g->planes[v][i] = (double)(i << v);
            g->levels[v].at[0] = g->levels[v].at[1] = g->levels[v].at[2] = g->planes[v];
        }
    g->coarse = LEAF_NO_TREELET;
}

/* Walk as tiles do, through all treelets. */
static void walk(grid *g, uint32_t t) {
    const leaf_layout *l = &g->layout;
    const uint32_t level = l->level_of[t], half = 1U << (l->cells_log2 - 1);
    uint32_t first[3];
    if (level == 0 || t == g->coarse) {
        assert_true(g->count < MOST);
        g->met[g->count++] = t;
        return;
    }
    for (int a = 0; a < 3; a++)
        first[a] = l->place[t][a] << l->cells_log2;
    const unsigned existing = leaf_layout_children(l, t),
                   eye = octant_of_eye(&g->levels[level], first, half, g->eye);
    unsigned order = octants_in_order(existing, eye);
    if (t == g->start.path[level])
        order &= directory_start_order(&g->start, level, eye);
    for (unsigned k = 0; k < 8; k++)
        if (order >> k & 1u) {
            const unsigned below = existing & ((1u << (k ^ eye)) - 1u);
            walk(g, l->first_child[t] + (uint32_t)__builtin_popcount(below));
        }
}

static void walk_from(grid *g, uint32_t first) {
    directory_start_begin(&g->start, &g->layout, g->levels, g->eye, first);
    g->count = 0;
    walk(g, 0);
}

/* Of treelets of the whole walk, noted in any order, the first is where the next walk begins. */
static void check_notes(grid *g, const uint32_t whole[], uint32_t count, field_random *r) {
    for (int n = 0; n < 50; n++) {
        uint32_t least = count;
        directory_start_begin(&g->start, &g->layout, g->levels, g->eye, 0);
        assert_int_equal(directory_start_next(&g->start), 0);
        for (int k = 0; k < 1 + n % 5; k++) {
            const uint32_t at = (uint32_t)field_random_below(r, count);
            least = at < least ? at : least;
            directory_start_note(&g->start, whole[at]);
        }
        assert_int_equal(directory_start_next(&g->start), whole[least]);
    }
}

static void check_eye(grid *g, field_random *r) {
    static uint32_t whole[MOST];
    walk_from(g, 0);
    const uint32_t count = g->count;
    memcpy(whole, g->met, count * sizeof *whole);
    for (uint32_t i = 0; i < count; i++) {
        walk_from(g, whole[i]);
        assert_int_equal(g->count, count - i);
        assert_memory_equal(g->met, whole + i, (count - i) * sizeof *whole);
    }
    check_notes(g, whole, count, r);
}

static void test_starts(void **state) {
    static const uint32_t dims[][3] = {{15, 15, 15}, {33, 20, 17}, {100, 65, 40}, {40, 120, 97}};
    static grid g;
    (void)state;
    field_random r = {FIELD_SEED};
    for (size_t i = 0; i < sizeof dims / sizeof *dims; i++) {
        grid_make(&g, dims[i]);
        for (int n = 0; n < 20; n++) {
            for (int a = 0; a < 3; a++)
                g.eye[a] = (double)field_random_below(&r, 3 * dims[i][a]) - dims[i][a];
            g.coarse = n % 2 ? g.layout.level[g.layout.levels > 2 ? 1 : 0].first : LEAF_NO_TREELET;
            check_eye(&g, &r);
        }
        leaf_layout_release(&g.layout);
        assert_int_equal(mem_used(&g.m), 0);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_starts)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
