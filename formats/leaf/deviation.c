#include "formats/leaf/deviation.h"

#include <assert.h>
#include <float.h>
#include <math.h>

/* ---- Codes ---- */

uint16_t deviation_code(double d) {
    uint32_t bits;
    if (!(d <= (double)FLT_MAX))
        return DEVIATION_UNKNOWN;
    float f = (float)d;
    if ((double)f < d)
        f = nextafterf(f, INFINITY);
    memcpy(&bits, &f, sizeof bits);
    return (uint16_t)((bits + 0xFFFFu) >> 16);
}

/* ---- Where codes are ---- */

uint64_t deviation_bytes(const leaf_header *h) {
    uint64_t finest = 1;
    if (h->bare)
        return 0;
    for (int a = 0; a < 3; a++)
        finest *= ((h->dims[a] - 2) >> h->cells_log2) + 1;
    const uint64_t sets = (uint64_t)h->fields * h->steps;
    return ((h->treelets - finest) * sets << 3 * (h->cells_log2 - DEVIATION_BRICK_LOG2)) *
           sizeof(uint16_t);
}

static bool has_cells(const leaf_layout *l, const leaf_payload *p, uint32_t i) {
    const uint32_t side = deviation_side(l);
    const uint32_t at[3] = {i % side, i / side % side, i / side / side};
    bool any = true;
    for (int a = 0; a < 3; a++)
        any &= at[a] << DEVIATION_BRICK_LOG2 < p->cells[a];
    return any;
}

bool deviation_has_cells(const leaf_layout *l, uint32_t t, uint32_t brick) {
    const leaf_payload p = leaf_layout_payload(l, t);
    return has_cells(l, &p, brick);
}

bool deviation_sound(const leaf_layout *l, const uint16_t *codes, size_t *brick) {
    const uint32_t bricks = deviation_bricks(l), coarse = l->level[0].first;
    for (uint32_t t = 0; t < coarse; t++) {
        const leaf_payload p = leaf_layout_payload(l, t);
        for (uint32_t i = 0; i < bricks; i++) {
            const unsigned most = has_cells(l, &p, i) ? DEVIATION_UNKNOWN : 0;
            for (uint32_t set = 0; set < l->sets; set++) {
                *brick = deviation_at(l, set, t) + i;
                if (codes[*brick] > most)
                    return false;
            }
        }
    }
    return true;
}

/* The greatest deviation over the cells [first, end) of coarse treelet t. */
static double most_over(const leaf_layout *l, const uint16_t *codes, uint32_t set, uint32_t t,
                        const uint32_t first[3], const uint32_t end[3]) {
    const uint16_t *of = codes + deviation_at(l, set, t);
    uint16_t most = 0;
    for (uint32_t z = first[2]; z < end[2]; z = (z / DEVIATION_BRICK + 1) * DEVIATION_BRICK)
        for (uint32_t y = first[1]; y < end[1]; y = (y / DEVIATION_BRICK + 1) * DEVIATION_BRICK)
            for (uint32_t x = first[0]; x < end[0];
                 x = (x / DEVIATION_BRICK + 1) * DEVIATION_BRICK) {
                const uint16_t code = of[deviation_brick(l, x, y, z)];
                most = code > most ? code : most;
            }
    return deviation_value(most);
}

double deviation_over(const leaf_layout *l, const uint16_t *codes, uint32_t set, uint32_t t,
                      uint32_t k, uint32_t *up) {
    uint32_t place[3], first[3], end[3];
    for (int a = 0; a < 3; a++) {
        const uint64_t from = (uint64_t)l->place[t][a] << l->cells_log2;
        const uint64_t to = from + (1u << l->cells_log2);
        const uint64_t last = to < l->level[0].cells[a] ? to : l->level[0].cells[a];
        place[a] = (uint32_t)(from >> k >> l->cells_log2);
        first[a] = (uint32_t)(from >> k) - (place[a] << l->cells_log2);
        end[a] = (uint32_t)((last - 1) >> k) + 1 - (place[a] << l->cells_log2);
    }
    *up = leaf_layout_find(l, k, place);
    return most_over(l, codes, set, *up, first, end);
}

/* ---- Two levels ---- */

/* The coordinate of a node, also behind the end: as in a level's planes, the last cell of level 0
 * is repeated there. */
static double coordinate(const double *axis, uint32_t last, uint64_t node) {
    return node <= last ? axis[node]
                        : axis[last] + (double)(node - last) * (axis[last] - axis[last - 1]);
}

double deviation_weight(const double *axis, uint32_t last, uint32_t fine, uint32_t i) {
    const double from = coordinate(axis, last, (uint64_t)2 * i << fine);
    const double at = coordinate(axis, last, ((uint64_t)2 * i + 1) << fine);
    const double to = coordinate(axis, last, ((uint64_t)2 * i + 2) << fine);
    return (at - from) / (to - from);
}

/* On each of three axes the weight errs by at most 2^-51. The product with it and two sums err by
 * as much, relative to numbers up to twice the largest value. All that is less than 2^-46 of that
 * value. */
double deviation_rounding(sample_type type, bool rectilinear, const double range[2],
                          uint32_t level) {
    if ((type != SAMPLE_F32 && !rectilinear) || !(range[0] <= range[1]))
        return 0.0;
    return level * 0x1p-45 * fmax(fabs(range[0]), fabs(range[1]));
}

/* ---- Comparing ---- */

enum { COARSE_ROWS = DEVIATION_BRICK + 1 };

/* The greatest differences at the nodes of two rows of bricks, over all their rows of nodes and all
 * slices. Each row of bricks has `row` numbers for even places on x, then `row` for odd ones. For
 * integers on a regular grid, floats hold the differences exactly (17 bits and 3 of fractions).
 * Others are doubles. */
struct deviation_band {
    uint32_t nodes, row;
    bool wide; /* doubles, not floats */
    _Alignas(64) char most[];
};

static uint32_t row_of(uint32_t nodes) {
    return (nodes / 2 + 1 + 15) / 16 * 16;
}

size_t deviation_band_bytes(uint32_t nodes) {
    return sizeof(deviation_band) + 4 * (size_t)row_of(nodes) * sizeof(double);
}

void deviation_band_begin(deviation_band *band, uint32_t nodes) {
    memset(band, 0, deviation_band_bytes(nodes));
    band->nodes = nodes;
    band->row = row_of(nodes);
}

size_t deviation_scratch_bytes(uint32_t nodes) {
    return (COARSE_ROWS + 1) * (size_t)row_of(nodes) * sizeof(double);
}

/* A difference that is not finite counts as infinite; those of integers are always finite. */
#define OF_REAL(A, x)    ((x) <= (A)DBL_MAX ? (x) : (A)INFINITY)
#define OF_INTEGER(A, x) (x)

/* T: the samples' type; A: the type of the arithmetic. */
#define DEFINE_COMPARE(T, A, suffix, FINITE)                                                       \
    /* Interpolate between two coarse rows. */                                                     \
    static void between_##suffix(const T *restrict a, const T *restrict b, A weight,               \
                                 uint32_t count, A *restrict out) {                                \
        for (uint32_t i = 0; i < count; i++)                                                       \
            out[i] = (A)a[i] + weight * ((A)b[i] - (A)a[i]);                                       \
    }                                                                                              \
    static void mix_##suffix(const A *restrict a, const A *restrict b, A weight, uint32_t count,   \
                             A *restrict out) {                                                    \
        for (uint32_t i = 0; i < count; i++)                                                       \
            out[i] = a[i] + weight * (b[i] - a[i]);                                                \
    }                                                                                              \
    static void row_##suffix(const T *restrict fine, const A *restrict coarse,                     \
                             const double *weight, uint32_t nodes, A *restrict even,               \
                             A *restrict odd) {                                                    \
        for (uint32_t i = 0; i < (nodes + 1) / 2; i++) {                                           \
            const A off = (A)fine[2 * i] - coarse[i], x = off < 0 ? -off : off;                    \
            const A y = FINITE(A, x);                                                              \
            even[i] = y > even[i] ? y : even[i];                                                   \
        }                                                                                          \
        for (uint32_t i = 0; i < nodes / 2; i++) {                                                 \
            const A w = weight ? (A)weight[i] : (A)0.5;                                            \
            const A at = coarse[i] + w * (coarse[i + 1] - coarse[i]);                              \
            const A off = (A)fine[2 * i + 1] - at, x = off < 0 ? -off : off;                       \
            const A y = FINITE(A, x);                                                              \
            odd[i] = y > odd[i] ? y : odd[i];                                                      \
        }                                                                                          \
    }                                                                                              \
    static void compare_##suffix(const deviation_slice *s, void *scratch, deviation_band *band) {  \
        const uint32_t width = s->nodes / 2 + 1, row = band->row;                                  \
        A *rows = scratch, *mixed = rows + COARSE_ROWS * row, *most = (A *)(void *)band->most;     \
        for (uint32_t y = 0; y <= s->rows / 2; y++)                                                \
            between_##suffix((const T *)s->coarse[0] + y * s->coarse_row,                          \
                             (const T *)s->coarse[1] + y * s->coarse_row, (A)s->weight_z, width,   \
                             rows + y * row);                                                      \
        for (uint32_t y = 0; y < s->rows; y++) {                                                   \
            const T *fine = (const T *)s->fine + y * s->fine_row;                                  \
            const A *coarse = rows + y / 2 * row;                                                  \
            if (y % 2) {                                                                           \
                mix_##suffix(coarse, coarse + row, s->weight[1] ? (A)s->weight[1][y / 2] : (A)0.5, \
                             width, mixed);                                                        \
                coarse = mixed;                                                                    \
            }                                                                                      \
            if (y <= DEVIATION_BRICK)                                                              \
                row_##suffix(fine, coarse, s->weight[0], s->nodes, most, most + row);              \
            if (y >= DEVIATION_BRICK)                                                              \
                row_##suffix(fine, coarse, s->weight[0], s->nodes, most + 2 * row,                 \
                             most + 3 * row);                                                      \
        }                                                                                          \
    }

DEFINE_COMPARE(uint8_t, float, u8, OF_INTEGER)
DEFINE_COMPARE(int8_t, float, i8, OF_INTEGER)
DEFINE_COMPARE(uint16_t, float, u16, OF_INTEGER)
DEFINE_COMPARE(int16_t, float, i16, OF_INTEGER)
DEFINE_COMPARE(uint8_t, double, u8_wide, OF_INTEGER)
DEFINE_COMPARE(int8_t, double, i8_wide, OF_INTEGER)
DEFINE_COMPARE(uint16_t, double, u16_wide, OF_INTEGER)
DEFINE_COMPARE(int16_t, double, i16_wide, OF_INTEGER)
DEFINE_COMPARE(float, double, f32_wide, OF_REAL)

typedef void (*compare_fn)(const deviation_slice *, void *, deviation_band *);

void deviation_compare(const deviation_slice *s, void *scratch, deviation_band *band) {
    static const compare_fn narrow[] = {[SAMPLE_U8] = compare_u8,
                                        [SAMPLE_I8] = compare_i8,
                                        [SAMPLE_U16] = compare_u16,
                                        [SAMPLE_I16] = compare_i16};
    static const compare_fn wide[] = {[SAMPLE_U8] = compare_u8_wide,
                                      [SAMPLE_I8] = compare_i8_wide,
                                      [SAMPLE_U16] = compare_u16_wide,
                                      [SAMPLE_I16] = compare_i16_wide,
                                      [SAMPLE_F32] = compare_f32_wide};
    assert(s->nodes == band->nodes && s->rows <= 2 * DEVIATION_BRICK + 1);
    band->wide = s->type == SAMPLE_F32 || s->weight[0];
    (band->wide ? wide : narrow)[s->type](s, scratch, band);
}

static double most_of(const deviation_band *band, uint32_t from, uint32_t count) {
    const float *narrow = (const float *)(const void *)band->most;
    const double *wide = (const double *)(const void *)band->most;
    double most = 0.0;
    for (uint32_t i = from; i < from + count; i++)
        most = fmax(most, band->wide ? wide[i] : (double)narrow[i]);
    return most;
}

/* Brick x has the nodes 8 x .. 8 x + 8: five at even places, four at odd ones. */
double deviation_of_brick(const deviation_band *band, uint32_t x, uint32_t y) {
    const uint32_t half = DEVIATION_BRICK / 2, even = 2 * y * band->row;
    const uint32_t evens = (band->nodes + 1) / 2, odds = band->nodes / 2, from = half * x;
    return fmax(most_of(band, even + from, evens - from < half + 1 ? evens - from : half + 1),
                most_of(band, even + band->row + from, odds - from < half ? odds - from : half));
}
