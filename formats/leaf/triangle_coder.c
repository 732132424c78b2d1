/* The streams:
 *
 *   0       u8: the first byte
 *   of a topology, then:
 *   1       u8 codes[3 c]: which vertex is at a corner, below
 *   2 - 5   u8 plane[4][3 n]: places, each axis after the other
 *   6 - 9   u8 plane[4][n], only if there are normals: the low and the high byte of u, then of v
 *   10, 11  u8 each: low and high bytes of the words that codes ask for
 *   of positions: 1 - 8, the planes; of values: 1 - 4
 *
 * Corner after corner, with m vertices so far, a code says which one is there: 0: a new one, m. 1
 * .. 254: the one at the code-th corner before. 255: m - 1 - w, with w the next word. A place is
 * predicted by those of the same triangle that are known, of the vertices before it in the row: one
 * by that one, two by the mean of both; else by the vertex before. u and v of a normal are
 * predicted by those of the vertex before.
 */
#include "formats/leaf/triangle_coder.h"

#include "formats/leaf/coded_payload.h"
#include "formats/leaf/float_planes.h"
#include "formats/leaf/triangle_geometry.h"

enum { NEW = 0, FARTHEST = 254, WORD = 255 };

/* A payload: floats, normals, zeros; of a topology corners, and zeros. */
typedef struct parts {
    size_t floats, normals, floats_end, corners, bytes;
} parts;

/* Where the zeros behind floats and normals begin. */
static size_t words_end(const parts *p) {
    return (p->floats + p->normals) * sizeof(uint32_t);
}

static parts parts_of(leaf_block block, const triangle_shape *s) {
    if (block == LEAF_BLOCK_VALUES)
        return (parts){s->vertices, 0, s->value_bytes, 0, s->value_bytes};
    parts places = {3 * (size_t)s->vertices, s->normals, s->place_bytes, 0, s->place_bytes};
    if (block == LEAF_BLOCK_TOPOLOGY) {
        places.corners = TRIANGLE_CORNERS * (size_t)s->triangles;
        places.bytes = s->topology_bytes;
    }
    return places;
}

static size_t bytes_of(leaf_block block, const uint32_t counts[4]) {
    const triangle_shape s = triangle_shape_of(counts);
    return parts_of(block, &s).bytes;
}

/* A code and a word for each corner. */
static size_t room_of(leaf_block block, const uint32_t counts[4]) {
    const triangle_shape s = triangle_shape_of(counts);
    const parts p = parts_of(block, &s);
    const size_t coded = words_end(&p) + 3 * p.corners;
    return 1 + (coded > p.bytes ? coded : p.bytes);
}

static size_t scratch_of(const uint32_t counts[4]) {
    return TRIANGLE_CORNERS * (size_t)counts[0] * sizeof(uint16_t);
}

static bool padding_is_zero(const char *payload, const parts *p) {
    const size_t corners_end = p->floats_end + p->corners * sizeof(uint16_t);
    return coded_payload_is_zero(payload, words_end(p), p->floats_end) &&
           coded_payload_is_zero(payload, p->corners ? corners_end : p->bytes, p->bytes);
}

/* ---- corners ---- */

/* The words are put into scratch. -1: a vertex is not new where it is first used. */
static int64_t encode_corners(const uint16_t *rows, size_t corners, uint8_t *codes,
                              uint16_t *words) {
    uint32_t met = 0;
    int64_t count = 0;
    for (size_t i = 0; i < corners; i++) {
        size_t back = 1;
        if (rows[i] > met)
            return -1;
        if (rows[i] == met) {
            codes[i] = NEW;
            met++;
            continue;
        }
        while (back <= FARTHEST && back <= i && rows[i - back] != rows[i])
            back++;
        if (back <= FARTHEST && back <= i) {
            codes[i] = (uint8_t)back;
        } else {
            codes[i] = WORD;
            words[count++] = (uint16_t)(met - 1 - rows[i]);
        }
    }
    return count;
}

/* The words lie behind all planes, so that their number need not be told. */
static bool decode_corners(const uint8_t *codes, coded_input *words, const triangle_shape *s,
                           uint16_t *rows) {
    const size_t corners = TRIANGLE_CORNERS * (size_t)s->triangles, count = words->left / 2;
    const uint8_t *low = words->at, *high = low + count;
    size_t used = 0;
    uint32_t met = 0;
    for (size_t i = 0; i < corners; i++) {
        const uint8_t code = codes[i];
        if (code == NEW) {
            if (met == s->vertices)
                return false;
            rows[i] = (uint16_t)met++;
        } else if (code != WORD) {
            if (code > i)
                return false;
            rows[i] = rows[i - code];
        } else {
            if (used == count)
                return false;
            const uint32_t back = low[used] | (uint32_t)high[used] << 8;
            used++;
            if (back >= met)
                return false;
            rows[i] = (uint16_t)(met - 1 - back);
        }
    }
    return met == s->vertices && words->left == 2 * used;
}

/* ---- places ---- */

/* Bits of the prediction of the vertex that corner i has first, from those that are there. */
static uint32_t predicted(const uint16_t *rows, size_t i, const float *x) {
    const uint32_t v = rows[i];
    const size_t k = i % TRIANGLE_CORNERS;
    float p = v > 0 ? x[v - 1] : 0.0F;
    if (k == 1)
        p = x[rows[i - 1]];
    if (k == 2)
        p = 0.5F * (x[rows[i - 2]] + x[rows[i - 1]]);
    return float_planes_predicted(p);
}

/* Whether corner i has a vertex first, with `met` before. */
static bool is_first(const uint16_t *rows, size_t i, uint32_t *met) {
    if (rows[i] != *met)
        return false;
    ++*met;
    return true;
}

static void encode_places(const triangle_shape *s, const uint16_t *rows, const float *places,
                          uint8_t *planes) {
    const size_t n = s->vertices, stride = 3 * n;
    uint32_t met = 0;
    for (size_t i = 0; i < TRIANGLE_CORNERS * (size_t)s->triangles; i++)
        if (is_first(rows, i, &met))
            for (size_t a = 0; a < 3; a++) {
                const float *x = places + a * n;
                uint32_t bits;
                memcpy(&bits, &x[rows[i]], sizeof bits);
                float_planes_put(planes + a * n + rows[i], stride, bits, predicted(rows, i, x));
            }
}

static void decode_places(const triangle_shape *s, const uint16_t *rows, const uint8_t *planes,
                          float *places) {
    const size_t n = s->vertices, stride = 3 * n;
    uint32_t met = 0;
    for (size_t i = 0; i < TRIANGLE_CORNERS * (size_t)s->triangles; i++)
        if (is_first(rows, i, &met))
            for (size_t a = 0; a < 3; a++) {
                float *x = places + a * n;
                const uint32_t bits =
                    float_planes_get(planes + a * n + rows[i], stride, predicted(rows, i, x));
                memcpy(&x[rows[i]], &bits, sizeof bits);
            }
}

/* ---- normals ---- */

enum { NORMAL_PLANES = 4 };

static uint32_t folded(uint32_t now, uint32_t before) {
    const uint32_t d = (now - before) & 0xffff;
    return d < 0x8000 ? 2 * d : 0x1ffff - 2 * d;
}

static uint32_t unfolded(uint32_t folded_difference, uint32_t before) {
    const uint32_t half = folded_difference >> 1;
    return (before + (folded_difference & 1 ? ~half : half)) & 0xffff;
}

static void encode_normals(const uint32_t *normals, size_t count, uint8_t *planes) {
    uint32_t before = 0;
    for (size_t i = 0; i < count; i++) {
        for (unsigned k = 0; k < 2; k++) {
            const uint32_t d = folded(normals[i] >> 16 * k & 0xffff, before >> 16 * k & 0xffff);
            planes[2 * k * count + i] = (uint8_t)d;
            planes[(2 * k + 1) * count + i] = (uint8_t)(d >> 8);
        }
        before = normals[i];
    }
}

static void decode_normals(const uint8_t *planes, size_t count, uint32_t *normals) {
    uint32_t before = 0;
    for (size_t i = 0; i < count; i++) {
        uint32_t code = 0;
        for (unsigned k = 0; k < 2; k++) {
            const uint32_t d = planes[2 * k * count + i] | (uint32_t)planes[(2 * k + 1) * count + i]
                                                               << 8;
            code |= unfolded(d, before >> 16 * k & 0xffff) << 16 * k;
        }
        before = normals[i] = code;
    }
}

/* The normals of a payload, behind its floats. */
static void put_normals(const parts *p, const char *payload, coded_streams *out) {
    const void *normals = payload + p->floats * sizeof(float);
    if (p->normals == 0)
        return;
    encode_normals(normals, p->normals, coded_streams_take(out, p->normals * sizeof(uint32_t)));
    coded_payload_end_planes(out, NORMAL_PLANES, p->normals);
}

/* ---- payloads ---- */

static bool encode_topology(const triangle_shape *s, const parts *p, const char *payload,
                            void *scratch, coded_streams *out) {
    const uint16_t *rows = triangle_rows(s, payload)[0], *words = scratch;
    const int64_t count =
        encode_corners(rows, p->corners, coded_streams_take(out, p->corners), scratch);
    if (count < 0)
        return false;
    coded_streams_end(out);
    encode_places(s, rows, (const float *)(const void *)payload,
                  coded_streams_take(out, p->floats * sizeof(float)));
    coded_payload_end_planes(out, FLOAT_PLANES, p->floats);
    put_normals(p, payload, out);
    for (unsigned shift = 0; shift < 16; shift += 8) {
        uint8_t *to = coded_streams_take(out, (size_t)count);
        for (int64_t i = 0; i < count; i++)
            to[i] = (uint8_t)(words[i] >> shift);
        coded_streams_end(out);
    }
    return true;
}

/* False: the payload could not be made again. */
static bool encode_streams(leaf_block block, const triangle_shape *s, const parts *p,
                           const char *payload, void *scratch, coded_streams *out) {
    if (!padding_is_zero(payload, p))
        return false;
    coded_payload_begin(CODED_STREAMS, out);
    coded_streams_end(out);
    if (block == LEAF_BLOCK_TOPOLOGY)
        return encode_topology(s, p, payload, scratch, out);
    float_planes_encode(payload, p->floats, 1, coded_streams_take(out, p->floats * sizeof(float)));
    coded_payload_end_planes(out, FLOAT_PLANES, p->floats);
    put_normals(p, payload, out);
    return true;
}

static void encode(leaf_block block, const uint32_t counts[4], const float bounds[6],
                   const void *payload, void *scratch, coded_streams *out) {
    const triangle_shape s = triangle_shape_of(counts);
    const parts p = parts_of(block, &s);
    (void)bounds;
    if (!encode_streams(block, &s, &p, payload, scratch, out))
        coded_payload_store(payload, p.bytes, out);
}

static bool decode_streams(const triangle_shape *s, const parts *p, coded_input *in,
                           char *payload) {
    const uint8_t *codes = coded_input_take(in, p->corners);
    const uint8_t *planes = coded_input_take(in, p->floats * sizeof(float));
    const uint8_t *normals = coded_input_take(in, p->normals * sizeof(uint32_t));
    if (!codes || !planes || !normals)
        return false;
    const size_t floats = p->floats * sizeof(float);
    memset(payload + floats, 0, p->bytes - floats);
    decode_normals(normals, p->normals, (uint32_t *)(void *)(payload + floats));
    if (!p->corners) {
        float_planes_decode(planes, p->floats, 1, payload);
        return in->left == 0;
    }
    uint16_t *rows = (uint16_t *)(void *)(payload + p->floats_end);
    if (!decode_corners(codes, in, s, rows))
        return false;
    decode_places(s, rows, planes, (float *)(void *)payload);
    return true;
}

static bool decode(leaf_block block, const uint32_t counts[4], const float bounds[6],
                   const uint8_t *in, size_t bytes, void *payload) {
    const triangle_shape s = triangle_shape_of(counts);
    const parts p = parts_of(block, &s);
    coded_input rest = {in, bytes};
    const uint8_t *first = coded_input_take(&rest, 1);
    (void)bounds;
    if (first && *first == CODED_STORED)
        return coded_payload_stored(&rest, payload, p.bytes);
    return first && *first == CODED_STREAMS && decode_streams(&s, &p, &rest, payload);
}

const leaf_coder triangle_coder = {
    .bytes = bytes_of, .room = room_of, .scratch = scratch_of, .encode = encode, .decode = decode};
