/* The order of payloads in a file: a grid's slabs come in the order in which slices complete them,
 * found here by trying out which slices are there. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "formats/leaf/leaf_order.h"
#include "formats/leaf/mesh_layout.h"

enum { FIELDS = 2, STEPS = 3, SLABS_MAX = 64 };

static const uint32_t SIZES[][3] = {{2, 2, 2},   {60, 40, 33}, {33, 34, 200}, {17, 18, 130},
                                    {5, 5, 257}, {40, 70, 34}, {33, 33, 66},  {200, 3, 35}};

/* Whether slice z of a level is complete, of the slices of level 0 below `slices`. */
static bool has_slice(const leaf_layout *l, uint32_t level, uint32_t z, uint32_t slices) {
    if (level == 0)
        return z < slices;
    for (int64_t tap = 2 * (int64_t)z - 2; tap <= 2 * (int64_t)z + 2; tap++) {
        const int64_t last = l->level[level - 1].dims[2] - 1;
        const int64_t at = tap < 0 ? 0 : tap > last ? last : tap;
        if (!has_slice(l, level - 1, (uint32_t)at, slices))
            return false;
    }
    return true;
}

static bool has_slab(const leaf_layout *l, uint32_t level, uint32_t z, uint32_t slices) {
    const uint32_t side = 2U << l->cells_log2;
    for (uint32_t k = z * side; k <= (z + 1) * side + l->halo; k++)
        if (k < l->level[level].dims[2] && !has_slice(l, level, k, slices))
            return false;
    return true;
}

/* The slabs as they become complete. Returns how many there are. */
static uint32_t find_slabs(const leaf_layout *l, leaf_slab out[SLABS_MAX]) {
    uint32_t next[LEAF_LEVELS_MAX] = {0}, count = 0;
    for (uint32_t slices = 1; slices <= l->level[0].dims[2]; slices++)
        for (uint32_t level = 0; level < l->levels; level++)
            while (next[level] * 2 < l->level[level].treelets[2] &&
                   has_slab(l, level, next[level], slices)) {
                assert_true(count < SLABS_MAX);
                out[count++] = (leaf_slab){level, next[level]++, slices};
            }
    return count;
}

static void check_slabs(const leaf_layout *l) {
    leaf_slab slabs[SLABS_MAX];
    const uint32_t count = find_slabs(l, slabs);
    leaf_slabs s = leaf_slabs_begin(l);
    for (uint32_t i = 0; i < count; i++) {
        assert_memory_equal(&s.at, &slabs[i], sizeof s.at);
        assert_int_equal(leaf_slabs_next(&s, l), i + 1 < count);
    }
    assert_int_equal(slabs[count - 1].level, l->levels - 1);
}

/* The place of a payload's treelet in the order of one set. */
static void check_payloads(const leaf_layout *l) {
    leaf_slab slabs[SLABS_MAX];
    const uint32_t count = find_slabs(l, slabs);
    uint32_t payloads = 0;
    leaf_order o = leaf_order_begin(l);
    for (uint32_t set = 0; set < l->sets; set++)
        for (uint32_t i = 0; i < count; i++) {
            const leaf_level *v = &l->level[slabs[i].level];
            for (uint32_t y = 0; y < v->treelets[1]; y += 2)
                for (uint32_t x = 0; x < v->treelets[0]; x += 2) {
                    uint32_t parent = LEAF_NO_TREELET;
                    for (uint32_t octant = 0; octant < 8; octant++) {
                        const uint32_t place[3] = {x + octant % 2, y + octant / 2 % 2,
                                                   2 * slabs[i].z + octant / 4};
                        if (place[0] >= v->treelets[0] || place[1] >= v->treelets[1] ||
                            place[2] >= v->treelets[2])
                            continue;
                        const uint32_t t = leaf_layout_find(l, slabs[i].level, place);
                        assert_int_equal(o.p, leaf_layout_samples(l, set, t));
                        if (t > 0)
                            parent = leaf_layout_parent(l, t);
                        assert_int_equal(o.parent, parent);
                        leaf_order_next(&o, l);
                        payloads++;
                    }
                    if (!l->shells || parent == LEAF_NO_TREELET)
                        continue;
                    assert_int_equal(o.p, leaf_layout_shell(l, set, parent));
                    leaf_order_next(&o, l);
                    payloads++;
                }
        }
    assert_int_equal(payloads, l->payloads);
    assert_int_equal(o.p, l->payloads);
}

static void test_order(void **state) {
    (void)state;
    mem m;
    mem_init(&m, 0);
    for (size_t i = 0; i < sizeof SIZES / sizeof SIZES[0]; i++)
        for (uint32_t how = 0; how < 4; how++) {
            leaf_layout l;
            assert_int_equal(leaf_layout_init(&l, &m, SIZES[i], 4, how & 1, SAMPLE_U8), ST_OK);
            assert_true(leaf_layout_repeat(&l, FIELDS, STEPS, how & 2));
            check_slabs(&l);
            check_payloads(&l);
            assert_int_equal(leaf_order_last(&l), (l.sets - 1) * l.treelets);
            leaf_layout_release(&l);
        }
    assert_int_equal(mem_used(&m), 0);
}

static void test_others(void **state) {
    (void)state;
    const mesh_layout_blocks blocks = {.treelets = 5, .fields = 2, .steps = 1};
    leaf_layout l;
    mesh_layout_of(&l, &blocks);
    leaf_order o = leaf_order_begin(&l);
    for (uint32_t p = 0; p < l.payloads; p++) {
        assert_int_equal(o.p, p);
        leaf_order_next(&o, &l);
    }
    assert_int_equal(o.p, l.payloads);
    assert_int_equal(leaf_order_last(&l), 14);
}

static void test_places(void **state) {
    (void)state;
    mem m;
    mem_init(&m, 0);
    leaf_layout l;
    assert_int_equal(leaf_layout_init(&l, &m, (uint32_t[3]){60, 40, 33}, 4, 0, SAMPLE_U8), ST_OK);
    /* Firsts of families start runs, others follow at multiples of 64; the lone root, too, starts
     * one. */
    for (uint32_t t = 0; t < l.treelets; t++) {
        bool first = t == 0;
        for (uint32_t p = 0; p < l.treelets; p++)
            first |= l.first_child[p] == t;
        leaf_placing x = {.end = 5000};
        assert_int_equal(leaf_placing_next(&x, &l, t, 100, 12), first ? 8192 : 5056);
        assert_int_equal(x.end, first ? 8292 : 5156);
        x = (leaf_placing){.end = 8192};
        assert_int_equal(leaf_placing_next(&x, &l, t, 1, 12), 8192);
        /* One of no bytes is at the end of what is there, and hands on that a run begins. */
        x = (leaf_placing){.end = 5000};
        assert_int_equal(leaf_placing_next(&x, &l, t, 0, 12), 5000);
        assert_int_equal(x.end, 5000);
        assert_int_equal(x.run, first);
    }
    leaf_placing x = {.end = 5000};
    assert_int_equal(leaf_placing_next(&x, &l, 1, 0, 12), 5000);
    assert_int_equal(leaf_placing_next(&x, &l, 2, 64, 12), 8192);
    assert_int_equal(leaf_placing_next(&x, &l, 3, 64, 12), 8256);
    leaf_layout_release(&l);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_order), cmocka_unit_test(test_others),
                                       cmocka_unit_test(test_places)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
