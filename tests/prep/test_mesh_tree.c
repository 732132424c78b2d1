/* test_mesh_tree.c - the trees of mesh treelets. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <stdlib.h>

#include "formats/mesh/mesh_leaf.h"
#include "prep/mesh/mesh_tree.h"
#include "tests/support/fields.h"

/* Trees over keys made to be deep: no deeper, and of no more nodes, than is said. */
static uint32_t depth_of(const mesh_tree *t, uint32_t node) {
    uint32_t most = 0;
    for (uint32_t c = 0; c < t->node[node].children; c++)
        if (!(t->node[node].child[c] & MESH_LEAF)) {
            const uint32_t below = depth_of(t, t->node[node].child[c]);
            most = below > most ? below : most;
        }
    return 1 + most;
}

static int compare_keys(const void *a, const void *b) {
    const mesh_record *x = a, *y = b;
    return x->key < y->key ? -1 : x->key > y->key;
}

static void test_trees(void **state) {
    (void)state;
    static mesh_record records[16384];
    mem m;
    field_random r = {FIELD_SEED};
    uint32_t deepest = 0;
    mem_init(&m, 0);
    for (int n = 0; n < 600; n++) {
        const uint32_t count = 1 + (uint32_t)(field_random_bits(&r) % (n % 6 ? 600 : 16384));
        const uint32_t leaf_tets = 1 + (uint32_t)(field_random_bits(&r) % 16);
        for (uint32_t i = 0; i < count; i++) {
            const uint64_t bits = field_random_bits(&r) >> 1;
            /* Spread; a chain, a bit a level; chains with crowds at their ends; all the same. */
            const uint64_t one = UINT64_C(1) << (62 - i % 63);
            const uint64_t keys[5] = {bits, one, bits % 3 ? one | bits % one : one, 5,
                                      one | bits % (one < 8 ? one : 8)};
            records[i] = (mesh_record){.key = keys[n % 5]};
        }
        qsort(records, count, sizeof *records, compare_keys);
        mesh_tree t;
        const size_t before = mem_used(&m);
        assert_int_equal(mesh_tree_init(&t, &m, count, leaf_tets), ST_OK);
        assert_true(mem_used(&m) - before <= mesh_tree_memory(count, leaf_tets));
        mesh_tree_build(&t, records, count);
        assert_true(t.nodes <= mesh_tree_nodes_max(count, leaf_tets));
        deepest = depth_of(&t, 0) > deepest ? depth_of(&t, 0) : deepest;
        assert_true(depth_of(&t, 0) <= MESH_DEPTH_MAX);
        const uint32_t counts[4] = {count, 4, t.nodes, t.leaves};
        assert_null(mesh_leaf_counts_fault(counts, count, leaf_tets));
        mesh_tree_release(&t);
    }
    assert_true(deepest > MESH_DEPTH_MAX / 2);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_trees),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
