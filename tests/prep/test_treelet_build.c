/* test_treelet_build.c - payloads against FORMAT.md done sample by sample. */
/* marks: bits */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "formats/leaf/quantize.h"
#include "prep/grid/treelet_build.h"
#include "tests/support/fields.h"
#include "tests/support/leaf_files.h"

/* One level, whole in memory, and the treelet that is looked at. */
typedef struct level {
    leaf_layout l;
    const char *samples;
    const char **slices;
    sample_box box;
    uint32_t t;
    leaf_payload p;
    unsigned char *payload;
    grid_summary summary;
} level;

static float node(const level *v, int64_t x, int64_t y, int64_t z) {
    int64_t i[3] = {x, y, z};
    for (int a = 0; a < 3; a++) {
        int64_t n = v->l.level[0].dims[a];
        i[a] = i[a] < 0 ? 0 : i[a] >= n ? n - 1 : i[a];
    }
    const uint32_t *d = v->l.level[0].dims;
    return sample_get(v->l.type, v->samples, (size_t)(i[0] + d[0] * (i[1] + (int64_t)d[1] * i[2])));
}

/* Finite range over own nodes [first, last] of the treelet. */
static void range_over(const level *v, const uint32_t first[3], const uint32_t last[3],
                       float r[2]) {
    const uint32_t *place = v->l.place[v->t], b = 1u << v->l.cells_log2;
    r[0] = INFINITY;
    r[1] = -INFINITY;
    for (uint32_t z = first[2]; z <= last[2]; z++)
        for (uint32_t y = first[1]; y <= last[1]; y++)
            for (uint32_t x = first[0]; x <= last[0]; x++) {
                float s = node(v, place[0] * b + x, place[1] * b + y, place[2] * b + z);
                if (isfinite(s)) {
                    r[0] = fminf(r[0], s);
                    r[1] = fmaxf(r[1], s);
                }
            }
}

static void check_samples(const level *v) {
    const uint32_t *place = v->l.place[v->t], b = 1u << v->l.cells_log2;
    int64_t h = v->l.halo;
    size_t i = 0;
    for (int64_t z = 0; z < v->p.samples[2]; z++)
        for (int64_t y = 0; y < v->p.samples[1]; y++)
            for (int64_t x = 0; x < v->p.samples[0]; x++, i++) {
                float expected =
                    node(v, place[0] * b + x - h, place[1] * b + y - h, place[2] * b + z - h);
                float got = sample_get(v->l.type, v->payload + v->p.samples_at, i);
                if (memcmp(&got, &expected, sizeof got) != 0)
                    fail_msg("treelet %u sample %zu: %g, expected %g", v->t, i, (double)got,
                             (double)expected);
            }
}

/* Node (x, y, z) of tree level k: min/max over its finite samples, through the code function;
 * empty: 255, 0. Codes of inner nodes are those of their range, since the function is monotone. */
static void check_code(const level *v, const quantizer *q, uint32_t k, uint32_t x, uint32_t y,
                       uint32_t z) {
    uint32_t side = (1u << v->l.cells_log2) >> k, m = 0, xyz[3] = {x, y, z}, first[3], last[3];
    float r[2] = {INFINITY, -INFINITY};
    bool inside = true;
    for (unsigned a = 0; a < 3; a++) {
        for (unsigned bit = 0; bit < k; bit++)
            m |= (xyz[a] >> bit & 1) << (3 * bit + a);
        first[a] = xyz[a] * side;
        last[a] = first[a] + side < v->p.cells[a] ? first[a] + side : v->p.cells[a];
        inside &= first[a] < v->p.cells[a];
    }
    if (inside)
        range_over(v, first, last, r);
    bool empty = r[0] > r[1];
    const unsigned char *codes = v->payload + leaf_codes_at(k);
    assert_int_equal(codes[m], empty ? 255 : quantizer_floor(q, (double)r[0]));
    assert_int_equal(codes[m + (1u << (3 * k))], empty ? 0 : quantizer_ceil(q, (double)r[1]));
}

static void check_treelet(const level *v) {
    static const uint32_t origin[3] = {0, 0, 0};
    float own[2];
    range_over(v, origin, v->p.cells, own);
    assert_true(own[0] == v->summary.own[0] && own[1] == v->summary.own[1]);
    assert_false(signbit(v->summary.own[0]) && v->summary.own[0] == 0);
    bool non_finite = false;
    for (uint32_t z = 0; z <= v->p.cells[2]; z++)
        for (uint32_t y = 0; y <= v->p.cells[1]; y++)
            for (uint32_t x = 0; x <= v->p.cells[0]; x++)
                non_finite |= !isfinite(node(v, (v->l.place[v->t][0] << v->l.cells_log2) + x,
                                             (v->l.place[v->t][1] << v->l.cells_log2) + y,
                                             (v->l.place[v->t][2] << v->l.cells_log2) + z));
    assert_int_equal(v->summary.flags, non_finite ? LEAF_FLAG_NON_FINITE : 0);
    check_samples(v);
    quantizer q = quantizer_of(own[0], own[1], v->l.type);
    for (uint32_t k = 1; k <= v->p.node_levels; k++)
        for (uint32_t i = 0; i < 1u << (3 * k); i++)
            check_code(v, &q, k, i & ((1u << k) - 1), i >> k & ((1u << k) - 1), i >> (2 * k));
    for (uint32_t i = leaf_codes_at(v->p.node_levels + 1); i < v->p.samples_at; i++)
        assert_int_equal(v->payload[i], 0);
    size_t end = v->p.samples_at + (size_t)v->p.samples[0] * v->p.samples[1] * v->p.samples[2] *
                                       sample_size(v->l.type);
    for (size_t i = end; i < v->p.bytes; i++)
        assert_int_equal(v->payload[i], 0);
}

/* All treelets of level 0. */
static void check_level(const uint32_t dims[3], sample_type type, const void *samples,
                        uint32_t log2, uint32_t halo) {
    mem m;
    mem_init(&m, 0);
    level v = {.samples = samples};
    assert_int_equal(leaf_layout_init(&v.l, &m, dims, log2, halo, type), ST_OK);
    v.slices = calloc(dims[2], sizeof *v.slices);
    v.box = (sample_box){.size = {dims[0], dims[1], dims[2]},
                         .row_bytes = dims[0] * sample_size(type),
                         .slices = v.slices};
    for (uint32_t z = 0; z < dims[2]; z++)
        v.slices[z] = v.samples + z * dims[1] * v.box.row_bytes;
    grid_codes_scratch *scratch = mem_alloc(&m, grid_codes_scratch_bytes(leaf_node_levels(&v.l)));
    v.payload = mem_alloc(&m, leaf_layout_payload_max(&v.l));
    memset(v.payload, 0xA5, leaf_layout_payload_max(&v.l));
    for (v.t = v.l.level[0].first; v.t < v.l.treelets; v.t++) {
        v.p = leaf_layout_payload(&v.l, v.t);
        treelet_build(&v.l, v.t, &v.box, scratch, v.payload, &v.summary);
        check_treelet(&v);
    }
    mem_free(&m, v.payload);
    mem_free(&m, scratch);
    leaf_layout_release(&v.l);
    free(v.slices);
    assert_int_equal(mem_used(&m), 0);
}

static void test_payloads(void **state) {
    (void)state;
    static const uint32_t sizes[][3] = {
        {2, 2, 2}, {17, 17, 17}, {18, 5, 34}, {33, 16, 20}, {3, 37, 2}};
    for (size_t i = 0; i < sizeof sizes / sizeof sizes[0]; i++)
        for (int type = SAMPLE_U8; type <= SAMPLE_F32; type++)
            for (uint32_t halo = 0; halo < 2; halo++) {
                leaf_case c =
                    leaf_files_case(sizes[i][0], sizes[i][1], sizes[i][2], (sample_type)type);
                void *samples = leaf_files_random(&c, FIELD_SEED + i, halo ? 40 : 0);
                check_level(c.dims, c.type, samples, 4, halo);
                check_level(c.dims, c.type, samples, 5 + (uint32_t)i % 2, halo);
                free(samples);
            }
}

static void test_strange(void **state) {
    (void)state;
    static const float values[] = {0, -0.0F, NAN, INFINITY, -INFINITY, 1e-45F, -3.4028235e38F, 7};
    enum { N = 19, COUNT = N * N * N };
    static const uint32_t dims[3] = {N, N, N};
    float *samples = malloc(COUNT * sizeof *samples);
    for (size_t n = 0; n < sizeof values / sizeof values[0]; n++) {
        for (int i = 0; i < COUNT; i++)
            samples[i] = values[n];
        check_level(dims, SAMPLE_F32, samples, 4, 1);
        /* One other sample among them: in a corner, in the middle, at the far end. */
        static const int places[] = {0, COUNT / 2, COUNT - 1};
        for (int i = 0; i < 3; i++) {
            samples[places[i]] = i == 1 ? -0.0F : 5;
            check_level(dims, SAMPLE_F32, samples, 4, 1);
        }
    }
    free(samples);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_payloads),
        cmocka_unit_test(test_strange),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
