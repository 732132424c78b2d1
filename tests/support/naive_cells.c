#include "tests/support/naive_cells.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

/* ---- floats ---- */

static uint32_t bits_of(float x) {
    uint32_t bits;
    memcpy(&bits, &x, sizeof bits);
    return bits;
}

static int64_t rank_of(uint32_t bits) {
    return bits >> 31 ? (int64_t)UINT32_MAX - bits : (int64_t)bits + ((int64_t)1 << 31);
}

static uint32_t bits_at(int64_t rank) {
    return rank >= (int64_t)1 << 31 ? (uint32_t)(rank - ((int64_t)1 << 31))
                                    : (uint32_t)((int64_t)UINT32_MAX - rank);
}

/* The bits of element n of planes that are `stride` bytes apart, predicted by these. */
static uint32_t decode_bits(const unsigned char *planes, size_t stride, size_t n,
                            uint32_t predicted) {
    int64_t folded = 0;
    for (size_t b = 0; b < 4; b++)
        folded += (int64_t)planes[b * stride + n] << 8 * b;
    const int64_t difference = folded % 2 ? -(folded + 1) / 2 : folded / 2;
    const int64_t rank = rank_of(predicted) + difference;
    return bits_at(((rank % ((int64_t)1 << 32)) + ((int64_t)1 << 32)) % ((int64_t)1 << 32));
}

static void write_bits(unsigned char *payload, size_t index, uint32_t bits) {
    memcpy(payload + index * sizeof bits, &bits, sizeof bits);
}

/* Float n, which p predicts. */
static void decode(const unsigned char *planes, size_t stride, size_t n, float p,
                   unsigned char *payload) {
    write_bits(payload, n, decode_bits(planes, stride, n, bits_of(p != p ? 0.0f : p)));
}

static float read_float(const unsigned char *payload, size_t index) {
    float x;
    memcpy(&x, payload + index * sizeof x, sizeof x);
    return x;
}

/* The compiler must not keep more digits, nor join operations. */
static float add(float a, float b) {
    volatile float sum = a + b;
    return sum;
}

static float less(float a, float b) {
    volatile float difference = a - b;
    return difference;
}

static float seven(float i, float j, float ij, float k, float ik, float jk, float ijk) {
    return add(i, add(less(j, ij), less(less(k, ik), less(jk, ijk))));
}

/* Take the payload that follows a 0. */
static bool take_stored(const unsigned char *in, size_t bytes, unsigned char *payload,
                        size_t payload_bytes) {
    if (bytes != payload_bytes + 1)
        return false;
    memcpy(payload, in + 1, payload_bytes);
    return true;
}

/* ---- curvilinear grids ---- */

typedef struct lattice {
    const unsigned char *payload;
    size_t first; /* float of the axis */
    size_t n[3];
} lattice;

static float at(const lattice *l, long i, long j, long k) {
    if (i < 0 || j < 0 || k < 0)
        return 0.0f;
    return read_float(l->payload,
                      l->first + (size_t)i + l->n[0] * ((size_t)j + l->n[1] * (size_t)k));
}

bool naive_cells_curvilinear(bool places, const uint32_t counts[4], const unsigned char *in,
                             size_t bytes, unsigned char *payload, size_t payload_bytes) {
    const size_t n[3] = {counts[0] + 1U, counts[1] + 1U, counts[2] + 1U},
                 nodes = n[0] * n[1] * n[2];
    const size_t cells = (size_t)counts[0] * counts[1] * counts[2];
    const size_t codes = places ? (cells + 3) / 4 : 0, axes = places ? 3 : 1;
    if (bytes && in[0] == 0)
        return take_stored(in, bytes, payload, payload_bytes);
    if (!bytes || in[0] != 1 || bytes != 1 + codes + 4 * axes * nodes)
        return false;
    memset(payload, 0, payload_bytes);
    memcpy(payload + 4 * axes * nodes, in + 1, codes);
    const unsigned char *planes = in + 1 + codes;
    for (size_t a = 0; a < axes; a++) {
        lattice l = {.payload = payload, .first = a * nodes};
        memcpy(l.n, n, sizeof l.n);
        size_t node = a * nodes;
        for (long k = 0; k < (long)n[2]; k++)
            for (long j = 0; j < (long)n[1]; j++)
                for (long i = 0; i < (long)n[0]; i++, node++) {
                    const float p =
                        seven(at(&l, i - 1, j, k), at(&l, i, j - 1, k), at(&l, i - 1, j - 1, k),
                              at(&l, i, j, k - 1), at(&l, i - 1, j, k - 1), at(&l, i, j - 1, k - 1),
                              at(&l, i - 1, j - 1, k - 1));
                    decode(planes, axes * nodes, node, p, payload);
                }
    }
    return true;
}

/* ---- mixed meshes ---- */

enum { CORNERS = 8, ROW = 10, PLACES = 4096 };

static size_t aligned(size_t bytes) {
    return (bytes + 63) / 64 * 64;
}

static bool decode_row(const unsigned char *planes, size_t count, unsigned char *payload) {
    uint32_t before = 0;
    for (size_t i = 0; i < count; i++) {
        before = decode_bits(planes, count, i, before);
        write_bits(payload, i, before);
    }
    return true;
}

typedef struct mesh {
    size_t cells, nodes, width;
    uint32_t (*row)[ROW];
} mesh;

static bool decode_corners(const mesh *m, const unsigned char *code, const unsigned char *words,
                           size_t count) {
    uint32_t end[3][PLACES];
    uint32_t told = 0;
    size_t taken = 0;
    memset(end, 0, sizeof end);
    for (int a = 0; a < 3; a++)
        for (int i = 0; i < PLACES; i++)
            end[a][i] = 65535;
    for (size_t c = 0; c < m->cells; c++) {
        uint32_t *cell = m->row[c];
        for (size_t q = 0; q < m->width; q++) {
            const unsigned k = code[c * m->width + q];
            int64_t node;
            if (k == 0) {
                node = told++;
            } else if (k <= 3) {
                if (!(q >> (k - 1) & 1))
                    return false;
                node = end[k - 1][cell[q - ((size_t)1 << (k - 1))] % PLACES];
            } else if (k <= 10) {
                if (k - 4 >= q)
                    return false;
                node = cell[k - 4];
            } else if (k <= 254) {
                const size_t back = k - 10;
                if (back > c * m->width)
                    return false;
                node = m->row[(c * m->width - back) / m->width][(c * m->width - back) % m->width];
            } else {
                if (taken == count)
                    return false;
                node = (int64_t)told - 1 - (words[taken] + 256 * words[count + taken]);
                taken++;
            }
            if (node < 0 || node >= told || node >= (int64_t)m->nodes)
                return false;
            cell[q] = (uint32_t)node;
        }
        if (m->width == ROW && cell[8] == cell[9] && cell[9] != cell[0])
            return false;
        for (size_t q = 0; q < CORNERS; q++)
            for (size_t a = 0; a < 3; a++)
                if (q >> a & 1 && cell[q] != cell[q - ((size_t)1 << a)])
                    end[a][cell[q - ((size_t)1 << a)] % PLACES] = cell[q];
    }
    return told == m->nodes && taken == count;
}

static float predict_in_tet(const uint32_t cell[ROW], size_t q, uint32_t told,
                            const unsigned char *payload, size_t first) {
    static const size_t edges[6][2] = {{0, 1}, {1, 2}, {0, 2}, {0, 3}, {1, 3}, {2, 3}};
    if (q >= 4) {
        const float a = read_float(payload, first + cell[edges[q - 4][0]]),
                    b = read_float(payload, first + cell[edges[q - 4][1]]);
        return 0.5f * add(a, b);
    }
    if (q > 0)
        return read_float(payload, first + cell[q - 1]);
    return told ? read_float(payload, first + told - 1) : 0.0f;
}

static float predict(const uint32_t cell[ROW], size_t q, uint32_t told,
                     const unsigned char *payload, size_t first) {
    static const size_t faces[3][3] = {{1, 2, 3}, {1, 4, 5}, {2, 4, 6}},
                        one[7] = {1, 2, 4, 3, 5, 6, 7};
    float f[CORNERS] = {0};
    bool there[CORNERS] = {0};
    int count = 0;
    for (size_t d = 1; d < CORNERS; d++) {
        there[d] = cell[q ^ d] < told;
        count += there[d];
        f[d] = there[d] ? read_float(payload, first + cell[q ^ d]) : 0.0f;
    }
    if (count == 7)
        return seven(f[1], f[2], f[3], f[4], f[5], f[6], f[7]);
    for (int i = 0; i < 3; i++) {
        const size_t *d = faces[i];
        if (there[d[0]] && there[d[1]] && there[d[2]])
            return add(f[d[0]], less(f[d[1]], f[d[2]]));
    }
    for (int i = 0; i < 7; i++)
        if (there[one[i]])
            return f[one[i]];
    return told ? read_float(payload, first + told - 1) : 0.0f;
}

static void decode_places(const mesh *m, const unsigned char *planes, unsigned char *payload) {
    uint32_t told = 0;
    for (size_t c = 0; c < m->cells; c++)
        for (size_t q = 0; q < m->width; q++) {
            const uint32_t *cell = m->row[c];
            const bool tet = m->width == ROW && cell[8] != cell[9];
            if (cell[q] != told)
                continue;
            for (size_t a = 0; a < 3; a++) {
                const size_t first = a * m->nodes;
                const float p = tet ? predict_in_tet(cell, q, told, payload, first)
                                    : predict(cell, q, told, payload, first);
                decode(planes, 3 * m->nodes, first + told, p, payload);
            }
            told++;
        }
}

static bool decode_topology(const mesh *m, const unsigned char *in, size_t bytes,
                            unsigned char *payload) {
    const size_t fixed = m->cells * m->width + 12 * m->nodes;
    if (bytes < fixed || (bytes - fixed) % 2)
        return false;
    const unsigned char *planes = in + m->cells * m->width;
    if (!decode_corners(m, in, planes + 12 * m->nodes, (bytes - fixed) / 2))
        return false;
    decode_places(m, planes, payload);
    unsigned char *to = payload + aligned(12 * m->nodes + (m->cells + 3) / 4);
    for (size_t i = 0; i < m->cells * m->width; i++) {
        const uint32_t node = m->row[i / m->width][i % m->width];
        to[2 * i] = (unsigned char)(node % 256);
        to[2 * i + 1] = (unsigned char)(node / 256);
    }
    return true;
}

bool naive_cells_mixed(int block, const uint32_t counts[4], const unsigned char *in, size_t bytes,
                       unsigned char *payload, size_t payload_bytes) {
    mesh m = {.cells = counts[0], .nodes = counts[1], .width = counts[2] ? ROW : CORNERS};
    const size_t codes = block == 1 ? 0 : (m.cells + 3) / 4,
                 floats = block == 1 ? m.nodes : 3 * m.nodes;
    if (bytes && in[0] == 0)
        return take_stored(in, bytes, payload, payload_bytes);
    if (!bytes || in[0] != 1 || bytes < 1 + codes)
        return false;
    memset(payload, 0, payload_bytes);
    memcpy(payload + 4 * floats, in + 1, codes);
    in += 1 + codes;
    bytes -= 1 + codes;
    if (block != 0)
        return bytes == 4 * floats && decode_row(in, floats, payload);
    m.row = malloc(m.cells * sizeof *m.row);
    assert(m.row);
    const bool sound = decode_topology(&m, in, bytes, payload);
    free(m.row);
    return sound;
}

/* ---- surfaces ---- */

static uint32_t corner_at(const unsigned char *rows, size_t i) {
    return rows[2 * i] + 256U * rows[2 * i + 1];
}

/* The vertex that a corner's code says; -1: none. */
static int64_t told_by(const unsigned char *rows, size_t i, unsigned code, uint32_t told,
                       int64_t word) {
    if (code == 0)
        return told;
    if (code == 255)
        return word < 0 ? -1 : (int64_t)told - 1 - word;
    return code > i ? -1 : (int64_t)corner_at(rows, i - code);
}

static bool decode_triangles(size_t corners, size_t vertices, const unsigned char *code,
                             const unsigned char *words, size_t count, unsigned char *rows) {
    uint32_t told = 0;
    size_t taken = 0;
    for (size_t i = 0; i < corners; i++) {
        int64_t word = -1;
        if (code[i] == 255 && taken < count) {
            word = words[taken] + 256 * words[count + taken];
            taken++;
        }
        const int64_t v = told_by(rows, i, code[i], told, word);
        told += code[i] == 0;
        if (v < 0 || v >= told || told > vertices)
            return false;
        rows[2 * i] = (unsigned char)(v % 256);
        rows[2 * i + 1] = (unsigned char)(v / 256);
    }
    return told == vertices && taken == count;
}

static void decode_points(size_t corners, size_t vertices, const unsigned char *planes,
                          const unsigned char *rows, unsigned char *payload) {
    uint32_t told = 0;
    for (size_t i = 0; i < corners; i++) {
        if (corner_at(rows, i) != told)
            continue;
        for (size_t a = 0; a < 3; a++) {
            const size_t first = a * vertices;
            float p = told ? read_float(payload, first + told - 1) : 0.0f;
            if (i % 3 == 1)
                p = read_float(payload, first + corner_at(rows, i - 1));
            if (i % 3 == 2)
                p = 0.5f * add(read_float(payload, first + corner_at(rows, i - 2)),
                               read_float(payload, first + corner_at(rows, i - 1)));
            decode(planes, 3 * vertices, first + told, p, payload);
        }
        told++;
    }
}

/* u and v of each normal: two planes each, differences from the normal before. */
static void decode_normals(size_t count, const unsigned char *planes, unsigned char *to) {
    int64_t before[2] = {0, 0};
    for (size_t i = 0; i < count; i++)
        for (size_t k = 0; k < 2; k++) {
            const int64_t stored =
                planes[2 * k * count + i] + 256 * planes[(2 * k + 1) * count + i];
            const int64_t difference = stored % 2 ? -(stored + 1) / 2 : stored / 2;
            before[k] = (before[k] + difference + 65536) % 65536;
            to[4 * i + 2 * k] = (unsigned char)(before[k] % 256);
            to[4 * i + 2 * k + 1] = (unsigned char)(before[k] / 256);
        }
}

bool naive_cells_triangles(int block, const uint32_t counts[4], const unsigned char *in,
                           size_t bytes, unsigned char *payload, size_t payload_bytes) {
    const size_t corners = block == 0 ? 3 * (size_t)counts[0] : 0, vertices = counts[1],
                 floats = block == 1 ? vertices : 3 * vertices,
                 normals = block == 1 ? 0 : counts[2], fixed = 1 + corners + 4 * (floats + normals);
    if (bytes && in[0] == 0)
        return take_stored(in, bytes, payload, payload_bytes);
    if (!bytes || in[0] != 1 || bytes < fixed || (bytes - fixed) % 2)
        return false;
    memset(payload, 0, payload_bytes);
    decode_normals(normals, in + 1 + corners + 4 * floats, payload + 4 * floats);
    if (block != 0)
        return bytes == fixed && decode_row(in + 1, floats, payload);
    unsigned char *rows = payload + aligned(4 * (floats + normals));
    if (!decode_triangles(corners, vertices, in + 1, in + fixed, (bytes - fixed) / 2, rows))
        return false;
    decode_points(corners, vertices, in + 1 + corners, rows, payload);
    return true;
}
