#include "prep/grid/pyramid.h"

#include <assert.h>
#include <math.h>
#include <stdbool.h>
#include <string.h>

enum { TAPS = 5, BAND_ROWS = 16 };

/* Non-finite samples are kept track of beside f32 sums: the weights that went into a sum, and
 * whether its centre is missing. */
enum {
    CENTRE_MISSING = 1 << 15,
    WEIGHT_MASK = CENTRE_MISSING - 1,
    WHOLE_PLANE = 16 * 16,
    WHOLE = 16 * 16 * 16
};

struct pyramid {
    mem *m;
    sample_type type;
    uint32_t fine[3], coarse[3];
    uint32_t fed, done; /* slices: fine ones so far, coarse ones so far */
    /* Fine slices filtered and thinned in x and y: sums in units of 1 / WHOLE_PLANE. Fine slice z
     * is in planes[z % TAPS]. */
    char *planes[TAPS];
    uint16_t *weights[TAPS]; /* f32: valid for the bands that are dirty */
    bool *dirty[TAPS];       /* per band: a non-finite sample went into it */
    /* Per thread: rows filtered and thinned in x; fine row y is in row y % TAPS. */
    char *rows;
    uint16_t *row_weights;
};

/* ---- kernels: one row filtered in x, five rows in y, five in z ---- */

typedef struct kernels {
    size_t sum_size;
    void (*x)(const void *row, uint32_t nodes, void *sums, uint32_t coarse);
    void (*y)(const void *const taps[TAPS], void *sums, uint32_t coarse);
    void (*z)(const void *const taps[TAPS], void *samples, uint32_t coarse);
} kernels;

static uint32_t clamped(int64_t i, uint32_t nodes) {
    return i < 0 ? 0 : i >= nodes ? nodes - 1 : (uint32_t)i;
}

/* The mean of v[0 .. 4] times 16, added from the lowest index up. */
#define WEIGH(S, v0, v1, v2, v3, v4) \
    (((((S)(v0) + (S)4 * (S)(v1)) + (S)6 * (S)(v2)) + (S)4 * (S)(v3)) + (S)(v4))

/* T: the samples' type; P: one that holds sums over a plane; S: one in which sums are taken. */
#define DEFINE_XY(T, P, S, suffix)                                                             \
    static void x_##suffix(const void *from, uint32_t nodes, void *to, uint32_t coarse) {      \
        const T *restrict v = from;                                                            \
        P *restrict sums = to;                                                                 \
        for (uint32_t i = 1; 2 * i + 2 < nodes; i++)                                           \
            sums[i] =                                                                          \
                (P)WEIGH(S, v[2 * i - 2], v[2 * i - 1], v[2 * i], v[2 * i + 1], v[2 * i + 2]); \
        for (uint32_t i = 0; i < coarse; i++) {                                                \
            if (i > 0 && 2 * i + 2 < nodes)                                                    \
                i = (nodes - 1) / 2; /* the first that reaches over the end */                 \
            T e[TAPS];                                                                         \
            for (int d = 0; d < TAPS; d++)                                                     \
                e[d] = v[clamped(2 * (int64_t)i + d - 2, nodes)];                              \
            sums[i] = (P)WEIGH(S, e[0], e[1], e[2], e[3], e[4]);                               \
        }                                                                                      \
    }                                                                                          \
    static void y_##suffix(const void *const taps[TAPS], void *to, uint32_t coarse) {          \
        const P *a = taps[0], *b = taps[1], *c = taps[2], *d = taps[3], *e = taps[4];          \
        P *restrict sums = to;                                                                 \
        for (uint32_t i = 0; i < coarse; i++)                                                  \
            sums[i] = (P)WEIGH(S, a[i], b[i], c[i], d[i], e[i]);                               \
    }

/* Half to even: below a half nothing is carried, above it always, and at it where the quotient is
 * odd. Shifts of negative sums are arithmetic (as gcc and clang have them), so quotients are
 * rounded down first, then up alike. */
#define DEFINE_Z_INTEGER(T, P, S, suffix)                                             \
    static void z_##suffix(const void *const taps[TAPS], void *to, uint32_t coarse) { \
        const P *a = taps[0], *b = taps[1], *c = taps[2], *d = taps[3], *e = taps[4]; \
        T *restrict samples = to;                                                     \
        for (uint32_t i = 0; i < coarse; i++) {                                       \
            S sum = WEIGH(S, a[i], b[i], c[i], d[i], e[i]);                           \
            samples[i] = (T)((sum + (WHOLE / 2 - 1) + ((sum >> 12) & 1)) >> 12);      \
        }                                                                             \
    }

DEFINE_XY(uint8_t, uint16_t, uint32_t, u8)
DEFINE_XY(int8_t, int16_t, int32_t, i8)
DEFINE_XY(uint16_t, uint32_t, uint32_t, u16)
DEFINE_XY(int16_t, int32_t, int32_t, i16)
DEFINE_XY(float, double, double, f32)
DEFINE_Z_INTEGER(uint8_t, uint16_t, uint32_t, u8)
DEFINE_Z_INTEGER(int8_t, int16_t, int32_t, i8)
DEFINE_Z_INTEGER(uint16_t, uint32_t, uint32_t, u16)
DEFINE_Z_INTEGER(int16_t, int32_t, int32_t, i16)

static void z_f32(const void *const taps[TAPS], void *to, uint32_t coarse) {
    const double *a = taps[0], *b = taps[1], *c = taps[2], *d = taps[3], *e = taps[4];
    float *restrict samples = to;
    for (uint32_t i = 0; i < coarse; i++)
        samples[i] = (float)(WEIGH(double, a[i], b[i], c[i], d[i], e[i]) / WHOLE);
}

static const kernels all_kernels[] = {
    [SAMPLE_U8] = {sizeof(uint16_t), x_u8, y_u8, z_u8},
    [SAMPLE_I8] = {sizeof(int16_t), x_i8, y_i8, z_i8},
    [SAMPLE_U16] = {sizeof(uint32_t), x_u16, y_u16, z_u16},
    [SAMPLE_I16] = {sizeof(int32_t), x_i16, y_i16, z_i16},
    [SAMPLE_F32] = {sizeof(double), x_f32, y_f32, z_f32},
};

/* ---- the same with missing samples: sums with their weights ---- */

static const uint16_t tap_weights[TAPS] = {1, 4, 6, 4, 1};

static void x_missing(const float *row, uint32_t nodes, double *sums, uint16_t *weights,
                      uint32_t coarse) {
    for (uint32_t i = 0; i < coarse; i++) {
        double v[TAPS];
        unsigned weight = 0;
        for (int d = 0; d < TAPS; d++) {
            float sample = row[clamped(2 * (int64_t)i + d - 2, nodes)];
            bool there = isfinite(sample);
            v[d] = there ? (double)sample : 0.0;
            weight += there ? tap_weights[d] : 0u;
        }
        sums[i] = WEIGH(double, v[0], v[1], v[2], v[3], v[4]);
        weights[i] =
            (uint16_t)(weight |
                       (isfinite(row[clamped(2 * (int64_t)i, nodes)]) ? 0u : CENTRE_MISSING));
    }
}

static void add_weights(const uint16_t *const taps[TAPS], uint16_t *weights, uint32_t coarse) {
    for (uint32_t i = 0; i < coarse; i++) {
        unsigned weight = 0;
        for (int d = 0; d < TAPS; d++)
            weight += tap_weights[d] * (taps[d][i] & (unsigned)WEIGHT_MASK);
        weights[i] = (uint16_t)(weight | (taps[2][i] & (unsigned)CENTRE_MISSING));
    }
}

/* weights: of each tap, or NULL where nothing is missing. */
static void z_missing(const double *const taps[TAPS], const uint16_t *const weights[TAPS],
                      float *samples, uint32_t coarse) {
    for (uint32_t i = 0; i < coarse; i++) {
        unsigned weight = 0;
        for (int d = 0; d < TAPS; d++)
            weight += tap_weights[d] *
                      (weights[d] ? weights[d][i] & (unsigned)WEIGHT_MASK : (unsigned)WHOLE_PLANE);
        bool missing = weights[2] && (weights[2][i] & CENTRE_MISSING);
        double sum = WEIGH(double, taps[0][i], taps[1][i], taps[2][i], taps[3][i], taps[4][i]);
        samples[i] = missing ? NAN : (float)(sum / weight);
    }
}

/* ---- a band of coarse rows ---- */

typedef struct feeding {
    pyramid *p;
    const char *fine;
    uint32_t count;
    char *coarse;
} feeding;

typedef struct band {
    uint32_t first, last; /* coarse rows, last one not included */
    uint32_t index;
    char *rows; /* TAPS rows of sums */
    uint16_t *row_weights;
} band;

static bool any_non_finite(const float *row, uint32_t nodes) {
    uint32_t found = 0;
    for (uint32_t x = 0; x < nodes; x++) {
        uint32_t bits;
        memcpy(&bits, &row[x], sizeof bits);
        found |= (bits & 0x7F800000u) == 0x7F800000u;
    }
    return found;
}

static bool is_dirty(const pyramid *p, const band *b, const char *slice, size_t row_bytes) {
    if (p->type != SAMPLE_F32)
        return false;
    uint32_t from = clamped(2 * (int64_t)b->first - 2, p->fine[1]);
    uint32_t to = clamped(2 * (int64_t)(b->last - 1) + 2, p->fine[1]);
    for (uint32_t y = from; y <= to; y++)
        if (any_non_finite((const float *)(slice + y * row_bytes), p->fine[0]))
            return true;
    return false;
}

/* Filter and thin the band's part of fine slice z in x and y. */
static void filter_plane(pyramid *p, const band *b, const char *slice, uint32_t z) {
    const kernels *k = &all_kernels[p->type];
    const uint32_t width = p->coarse[0];
    const size_t row_bytes = p->fine[0] * sample_size(p->type), sum_bytes = width * k->sum_size;
    const bool dirty = is_dirty(p, b, slice, row_bytes);
    p->dirty[z % TAPS][b->index] = dirty;
    int64_t filtered = (int64_t)clamped(2 * (int64_t)b->first - 2, p->fine[1]) - 1;
    for (uint32_t j = b->first; j < b->last; j++) {
        const void *taps[TAPS];
        const uint16_t *weights[TAPS];
        for (int d = 0; d < TAPS; d++) {
            uint32_t y = clamped(2 * (int64_t)j + d - 2, p->fine[1]);
            char *sums = b->rows + y % TAPS * sum_bytes;
            uint16_t *row_weights = dirty ? b->row_weights + (size_t)(y % TAPS) * width : NULL;
            if (y > filtered) {
                filtered = y;
                if (dirty)
                    x_missing((const float *)(slice + y * row_bytes), p->fine[0], (double *)sums,
                              row_weights, width);
                else
                    k->x(slice + y * row_bytes, p->fine[0], sums, width);
            }
            taps[d] = sums;
            weights[d] = row_weights;
        }
        k->y(taps, p->planes[z % TAPS] + j * sum_bytes, width);
        if (dirty)
            add_weights(weights, p->weights[z % TAPS] + (size_t)j * width, width);
    }
}

/* The band's part of coarse slice k, from the planes around fine slice 2k. */
static void filter_slice(const pyramid *p, const band *b, uint32_t k, char *slice) {
    const uint32_t width = p->coarse[0];
    const kernels *f = &all_kernels[p->type];
    uint32_t z[TAPS];
    bool dirty = false;
    for (int d = 0; d < TAPS; d++) {
        z[d] = clamped(2 * (int64_t)k + d - 2, p->fine[2]) % TAPS;
        dirty |= p->dirty[z[d]][b->index];
    }
    for (uint32_t j = b->first; j < b->last; j++) {
        const void *taps[TAPS];
        const uint16_t *weights[TAPS];
        for (int d = 0; d < TAPS; d++) {
            taps[d] = p->planes[z[d]] + (size_t)j * width * f->sum_size;
            weights[d] = p->dirty[z[d]][b->index] ? p->weights[z[d]] + (size_t)j * width : NULL;
        }
        char *row = slice + (size_t)j * width * sample_size(p->type);
        if (dirty)
            z_missing((const double *const *)taps, weights, (float *)row, width);
        else
            f->z(taps, row, width);
    }
}

/* Coarse slices that are complete when `seen` fine ones have been: those with all of 2k - 2 .. 2k +
 * 2 among them. */
static uint32_t ready(const pyramid *p, uint32_t seen) {
    return seen == p->fine[2] ? p->coarse[2] : seen ? (seen - 1) / 2 : 0;
}

static status feed_band(void *ctx, size_t index, int worker) {
    const feeding *f = ctx;
    pyramid *p = f->p;
    const size_t size = sample_size(p->type), row_sums = (size_t)TAPS * p->coarse[0];
    const size_t fine_bytes = (size_t)p->fine[0] * p->fine[1] * size;
    const size_t coarse_bytes = (size_t)p->coarse[0] * p->coarse[1] * size;
    uint32_t first = (uint32_t)index * BAND_ROWS, left = p->coarse[1] - first;
    band b = {
        .first = first,
        .last = first + (left < BAND_ROWS ? left : BAND_ROWS),
        .index = (uint32_t)index,
        .rows = p->rows + (size_t)worker * row_sums * all_kernels[p->type].sum_size,
        .row_weights = p->row_weights ? p->row_weights + (size_t)worker * row_sums : NULL,
    };
    uint32_t k = p->done;
    for (uint32_t i = 0; i < f->count; i++) {
        filter_plane(p, &b, f->fine + i * fine_bytes, p->fed + i);
        for (; k < ready(p, p->fed + i + 1); k++)
            filter_slice(p, &b, k, f->coarse + (k - p->done) * coarse_bytes);
    }
    return ST_OK;
}

/* ---- the level ---- */

uint32_t pyramid_coarse(uint32_t fine) {
    return fine / 2 + 1;
}

static uint32_t bands(const uint32_t fine[3]) {
    return (pyramid_coarse(fine[1]) + BAND_ROWS - 1) / BAND_ROWS;
}

uint64_t pyramid_memory(sample_type type, const uint32_t fine[3], int threads) {
    uint64_t width = pyramid_coarse(fine[0]), plane = width * pyramid_coarse(fine[1]);
    uint64_t each = all_kernels[type].sum_size + (type == SAMPLE_F32 ? sizeof(uint16_t) : 0);
    return TAPS * each * (plane + (uint64_t)threads * width) + TAPS * bands(fine) +
           sizeof(pyramid) + 4096;
}

status pyramid_create(mem *m, sample_type type, const uint32_t fine[3], int threads,
                      pyramid **out) {
    assert(type >= SAMPLE_U8 && type <= SAMPLE_F32);
    pyramid *p = mem_zalloc(m, sizeof *p);
    if (!p)
        return ST_NOMEM;
    p->m = m;
    p->type = type;
    for (int a = 0; a < 3; a++) {
        p->fine[a] = fine[a];
        p->coarse[a] = pyramid_coarse(fine[a]);
    }
    const size_t sum_size = all_kernels[type].sum_size, plane = (size_t)p->coarse[0] * p->coarse[1];
    const size_t rows = (size_t)threads * TAPS * p->coarse[0];
    for (int i = 0; i < TAPS; i++) {
        p->planes[i] = mem_array(m, plane, sum_size);
        p->dirty[i] = mem_array(m, bands(fine), sizeof *p->dirty[i]);
        if (type == SAMPLE_F32)
            p->weights[i] = mem_array(m, plane, sizeof *p->weights[i]);
        if (!p->planes[i] || !p->dirty[i] || (type == SAMPLE_F32 && !p->weights[i]))
            goto fail;
    }
    p->rows = mem_array(m, rows, sum_size);
    if (type == SAMPLE_F32)
        p->row_weights = mem_array(m, rows, sizeof *p->row_weights);
    if (!p->rows || (type == SAMPLE_F32 && !p->row_weights))
        goto fail;
    *out = p;
    return ST_OK;
fail:
    pyramid_destroy(p);
    return ST_NOMEM;
}

void pyramid_destroy(pyramid *p) {
    if (!p)
        return;
    for (int i = 0; i < TAPS; i++) {
        mem_free(p->m, p->planes[i]);
        mem_free(p->m, p->dirty[i]);
        mem_free(p->m, p->weights[i]);
    }
    mem_free(p->m, p->rows);
    mem_free(p->m, p->row_weights);
    mem_free(p->m, p);
}

uint32_t pyramid_ready(const pyramid *p, uint32_t count) {
    return ready(p, p->fed + count) - p->done;
}

status pyramid_feed(pyramid *p, pool *workers, const void *fine, uint32_t count, void *coarse) {
    assert(p->fed + count <= p->fine[2]);
    feeding f = {.p = p, .fine = fine, .count = count, .coarse = coarse};
    status st = pool_run(workers, bands(p->fine), feed_band, &f);
    if (st != ST_OK)
        return st;
    p->fed += count;
    p->done = ready(p, p->fed);
    return ST_OK;
}
