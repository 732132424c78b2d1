/* test_leaf_layout.c - levels, treelets, their order and their payloads' sizes, against FORMAT.md
 * done the long way.
 */
/* marks: bits */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <string.h>

#include "formats/leaf/leaf_layout.h"

static const uint32_t SIZES[][3] = {{2, 2, 2},   {17, 17, 17}, {18, 17, 2},  {33, 33, 33},
                                    {34, 2, 65}, {2, 200, 3},  {65, 66, 67}, {130, 40, 90},
                                    {513, 2, 2}, {64, 64, 64}, {97, 129, 33}};

static uint32_t parts(uint32_t cells, uint32_t b) {
    uint32_t n = 0;
    for (uint32_t at = 0; at < cells; at += b)
        n++;
    return n;
}

static void check_levels(const leaf_layout *l, const uint32_t dims[3], uint32_t b) {
    uint32_t cells[3] = {dims[0] - 1, dims[1] - 1, dims[2] - 1}, total = 0;
    for (uint32_t i = 0; i < l->levels; i++) {
        const leaf_level *v = &l->level[i];
        for (int a = 0; a < 3; a++) {
            assert_int_equal(v->cells[a], cells[a]);
            assert_int_equal(v->dims[a], cells[a] + 1);
            assert_int_equal(v->treelets[a], parts(cells[a], b));
            /* N' = floor((N - 1) / 2) + 1, one more where N - 1 is odd. */
            cells[a] = cells[a] / 2 + cells[a] % 2;
        }
        bool fits = v->cells[0] <= b && v->cells[1] <= b && v->cells[2] <= b;
        assert_int_equal(fits, i + 1 == l->levels);
        total += v->count;
    }
    assert_int_equal(total, l->treelets);
    assert_int_equal(l->level[l->levels - 1].first, 0);
}

/* Breadth first: parents in order, each with its children in the order of octants. */
static void check_order(const leaf_layout *l) {
    uint32_t next = 1;
    for (uint32_t t = 0; t < l->treelets; t++) {
        uint32_t level = l->level_of[t];
        assert_true(t >= l->level[level].first &&
                    t < l->level[level].first + l->level[level].count);
        assert_int_equal(leaf_layout_find(l, level, l->place[t]), t);
        unsigned mask = leaf_layout_children(l, t);
        assert_int_equal(mask & 1, level > 0);
        if (level == 0) {
            assert_int_equal(l->first_child[t], LEAF_NO_TREELET);
            continue;
        }
        assert_int_equal(l->first_child[t], next);
        for (unsigned o = 0; o < 8; o++) {
            uint32_t place[3];
            bool there = true;
            for (unsigned a = 0; a < 3; a++) {
                place[a] = 2 * l->place[t][a] + (o >> a & 1);
                there &= place[a] < l->level[level - 1].treelets[a];
            }
            assert_int_equal(mask >> o & 1, there);
            if (there)
                assert_memory_equal(l->place[next++], place, sizeof place);
        }
    }
    assert_int_equal(next, l->treelets);
}

static void check_payloads(const leaf_layout *l) {
    uint64_t cells[LEAF_LEVELS_MAX] = {0}, codes = 0;
    for (uint32_t k = 1; k <= l->cells_log2 - 2; k++)
        codes += 2ULL << (3 * k);
    for (uint32_t t = 0; t < l->treelets; t++) {
        leaf_payload p = leaf_layout_payload(l, t);
        cells[l->level_of[t]] += (uint64_t)p.cells[0] * p.cells[1] * p.cells[2];
        uint64_t samples = sample_size(l->type);
        for (int a = 0; a < 3; a++) {
            assert_int_equal(p.samples[a], p.cells[a] + 1 + 2 * l->halo);
            samples *= p.samples[a];
        }
        assert_true(p.samples_at % 64 == 0 && p.samples_at >= codes && p.samples_at < codes + 64);
        assert_true(p.bytes % 64 == 0 && p.bytes >= p.samples_at + samples &&
                    p.bytes < p.samples_at + samples + 64);
        assert_true(p.bytes <= leaf_layout_payload_max(l));
        assert_int_equal(p.node_levels, l->cells_log2 - 2);
    }
    for (uint32_t i = 0; i < l->levels; i++) {
        const uint32_t *c = l->level[i].cells;
        assert_int_equal(cells[i], (uint64_t)c[0] * c[1] * c[2]);
    }
    assert_int_equal(leaf_codes_at(1), 0);
    assert_int_equal(leaf_codes_at(2), 16);
    assert_int_equal(leaf_codes_at(3), 144);
    assert_int_equal(leaf_codes_at(l->cells_log2 - 1), codes);
}

static void test_geometry(void **state) {
    (void)state;
    static const sample_type types[] = {SAMPLE_U8, SAMPLE_I16, SAMPLE_F32};
    mem m;
    mem_init(&m, 0);
    for (size_t i = 0; i < sizeof SIZES / sizeof SIZES[0]; i++)
        for (uint32_t log2 = 4; log2 <= 6; log2++) {
            leaf_layout l, levels;
            assert_int_equal(leaf_layout_levels(&levels, SIZES[i], log2, log2 & 1, types[log2 - 4]),
                             ST_OK);
            assert_null(levels.place);
            assert_int_equal(leaf_layout_init(&l, &m, SIZES[i], log2, log2 & 1, types[log2 - 4]),
                             ST_OK);
            assert_memory_equal(l.level, levels.level, sizeof l.level);
            check_levels(&l, SIZES[i], 1u << log2);
            check_order(&l);
            check_payloads(&l);
            leaf_layout_release(&l);
            assert_int_equal(mem_used(&m), 0);
        }
}

static void test_limits(void **state) {
    (void)state;
    leaf_layout l;
    const uint32_t most = 1 << 20;
    assert_int_equal(leaf_layout_levels(&l, (uint32_t[3]){1, 8, 8}, 5, 1, SAMPLE_U8),
                     ST_UNSUPPORTED);
    assert_int_equal(leaf_layout_levels(&l, (uint32_t[3]){8, 0, 8}, 5, 1, SAMPLE_U8),
                     ST_UNSUPPORTED);
    assert_int_equal(leaf_layout_levels(&l, (uint32_t[3]){8, 8, most + 1}, 5, 1, SAMPLE_U8),
                     ST_UNSUPPORTED);
    assert_int_equal(leaf_layout_levels(&l, (uint32_t[3]){8, 8, UINT32_MAX}, 5, 1, SAMPLE_U8),
                     ST_UNSUPPORTED);
    assert_int_equal(leaf_layout_levels(&l, (uint32_t[3]){most, most, most}, 4, 1, SAMPLE_U8),
                     ST_UNSUPPORTED);
    assert_int_equal(leaf_layout_levels(&l, (uint32_t[3]){most, 2, 2}, 4, 1, SAMPLE_U8), ST_OK);
    assert_int_equal(l.levels, 17);
    assert_int_equal(leaf_layout_levels(&l, (uint32_t[3]){65536, 65536, 32768}, 6, 1, SAMPLE_F32),
                     ST_OK);
    assert_int_equal(l.level[0].count, 1024u * 1024 * 512);
    mem m;
    mem_init(&m, 100);
    assert_int_equal(leaf_layout_init(&l, &m, (uint32_t[3]){64, 64, 64}, 4, 1, SAMPLE_U8),
                     ST_NOMEM);
    assert_int_equal(mem_used(&m), 0);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_geometry),
        cmocka_unit_test(test_limits),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
