/* test_mesh_coder.c - coded payloads of meshes: the same bytes come back, whatever they are, from
 * both decoders; hostile streams are refused, or make some payload, and touch nothing else. */
/* marks: bits */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "formats/leaf/float_planes.h"
#include "formats/leaf/leaf_unpacker.h"
#include "formats/mesh/mesh_coder.h"
#include "formats/mesh/mesh_leaf.h"
#include "tests/support/coder_lab.h"
#include "tests/support/fields.h"
#include "tests/support/mesh_leaves.h"
#include "tests/support/naive_coded.h"
#include "tests/support/scratch.h"

enum { GUARD_BYTE = 0xa7 };

static mem m;

/* ---- a payload, coded ---- */

static coder_subject subject_of(leaf_file *f, leaf_block block, uint32_t p, uint32_t t) {
    coder_subject x = coder_lab_subject(&mesh_coder, block, f->mesh->counts[t],
                                        f->mesh->bounds[leaf_layout_bounds(&f->layout, 0, t)]);
    assert_int_equal(x.bytes, leaf_layout_payload_bytes(&f->layout, p));
    assert_int_equal(leaf_file_load(f, p, NULL, x.payload), ST_OK);
    return x;
}

/* The naive decoder makes no boxes: take those of `like` if they are implied. */
static uint8_t *decode_naively(const coder_subject *x, const uint8_t *in, size_t size,
                               const uint8_t *like) {
    uint8_t *out = coder_lab_guarded(x->bytes);
    memset(out, 0, x->bytes);
    if (!naive_coded_decode((int)x->block, x->counts, in, size, out, x->bytes)) {
        free(out);
        return NULL;
    }
    if (like && x->block == LEAF_BLOCK_TOPOLOGY && in[0] == 1)
        for (uint32_t n = 0; n < x->counts[2]; n++)
            memcpy(out + n * sizeof(mesh_node), like + n * sizeof(mesh_node), sizeof(mesh_boxes));
    return out;
}

/* Encode; both decoders give the payload back. way: what the first byte is to say; -1: any. */
static void check_round(coder_subject *x, int way) {
    coder_lab_encode(x);
    const coded_streams *s = &x->streams;
    uint8_t *plain = coder_lab_decode(x, s->bytes, s->used);
    assert_non_null(plain);
    assert_memory_equal(plain, x->payload, x->bytes);
    uint8_t *naive = decode_naively(x, s->bytes, s->used, plain);
    assert_non_null(naive);
    assert_memory_equal(naive, x->payload, x->bytes);
    if (way >= 0)
        assert_int_equal(s->bytes[0], way);
    free(plain);
    free(naive);
}

/* ---- payloads of files ---- */

typedef void visit(coder_subject *x, field_random *r);

static void visit_file(const mesh_case *c, visit *f_of, uint64_t seed) {
    field_random r = {seed};
    leaf_file *f = NULL;
    assert_int_equal(leaf_file_open(&m, mesh_leaves_make(c, "coder.leaf"), &f), ST_OK);
    for (uint32_t p = 0; p < f->layout.payloads; p++) {
        uint32_t index;
        const leaf_block block = leaf_layout_block_of(&f->layout, p, &index);
        coder_subject x = subject_of(f, block, p, p % f->layout.treelets);
        f_of(&x, &r);
        coder_lab_release(&x);
    }
    leaf_file_close(f);
}

static void shuffle(uint32_t *items, size_t count, size_t width, field_random *r) {
    for (size_t i = count; i > 1; i--) {
        const size_t j = (size_t)field_random_below(r, (long)i);
        for (size_t k = 0; k < width; k++) {
            const uint32_t kept = items[(i - 1) * width + k];
            items[(i - 1) * width + k] = items[j * width + k];
            items[j * width + k] = kept;
        }
    }
}

/* Cubes of n^3 cells. shuffled: tets in any order, so that vertices come back after a long time. */
static void visit_cube(uint32_t n, uint32_t treelet_tets, uint32_t leaf_tets, bool shuffled,
                       bool chain, visit *f_of) {
    mesh_case c = mesh_leaves_cube(n, 1, 2, 3 * n, 9);
    field_random r = {n};
    mesh_leaves_extend(&c, n);
    c.mesh.treelet_tets = treelet_tets;
    c.mesh.leaf_tets = leaf_tets;
    c.chain = chain;
    if (shuffled)
        shuffle(c.ids[0], c.tets, 4, &r);
    visit_file(&c, f_of, n);
    mesh_leaves_release(&c);
}

static void check_file_payload(coder_subject *x, field_random *r) {
    (void)r;
    check_round(x, 1);
}

/* A path of 65 nodes is too long. */
static void check_deep(coder_subject *x, field_random *r) {
    (void)r;
    check_round(x, x->block == LEAF_BLOCK_TOPOLOGY && x->counts[2] > 64 ? 0 : 1);
}

/* Trees of one leaf, of many, as deep as can be; lists of recent vertices that are short, full,
 * moved. */
static void test_files(void **state) {
    (void)state;
    visit_cube(1, 1, 1, false, false, check_file_payload);
    visit_cube(1, 6, 64, false, false, check_file_payload);
    visit_cube(3, 50, 3, false, false, check_file_payload);
    visit_cube(3, 65, 1, false, true, check_file_payload);
    visit_cube(3, 66, 1, false, true, check_deep);
    visit_cube(5, 700, 12, true, false, check_file_payload);
    visit_cube(7, 4096, 12, false, false, check_file_payload);
    visit_cube(14, 16384, 64, false, false, check_file_payload);
    visit_cube(14, 16384, 64, true, false, check_file_payload);
}

static void check_small(coder_subject *x, field_random *r) {
    (void)r;
    coder_lab_encode(x);
    if (x->block == LEAF_BLOCK_TOPOLOGY)
        assert_true(x->streams.used * 3 < x->bytes * 2);
    else
        assert_true(x->streams.used <= x->bytes + 1);
}

/* Coded topologies of sound meshes are smaller, even before they are compressed. Other payloads are
 * not larger, but for the first byte. */
static void test_sizes(void **state) {
    (void)state;
    visit_cube(7, 4096, 12, false, false, check_small);
}

/* All vertices in one plane, in one line, at one place. */
static void test_flat(void **state) {
    (void)state;
    for (int axes = 0; axes < 3; axes++) {
        mesh_case c = mesh_leaves_cube(3, 1, 1, 4, 0);
        for (size_t v = 0; v < c.points; v++)
            for (int a = axes; a < 3; a++)
                c.xyz[v][a] = a == 0 ? -2.5F : 1e-40F;
        visit_file(&c, check_file_payload, 1);
        mesh_leaves_release(&c);
    }
}

/* ---- odd numbers ---- */

static uint32_t odd_bits(field_random *r) {
    static const uint32_t odd[] = {0,          0x80000000, 1,          0x80000001, 0x007fffff,
                                   0x7f800000, 0xff800000, 0x7fc00000, 0xffc00000, 0x7f800001,
                                   0xffffffff, 0x7fffffff, 0x7f7fffff, 0xff7fffff, 0x3f800000};
    if (field_random_below(r, 2))
        return (uint32_t)field_random_bits(r);
    return odd[field_random_below(r, sizeof odd / sizeof odd[0])];
}

/* Where the floats of the vertices are, and how many. */
static uint8_t *floats_of(const coder_subject *x, size_t *count) {
    const mesh_shape s = mesh_leaf_shape(x->counts);
    *count = s.vertices * (x->block == LEAF_BLOCK_VALUES ? 1 : 3);
    return x->payload + (x->block == LEAF_BLOCK_TOPOLOGY    ? s.positions_at
                         : x->block == LEAF_BLOCK_VALUES    ? s.values_at
                         : x->block == LEAF_BLOCK_GRADIENTS ? 0
                                                            : s.moved_at);
}

static void check_odd_floats(coder_subject *x, field_random *r) {
    size_t count;
    uint8_t *floats = floats_of(x, &count);
    for (size_t i = 0; i < count; i++) {
        const uint32_t bits = odd_bits(r);
        memcpy(floats + i * sizeof bits, &bits, sizeof bits);
    }
    check_round(x, x->block == LEAF_BLOCK_TOPOLOGY ? 2 : 1);
    for (size_t i = 0; i < count; i++)
        memcpy(floats + i * sizeof(float), &(float){-0.0F}, sizeof(float));
    memset(x->bounds, 0, sizeof x->bounds);
    check_round(x, -1);
}

/* Codes of nodes that are not those of the vertices; all absent, too. */
static void check_odd_codes(coder_subject *x, field_random *r) {
    const mesh_shape s = mesh_leaf_shape(x->counts);
    const size_t node = x->block == LEAF_BLOCK_VALUES     ? sizeof(mesh_codes)
                        : x->block == LEAF_BLOCK_TOPOLOGY ? sizeof(mesh_node)
                                                          : sizeof(mesh_boxes);
    const size_t codes = x->block == LEAF_BLOCK_VALUES ? sizeof(mesh_codes) : sizeof(mesh_boxes);
    if (x->block == LEAF_BLOCK_GRADIENTS)
        return;
    uint8_t *some = x->payload + node * (size_t)field_random_below(r, s.nodes);
    some[field_random_below(r, (long)codes)] ^= (uint8_t)(1 << field_random_below(r, 8));
    check_round(x, x->block == LEAF_BLOCK_TOPOLOGY ? 2 : 1);
    for (uint32_t n = 0; n < s.nodes; n++) {
        memset(x->payload + n * node, 255, codes / 2);
        memset(x->payload + n * node + codes / 2, 0, codes / 2);
    }
    check_round(x, x->block == LEAF_BLOCK_TOPOLOGY ? 2 : 1);
    for (uint32_t n = 0; n < s.nodes; n++)
        for (size_t i = 0; i < codes; i++)
            x->payload[n * node + i] = (uint8_t)field_random_bits(r);
    check_round(x, x->block == LEAF_BLOCK_TOPOLOGY ? 2 : 1);
}

static void test_odd_numbers(void **state) {
    (void)state;
    visit_cube(3, 50, 3, false, false, check_odd_floats);
    visit_cube(5, 700, 12, true, false, check_odd_floats);
    visit_cube(3, 50, 3, false, false, check_odd_codes);
    visit_cube(5, 700, 12, false, false, check_odd_codes);
}

/* ---- payloads that are stored as they are ---- */

static void check_stored(const coder_subject *x, size_t at, uint8_t flip) {
    coder_subject other = *x;
    other.streams = (coded_streams){0};
    other.payload = coder_lab_guarded(x->bytes);
    memcpy(other.payload, x->payload, x->bytes);
    other.payload[at] ^= flip;
    check_round(&other, 0);
    coder_lab_release(&other);
}

static void check_faulty(coder_subject *x, field_random *r) {
    const mesh_shape s = mesh_leaf_shape(x->counts);
    size_t count;
    const size_t floats_end = (size_t)(floats_of(x, &count) - x->payload) + count * sizeof(float);
    if (floats_end < x->bytes)
        check_stored(x, floats_end, 1);
    if (x->block == LEAF_BLOCK_VALUES && s.nodes % 4)
        check_stored(x, s.nodes * sizeof(mesh_codes), 255);
    if (x->block != LEAF_BLOCK_TOPOLOGY)
        return;
    check_stored(x, s.tets_at + 7, 255);                                         /* too large */
    check_stored(x, s.tets_at + 8 * (size_t)field_random_below(r, s.tets), 255); /* the order */
    check_stored(x, s.leaf_first_at, 1);
    check_stored(x, s.leaf_first_at + 2 * s.leaves, 1);
    check_stored(x, offsetof(mesh_node, child), 1);
    check_stored(x, offsetof(mesh_node, child) + 1, 0x80);
}

/* Any bytes at all. */
static void check_any(coder_subject *x, field_random *r) {
    for (size_t i = 0; i < x->bytes; i++)
        x->payload[i] = (uint8_t)field_random_bits(r);
    check_round(x, x->block == LEAF_BLOCK_TOPOLOGY ? 0 : -1);
    memset(x->payload, 0, x->bytes);
    check_round(x, x->block == LEAF_BLOCK_TOPOLOGY ? 0 : 1);
    memset(x->payload, 255, x->bytes);
    check_round(x, -1);
}

/* A vertex without a tet. */
static void check_unused(coder_subject *x, field_random *r) {
    if (x->block != LEAF_BLOCK_TOPOLOGY)
        return;
    const mesh_shape s = mesh_leaf_shape(x->counts);
    uint16_t *tets = (uint16_t *)(x->payload + s.tets_at);
    for (uint32_t i = 0; i < s.tets; i++)
        memcpy(tets + 4 * i, (const uint16_t[]){0, 1, 2, 3}, 8);
    (void)r;
    check_round(x, s.vertices == 4 ? 2 : 0);
}

static void test_stored(void **state) {
    (void)state;
    visit_cube(2, 40, 3, false, false, check_faulty);
    visit_cube(3, 50, 3, false, false, check_any);
    visit_cube(2, 30, 3, false, false, check_unused);
}

/* ---- hostile streams ---- */

static bool positions_within(const coder_subject *x, const uint8_t *payload) {
    const mesh_shape s = mesh_leaf_shape(x->counts);
    const float(*p)[3] = mesh_leaf_positions(&s, payload);
    for (uint32_t v = 0; v < s.vertices; v++)
        for (int a = 0; a < 3; a++)
            if (!(p[v][a] >= x->bounds[a] && p[v][a] <= x->bounds[a + 3]))
                return false;
    return true;
}

/* Both decoders agree. What comes out of bytes, if anything does, comes back from its own streams.
 * Returns whether anything did. */
static bool check_hostile(const coder_subject *x, const uint8_t *bytes, size_t size) {
    uint8_t *out = coder_lab_decode(x, bytes, size);
    uint8_t *naive = decode_naively(x, bytes, size, out);
    if (out) {
        assert_non_null(naive);
        assert_memory_equal(out, naive, x->bytes);
        coder_subject again = *x;
        again.payload = out;
        again.streams = (coded_streams){0};
        check_round(&again, -1);
        coder_lab_release(&again);
    } else if (naive) {
        assert_true(x->block == LEAF_BLOCK_TOPOLOGY && bytes[0] == 1);
        assert_false(positions_within(x, naive));
    }
    free(naive);
    return out != NULL;
}

static void check_cut(coder_subject *x, field_random *r) {
    coder_lab_encode(x);
    coded_streams *s = &x->streams;
    for (size_t size = 0; size < s->used; size++)
        assert_false(check_hostile(x, s->bytes, size));
    uint8_t *longer = malloc(s->used + 3);
    assert_non_null(longer);
    memcpy(longer, s->bytes, s->used);
    memset(longer + s->used, 0, 3);
    for (size_t more = 1; more <= 3; more++)
        assert_false(check_hostile(x, longer, s->used + more));
    free(longer);
    (void)r;
}

static void check_changed(coder_subject *x, field_random *r) {
    coder_lab_encode(x);
    coded_streams *s = &x->streams;
    uint8_t *bytes = malloc(s->used);
    assert_non_null(bytes);
    for (int round = 0; round < 150; round++) {
        memcpy(bytes, s->bytes, s->used);
        for (long i = field_random_below(r, 4); i >= 0; i--) {
            uint8_t *at = bytes + field_random_below(r, (long)s->used);
            const unsigned flipped = *at ^ 1U << field_random_below(r, 8);
            *at = (uint8_t)(field_random_below(r, 2) ? field_random_bits(r) : flipped);
        }
        (void)check_hostile(x, bytes, s->used);
    }
    /* Other counts: of a neighbour's shape. */
    for (int k = 0; k < 4; k++) {
        coder_subject other = *x;
        other.counts[k] += k % 2 ? 1 : (uint32_t)-1;
        other.bytes = mesh_coder.bytes(x->block, other.counts);
        if (!mesh_leaf_counts_fault(other.counts, 16384, 64))
            (void)check_hostile(&other, s->bytes, s->used);
    }
    free(bytes);
}

/* With boxes that are stored, positions may be any. */
static void check_changed_boxes(coder_subject *x, field_random *r) {
    x->payload[0] ^= 1;
    check_changed(x, r);
}

/* Streams that begin well: of one tree, with any codes, words and positions behind it. */
static void check_random(coder_subject *x, field_random *r) {
    coder_lab_encode(x);
    coded_streams *s = &x->streams;
    uint8_t *bytes = malloc(s->used);
    assert_non_null(bytes);
    for (int round = 0; round < 20; round++) {
        memcpy(bytes, s->bytes, s->used);
        for (size_t i = s->end[0]; i < s->used; i++)
            bytes[i] = (uint8_t)(field_random_bits(r) & (round % 2 ? 255 : 1));
        (void)check_hostile(x, bytes, s->used);
        bytes[0] = 2;
        (void)check_hostile(x, bytes, s->used);
    }
    free(bytes);
}

static void test_hostile(void **state) {
    (void)state;
    visit_cube(1, 6, 3, false, false, check_cut);
    visit_cube(2, 40, 3, false, false, check_cut);
    visit_cube(2, 40, 3, false, false, check_changed);
    visit_cube(4, 384, 12, true, false, check_changed);
    visit_cube(7, 2058, 12, true, false, check_changed);
    visit_cube(2, 40, 3, false, false, check_changed_boxes);
    visit_cube(7, 2058, 12, true, false, check_changed_boxes);
    visit_cube(2, 40, 3, false, false, check_random);
    visit_cube(7, 2058, 12, true, false, check_random);
}

/* ---- each rule of a topology's streams ---- */

/* Refuse a topology's streams with a byte that is wrong, and put it back. */
static void check_refused(coder_subject *x, size_t at, uint8_t wrong) {
    uint8_t *bytes = x->streams.bytes, kept = bytes[at];
    assert_true(kept != wrong);
    bytes[at] = wrong;
    assert_false(check_hostile(x, bytes, x->streams.used));
    bytes[at] = kept;
}

static void check_leaf_rules(coder_subject *x) {
    const size_t leaf = 1 + 2 * (size_t)x->counts[2];
    uint8_t *bytes = x->streams.bytes;
    if (x->counts[3] < 2)
        return;
    check_refused(x, leaf, (uint8_t)(bytes[leaf] + 1));
    bytes[leaf] = (uint8_t)(bytes[leaf] + bytes[leaf + 1]);
    check_refused(x, leaf + 1, 0);
    bytes[leaf] = (uint8_t)(bytes[leaf] - bytes[leaf + 1]);
}

/* Of any tet, make a corner that is told one that is not, and the other way round. */
static void check_corner_rules(coder_subject *x) {
    const uint8_t *bytes = x->streams.bytes;
    const size_t codes = x->streams.end[0], end = x->streams.end[2];
    for (size_t at = codes; at < end; at++)
        if (bytes[at] == 0 || bytes[at] == 255)
            check_refused(x, at, bytes[at] ^ 255);
}

/* Nine children of the first node, but as many as before of two nodes together. */
static void check_nine_children(coder_subject *x) {
    uint8_t *children = x->streams.bytes + 1;
    if (x->counts[2] < 2 || children[0] + children[1] < 9)
        return;
    const uint8_t kept = children[0];
    children[1] = (uint8_t)(children[1] - (9 - kept));
    check_refused(x, 1, 9);
    children[1] = (uint8_t)(children[1] + (9 - kept));
}

static void check_rules(coder_subject *x, field_random *r) {
    (void)r;
    if (x->block == LEAF_BLOCK_GRADIENTS)
        return;
    coder_lab_encode(x);
    check_nine_children(x);
    check_refused(x, 0, x->block == LEAF_BLOCK_TOPOLOGY ? 3 : 2);
    for (uint32_t n = 0; n < x->counts[2]; n++)
        check_refused(x, 1 + n, 9);
    if (x->block != LEAF_BLOCK_TOPOLOGY)
        return;
    for (size_t at = 1 + x->counts[2]; at < 1 + 2 * (size_t)x->counts[2]; at++)
        if (x->streams.bytes[at] != 255)
            check_refused(x, at, 255);
    check_leaf_rules(x);
    check_corner_rules(x);
}

/* A chain whose last node is no node's child, but the root has one more leaf. */
static void check_lost_node(coder_subject *x, field_random *r) {
    (void)r;
    const uint32_t n = x->counts[2];
    if (x->block != LEAF_BLOCK_TOPOLOGY || n < 3)
        return;
    coder_lab_encode(x);
    uint8_t *children = x->streams.bytes + 1, *inner = children + n;
    assert_true(children[0] == 2 && inner[0] == 2 && inner[n - 2] == 2);
    children[0] = 3;
    inner[n - 2] = 0;
    assert_false(check_hostile(x, x->streams.bytes, x->streams.used));
}

/* Boxes are not implied of positions that are out of bounds. */
static void check_out_of_bounds(coder_subject *x, field_random *r) {
    if (x->block != LEAF_BLOCK_TOPOLOGY)
        return;
    const mesh_shape s = mesh_leaf_shape(x->counts);
    static const float odd[] = {NAN, INFINITY, -INFINITY, 1e30F, -1e30F};
    float *floats = (float *)(x->payload + s.positions_at);
    floats[field_random_below(r, 3L * s.vertices)] = odd[field_random_below(r, 5)];
    check_round(x, 2);
    x->streams.bytes[0] = 1;
    assert_false(
        check_hostile(x, x->streams.bytes, x->streams.used - s.nodes * sizeof(mesh_boxes)));
}

static void check_cut_stored(coder_subject *x, field_random *r) {
    memset(x->payload, 0xa5, x->bytes);
    if (x->block == LEAF_BLOCK_TOPOLOGY)
        check_cut(x, r);
}

static void test_rules(void **state) {
    (void)state;
    visit_cube(3, 50, 3, true, false, check_rules);
    visit_cube(6, 1296, 12, true, false, check_rules);
    visit_cube(2, 40, 1, false, true, check_lost_node);
    visit_cube(3, 50, 3, false, false, check_out_of_bounds);
    visit_cube(1, 6, 3, false, false, check_cut_stored);
}

/* ---- floats ---- */

static void check_float(uint32_t bits, uint32_t predicted) {
    uint8_t planes[FLOAT_PLANES * 3];
    memset(planes, GUARD_BYTE, sizeof planes);
    float_planes_put(planes + 1, 3, bits, predicted);
    assert_int_equal(float_planes_get(planes + 1, 3, predicted), bits);
    for (size_t i = 0; i < sizeof planes; i++)
        assert_true(i % 3 == 1 || planes[i] == GUARD_BYTE);
}

static void test_floats(void **state) {
    (void)state;
    static const float ascending[] = {-INFINITY, -3e38F, -1.5F, -1e-45F, -0.0F,   0.0F,
                                      1e-45F,    1e-38F, 1.5F,  3e38F,   INFINITY};
    field_random r = {FIELD_SEED};
    for (size_t i = 0; i + 1 < sizeof ascending / sizeof ascending[0]; i++) {
        uint32_t a, b;
        memcpy(&a, &ascending[i], sizeof a);
        memcpy(&b, &ascending[i + 1], sizeof b);
        assert_true(float_planes_rank(a) < float_planes_rank(b));
    }
    assert_int_equal(float_planes_fold(0), 0);
    assert_int_equal(float_planes_fold(UINT32_MAX), 1);
    assert_int_equal(float_planes_fold(1), 2);
    assert_int_equal(float_planes_fold(0x80000000), UINT32_MAX);
    for (int i = 0; i < 10000; i++)
        check_float(odd_bits(&r), odd_bits(&r));
}

static int set_up(void **state) {
    (void)state;
    mem_init(&m, 0);
    return 0;
}

static int tear_down(void **state) {
    (void)state;
    assert_int_equal(mem_used(&m), 0);
    return 0;
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_floats),      cmocka_unit_test(test_files),
        cmocka_unit_test(test_sizes),       cmocka_unit_test(test_flat),
        cmocka_unit_test(test_odd_numbers), cmocka_unit_test(test_stored),
        cmocka_unit_test(test_hostile),     cmocka_unit_test(test_rules),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
