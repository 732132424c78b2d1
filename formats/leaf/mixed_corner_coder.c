/* The streams:
 *
 *   0      u8 code[cells][8], or [10]
 *   1 - 4  u8 plane[4][3][nodes]       coordinates, by axis, node after node
 *   5, 6   u8 low[words], high[words]
 */
#include "formats/leaf/mixed_corner_coder.h"

#include <string.h>

#include "formats/base/quadratic_tet.h"
#include "formats/leaf/coded_payload.h"
#include "formats/leaf/float_lattice.h"
#include "formats/leaf/float_planes.h"

enum { AXES = 3, NOWHERE = 0xFFFF };

size_t mixed_corners_room(const mixed_shape *s) {
    const size_t corners = (size_t)s->cells * s->width;
    return corners * (1 + sizeof(uint16_t)) + (size_t)s->nodes * sizeof(float[AXES]);
}

/* ---- edges ---- */

typedef struct edges {
    uint16_t end[AXES][MIXED_EDGES];
} edges;

static void edges_init(edges *e) {
    memset(e, 0xff, sizeof *e);
}

static inline uint32_t edges_end(const edges *e, uint32_t axis, uint32_t node) {
    return e->end[axis][node & (MIXED_EDGES - 1)];
}

static void edges_add(edges *e, const uint16_t cell[HEX_CORNERS]) {
    for (uint32_t c = 0; c < HEX_CORNERS; c++)
        for (uint32_t a = 0; a < AXES; a++) {
            const uint16_t from = cell[c & ~(1U << a)];
            if (from != cell[c])
                e->end[a][from & (MIXED_EDGES - 1)] = cell[c];
        }
}

/* ---- coordinates ---- */

/* What predicts a new node, in the order of float_lattice_predict3(), or predict2(). */
typedef struct guess {
    uint32_t count; /* 7, 3, 2, 1; 0: nothing does */
    uint32_t node[HEX_CORNERS - 1];
} guess;

static void guess_take(guess *g, const uint16_t cell[HEX_CORNERS], uint32_t corner,
                       const uint8_t *across, uint32_t count) {
    g->count = count;
    for (uint32_t i = 0; i < count; i++)
        g->node[i] = cell[corner ^ across[i]];
}

/* In a quadratic tet, whose row is told: the corner before predicts a corner, those of its edge, in
 * the middle between them, an edge's node. */
static guess guess_in_quadratic(const uint16_t *cell, uint32_t k, uint32_t told) {
    guess g = {.count = told ? 1 : 0, .node = {told - 1}};
    if (k >= QUADRATIC_CORNERS) {
        const int *edge = quadratic_edge((int)k - QUADRATIC_CORNERS);
        g.count = 2;
        for (int i = 0; i < 2; i++)
            g.node[i] = cell[edge[i]];
    } else if (k > 0) {
        g.node[0] = cell[k - 1];
    }
    return g;
}

/* Say what predicts the node of a corner: all others, as in a lattice; else three of a face, as a
 * parallelogram; else the nearest one; else the node before. told: nodes that are there. */
static guess guess_from(const uint16_t cell[HEX_CORNERS], uint32_t corner, uint32_t told) {
    static const uint8_t all[HEX_CORNERS - 1] = {1, 2, 4, 3, 5, 6, 7};
    static const uint8_t faces[AXES][3] = {{1, 2, 3}, {1, 4, 5}, {2, 4, 6}};
    guess g = {.count = told ? 1 : 0, .node = {told - 1}};
    uint32_t there = 0;
    for (uint32_t d = 1; d < HEX_CORNERS; d++)
        there |= (uint32_t)(cell[corner ^ d] < told) << d;
    if (there == 0xFE) {
        guess_take(&g, cell, corner, all, HEX_CORNERS - 1);
        return g;
    }
    for (int f = 0; f < AXES; f++)
        if (there >> faces[f][0] & there >> faces[f][1] & there >> faces[f][2] & 1) {
            guess_take(&g, cell, corner, faces[f], 3);
            return g;
        }
    for (int i = 0; i < HEX_CORNERS - 1; i++)
        if (there >> all[i] & 1) {
            guess_take(&g, cell, corner, &all[i], 1);
            return g;
        }
    return g;
}

static uint32_t predict(const guess *g, const float *x) {
    const uint32_t *n = g->node;
    float p = 0.0F;
    if (g->count == 7)
        p = float_lattice_predict3(x[n[0]], x[n[1]], x[n[2]], x[n[3]], x[n[4]], x[n[5]], x[n[6]]);
    else if (g->count == 3)
        p = float_lattice_predict2(x[n[0]], x[n[1]], x[n[2]]);
    else if (g->count == 2)
        p = 0.5F * (x[n[0]] + x[n[1]]);
    else if (g->count == 1)
        p = x[n[0]];
    return float_planes_predicted(p);
}

/* ---- encoding ---- */

typedef struct encoder {
    const uint16_t *corner; /* of all cells, row after row */
    uint32_t told, words;
    uint16_t *word;
    edges ends;
} encoder;

/* Corner c of the cell at corner[first]. */
static uint8_t code_of(encoder *e, size_t first, uint32_t c) {
    const uint16_t *cell = e->corner + first;
    const uint16_t node = cell[c];
    if (node == e->told) {
        e->told++;
        return MIXED_NEW;
    }
    for (uint32_t i = 0; i < c && i < MIXED_EARLIER - MIXED_OWN; i++)
        if (cell[i] == node)
            return (uint8_t)(MIXED_OWN + i);
    for (uint32_t a = 0; a < AXES; a++)
        if (c >> a & 1 && edges_end(&e->ends, a, cell[c ^ 1U << a]) == node && node != NOWHERE)
            return (uint8_t)(MIXED_EDGE + a);
    const size_t last = first < MIXED_LAST ? first : MIXED_LAST;
    for (size_t i = 0; i < last; i++)
        if (e->corner[first - 1 - i] == node)
            return (uint8_t)(MIXED_EARLIER + i);
    e->word[e->words++] = (uint16_t)(e->told - node - 1);
    return MIXED_FAR;
}

/* Whether a row is one: of ten, that of a quadratic tet, or a hexahedron's with its first corner
 * twice more. Nodes are new at corners of hexahedra alone, then. */
static bool is_row(const mixed_shape *s, const uint16_t *row) {
    return s->width < CELL_ROW || row[CELL_ROW - 2] != row[CELL_ROW - 1] ||
           row[CELL_ROW - 1] == row[0];
}

static bool are_in_order(const mixed_shape *s, const uint16_t *corner) {
    uint32_t told = 0;
    for (size_t i = 0; i < (size_t)s->cells * s->width; i++) {
        if (corner[i] > told)
            return false;
        told += corner[i] == told;
    }
    for (uint32_t i = 0; i < s->cells; i++)
        if (!is_row(s, corner + (size_t)s->width * i))
            return false;
    return told == s->nodes;
}

static void encode_codes(const mixed_shape *s, encoder *e, uint8_t *code) {
    edges_init(&e->ends);
    for (uint32_t i = 0; i < s->cells; i++) {
        const size_t first = (size_t)i * s->width;
        for (uint32_t c = 0; c < s->width; c++)
            code[first + c] = code_of(e, first, c);
        edges_add(&e->ends, e->corner + first);
    }
}

/* Call take() for each node in turn, with what predicts it. */
static inline void walk_nodes(const mixed_shape *s, const uint16_t *rows,
                              void (*take)(void *ctx, uint32_t node, const guess *g), void *ctx) {
    for (uint32_t i = 0, told = 0; i < s->cells && told < s->nodes; i++) {
        const uint16_t *row = rows + (size_t)s->width * i;
        const bool quadratic = s->width == CELL_ROW && row[CELL_ROW - 2] != row[CELL_ROW - 1];
        for (uint32_t c = 0; c < s->width; c++)
            if (row[c] == told) {
                const guess g =
                    quadratic ? guess_in_quadratic(row, c, told) : guess_from(row, c, told);
                take(ctx, told++, &g);
            }
    }
}

typedef struct coordinates {
    const mixed_shape *s;
    const float *of[AXES];
    uint8_t *put;       /* planes */
    const uint8_t *get; /* or these, for: */
    float *to[AXES];    /* the same as `of` */
} coordinates;

static inline void put_node(void *ctx, uint32_t node, const guess *g) {
    const coordinates *x = ctx;
    const size_t nodes = x->s->nodes;
    for (size_t a = 0; a < AXES; a++) {
        uint32_t bits;
        memcpy(&bits, &x->of[a][node], sizeof bits);
        float_planes_put(x->put + a * nodes + node, AXES * nodes, bits, predict(g, x->of[a]));
    }
}

static inline void get_node(void *ctx, uint32_t node, const guess *g) {
    const coordinates *x = ctx;
    const size_t nodes = x->s->nodes;
    for (size_t a = 0; a < AXES; a++) {
        const uint32_t bits =
            float_planes_get(x->get + a * nodes + node, AXES * nodes, predict(g, x->of[a]));
        memcpy(&x->to[a][node], &bits, sizeof bits);
    }
}

static coordinates coordinates_of(const mixed_shape *s, const void *topology) {
    coordinates x = {.s = s};
    for (int a = 0; a < AXES; a++)
        x.of[a] = mixed_coordinates(s, topology, a);
    return x;
}

bool mixed_corners_encode(const mixed_shape *s, const void *topology, void *scratch,
                          coded_streams *out) {
    const uint16_t *rows = mixed_rows(s, topology);
    encoder e = {.corner = rows, .word = scratch};
    if (!are_in_order(s, rows))
        return false;
    encode_codes(s, &e, coded_streams_take(out, (size_t)s->cells * s->width));
    coded_streams_end(out);
    coordinates x = coordinates_of(s, topology);
    x.put = coded_streams_take(out, (size_t)s->nodes * sizeof(float[AXES]));
    walk_nodes(s, rows, put_node, &x);
    coded_payload_end_planes(out, FLOAT_PLANES, (size_t)s->nodes * AXES);
    uint8_t *low = coded_streams_take(out, e.words);
    coded_streams_end(out);
    uint8_t *high = coded_streams_take(out, e.words);
    coded_streams_end(out);
    for (uint32_t i = 0; i < e.words; i++) {
        low[i] = (uint8_t)e.word[i];
        high[i] = (uint8_t)(e.word[i] >> 8);
    }
    return true;
}

/* ---- decoding ---- */

typedef struct decoder {
    const mixed_shape *s;
    uint16_t *corner;
    uint32_t told;
    const uint8_t *low, *high;
    size_t words; /* that are left */
    edges ends;
} decoder;

/* The node of a corner; the treelet's count of nodes, or more: it is malformed. */
static uint32_t node_of(decoder *d, uint8_t code, size_t first, uint32_t c) {
    const uint16_t *cell = d->corner + first;
    if (code == MIXED_NEW)
        return d->told++;
    if (code < MIXED_OWN) {
        const uint32_t a = code - MIXED_EDGE;
        if (!(c >> a & 1))
            return UINT32_MAX;
        const uint32_t end = edges_end(&d->ends, a, cell[c ^ 1U << a]);
        return end < d->told ? end : UINT32_MAX;
    }
    if (code < MIXED_EARLIER)
        return code - MIXED_OWN < (int)c ? cell[code - MIXED_OWN] : UINT32_MAX;
    if (code < MIXED_FAR) {
        const size_t back = code - MIXED_EARLIER + 1U;
        return back <= first ? d->corner[first - back] : UINT32_MAX;
    }
    if (!d->words)
        return UINT32_MAX;
    d->words--;
    return d->told - 1 - (uint32_t)(*d->low++ | *d->high++ << 8);
}

static bool decode_codes(decoder *d, const uint8_t *code) {
    edges_init(&d->ends);
    for (uint32_t i = 0; i < d->s->cells; i++) {
        const size_t first = (size_t)i * d->s->width;
        for (uint32_t c = 0; c < d->s->width; c++) {
            const uint32_t node = node_of(d, code[first + c], first, c);
            if (node >= d->s->nodes)
                return false;
            d->corner[first + c] = (uint16_t)node;
        }
        if (!is_row(d->s, d->corner + first))
            return false;
        edges_add(&d->ends, d->corner + first);
    }
    return d->told == d->s->nodes && !d->words;
}

bool mixed_corners_decode(const mixed_shape *s, coded_input *in, void *topology) {
    const size_t corners = (size_t)s->cells * s->width;
    decoder d = {.s = s, .corner = (uint16_t *)((char *)topology + s->rows_at)};
    coordinates x = coordinates_of(s, topology);
    const uint8_t *code = coded_input_take(in, corners);
    x.get = code ? coded_input_take(in, (size_t)s->nodes * sizeof(float[AXES])) : NULL;
    if (!x.get || in->left % 2)
        return false;
    for (int a = 0; a < AXES; a++)
        x.to[a] = (float *)topology + (size_t)a * s->nodes;
    d.words = in->left / 2;
    d.low = coded_input_take(in, d.words);
    d.high = coded_input_take(in, d.words);
    if (!decode_codes(&d, code))
        return false;
    walk_nodes(s, mixed_rows(s, topology), get_node, &x);
    return true;
}
