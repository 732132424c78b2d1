/* test_cell_coders.c - coded payloads of curvilinear grids, mixed meshes and surfaces: the same
 * bytes come back, whatever they are, from both decoders; hostile streams are refused by both, or
 * make the same payload, and touch nothing else. */
/* marks: bits */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "formats/leaf/curvilinear_coder.h"
#include "formats/leaf/curvilinear_geometry.h"
#include "formats/leaf/float_planes.h"
#include "formats/leaf/leaf_geometry.h"
#include "formats/leaf/mixed_coder.h"
#include "formats/leaf/mixed_corner_coder.h"
#include "formats/leaf/triangle_coder.h"
#include "formats/leaf/triangle_geometry.h"
#include "formats/mesh/mesh_coder.h"
#include "tests/support/coder_lab.h"
#include "tests/support/fields.h"
#include "tests/support/naive_cells.h"

enum { LIES = 30 };

static uint8_t *decode_naively(const coder_subject *x, const uint8_t *in, size_t size) {
    uint8_t *out = coder_lab_guarded(x->bytes);
    memset(out, 0, x->bytes);
    bool good;
    if (x->coder == &mixed_coder)
        good = naive_cells_mixed((int)x->block, x->counts, in, size, out, x->bytes);
    else if (x->coder == &triangle_coder)
        good = naive_cells_triangles((int)x->block, x->counts, in, size, out, x->bytes);
    else
        good = naive_cells_curvilinear(x->block != LEAF_BLOCK_VALUES, x->counts, in, size, out,
                                       x->bytes);
    if (good)
        return out;
    free(out);
    return NULL;
}

/* Both decoders say the same. Returns whether they take it. */
static bool check_both(const coder_subject *x, const uint8_t *in, size_t size) {
    uint8_t *plain = coder_lab_decode(x, in, size), *naive = decode_naively(x, in, size);
    assert_int_equal(plain != NULL, naive != NULL);
    const bool taken = plain != NULL;
    if (taken)
        assert_memory_equal(plain, naive, x->bytes);
    free(plain);
    free(naive);
    return taken;
}

/* Encode; both decoders give the payload back. first: what the first byte is to say. */
static void check_round(coder_subject *x, int first) {
    coder_lab_encode(x);
    const coded_streams *s = &x->streams;
    uint8_t *plain = coder_lab_decode(x, s->bytes, s->used);
    assert_non_null(plain);
    assert_memory_equal(plain, x->payload, x->bytes);
    free(plain);
    assert_true(check_both(x, s->bytes, s->used));
    assert_int_equal(s->bytes[0], first);
}

/* ---- payloads ---- */

/* Any bits: NaN with payloads, -0, infinities too. */
static float any_float(field_random *r) {
    const uint32_t bits = (uint32_t)field_random_bits(r);
    float x;
    memcpy(&x, &bits, sizeof x);
    return x;
}

typedef float number(field_random *r, uint32_t n);

static float smooth(field_random *r, uint32_t n) {
    (void)r;
    return (float)sin(0.1 * n) + 0.001f * (float)n;
}

static float wild(field_random *r, uint32_t n) {
    return n % 3 ? any_float(r) : NAN;
}

static void fill(float *to, size_t count, number *of, field_random *r) {
    for (size_t i = 0; i < count; i++)
        to[i] = of(r, (uint32_t)i);
}

static void fill_codes(uint8_t *to, size_t cells, field_random *r) {
    for (size_t i = 0; i < cells; i++)
        to[i / 4] |= (uint8_t)(field_random_below(r, 4) << 2 * (i % 4));
}

static void fill_curvilinear(coder_subject *x, number *of, field_random *r) {
    const size_t floats = curvilinear_nodes(x->counts) * (x->block == LEAF_BLOCK_VALUES ? 1U : 3U);
    fill((float *)(void *)x->payload, floats, of, r);
    if (x->block != LEAF_BLOCK_VALUES)
        fill_codes(x->payload + floats * sizeof(float), curvilinear_cells(x->counts), r);
}

/* Corners of cells in their order: of a lattice, or of random nodes, many of them again. Sets
 * counts[1]. */
typedef struct cells {
    uint32_t counts[4];
    uint16_t corner[MIXED_CELLS_MAX][HEX_CORNERS];
} cells;

static void make_lattice(cells *c, uint32_t side, bool wedges) {
    static uint16_t node[64 * 64 * 64];
    memset(node, 0xff, sizeof node);
    *c = (cells){.counts = {side * side * side}};
    for (uint32_t i = 0; i < c->counts[0]; i++)
        for (uint32_t q = 0; q < HEX_CORNERS; q++) {
            const uint32_t k = wedges && i % 3 == 1 && (q & 3) == 3 ? q - 1 : q;
            const uint32_t x = i % side + (k & 1), y = i / side % side + (k >> 1 & 1),
                           z = i / side / side + (k >> 2);
            uint16_t *n = &node[x + 64 * (y + 64 * z)];
            if (*n == UINT16_MAX)
                *n = (uint16_t)c->counts[1]++;
            c->corner[i][q] = *n;
        }
}

static void make_random(cells *c, uint32_t count, field_random *r) {
    *c = (cells){.counts = {count}};
    for (uint32_t i = 0; i < count; i++)
        for (uint32_t q = 0; q < HEX_CORNERS; q++) {
            const uint32_t met = c->counts[1];
            const long how = field_random_below(r, 4);
            uint32_t node = met;
            if (met > 4 && how == 1) /* one of them all */
                node = (uint32_t)field_random_below(r, met);
            else if (met > 4 && how >= 2) /* one of the latest */
                node = met - 1 - (uint32_t)field_random_below(r, met < 40 ? met : 40);
            c->counts[1] += node == met;
            c->corner[i][q] = (uint16_t)node;
        }
}

static void fill_mixed(coder_subject *x, const cells *c, number *of, field_random *r) {
    const mixed_shape s = mixed_shape_of(x->counts);
    const bool values = x->block == LEAF_BLOCK_VALUES;
    fill((float *)(void *)x->payload, s.nodes * (values ? 1U : 3U), of, r);
    if (!values)
        fill_codes(x->payload + s.codes_at, s.cells, r);
    if (x->block == LEAF_BLOCK_TOPOLOGY)
        memcpy(x->payload + s.rows_at, c->corner, s.cells * sizeof c->corner[0]);
}

/* ---- all of them ---- */

typedef void visit(coder_subject *x, field_random *r);

static const leaf_block blocks[] = {LEAF_BLOCK_TOPOLOGY, LEAF_BLOCK_VALUES, LEAF_BLOCK_POSITIONS};
static number *const numbers[] = {smooth, wild};

static void visit_curvilinear(visit *f, field_random *r) {
    static const uint32_t counts[][4] = {{1, 1, 1}, {3, 2, 5}, {32, 4, 2}, {2, 31, 1}, {1, 1, 32}};
    for (size_t i = 0; i < sizeof counts / sizeof counts[0]; i++)
        for (size_t b = 0; b < 3; b++)
            for (size_t n = 0; n < 2; n++) {
                coder_subject x = coder_lab_subject(&curvilinear_coder, blocks[b], counts[i], NULL);
                fill_curvilinear(&x, numbers[n], r);
                f(&x, r);
                coder_lab_release(&x);
            }
}

static void visit_cells(const cells *c, visit *f, field_random *r) {
    for (size_t b = 0; b < 3; b++)
        for (size_t n = 0; n < 2; n++) {
            coder_subject x = coder_lab_subject(&mixed_coder, blocks[b], c->counts, NULL);
            fill_mixed(&x, c, numbers[n], r);
            f(&x, r);
            coder_lab_release(&x);
        }
}

static bool has(const uint16_t *row, uint32_t count, uint32_t node) {
    for (uint32_t k = 0; k < count; k++)
        if (row[k] == node)
            return true;
    return false;
}

/* Rows of ten: quadratic tets that share nodes with the row before, and hexahedra with their first
 * corner twice more. */
static void visit_tens(uint32_t count, visit *f, field_random *r) {
    uint16_t(*rows)[CELL_ROW] = calloc(count, sizeof *rows);
    uint32_t counts[4] = {count, 0, 0, 0};
    assert_non_null(rows);
    for (uint32_t i = 0; i < count; i++) {
        const bool tet = i == 0 || field_random_below(r, 2) == 0;
        counts[2] += tet;
        for (uint32_t q = 0; q < CELL_ROW; q++) {
            const uint32_t met = counts[1], back = (uint32_t)field_random_below(r, 30);
            uint32_t node = met;
            if (!tet && q >= HEX_CORNERS)
                node = rows[i][0];
            else if (!tet && met > back && field_random_below(r, 2) == 0)
                node = met - 1 - back;
            else if (tet && i > 0 && q < 5 && !has(rows[i], q, rows[i - 1][q]))
                node = rows[i - 1][q];
            rows[i][q] = (uint16_t)node;
            counts[1] += node == met;
        }
    }
    for (size_t b = 0; b < 3; b++)
        for (size_t n = 0; n < 2; n++) {
            coder_subject x = coder_lab_subject(&mixed_coder, blocks[b], counts, NULL);
            const mixed_shape s = mixed_shape_of(counts);
            const bool values = blocks[b] == LEAF_BLOCK_VALUES;
            fill((float *)(void *)x.payload, s.nodes * (values ? 1U : 3U), numbers[n], r);
            if (!values)
                fill_codes(x.payload + s.codes_at, s.cells, r);
            if (blocks[b] == LEAF_BLOCK_TOPOLOGY)
                memcpy(x.payload + s.rows_at, rows, count * sizeof *rows);
            f(&x, r);
            coder_lab_release(&x);
        }
    free(rows);
}

static void visit_mixed(visit *f, field_random *r) {
    cells *c = malloc(sizeof *c);
    assert_non_null(c);
    for (uint32_t side = 1; side <= 9; side += 4) {
        make_lattice(c, side, false);
        visit_cells(c, f, r);
        make_lattice(c, side, true);
        visit_cells(c, f, r);
    }
    for (uint32_t count = 1; count <= 1024; count = 4 * count + 3) {
        make_random(c, count, r);
        visit_cells(c, f, r);
    }
    free(c);
    visit_tens(1, f, r);
    visit_tens(16, f, r);
    visit_tens(500, f, r);
}

/* ---- surfaces ---- */

/* Rows of triangles in their order. Sets counts[1]. */
typedef struct surface {
    uint32_t counts[4];
    uint16_t corner[TRIANGLES_MAX * TRIANGLE_CORNERS];
} surface;

/* Corners of random vertices, many of them again: near, and far behind. */
static void make_soup(surface *s, uint32_t count, field_random *r) {
    *s = (surface){.counts = {count}};
    for (uint32_t i = 0; i < TRIANGLE_CORNERS * count; i++) {
        const uint32_t met = s->counts[1];
        const long how = field_random_below(r, 4);
        uint32_t v = met;
        if (met > 4 && how == 1) /* one of them all */
            v = (uint32_t)field_random_below(r, met);
        else if (met > 4 && how >= 2) /* one of the latest */
            v = met - 1 - (uint32_t)field_random_below(r, met < 40 ? met : 40);
        s->counts[1] += v == met;
        s->corner[i] = (uint16_t)v;
    }
}

static void fill_surface(coder_subject *x, const surface *s, number *of, field_random *r) {
    const triangle_shape shape = triangle_shape_of(x->counts);
    fill((float *)(void *)x->payload, shape.vertices * (x->block == LEAF_BLOCK_VALUES ? 1U : 3U),
         of, r);
    uint32_t *normals = (uint32_t *)(void *)(x->payload + shape.vertices * sizeof(float[3]));
    for (uint32_t i = 0; i < shape.normals && x->block != LEAF_BLOCK_VALUES; i++)
        normals[i] = field_random_below(r, 3) ? (uint32_t)field_random_bits(r) : 0x80008000;
    if (x->block == LEAF_BLOCK_TOPOLOGY)
        memcpy(x->payload + shape.place_bytes, s->corner, triangle_rows_bytes(&shape));
}

/* With and without normals. */
static void visit_surface(surface *s, visit *f, field_random *r) {
    for (size_t b = 0; b < 3; b++)
        for (size_t n = 0; n < 3; n++) {
            s->counts[2] = n ? s->counts[1] : 0;
            coder_subject x = coder_lab_subject(&triangle_coder, blocks[b], s->counts, NULL);
            fill_surface(&x, s, numbers[n % 2], r);
            f(&x, r);
            coder_lab_release(&x);
        }
    s->counts[2] = 0;
}

static void visit_surfaces(visit *f, field_random *r) {
    surface *s = malloc(sizeof *s);
    assert_non_null(s);
    for (uint32_t count = 1; count <= 1500; count = 4 * count + 3) {
        make_soup(s, count, r);
        if (s->counts[1] >= TRIANGLE_CORNERS)
            visit_surface(s, f, r);
    }
    free(s);
}

static void visit_all(visit *f, uint64_t seed) {
    field_random r = {seed};
    visit_curvilinear(f, &r);
    visit_mixed(f, &r);
    visit_surfaces(f, &r);
}

/* ---- tests ---- */

static void check_sound(coder_subject *x, field_random *r) {
    (void)r;
    check_round(x, 1);
}

static void test_payloads_come_back(void **state) {
    (void)state;
    visit_all(check_sound, 1);
}

/* The largest treelet there is, of cells that share nothing: every node is new, and 16 bits just
 * hold its number. */
static void test_all_nodes_are_new(void **state) {
    (void)state;
    field_random r = {2};
    cells *c = calloc(1, sizeof *c);
    assert_non_null(c);
    c->counts[0] = MIXED_CELLS_MAX;
    c->counts[1] = MIXED_CELLS_MAX * HEX_CORNERS;
    for (uint32_t i = 0; i < c->counts[1]; i++)
        c->corner[i / HEX_CORNERS][i % HEX_CORNERS] = (uint16_t)i;
    visit_cells(c, check_sound, &r);
    /* The last cell has the very first node, too, which a word of 16 bits just reaches. */
    uint16_t *last = c->corner[MIXED_CELLS_MAX - 1];
    last[7] = last[6];
    last[6] = 0;
    c->counts[1]--;
    visit_cells(c, check_sound, &r);
    free(c);
}

/* Likewise of triangles that share nothing. */
static void test_all_vertices_are_new(void **state) {
    (void)state;
    field_random r = {6};
    surface *s = calloc(1, sizeof *s);
    assert_non_null(s);
    s->counts[0] = TRIANGLES_MAX;
    s->counts[1] = TRIANGLE_CORNERS * TRIANGLES_MAX;
    for (uint32_t i = 0; i < s->counts[1]; i++)
        s->corner[i] = (uint16_t)i;
    visit_surface(s, check_sound, &r);
    /* The last triangle has the very first vertex, too, and one at 255 corners before, and one at
     * 254. */
    uint16_t *last = s->corner + TRIANGLE_CORNERS * (TRIANGLES_MAX - 1);
    last[0] = 0;
    last[1] = (uint16_t)(s->counts[1] - 3 + 1 - 255);
    last[2] = (uint16_t)(s->counts[1] - 3 + 2 - 254);
    s->counts[1] -= 3;
    visit_surface(s, check_sound, &r);
    coder_subject x = coder_lab_subject(&triangle_coder, LEAF_BLOCK_TOPOLOGY, s->counts, NULL);
    fill_surface(&x, s, smooth, &r);
    coder_lab_encode(&x);
    const uint8_t *codes = x.streams.bytes + x.streams.end[1] - 3;
    assert_int_equal(codes[0], 255);
    assert_int_equal(codes[1], 255);
    assert_int_equal(codes[2], 254);
    coder_lab_release(&x);
    free(s);
}

static size_t content_end(const coder_subject *x) {
    const bool values = x->block == LEAF_BLOCK_VALUES;
    if (x->coder == &triangle_coder) {
        const triangle_shape s = triangle_shape_of(x->counts);
        return values                            ? 4 * (size_t)s.vertices
               : x->block != LEAF_BLOCK_TOPOLOGY ? triangle_place_bytes(&s)
                                                 : s.place_bytes + triangle_rows_bytes(&s);
    }
    if (x->coder == &curvilinear_coder) {
        const size_t nodes = curvilinear_nodes(x->counts);
        return values ? 4 * nodes : 12 * nodes + (curvilinear_cells(x->counts) + 3) / 4;
    }
    const mixed_shape s = mixed_shape_of(x->counts);
    return values                            ? 4 * (size_t)s.nodes
           : x->block != LEAF_BLOCK_TOPOLOGY ? s.codes_at + (s.cells + 3) / 4
                                             : s.rows_at + mixed_rows_bytes(&s);
}

/* Vertices out of order, in the first corner, in the last one, in all. */
static void check_stored_rows(coder_subject *x, field_random *r) {
    const triangle_shape s = triangle_shape_of(x->counts);
    const long corners = TRIANGLE_CORNERS * (long)s.triangles;
    uint16_t *corner = (uint16_t *)(void *)(x->payload + s.place_bytes);
    const uint16_t first = corner[0], last = corner[corners - 1];
    corner[0] = 1;
    check_round(x, 0);
    corner[0] = first;
    corner[corners - 1] = (uint16_t)(s.vertices + 1);
    check_round(x, 0);
    corner[corners - 1] = last;
    for (long i = 0; i < corners; i++)
        corner[i] = (uint16_t)field_random_bits(r);
    corner[field_random_below(r, corners)] = UINT16_MAX;
    check_round(x, 0);
    for (long i = 0; i < corners; i++)
        corner[i] = 0;
    corner[corners - 1] = 2; /* and 1 never */
    check_round(x, 0);
}

/* What cannot be made again is stored: padding with something in it, nodes out of order. */
static void check_stored(coder_subject *x, field_random *r) {
    if (content_end(x) < x->bytes) {
        x->payload[x->bytes - 1] = 1;
        check_round(x, 0);
        x->payload[x->bytes - 1] = 0;
    }
    if (x->coder == &triangle_coder && x->block == LEAF_BLOCK_TOPOLOGY)
        check_stored_rows(x, r);
    if (x->coder != &mixed_coder || x->block != LEAF_BLOCK_TOPOLOGY)
        return;
    const mixed_shape s = mixed_shape_of(x->counts);
    uint16_t *corner = (uint16_t *)(void *)(x->payload + s.rows_at);
    const uint16_t second = corner[1];
    corner[0] = 1;
    check_round(x, 0);
    corner[1] = 0;
    check_round(x, 0);
    corner[0] = 0;
    corner[1] = second;
    corner[s.width * s.cells - 1] = (uint16_t)s.nodes;
    check_round(x, 0);
    for (uint32_t i = 0; i < s.width * s.cells; i++)
        corner[i] = (uint16_t)field_random_bits(r);
    corner[field_random_below(r, (long)s.width * (long)s.cells)] = UINT16_MAX;
    check_round(x, 0);
}

static void test_odd_payloads_are_stored(void **state) {
    static const uint16_t late[HEX_CORNERS] = {1, 0, 1, 2, 3, 4, 5, 6};
    (void)state;
    visit_all(check_stored, 3);
    coder_subject x =
        coder_lab_subject(&mixed_coder, LEAF_BLOCK_TOPOLOGY, (const uint32_t[4]){1, 7}, NULL);
    memcpy(x.payload + mixed_shape_of(x.counts).rows_at, late, sizeof late);
    check_round(&x, 0);
    coder_lab_release(&x);
    /* A row of ten that is neither a tet's nor a hexahedron's: its last node comes twice. */
    x = coder_lab_subject(&mixed_coder, LEAF_BLOCK_TOPOLOGY, (const uint32_t[4]){16, 154, 15},
                          NULL);
    uint16_t *row = (uint16_t *)(void *)(x.payload + mixed_shape_of(x.counts).rows_at);
    for (uint16_t i = 0; i < 16 * CELL_ROW; i++)
        row[i] = i < 152 ? i : (uint16_t)(i < 156 ? 151 : i < 158 ? 152 : 153);
    check_round(&x, 0);
    coder_lab_release(&x);
}

/* Cut, lengthened, with other first bytes; with bytes changed: refused by both, or taken alike. */
static void check_lies(coder_subject *x, field_random *r) {
    coder_lab_encode(x);
    const size_t used = x->streams.used;
    uint8_t *in = malloc(used + 2);
    assert_non_null(in);
    memcpy(in, x->streams.bytes, used);
    in[used] = in[used + 1] = 0;
    for (size_t size = 0; size < used; size += 1 + used / 40)
        assert_false(check_both(x, in, size));
    assert_false(check_both(x, in, used + 1));
    for (int first = 2; first < 256; first += 23) {
        in[0] = (uint8_t)first;
        assert_false(check_both(x, in, used));
    }
    in[0] = 0; /* the payload as it is: there are more bytes, or fewer, or by chance as many */
    (void)check_both(x, in, used);
    for (int i = 0; i < LIES; i++) {
        memcpy(in, x->streams.bytes, used);
        for (int k = 0; k < 3; k++)
            in[1 + field_random_below(r, (long)used - 1)] = (uint8_t)field_random_bits(r);
        (void)check_both(x, in, used);
    }
    free(in);
}

static void test_lies(void **state) {
    (void)state;
    visit_all(check_lies, 4);
}

/* Each code of a corner, where it may stand and where not. */
static void test_codes_of_corners(void **state) {
    (void)state;
    field_random r = {5};
    cells *c = malloc(sizeof *c);
    assert_non_null(c);
    make_random(c, 100, &r);
    coder_subject x = coder_lab_subject(&mixed_coder, LEAF_BLOCK_TOPOLOGY, c->counts, NULL);
    fill_mixed(&x, c, smooth, &r);
    coder_lab_encode(&x);
    uint8_t *codes = x.streams.bytes + 1 + 25;
    int seen[5] = {0}, refused = 0;
    for (size_t i = 0; i < 800; i++)
        seen[codes[i] == MIXED_NEW      ? 0
             : codes[i] < MIXED_OWN     ? 1
             : codes[i] < MIXED_EARLIER ? 2
             : codes[i] < MIXED_FAR     ? 3
                                        : 4]++;
    for (int i = 0; i < 5; i++)
        assert_true(seen[i] > 0);
    for (size_t i = 0; i < 800; i += 7) {
        const uint8_t was = codes[i];
        for (int code = 0; code < 256; code++) {
            codes[i] = (uint8_t)code;
            refused += !check_both(&x, x.streams.bytes, x.streams.used);
        }
        codes[i] = was;
    }
    assert_true(refused > 100);
    coder_lab_release(&x);
    free(c);
}

/* Each code of a triangle's corner. */
static void test_codes_of_triangles(void **state) {
    (void)state;
    field_random r = {7};
    surface *s = malloc(sizeof *s);
    assert_non_null(s);
    make_soup(s, 300, &r);
    coder_subject x = coder_lab_subject(&triangle_coder, LEAF_BLOCK_TOPOLOGY, s->counts, NULL);
    fill_surface(&x, s, smooth, &r);
    coder_lab_encode(&x);
    uint8_t *codes = x.streams.bytes + 1;
    int seen[3] = {0}, refused = 0;
    for (size_t i = 0; i < 900; i++)
        seen[codes[i] == 0 ? 0 : codes[i] < 255 ? 1 : 2]++;
    for (int i = 0; i < 3; i++)
        assert_true(seen[i] > 0);
    for (size_t i = 0; i < 900; i += 7) {
        const uint8_t was = codes[i];
        for (int code = 0; code < 256; code++) {
            codes[i] = (uint8_t)code;
            refused += !check_both(&x, x.streams.bytes, x.streams.used);
        }
        codes[i] = was;
    }
    assert_true(refused > 100);
    /* The first word: up to the first vertex, and before it. */
    uint8_t *low = x.streams.bytes + x.streams.end[5];
    refused = 0;
    for (int word = 0; word < 256; word++) {
        *low = (uint8_t)word;
        refused += !check_both(&x, x.streams.bytes, x.streams.used);
    }
    assert_in_range(refused, 1, 255);
    coder_lab_release(&x);
    free(s);
}

/* Close nodes make small differences: a straight lattice has none but rounding. */
static void test_a_lattice_is_predicted(void **state) {
    (void)state;
    const uint32_t counts[4] = {16, 16, 16};
    coder_subject x = coder_lab_subject(&curvilinear_coder, LEAF_BLOCK_VALUES, counts, NULL);
    float *f = (float *)(void *)x.payload;
    for (uint32_t i = 0; i < 17 * 17 * 17; i++)
        f[i] = (float)(8 + i % 17 + 3 * (i / 17 % 17) + 5 * (i / 289) + (i % 17) * (i / 17 % 17));
    check_round(&x, 1);
    const uint8_t *plane = x.streams.bytes + 1;
    int odd = 0;
    for (size_t i = 0; i < 4913; i++)
        odd += plane[i] || plane[4913 + i] || plane[2 * 4913 + i] || plane[3 * 4913 + i];
    /* Whole numbers, with a product of i and j: but for the three axes, and the face on which two
     * neighbours are all that says so, all are exact. */
    assert_int_equal(odd, 1 + 3 * 16 + 16 * 16);
    coder_lab_release(&x);
}

/* Every kind that has a coder is tested here, or in test_mesh_coder.c. */
static void test_every_coder(void **state) {
    (void)state;
    int coders = 0;
    for (uint32_t kind = 0; kind < 16; kind++) {
        const leaf_geometry *g = leaf_geometry_of(kind);
        if (!g || !g->coder)
            continue;
        coders++;
        assert_true(g->coder == &mesh_coder || g->coder == &curvilinear_coder ||
                    g->coder == &mixed_coder || g->coder == &triangle_coder);
    }
    assert_int_equal(coders, 4);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_payloads_come_back),
        cmocka_unit_test(test_all_nodes_are_new),
        cmocka_unit_test(test_odd_payloads_are_stored),
        cmocka_unit_test(test_lies),
        cmocka_unit_test(test_all_vertices_are_new),
        cmocka_unit_test(test_codes_of_corners),
        cmocka_unit_test(test_codes_of_triangles),
        cmocka_unit_test(test_a_lattice_is_predicted),
        cmocka_unit_test(test_every_coder),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
