/* naive_coded.c - words in the comments are those of formats/FORMAT.md 6. */
#include "tests/support/naive_coded.h"

#include <stdlib.h>
#include <string.h>

#include <zstd.h>

typedef struct input {
    const unsigned char *at;
    size_t left;
    bool short_of;
} input;

static const unsigned char *take(input *in, size_t count) {
    static const unsigned char none[1];
    const unsigned char *at = in->at;
    if (count > in->left) {
        in->short_of = true;
        return none;
    }
    in->at += count;
    in->left -= count;
    return at;
}

static long up(long at) {
    return (at + 63) / 64 * 64;
}

static long unfold(long folded) {
    return folded % 2 ? -(folded + 1) / 2 : folded / 2;
}

static uint32_t read32(const unsigned char *b) {
    return b[0] | (uint32_t)b[1] << 8 | (uint32_t)b[2] << 16 | (uint32_t)b[3] << 24;
}

static void write_number(unsigned char *b, uint32_t x, int bytes) {
    for (int i = 0; i < bytes; i++, x >>= 8)
        b[i] = (unsigned char)x;
}

static int64_t rank_of(uint32_t x) {
    return x < 0x80000000U ? x + INT64_C(0x80000000) : INT64_C(0xffffffff) - x;
}

/* The float with number `at` of `count` in each plane. */
static uint32_t get_float(const unsigned char *planes, long count, long at, uint32_t predicted) {
    int64_t folded = 0;
    for (int b = 3; b >= 0; b--)
        folded = folded * 256 + planes[b * count + at];
    const int64_t rank =
        (rank_of(predicted) + unfold((long)folded) + (INT64_C(1) << 32)) % (INT64_C(1) << 32);
    return (uint32_t)(rank >= INT64_C(0x80000000) ? rank - INT64_C(0x80000000)
                                                  : INT64_C(0xffffffff) - rank);
}

/* ---- values, gradients, positions at a step ---- */

static bool get_codes(input *in, long nodes, long axes, unsigned char *payload) {
    long c = 0;
    const unsigned char *children = take(in, (size_t)nodes);
    for (long n = 0; n < nodes && !in->short_of; n++) {
        if (children[n] > 8)
            return false;
        c += children[n];
    }
    const unsigned char *lo = take(in, (size_t)(axes * c)), *hi = take(in, (size_t)(axes * c));
    if (in->short_of)
        return false;
    for (long a = 0; a < axes; a++) {
        int before = 0;
        for (long n = 0; n < nodes; n++)
            for (long k = 0; k < 8; k++) {
                unsigned char *to = payload + n * 16 * axes + a * 8 + k;
                to[0] = 255;
                to[axes * 8] = 0;
                if (k >= children[n])
                    continue;
                before = (before + *lo++) % 256;
                to[0] = (unsigned char)before;
                to[axes * 8] = (unsigned char)((before + *hi++) % 256);
            }
    }
    return true;
}

static bool get_parts(input *in, int block, const uint32_t counts[4], unsigned char *payload) {
    const long v = counts[1], n = counts[2], axes = block == 1 ? 1 : 3;
    if (block != 2 && !get_codes(in, n, axes, payload))
        return false;
    unsigned char *floats = payload + (block == 2 ? 0 : up(n * 16 * axes));
    const unsigned char *planes = take(in, (size_t)(4 * axes * v));
    if (in->short_of)
        return false;
    for (long a = 0; a < axes; a++) {
        uint32_t before = 0;
        for (long i = 0; i < v; i++) {
            before = get_float(planes, axes * v, a * v + i, before);
            write_number(floats + 4 * (i * axes + a), before, 4);
        }
    }
    return in->left == 0;
}

/* ---- the tree ---- */

/* Number the leaves below a node. Returns false on a path that is too long. */
static bool walk(unsigned char *payload, long node, int depth, long *leaf) {
    unsigned char *child = payload + node * 64 + 48;
    if (depth > 64)
        return false;
    for (int k = 0; k < 8; k++) {
        const long c = child[2 * k] + 256 * child[2 * k + 1];
        if (c == 0xffff)
            continue;
        if (c == 0x8000)
            write_number(child + 2 * k, (uint32_t)(0x8000 + (*leaf)++), 2);
        else if (!walk(payload, c, depth + 1, leaf))
            return false;
    }
    return true;
}

static bool get_tree(input *in, const uint32_t counts[4], unsigned char *payload) {
    const long n = counts[2], l = counts[3];
    const unsigned char *children = take(in, (size_t)n), *inner = take(in, (size_t)n),
                        *leaf = take(in, (size_t)l);
    long next = 1, leaves = 0, sum = 0;
    if (in->short_of)
        return false;
    for (long i = 0; i < n; i++) {
        if (children[i] > 8 || inner[i] >= 1 << children[i] || i >= next)
            return false;
        for (int k = 0; k < 8; k++) {
            const bool is_inner = inner[i] >> k & 1;
            const long c = k >= children[i] ? 0xffff : is_inner ? next++ : 0x8000;
            write_number(payload + i * 64 + 48 + 2 * k, (uint32_t)c, 2);
        }
    }
    if (next != n || !walk(payload, 0, 1, &leaves) || leaves != l)
        return false;
    for (long i = 0; i < l; i++) {
        if (leaf[i] == 0)
            return false;
        sum += leaf[i];
        write_number(payload + n * 64 + 2 * (i + 1), (uint32_t)sum, 2);
    }
    return sum == counts[0];
}

/* ---- tets ---- */

typedef struct tets {
    const uint32_t *counts;
    const unsigned char *code, *planes, *low, *high;
    unsigned char *tet, *positions;
    long words, word, told, last;
    long list[300], listed;
} tets;

static bool get_word(tets *x, bool tells, long base, long *vertex) {
    const long v = x->counts[1];
    if (x->word == x->words)
        return false;
    *vertex = (base + unfold(x->low[x->word] + 256 * x->high[x->word]) + 65536) % 65536;
    x->word++;
    if (*vertex >= v || (tells && x->told == v))
        return false;
    if (!tells)
        return true;
    for (long a = 0; a < 3; a++) {
        const uint32_t predicted = read32(x->positions + 12 * base + 4 * a);
        write_number(x->positions + 12 * *vertex + 4 * a,
                     get_float(x->planes, 3 * v, a * v + x->told, predicted), 4);
    }
    x->told++;
    x->last = *vertex;
    return true;
}

static void use(tets *x, const long place[4], int known, const long vertex[4]) {
    long list[300], listed = 0;
    for (int k = 0; k < 4; k++)
        list[listed++] = vertex[k];
    for (long at = 1; at <= x->listed && listed < 254; at++) {
        bool out = false;
        for (int k = 0; k < known; k++)
            out |= place[k] == at;
        if (!out)
            list[listed++] = x->list[at - 1];
    }
    memcpy(x->list, list, sizeof list);
    x->listed = listed;
}

static int ascending(const void *a, const void *b) {
    const long x = *(const long *)a, y = *(const long *)b;
    return (x > y) - (x < y);
}

static bool get_tet(tets *x, long t) {
    long vertex[4], place[4], at = 0;
    int known = 0;
    for (int k = 0; k < 4; k++) {
        const int code = x->code[k * (long)x->counts[0] + t];
        if (code >= 1 && code <= 254) {
            at += code;
            if (known < k || at > x->listed)
                return false;
            place[known++] = at;
            vertex[k] = x->list[at - 1];
        } else if (!get_word(x, code == 0, k == 0 ? x->last : vertex[0], &vertex[k])) {
            return false;
        }
    }
    use(x, place, known, vertex);
    qsort(vertex, 4, sizeof vertex[0], ascending);
    for (int k = 0; k < 4; k++)
        write_number(x->tet + 8 * t + 2 * k, (uint32_t)vertex[k], 2);
    return true;
}

static bool get_topology(input *in, int way, const uint32_t counts[4], unsigned char *payload) {
    const long t = counts[0], v = counts[1], n = counts[2];
    const long tets_at = up(64 * n + 2 * ((long)counts[3] + 1)), boxes = way == 2 ? 48 * n : 0;
    tets x = {.counts = counts};
    if (!get_tree(in, counts, payload))
        return false;
    x.code = take(in, (size_t)(4 * t));
    x.planes = take(in, (size_t)(12 * v));
    if (in->short_of || (long)in->left < boxes || ((long)in->left - boxes) % 2)
        return false;
    x.words = ((long)in->left - boxes) / 2;
    x.low = take(in, (size_t)x.words);
    x.high = take(in, (size_t)x.words);
    x.tet = payload + tets_at;
    x.positions = payload + up(tets_at + 8 * t);
    for (long i = 0; i < t; i++)
        if (!get_tet(&x, i))
            return false;
    for (long i = 0; i < n && boxes; i++)
        memcpy(payload + 64 * i, in->at + 48 * i, 48);
    return x.told == v && x.word == x.words;
}

bool naive_coded_decode(int block, const uint32_t counts[4], const unsigned char *in, size_t bytes,
                        unsigned char *payload, size_t payload_bytes) {
    input rest = {in, bytes, false};
    const int way = *take(&rest, 1);
    if (rest.short_of)
        return false;
    if (way == 0) {
        if (rest.left != payload_bytes)
            return false;
        memcpy(payload, rest.at, payload_bytes);
        return true;
    }
    if (block == 0)
        return (way == 1 || way == 2) && get_topology(&rest, way, counts, payload);
    return way == 1 && get_parts(&rest, block, counts, payload);
}

bool naive_coded_unpack(int block, const uint32_t counts[4], const unsigned char *stored,
                        size_t stored_bytes, unsigned char *payload, size_t payload_bytes,
                        bool *implied) {
    const size_t room = 4 * payload_bytes + 4096;
    unsigned char *streams = malloc(room);
    const size_t bytes = streams ? ZSTD_decompress(streams, room, stored, stored_bytes) : 0;
    const bool good =
        ZSTD_findFrameCompressedSize(stored, stored_bytes) == stored_bytes &&
        !ZSTD_isError(bytes) && bytes > 0 &&
        naive_coded_decode(block, counts, streams, bytes, payload, payload_bytes);
    *implied = good && block == 0 && streams[0] == 1;
    free(streams);
    return good;
}
