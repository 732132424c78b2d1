/* active_template.h - active_compute() with vectors; active_sse42.c, active_avx2.c and
 * active_avx512.c include it.
 *
 * Makes the same masks as active.c, to the bit, 32 cells at a time. A row of 33 samples becomes two
 * words with a bit per cell. `any`: one of the cell's two samples is at or above a limit; `all`:
 * both are. An interval needs `any` for its reach and `all` for its beyond (interest.h); for an
 * isovalue one pass gives both. Words of four rows are combined to active cells, and turned into
 * Morton order together. A row of blocks, along x, is skipped unless the codes of one of its blocks
 * meet the interest.
 */
#ifndef STREAM_ACTIVE_TEMPLATE_H
#define STREAM_ACTIVE_TEMPLATE_H

#include "formats/base/simd.h"
#include "stream/active.h"

active_fn active_compute_sse42, active_compute_avx2, active_compute_avx512;

#ifdef SIMD_NAME

#include <float.h>
#include <math.h>
#include <stdbool.h>
#include <string.h>

#include "formats/leaf/quantize.h"

enum {
    BLOCK = 1 << LEAF_BLOCK_LOG2,
    ROW = 32, /* cells per word */
    ROW_BLOCKS = ROW / BLOCK,
    CELLS_MAX = 1 << LEAF_CELLS_LOG2_MAX,
    NODES_MAX = CELLS_MAX + 1,
    GROUPS_MAX = 1 << (3 * (LEAF_CELLS_LOG2_MAX - LEAF_BLOCK_LOG2 - 1)),
    BLOCKS_A_SIDE_MAX = CELLS_MAX / BLOCK
};

/* The Morton index of (x, 0, 0). Shifted by 1 or 2 bits: the index of (0, x, 0) or (0, 0, x). */
static const uint16_t SPREAD[BLOCKS_A_SIDE_MAX] = {0,   1,   8,   9,   64,  65,  72,  73,
                                                   512, 513, 520, 521, 576, 577, 584, 585};

/* ---- 32 samples against a limit, a bit each ---- */

#if defined __AVX512F__

typedef __m256i limit8;
typedef __m512i limit16;

SIMD limit8 limit8_of(int32_t a) {
    return _mm256_set1_epi8((char)a);
}
SIMD limit16 limit16_of(int32_t a) {
    return _mm512_set1_epi16((short)a);
}
SIMD uint32_t reach_u8(const uint8_t *s, limit8 limit) {
    return _mm256_cmpge_epu8_mask(_mm256_loadu_si256((const __m256i *)s), limit);
}
SIMD uint32_t reach_i8(const int8_t *s, limit8 limit) {
    return _mm256_cmpge_epi8_mask(_mm256_loadu_si256((const __m256i *)s), limit);
}
SIMD uint32_t reach_u16(const uint16_t *s, limit16 limit) {
    return _mm512_cmpge_epu16_mask(_mm512_loadu_si512(s), limit);
}
SIMD uint32_t reach_i16(const int16_t *s, limit16 limit) {
    return _mm512_cmpge_epi16_mask(_mm512_loadu_si512(s), limit);
}

#elif defined __AVX2__

typedef __m256i limit8;
typedef __m256i limit16;

SIMD limit8 limit8_of(int32_t a) {
    return _mm256_set1_epi8((char)a);
}
SIMD limit16 limit16_of(int32_t a) {
    return _mm256_set1_epi16((short)a);
}
SIMD __m256i load32(const void *from) {
    return _mm256_loadu_si256((const __m256i *)from);
}
SIMD uint32_t reach_u8(const uint8_t *s, limit8 limit) {
    const __m256i a = load32(s);
    return (uint32_t)_mm256_movemask_epi8(_mm256_cmpeq_epi8(_mm256_max_epu8(a, limit), a));
}
SIMD uint32_t reach_i8(const int8_t *s, limit8 limit) {
    const __m256i a = load32(s);
    return (uint32_t)_mm256_movemask_epi8(_mm256_cmpeq_epi8(_mm256_max_epi8(a, limit), a));
}
/* Combine two masks of 16 words, in order. */
SIMD uint32_t bits_of_words(__m256i first, __m256i second) {
    const __m256i packed = _mm256_packs_epi16(first, second);
    return (uint32_t)_mm256_movemask_epi8(_mm256_permute4x64_epi64(packed, 0xd8));
}
SIMD uint32_t reach_u16(const uint16_t *s, limit16 limit) {
    const __m256i a = load32(s), b = load32(s + 16);
    return bits_of_words(_mm256_cmpeq_epi16(_mm256_max_epu16(a, limit), a),
                         _mm256_cmpeq_epi16(_mm256_max_epu16(b, limit), b));
}
SIMD uint32_t reach_i16(const int16_t *s, limit16 limit) {
    const __m256i a = load32(s), b = load32(s + 16);
    return bits_of_words(_mm256_cmpeq_epi16(_mm256_max_epi16(a, limit), a),
                         _mm256_cmpeq_epi16(_mm256_max_epi16(b, limit), b));
}

#else

typedef __m128i limit8;
typedef __m128i limit16;

SIMD limit8 limit8_of(int32_t a) {
    return _mm_set1_epi8((char)a);
}
SIMD limit16 limit16_of(int32_t a) {
    return _mm_set1_epi16((short)a);
}
SIMD __m128i load16(const void *from) {
    return _mm_loadu_si128((const __m128i *)from);
}
SIMD uint32_t bits_of_bytes(__m128i first, __m128i second) {
    return (uint32_t)_mm_movemask_epi8(first) | (uint32_t)_mm_movemask_epi8(second) << 16;
}
SIMD uint32_t reach_u8(const uint8_t *s, limit8 limit) {
    const __m128i a = load16(s), b = load16(s + 16);
    return bits_of_bytes(_mm_cmpeq_epi8(_mm_max_epu8(a, limit), a),
                         _mm_cmpeq_epi8(_mm_max_epu8(b, limit), b));
}
SIMD uint32_t reach_i8(const int8_t *s, limit8 limit) {
    const __m128i a = load16(s), b = load16(s + 16);
    return bits_of_bytes(_mm_cmpeq_epi8(_mm_max_epi8(a, limit), a),
                         _mm_cmpeq_epi8(_mm_max_epi8(b, limit), b));
}
SIMD __m128i reach_u16_8(const uint16_t *s, limit16 limit) {
    const __m128i a = load16(s);
    return _mm_cmpeq_epi16(_mm_max_epu16(a, limit), a);
}
SIMD uint32_t reach_u16(const uint16_t *s, limit16 limit) {
    return bits_of_bytes(_mm_packs_epi16(reach_u16_8(s, limit), reach_u16_8(s + 8, limit)),
                         _mm_packs_epi16(reach_u16_8(s + 16, limit), reach_u16_8(s + 24, limit)));
}
SIMD __m128i reach_i16_8(const int16_t *s, limit16 limit) {
    const __m128i a = load16(s);
    return _mm_cmpeq_epi16(_mm_max_epi16(a, limit), a);
}
SIMD uint32_t reach_i16(const int16_t *s, limit16 limit) {
    return bits_of_bytes(_mm_packs_epi16(reach_i16_8(s, limit), reach_i16_8(s + 8, limit)),
                         _mm_packs_epi16(reach_i16_8(s + 16, limit), reach_i16_8(s + 24, limit)));
}

#endif

SIMD uint32_t reach_f32(const float *s, vf limit) {
    uint32_t bits = 0;
    for (int i = 0; i < ROW; i += VF_N)
        bits |= (uint32_t)mf_bits(f_ge(f_load(s + i), limit)) << i;
    return bits;
}
SIMD uint32_t finite_f32(const float *s, vf limit) {
    uint32_t bits = 0;
    for (int i = 0; i < ROW; i += VF_N)
        bits |= (uint32_t)mf_bits(f_le(f_abs(f_load(s + i)), limit)) << i;
    return bits;
}

/* ---- Rows of cells ---- */

/* A word of up to 32 cells for each row of samples of a layer of blocks. Index: y + n * z, with n
 * rows per plane, and z counted from the layer's first plane. */
enum { PLANES = BLOCK + 1 };
typedef uint32_t layer_words[NODES_MAX * PLANES];

/* Bits per cell, about its two samples on the row. any: one reaches the interval; all: both lie
 * beyond it; bad: one is NaN or inf. spare: for words of a pass that nobody needs. */
typedef struct row_bits {
    layer_words any, all, bad, spare;
} row_bits;

/* One treelet's samples, from behind the halo on. */
typedef struct sample_rows {
    const char *first, *end;
    size_t element, row, slice; /* bytes */
    sample_type type;
} sample_rows;

/* The limit of f >= limit, in the type of samples: i of integers, f of floats. */
typedef struct threshold {
    int32_t i;
    float f;
} threshold;

/* One pass over a layer: the limit, and the words of its rows to fill (any or all of a cell's two
 * samples reach the limit). No limit: `any` becomes the cells with NaN or inf. */
typedef struct row_pass {
    const threshold *limit;
    uint32_t *any, *all;
} row_pass;

/* Convert a limit to the type of samples. Returns false if no sample can reach it. */
SIMD bool threshold_of(sample_type type, float limit, threshold *out) {
    static const double least[] = {
        [SAMPLE_U8] = 0, [SAMPLE_I8] = INT8_MIN, [SAMPLE_U16] = 0, [SAMPLE_I16] = INT16_MIN};
    static const double most[] = {[SAMPLE_U8] = UINT8_MAX,
                                  [SAMPLE_I8] = INT8_MAX,
                                  [SAMPLE_U16] = UINT16_MAX,
                                  [SAMPLE_I16] = INT16_MAX};
    if (type == SAMPLE_F32) {
        out->f = limit;
        return limit <= FLT_MAX;
    }
    const double i = ceil((double)limit);
    if (!(i <= most[type]))
        return false;
    out->i = (int32_t)(i > least[type] ? i : least[type]);
    return true;
}

#define RUN(NAME, TYPE, LIMIT, VECTOR, BITS)                                                   \
    SIMD void NAME(const void *from, size_t stride, uint32_t count, TYPE limit, uint32_t *any, \
                   uint32_t *all) {                                                            \
        const TYPE *s = from;                                                                  \
        const VECTOR at = LIMIT(limit);                                                        \
        for (uint32_t i = 0; i < count; i++, s += stride) {                                    \
            const uint32_t here = BITS(s, at);                                                 \
            const uint32_t next = here >> 1 | (uint32_t)(s[ROW] >= limit) << (ROW - 1);        \
            any[i] = here | next;                                                              \
            all[i] = here & next;                                                              \
        }                                                                                      \
    }

RUN(run_u8, uint8_t, limit8_of, limit8, reach_u8)
RUN(run_i8, int8_t, limit8_of, limit8, reach_i8)
RUN(run_u16, uint16_t, limit16_of, limit16, reach_u16)
RUN(run_i16, int16_t, limit16_of, limit16, reach_i16)
RUN(run_f32, float, f_set, vf, reach_f32)

static void run_bad(const void *from, size_t stride, uint32_t count, uint32_t *bad) {
    const float *s = from;
    const vf at = f_set(FLT_MAX);
    for (uint32_t i = 0; i < count; i++, s += stride) {
        const uint32_t here = ~finite_f32(s, at);
        bad[i] = here | here >> 1 | (uint32_t)!isfinite(s[ROW]) << (ROW - 1);
    }
}

/* Make the words of `count` consecutive rows. Reads 33 samples of each. */
static void run_of(const sample_rows *s, const void *from, size_t stride, uint32_t count,
                   const row_pass *pass, size_t at) {
    const threshold *limit = pass->limit;
    uint32_t *any = pass->any + at, *all = pass->all + at;
    if (!limit) {
        run_bad(from, stride, count, any);
        return;
    }
    switch (s->type) {
    case SAMPLE_U8: run_u8(from, stride, count, (uint8_t)limit->i, any, all); return;
    case SAMPLE_I8: run_i8(from, stride, count, (int8_t)limit->i, any, all); return;
    case SAMPLE_U16: run_u16(from, stride, count, (uint16_t)limit->i, any, all); return;
    case SAMPLE_I16: run_i16(from, stride, count, (int16_t)limit->i, any, all); return;
    default: run_f32(from, stride, count, limit->f, any, all);
    }
}

/* Make the words of rows y .. y + count - 1 of plane z, for cells from x on. Where 33 samples would
 * reach past the end of the payload, copy the rows first. */
static void rows_of_plane(const sample_rows *s, uint32_t x, uint32_t y, uint32_t z, uint32_t count,
                          const row_pass *pass, size_t at) {
    const size_t width = (ROW + 1) * s->element;
    const char *from = s->first + x * s->element + y * s->row + z * s->slice;
    if ((size_t)(s->end - from) >= (count - 1) * s->row + width) {
        run_of(s, from, s->row / s->element, count, pass, at);
        return;
    }
    for (uint32_t i = 0; i < count; i++, from += s->row) {
        float copy[ROW + 1] = {0};
        const size_t left = (size_t)(s->end - from);
        memcpy(copy, from, left < width ? left : width);
        run_of(s, copy, 0, 1, pass, at + i);
    }
}

/* Which rows of blocks are looked at: bit `by` of element `bz`, by the block's y and z. */
typedef uint16_t wanted_rows[BLOCKS_A_SIDE_MAX];

/* Make the words of plane z, for the rows of samples that the rows of blocks in `held` touch. at:
 * index of the plane's first word. */
static void rows_wanted(const sample_rows *s, const uint32_t cells[3], unsigned held, uint32_t x,
                        uint32_t z, const row_pass *pass, size_t at) {
    while (held) {
        const unsigned by = (unsigned)__builtin_ctz(held);
        const unsigned run = (unsigned)__builtin_ctz(~(held >> by));
        held &= ~(((1u << run) - 1u) << by);
        const uint32_t y = by * BLOCK, last = y + run * BLOCK;
        if (y >= cells[1])
            break;
        rows_of_plane(s, x, y, z, (last < cells[1] ? last : cells[1]) - y + 1, pass, at + y);
    }
}

/* Make the words of layer bz of blocks. Its first plane is also the last plane of the layer below:
 * copy it from there if that layer has been made. */
static void layer_wanted(const sample_rows *s, const uint32_t cells[3], uint32_t side, uint32_t x,
                         const wanted_rows wanted, uint32_t bz, const row_pass *pass) {
    const uint32_t nodes = side + 1, z0 = bz * BLOCK;
    const uint32_t last = cells[2] - z0 < BLOCK ? cells[2] - z0 : BLOCK;
    uint32_t k = 0;
    if (bz > 0 && wanted[bz - 1]) {
        const size_t bytes = nodes * sizeof *pass->any, from = (size_t)BLOCK * nodes;
        memcpy(pass->any, pass->any + from, bytes);
        memcpy(pass->all, pass->all + from, bytes);
        k = 1;
    }
    for (; k <= last; k++) {
        /* The next layer copies the last plane, so make that one for both. */
        const bool shared = k == BLOCK && z0 + BLOCK < side;
        rows_wanted(s, cells, wanted[bz] | (shared ? wanted[bz + 1] : 0u), x, z0 + k, pass,
                    (size_t)k * nodes);
    }
}

/* ---- From rows to blocks ---- */

SIMD __m128i words(const uint32_t *from) {
    return _mm_loadu_si128((const __m128i *)from);
}

/* Find the active cells of 4 x 4 rows: m[z], one lane per y. */
SIMD void mixed_cells(const row_bits *rows, size_t at, size_t nodes, bool non_finite,
                      __m128i m[BLOCK]) {
    const uint32_t *any = rows->any + at, *all = rows->all + at, *bad = rows->bad + at;
    __m128i some = _mm_or_si128(words(any), words(any + 1));
    __m128i every = _mm_and_si128(words(all), words(all + 1));
    for (int z = 0; z < BLOCK; z++) {
        any += nodes;
        all += nodes;
        const __m128i some_next = _mm_or_si128(words(any), words(any + 1));
        const __m128i every_next = _mm_and_si128(words(all), words(all + 1));
        m[z] = _mm_andnot_si128(_mm_and_si128(every, every_next), _mm_or_si128(some, some_next));
        some = some_next;
        every = every_next;
    }
    for (int z = 0; non_finite && z < BLOCK; z++, bad += nodes) {
        const __m128i here = _mm_or_si128(words(bad), words(bad + 1));
        const __m128i next = _mm_or_si128(words(bad + nodes), words(bad + nodes + 1));
        m[z] = _mm_andnot_si128(_mm_or_si128(here, next), m[z]);
    }
}

/* Swap the bits of a that mask selects with the bits `by` positions higher. */
SIMD __m128i exchange(__m128i a, int by, int mask) {
    const __m128i t = _mm_and_si128(_mm_xor_si128(a, _mm_srli_epi32(a, by)), _mm_set1_epi32(mask));
    return _mm_xor_si128(a, _mm_xor_si128(t, _mm_slli_epi32(t, by)));
}

/* Turn four rows of 32 cells, (y, z) = 00 10 01 11, into bytes of 2 x 2 x 2 cells: transpose 4 x 4
 * pairs of bits in every byte column. */
SIMD __m128i groups_of(__m128i rows) {
    const __m128i columns = _mm_setr_epi8(0, 4, 8, 12, 1, 5, 9, 13, 2, 6, 10, 14, 3, 7, 11, 15);
    const __m128i bytes = _mm_shuffle_epi8(rows, columns);
    return exchange(exchange(bytes, 6, 0x00cc00cc), 12, 0x0000f0f0);
}

SIMD void add_blocks(uint64_t *to, __m128i pair) {
    __m128i *at = (__m128i *)to;
    _mm_storeu_si128(at, _mm_or_si128(_mm_loadu_si128(at), pair));
}

/* Add the masks of a row of blocks from its 4 x 4 rows of cells. cells: the row's first block. */
SIMD void put_blocks(const __m128i m[BLOCK], uint32_t blocks, uint64_t *cells) {
    /* 16-bit lanes: the groups (x = 0, 1) of every block, for (y, z) = 00 10 01 11. */
    const __m128i g00 = groups_of(_mm_unpacklo_epi64(m[0], m[1]));
    const __m128i g10 = groups_of(_mm_unpackhi_epi64(m[0], m[1]));
    const __m128i g01 = groups_of(_mm_unpacklo_epi64(m[2], m[3]));
    const __m128i g11 = groups_of(_mm_unpackhi_epi64(m[2], m[3]));
    const __m128i lo0 = _mm_unpacklo_epi16(g00, g10), lo1 = _mm_unpacklo_epi16(g01, g11);
    add_blocks(cells, _mm_unpacklo_epi32(lo0, lo1));
    add_blocks(cells + SPREAD[2], _mm_unpackhi_epi32(lo0, lo1));
    if (blocks <= 4)
        return;
    const __m128i hi0 = _mm_unpackhi_epi16(g00, g10), hi1 = _mm_unpackhi_epi16(g01, g11);
    add_blocks(cells + SPREAD[4], _mm_unpacklo_epi32(hi0, hi1));
    add_blocks(cells + SPREAD[6], _mm_unpackhi_epi32(hi0, hi1));
}

/* Make the masks of the wanted rows of blocks of layer bz from the words of their rows. */
static void blocks_wanted(const row_bits *rows, const uint32_t cells[3], uint32_t side, uint32_t x,
                          const wanted_rows wanted, uint32_t bz, bool non_finite, uint64_t *out) {
    const uint32_t left = cells[0] - x, z = bz * BLOCK;
    const __m128i row = _mm_set1_epi32(left < ROW ? (int)((1u << left) - 1u) : -1);
    const __m128i lanes = _mm_setr_epi32(0, 1, 2, 3);
    for (unsigned held = wanted[bz]; held; held &= held - 1) {
        const uint32_t by = (uint32_t)__builtin_ctz(held), y = by * BLOCK;
        __m128i m[BLOCK];
        mixed_cells(rows, y, side + 1, non_finite, m);
        /* Keep only cells that exist. */
        const __m128i valid =
            _mm_and_si128(row, _mm_cmpgt_epi32(_mm_set1_epi32((int)cells[1] - (int)y), lanes));
        for (uint32_t k = 0; k < BLOCK; k++)
            m[k] = z + k < cells[2] ? _mm_and_si128(m[k], valid) : _mm_setzero_si128();
        put_blocks(m, side / BLOCK,
                   out + SPREAD[x / BLOCK] + (SPREAD[by] << 1) + (SPREAD[bz] << 2));
    }
}

/* ---- Codes and nodes ---- */

/* Find whether the codes of each block meet the interest: a byte per eight siblings. */
static void held_blocks(const uint8_t *lo, const uint8_t *hi, uint32_t blocks,
                        const interest_part *in, uint8_t *held) {
    for (uint32_t b = 0; b < blocks; b += 16) {
        const __m128i low = _mm_loadu_si128((const __m128i *)(lo + b));
        const __m128i high = _mm_loadu_si128((const __m128i *)(hi + b));
        __m128i holds = _mm_setzero_si128();
        for (int i = 0; i < in->count; i++) {
            const __m128i below = _mm_set1_epi8((char)in->codes[i].below);
            const __m128i above = _mm_set1_epi8((char)in->codes[i].above);
            holds =
                _mm_or_si128(holds, _mm_and_si128(_mm_cmpeq_epi8(_mm_min_epu8(low, below), low),
                                                  _mm_cmpeq_epi8(_mm_max_epu8(high, above), high)));
        }
        const uint16_t bits = (uint16_t)_mm_movemask_epi8(holds);
        memcpy(held + b / 8, &bits, sizeof bits);
    }
}

/* Find the rows of blocks with a held block in the word from x on. Returns false for none. */
static bool want_rows(const uint8_t *held, uint32_t side, uint32_t x, wanted_rows wanted) {
    const uint32_t pairs = side / (2 * BLOCK), first = x / (2 * BLOCK);
    unsigned any = 0;
    for (uint32_t z = 0; z < pairs; z++) {
        unsigned here[2] = {0, 0};
        for (uint32_t y = 0; y < pairs; y++) {
            const uint8_t *from = held + SPREAD[first] + (SPREAD[y] << 1) + (SPREAD[z] << 2);
            unsigned h = from[0] | from[1];
            if (pairs >= ROW_BLOCKS / 2)
                h |= from[SPREAD[2]] | from[SPREAD[3]];
            h |= h >> 1;
            here[0] |= ((h & 1u) | (h >> 1 & 2u)) << (2 * y);
            here[1] |= ((h >> 4 & 1u) | (h >> 5 & 2u)) << (2 * y);
        }
        wanted[2 * z] = (uint16_t)here[0];
        wanted[2 * z + 1] = (uint16_t)here[1];
        any |= here[0] | here[1];
    }
    return any != 0;
}

/* Returns which of eight blocks have an active cell. */
SIMD unsigned filled_blocks(const uint64_t cells[8]) {
#if defined __AVX512F__
    const __m512i all = _mm512_loadu_si512(cells);
    return _mm512_test_epi64_mask(all, all);
#else
    unsigned empty = 0;
    for (int i = 0; i < 8; i += 2) {
        const __m128i pair = _mm_loadu_si128((const __m128i *)(cells + i));
        empty |=
            (unsigned)_mm_movemask_pd(_mm_castsi128_pd(_mm_cmpeq_epi64(pair, _mm_setzero_si128())))
            << i;
    }
    return ~empty & 255u;
#endif
}

/* Build the tree above the blocks. */
static void sum_up(active_masks *masks, uint32_t levels, const uint8_t *held) {
    uint8_t *leaves = masks->nodes + active_nodes_at(levels - 1);
    for (uint32_t g = 0; g < 1u << (3 * (levels - 1)); g++) {
        uint64_t *cells = masks->cells + 8 * (size_t)g;
        const unsigned filled = filled_blocks(cells);
        /* Clear blocks that were only looked at for a neighbour in their row, and whose codes say
         * that nothing is there: codes decide. (In files that we wrote, they are right.) */
        for (unsigned wrong = filled & ~(unsigned)held[g]; wrong; wrong &= wrong - 1)
            cells[__builtin_ctz(wrong)] = 0;
        leaves[g] = (uint8_t)(filled & held[g]);
    }
    for (uint32_t k = levels - 1; k >= 1; k--) {
        const uint8_t *nodes = masks->nodes + active_nodes_at(k);
        uint8_t *above = k > 1 ? masks->nodes + active_nodes_at(k - 1) : &masks->root;
        for (uint32_t g = 0; g < 1u << (3 * (k - 1)); g++) {
            const __m128i eight = _mm_loadl_epi64((const __m128i *)(nodes + 8 * (size_t)g));
            above[g] = (uint8_t)~_mm_movemask_epi8(_mm_cmpeq_epi8(eight, _mm_setzero_si128()));
        }
    }
}

/* ---- A treelet ---- */

/* Make the masks of the cells from x on that a word covers. */
static void word_of_cells(active_masks *masks, const sample_rows *s, const leaf_payload *shape,
                          uint32_t x, const wanted_rows wanted, bool non_finite,
                          const interest_part *in) {
    const uint32_t side = BLOCK << shape->node_levels;
    const size_t used = (size_t)(side + 1) * PLANES * sizeof(uint32_t);
    row_bits rows;
    const row_pass missing = {NULL, rows.bad, rows.spare};
    if (shape->cells[1] < side || shape->cells[2] < side) {
        /* Clear the words of rows that do not exist: they are read together with others. */
        memset(rows.any, 0, used);
        memset(rows.all, 0, used);
        memset(rows.bad, 0, used);
    }
    for (int i = 0; i < in->count; i++) {
        const value_limits at = in->limits[i];
        const bool isovalue = at.reach == at.beyond;
        threshold reach = {0, 0.0f}, beyond = {0, 0.0f};
        if (!threshold_of(s->type, at.reach, &reach))
            continue;
        const bool bounded = !isovalue && threshold_of(s->type, at.beyond, &beyond);
        const row_pass first = {&reach, rows.any, isovalue ? rows.all : rows.spare};
        const row_pass second = {&beyond, rows.spare, rows.all};
        if (!isovalue && !bounded)
            memset(rows.all, 0, used);
        for (uint32_t bz = 0; bz * BLOCK < shape->cells[2]; bz++) {
            if (!wanted[bz])
                continue;
            if (non_finite)
                layer_wanted(s, shape->cells, side, x, wanted, bz, &missing);
            layer_wanted(s, shape->cells, side, x, wanted, bz, &first);
            if (bounded)
                layer_wanted(s, shape->cells, side, x, wanted, bz, &second);
            blocks_wanted(&rows, shape->cells, side, x, wanted, bz, non_finite, masks->cells);
        }
    }
}

void SIMD_NAME(active_compute)(active_masks *masks, const leaf_file *f, uint32_t p,
                               const void *payload, const interest *in) {
    const leaf_payload shape = leaf_layout_payload(&f->layout, p % f->layout.treelets);
    const uint32_t levels = shape.node_levels, blocks = 1u << (3 * levels);
    const uint32_t side = BLOCK << levels, halo = f->layout.halo;
    const quantizer q = quantizer_of(f->own[p][0], f->own[p][1], f->layout.type);
    interest_part part;
    uint8_t held[GROUPS_MAX];
    interest_within(&part, in, &q);
    const uint8_t *lo = (const uint8_t *)payload + leaf_codes_at(levels);
    held_blocks(lo, lo + blocks, blocks, &part, held);

    const size_t element = sample_size(f->layout.type), row = shape.samples[0] * element;
    sample_rows s = {.end = (const char *)payload + shape.bytes,
                     .element = element,
                     .row = row,
                     .slice = row * shape.samples[1],
                     .type = f->layout.type};
    s.first = (const char *)payload + shape.samples_at + halo * (s.element + s.row + s.slice);
    memset(masks->cells, 0, blocks * sizeof *masks->cells);
    wanted_rows wanted;
    for (uint32_t x = 0; x < shape.cells[0]; x += ROW)
        if (want_rows(held, side, x, wanted))
            word_of_cells(masks, &s, &shape, x, wanted, f->flags[p] & LEAF_FLAG_NON_FINITE, &part);
    sum_up(masks, levels, held);
    active_bound(masks, levels);
}

#endif
#endif
