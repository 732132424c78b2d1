/* test_active.c - masks of active cells: what they say against the samples themselves, and the
 * vector versions against the scalar one, bit for bit; payloads and masks end at a page that may
 * not be touched.
 */
/* marks: long */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <float.h>
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#include "stream/active.h"
#include "tests/support/fields.h"
#include "tests/support/interests.h"
#include "tests/support/leaf_files.h"
#include "tests/support/loaded.h"
#include "tests/support/watched.h"

static mem m;

/* ---- Blocks that end where a page does which may not be touched ---- */

typedef struct guarded {
    void *map, *block;
    size_t mapped;
} guarded;

static guarded guarded_make(size_t bytes) {
    const size_t page = (size_t)sysconf(_SC_PAGESIZE), room = (bytes + page - 1) / page * page;
    guarded g = {.mapped = room + page};
    g.map = mmap(NULL, g.mapped, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    assert_true(g.map != MAP_FAILED);
    assert_int_equal(mprotect((char *)g.map + room, page, PROT_NONE), 0);
    g.block = (char *)g.map + room - bytes;
    return g;
}

static void guarded_release(guarded *g) {
    munmap(g->map, g->mapped);
}

/* ---- The truth ---- */

static uint32_t morton(uint32_t x, uint32_t y, uint32_t z) {
    uint32_t code = 0;
    for (int bit = 0; bit < 8; bit++)
        code |= (x >> bit & 1u) << (3 * bit) | (y >> bit & 1u) << (3 * bit + 1) |
                (z >> bit & 1u) << (3 * bit + 2);
    return code;
}

static bool is_active(const leaf_file *f, const leaf_payload *shape, const void *samples,
                      const uint32_t cell[3], const interests *set) {
    double lo = INFINITY, hi = -INFINITY;
    for (unsigned c = 0; c < 8; c++) {
        size_t at[3];
        for (unsigned a = 0; a < 3; a++)
            at[a] = cell[a] + (c >> a & 1u) + f->layout.halo;
        const double v = (double)sample_get(
            f->layout.type, samples,
            at[0] + shape->samples[0] * (at[1] + (size_t)shape->samples[1] * at[2]));
        if (!isfinite(v))
            return false;
        lo = fmin(lo, v);
        hi = fmax(hi, v);
    }
    return interests_meet(set, lo, hi);
}

/* All masks from their definition. */
static void true_masks(active_masks *masks, const leaf_file *f, uint32_t t, const void *payload,
                       const interests *set) {
    const leaf_payload shape = leaf_layout_payload(&f->layout, t);
    const void *samples = (const char *)payload + shape.samples_at;
    const uint32_t k = shape.node_levels;
    uint32_t cell[3];
    for (cell[2] = 0; cell[2] < shape.cells[2]; cell[2]++)
        for (cell[1] = 0; cell[1] < shape.cells[1]; cell[1]++)
            for (cell[0] = 0; cell[0] < shape.cells[0]; cell[0]++) {
                if (!is_active(f, &shape, samples, cell, set))
                    continue;
                const uint32_t at = morton(cell[0], cell[1], cell[2]);
                masks->cells[at / 64] |= UINT64_C(1) << at % 64;
                /* The nodes above: of level j, 8^j of them, B^3 / 8^j cells each. */
                for (uint32_t j = 1; j < k; j++) {
                    const uint32_t child = at >> (3 * (k + LEAF_BLOCK_LOG2 - j - 1));
                    masks->nodes[active_nodes_at(j) + child / 8] |= (uint8_t)(1u << child % 8);
                }
                for (int a = 0; a < 3; a++) {
                    const uint8_t block = (uint8_t)(cell[a] >> LEAF_BLOCK_LOG2);
                    masks->first[a] =
                        masks->root && masks->first[a] < block ? masks->first[a] : block;
                    masks->end[a] = masks->end[a] > block ? masks->end[a] : block + 1;
                }
                masks->root |= (uint8_t)(1u << (at >> (3 * (k + LEAF_BLOCK_LOG2 - 1))));
            }
}

/* ---- Comparing ---- */

static void assert_same_masks(const active_masks *got, const active_masks *want, uint32_t levels,
                              const char *what) {
    const size_t nodes = active_nodes_at(levels), blocks = (size_t)1 << (3 * levels);
    if (got->root != want->root)
        fail_msg("%s: the root has children %02x, not %02x", what, got->root, want->root);
    for (int a = 0; a < 3 && want->root; a++)
        if (got->first[a] != want->first[a] || got->end[a] != want->end[a])
            fail_msg("%s: active blocks from %d to %d on axis %d, not %d to %d", what,
                     got->first[a], got->end[a], a, want->first[a], want->end[a]);
    for (size_t i = 0; i < nodes; i++)
        if (got->nodes[i] != want->nodes[i])
            fail_msg("%s: node %zu has children %02x, not %02x", what, i, got->nodes[i],
                     want->nodes[i]);
    for (size_t i = 0; i < blocks; i++)
        if (got->cells[i] != want->cells[i])
            fail_msg("%s: block %zu has cells %016llx, not %016llx", what, i,
                     (unsigned long long)got->cells[i], (unsigned long long)want->cells[i]);
}

typedef struct bench {
    leaf_file *f;
    guarded want, got;
    uint32_t levels;
    uint64_t cells; /* active ones, of all that was compared */
    const char *name;
} bench;

static active_masks *dirty(const guarded *g, uint32_t levels) {
    active_masks *masks = active_init(g->block, levels);
    memset(masks->cells, 0xa5, active_bytes(levels) - sizeof *masks);
    masks->root = 0x5a;
    memset(masks->first, 0x5a, sizeof masks->first);
    memset(masks->end, 0x5a, sizeof masks->end);
    return masks;
}

static void compare(bench *b, uint32_t t, const void *payload, const interests *set, bool honest) {
    char what[512];
    active_masks *want = active_init(b->want.block, b->levels);
    if (honest)
        true_masks(want, b->f, t, payload, set);
    else
        active_compute(want, b->f, t, payload, &set->in);
    for (size_t i = 0; i < (size_t)1 << (3 * b->levels); i++)
        b->cells += (unsigned)__builtin_popcountll(want->cells[i]);
    for (int isa = CPU_SCALAR; isa <= (int)cpu_best(); isa++) {
        active_masks *got = dirty(&b->got, b->levels);
        active_for((cpu_isa)isa)(got, b->f, t, payload, &set->in);
        snprintf(what, sizeof what, "%s, treelet %u, %s, %s", b->name, t, interests_name(set),
                 cpu_isa_name((cpu_isa)isa));
        assert_same_masks(got, want, b->levels, what);
    }
}

/* Codes that say anything: what the versions make of them is the same. */
static void lie(uint8_t *codes, size_t bytes, field_random *r) {
    for (size_t i = 0; i < bytes; i++)
        if (field_random_below(r, 3) == 0)
            codes[i] = (uint8_t)field_random_bits(r);
}

/* Each isovalue, all together, none, everything, and any intervals between these values. */
static void compare_interests(bench *b, uint32_t t, const void *payload, const double *values,
                              int count, field_random *r, bool honest) {
    interests set;
    for (int i = 0; i < count; i++) {
        interests_of_isovalues(&set, &values[i], 1);
        compare(b, t, payload, &set, honest);
    }
    interests_of_isovalues(&set, values, count);
    compare(b, t, payload, &set, honest);
    interests_of_isovalues(&set, values, 0);
    compare(b, t, payload, &set, honest);
    interests_of_all(&set);
    compare(b, t, payload, &set, honest);
    for (int i = 0; i < 6; i++) {
        interests_random(&set, r, values, count);
        compare(b, t, payload, &set, honest);
    }
}

static void compare_treelet(bench *b, uint32_t t, const double *values, int count,
                            field_random *r) {
    const leaf_payload shape = leaf_layout_payload(&b->f->layout, t);
    guarded payload = guarded_make(shape.bytes);
    assert_int_equal(loaded(b->f, t, payload.block), ST_OK);
    compare_interests(b, t, payload.block, values, count, r, true);
    lie(payload.block, leaf_codes_at(shape.node_levels + 1), r);
    compare_interests(b, t, payload.block, values, count, r, false);
    guarded_release(&payload);
}

enum { VALUES_MAX = 32 };

/* All treelets of a case, for values that samples have, lie between, or never reach. Returns the
 * active cells seen. */
static uint64_t compare_case(leaf_case c, const char *name, const double *more, int more_count) {
    bench b = {.name = name};
    double isos[VALUES_MAX] = {-1e30, 1e30, 0.0, -0.5, -1e-310, 4e-45, 300.25, -1e300};
    int count = 8;
    for (int i = 0; i < more_count; i++)
        isos[count++] = more[i];
    field_random r = {FIELD_SEED};
    const size_t total = (size_t)c.dims[0] * c.dims[1] * c.dims[2];
    for (int i = 0; i < 4; i++) {
        const double v = (double)sample_get(c.type, c.samples, field_random_bits(&r) % total);
        if (!isfinite(v))
            continue;
        isos[count++] = v;
        isos[count++] = v + (i < 2 ? 0.25 : -0.25);
        isos[count++] = nextafter(v, i < 2 ? INFINITY : -INFINITY);
    }
    assert_true(count <= VALUES_MAX);
    assert_int_equal(leaf_file_open(&m, leaf_files_make(&c, "active.leaf"), &b.f), ST_OK);
    b.levels = c.options.file.cells_log2 - LEAF_BLOCK_LOG2;
    b.want = guarded_make(active_bytes(b.levels));
    b.got = guarded_make(active_bytes(b.levels));
    for (uint32_t t = 0; t < b.f->layout.treelets; t++)
        compare_treelet(&b, t, isos, count, &r);
    guarded_release(&b.want);
    guarded_release(&b.got);
    leaf_file_close(b.f);
    assert_int_equal(mem_used(&m), 0);
    return b.cells;
}

static const sample_type types[] = {SAMPLE_U8, SAMPLE_I8, SAMPLE_U16, SAMPLE_I16, SAMPLE_F32};
enum { TYPES = sizeof types / sizeof *types };

/* ---- The tests ---- */

/* Every type, every size of treelet, full ones and all ways of being cut. */
static void test_shapes(void **state) {
    (void)state;
    static const uint32_t dims[][4] = {{4, 33, 20, 35}, {4, 2, 5, 18},   {5, 34, 33, 42},
                                       {5, 63, 4, 3},   {5, 3, 2, 66},   {6, 66, 68, 5},
                                       {6, 98, 3, 67},  {6, 65, 35, 33}, {6, 34, 2, 2}};
    for (size_t d = 0; d < sizeof dims / sizeof *dims; d++)
        for (size_t i = WATCHED ? d % 3 : 0; i < TYPES; i += WATCHED ? 3 : 1) {
            char name[64];
            leaf_case c = leaf_files_case(dims[d][1], dims[d][2], dims[d][3], types[i]);
            c.options.file.cells_log2 = dims[d][0];
            c.options.file.halo = (uint32_t)(d + i) & 1u;
            snprintf(name, sizeof name, "%s, %u x %u x %u, treelets of %u", sample_name(types[i]),
                     dims[d][1], dims[d][2], dims[d][3], 1u << dims[d][0]);
            void *samples = leaf_files_random(&c, FIELD_SEED + d, 0);
            c.samples = samples;
            assert_true(compare_case(c, name, NULL, 0) > 0);
            free(samples);
        }
}

/* Plateaus, and extremes of the type beside each other: isovalues equal to them and just beyond. */
static void test_extremes(void **state) {
    (void)state;
    static const double values[TYPES][5] = {{0, 255, 1, 254, 37},
                                            {-128, 127, 0, -1, 37},
                                            {0, 65535, 1, 65534, 300},
                                            {-32768, 32767, 0, -1, 300},
                                            {-3.402823466e38, 3.402823466e38, 0, 1e-45, -1e-40}};
    for (size_t i = 0; i < TYPES; i++) {
        leaf_case c = leaf_files_case(35, 17, 34, types[i]);
        c.options.file.cells_log2 = 5;
        const size_t count = (size_t)35 * 17 * 34;
        char *samples = malloc(count * sample_size(types[i]));
        assert_non_null(samples);
        field_random r = {FIELD_SEED};
        double more[10];
        for (size_t at = 0; at < count; at++) {
            /* Runs of one value, so that blocks with and without a surface lie side by side. */
            const double v = values[i][field_random_below(&r, 8) ? 4 : field_random_below(&r, 5)];
            switch (types[i]) {
            case SAMPLE_U8: ((uint8_t *)samples)[at] = (uint8_t)v; break;
            case SAMPLE_I8: ((int8_t *)samples)[at] = (int8_t)v; break;
            case SAMPLE_U16: ((uint16_t *)samples)[at] = (uint16_t)v; break;
            case SAMPLE_I16: ((int16_t *)samples)[at] = (int16_t)v; break;
            default: ((float *)samples)[at] = (float)v;
            }
        }
        for (int k = 0; k < 5; k++) {
            more[2 * k] = values[i][k];
            more[2 * k + 1] = nextafter(values[i][k], k & 1 ? -INFINITY : INFINITY);
        }
        c.samples = samples;
        assert_true(compare_case(c, sample_name(types[i]), more, 10) > 0);
        free(samples);
    }
}

/* Voxels that are NaN or inf, many and few. */
static void test_missing(void **state) {
    (void)state;
    for (uint32_t log2 = LEAF_CELLS_LOG2_MIN; log2 <= LEAF_CELLS_LOG2_MAX; log2++)
        for (int one_in = 3; one_in <= 3000; one_in *= WATCHED ? 1000 : 10) {
            static const double more[] = {0.25, 0.5, 1.0};
            leaf_case c = leaf_files_case(67, 34, 19, SAMPLE_F32);
            c.options.file.cells_log2 = log2;
            c.options.file.halo = log2 & 1u;
            void *samples = leaf_files_random(&c, FIELD_SEED, one_in);
            c.samples = samples;
            (void)compare_case(c, "missing voxels", more, 3);
            free(samples);
        }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_shapes),
                                       cmocka_unit_test(test_extremes),
                                       cmocka_unit_test(test_missing)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
