#include "formats/leaf/grid_codes.h"

#include <math.h>
#include <string.h>

#include "formats/leaf/quantize.h"

enum {
    CELLS_MAX = 1 << LEAF_CELLS_LOG2_MAX,
    BLOCK = 1 << LEAF_BLOCK_LOG2,
    ROW_MAX = CELLS_MAX + 1,
    SOME = 32 /* samples at once; of fewer gcc makes no vectors */
};

struct grid_codes_scratch {
    float *lo, *hi; /* ranges of the 4^3 blocks, Morton order, in `room`; lo > hi: empty */
    /* Minimum and maximum over the up to 25 rows of a line of blocks; of the sample type. */
    _Alignas(64) char row_lo[ROW_MAX * sizeof(float)];
    _Alignas(64) char row_hi[ROW_MAX * sizeof(float)];
    float room[];
};

static uint32_t blocks_of(uint32_t node_levels) {
    return 1U << (3 * node_levels);
}

size_t grid_codes_scratch_bytes(uint32_t node_levels) {
    return sizeof(grid_codes_scratch) + 2 * blocks_of(node_levels) * sizeof(float);
}

/* ---- ranges of the 4^3 blocks ---- */

/* Spread the bits of a block coordinate (below 16), with two zero bits between each. */
static uint32_t spread(uint32_t v) {
    return (v & 1) | (v & 2) << 2 | (v & 4) << 4 | (v & 8) << 6;
}

static uint32_t morton(uint32_t x, uint32_t y, uint32_t z) {
    return spread(x) | spread(y) << 1 | spread(z) << 2;
}

/* A sample as an operand of a minimum and of a maximum. */
#define ANY_LO(v)    (v)
#define ANY_HI(v)    (v)
#define FINITE_LO(v) (isfinite(v) ? (v) : INFINITY)
#define FINITE_HI(v) (isfinite(v) ? (v) : -INFINITY)

/* The rows of a line of blocks: `rows` of them in each of `slices`. */
typedef struct block_rows {
    const char *first;               /* the first own sample */
    size_t row_stride, slice_stride; /* in samples */
    uint32_t rows, slices, nodes;
} block_rows;

/* Reduce the rows of a line to one, some samples at once: the last ones of
 * a row are taken together with some before them. Then reduce that to blocks. */
#define DEFINE_BLOCK_LINE(suffix, T, OF_LO, OF_HI)                                                \
    static inline void some_##suffix(const block_rows *r, uint32_t x, uint32_t n, T *restrict lo, \
                                     T *restrict hi) {                                            \
        const T *slice = (const T *)r->first + x;                                                 \
        T a[SOME], b[SOME];                                                                       \
        for (uint32_t i = 0; i < n; i++) {                                                        \
            a[i] = OF_LO(slice[i]);                                                               \
            b[i] = OF_HI(slice[i]);                                                               \
        }                                                                                         \
        for (uint32_t z = 0; z < r->slices; z++, slice += r->slice_stride) {                      \
            const T *row = slice;                                                                 \
            for (uint32_t y = 0; y < r->rows; y++, row += r->row_stride)                          \
                for (uint32_t i = 0; i < n; i++) {                                                \
                    const T v = OF_LO(row[i]), w = OF_HI(row[i]);                                 \
                    a[i] = v < a[i] ? v : a[i];                                                   \
                    b[i] = w > b[i] ? w : b[i];                                                   \
                }                                                                                 \
        }                                                                                         \
        memcpy(lo + x, a, n * sizeof(T));                                                         \
        memcpy(hi + x, b, n * sizeof(T));                                                         \
    }                                                                                             \
    static void line_##suffix(grid_codes_scratch *s, const block_rows *r, uint32_t by,            \
                              uint32_t bz) {                                                      \
        T *restrict lo = (T *)s->row_lo, *restrict hi = (T *)s->row_hi;                           \
        const uint32_t cells = r->nodes - 1;                                                      \
        for (uint32_t x = 0; x + SOME <= r->nodes; x += SOME)                                     \
            some_##suffix(r, x, SOME, lo, hi);                                                    \
        if (r->nodes % SOME && r->nodes > SOME)                                                   \
            some_##suffix(r, r->nodes - SOME, SOME, lo, hi);                                      \
        else if (r->nodes < SOME)                                                                 \
            some_##suffix(r, 0, r->nodes, lo, hi);                                                \
        for (uint32_t x0 = 0, bx = 0; x0 < cells; x0 += BLOCK, bx++) {                            \
            const uint32_t x1 = x0 + BLOCK < cells ? x0 + BLOCK : cells;                          \
            T a = lo[x0], b = hi[x0];                                                             \
            for (uint32_t x = x0 + 1; x <= x1; x++) {                                             \
                a = lo[x] < a ? lo[x] : a;                                                        \
                b = hi[x] > b ? hi[x] : b;                                                        \
            }                                                                                     \
            const uint32_t m = morton(bx, by, bz);                                                \
            s->lo[m] = (float)a;                                                                  \
            s->hi[m] = (float)b;                                                                  \
        }                                                                                         \
    }

DEFINE_BLOCK_LINE(u8, uint8_t, ANY_LO, ANY_HI)
DEFINE_BLOCK_LINE(i8, int8_t, ANY_LO, ANY_HI)
DEFINE_BLOCK_LINE(u16, uint16_t, ANY_LO, ANY_HI)
DEFINE_BLOCK_LINE(i16, int16_t, ANY_LO, ANY_HI)
DEFINE_BLOCK_LINE(f32, float, ANY_LO, ANY_HI)
DEFINE_BLOCK_LINE(f32_finite, float, FINITE_LO, FINITE_HI)

typedef void (*block_line)(grid_codes_scratch *, const block_rows *, uint32_t, uint32_t);

/* Returns whether any of the treelet's own samples is NaN or inf, by an exponent of all ones. */
static bool any_non_finite(const leaf_payload *p, const char *own, size_t row_stride,
                           size_t slice_stride) {
    uint32_t found = 0;
    for (uint32_t z = 0; z <= p->cells[2]; z++)
        for (uint32_t y = 0; y <= p->cells[1]; y++) {
            const uint32_t *row = (const uint32_t *)own + z * slice_stride + y * row_stride;
            for (uint32_t x = 0; x <= p->cells[0]; x++)
                found |= (row[x] & 0x7F800000u) == 0x7F800000u;
        }
    return found;
}

static void block_ranges(grid_codes_scratch *s, const leaf_layout *l, const leaf_payload *p,
                         const char *samples, uint8_t *flags) {
    static const block_line lines[] = {[SAMPLE_U8] = line_u8,
                                       [SAMPLE_I8] = line_i8,
                                       [SAMPLE_U16] = line_u16,
                                       [SAMPLE_I16] = line_i16,
                                       [SAMPLE_F32] = line_f32};
    size_t row = p->samples[0], slice = row * p->samples[1];
    const char *own = samples + l->halo * (1 + row + slice) * sample_size(l->type);
    block_line line = lines[l->type];
    *flags = 0;
    if (l->type == SAMPLE_F32 && any_non_finite(p, own, row, slice)) {
        line = line_f32_finite;
        *flags = LEAF_FLAG_NON_FINITE;
    }
    const uint32_t blocks = blocks_of(p->node_levels);
    s->lo = s->room;
    s->hi = s->room + blocks;
    for (uint32_t m = 0; m < blocks; m++) {
        s->lo[m] = INFINITY;
        s->hi[m] = -INFINITY;
    }
    block_rows r = {.row_stride = row, .slice_stride = slice, .nodes = p->cells[0] + 1};
    for (uint32_t z = 0; z < p->cells[2]; z += BLOCK)
        for (uint32_t y = 0; y < p->cells[1]; y += BLOCK) {
            r.first = own + (z * slice + y * row) * sample_size(l->type);
            r.rows = (y + BLOCK < p->cells[1] ? BLOCK : p->cells[1] - y) + 1;
            r.slices = (z + BLOCK < p->cells[2] ? BLOCK : p->cells[2] - z) + 1;
            line(s, &r, y / BLOCK, z / BLOCK);
        }
}

/* ---- codes ---- */

static void own_range(const grid_codes_scratch *s, uint32_t blocks, float own[2]) {
    float lo = INFINITY, hi = -INFINITY;
    for (uint32_t m = 0; m < blocks; m++) {
        lo = s->lo[m] < lo ? s->lo[m] : lo;
        hi = s->hi[m] > hi ? s->hi[m] : hi;
    }
    /* -0 + 0 is +0: so the bytes do not depend on which zero came first. */
    own[0] = lo + 0.0F;
    own[1] = hi + 0.0F;
}

static void encode_blocks(const grid_codes_scratch *s, const quantizer *q, uint32_t blocks,
                          uint8_t *lo, uint8_t *hi) {
    for (uint32_t m = 0; m < blocks; m++) {
        bool empty = s->lo[m] > s->hi[m];
        lo[m] = empty ? 255 : quantizer_floor(q, (double)s->lo[m]);
        hi[m] = empty ? 0 : quantizer_ceil(q, (double)s->hi[m]);
    }
}

static void merge_children(const uint8_t *child_lo, const uint8_t *child_hi, uint32_t nodes,
                           uint8_t *lo, uint8_t *hi) {
    for (uint32_t m = 0; m < nodes; m++) {
        uint8_t a = 255, b = 0;
        for (uint32_t c = 8 * m; c < 8 * m + 8; c++) {
            a = child_lo[c] < a ? child_lo[c] : a;
            b = child_hi[c] > b ? child_hi[c] : b;
        }
        lo[m] = a;
        hi[m] = b;
    }
}

/* Write codes relative to a range, and zeros behind codes and samples. */
static void encode(const leaf_payload *p, sample_type type, const grid_codes_scratch *s,
                   const float range[2], void *payload) {
    const uint32_t blocks = blocks_of(p->node_levels);
    uint8_t *codes = payload, *lo = codes + leaf_codes_at(p->node_levels);
    const quantizer q = quantizer_of(range[0], range[1], type);
    encode_blocks(s, &q, blocks, lo, lo + blocks);
    for (uint32_t k = p->node_levels - 1; k >= 1; k--) {
        const uint32_t nodes = blocks_of(k);
        const uint8_t *below = codes + leaf_codes_at(k + 1);
        uint8_t *here = codes + leaf_codes_at(k);
        merge_children(below, below + 8 * nodes, nodes, here, here + nodes);
    }
    const uint32_t codes_end = leaf_codes_at(p->node_levels + 1);
    const uint32_t samples_end = p->samples_at + (uint32_t)leaf_payload_sample_bytes(p, type);
    memset(codes + codes_end, 0, p->samples_at - codes_end);
    memset(codes + samples_end, 0, leaf_aligned(samples_end) - samples_end);
}

grid_summary grid_codes_make(const leaf_layout *l, uint32_t t, grid_codes_scratch *s,
                             void *payload) {
    const leaf_payload p = leaf_layout_payload(l, t);
    grid_summary summary;
    block_ranges(s, l, &p, (const char *)payload + p.samples_at, &summary.flags);
    own_range(s, blocks_of(p.node_levels), summary.own);
    encode(&p, l->type, s, summary.own, payload);
    return summary;
}

void grid_codes_make_within(const leaf_layout *l, uint32_t t, const float range[2],
                            grid_codes_scratch *s, void *payload) {
    const leaf_payload p = leaf_layout_payload(l, t);
    uint8_t flags;
    block_ranges(s, l, &p, (const char *)payload + p.samples_at, &flags);
    encode(&p, l->type, s, range, payload);
}
