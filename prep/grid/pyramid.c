#include "prep/grid/pyramid.h"

#include <assert.h>
#include <math.h>
#include <stdbool.h>
#include <string.h>

#include "formats/grid/slice_tiles.h"
#include "prep/grid/pyramid_rows.h"

enum { TAPS = PYRAMID_TAPS, BAND_ROWS = SLICE_TILE };

/* For f32, each sum has a mark for non-finite samples: the weights that went into the sum, and
 * whether its centre is missing. */
enum { CENTRE_MISSING = 1 << 15, WEIGHT_MASK = CENTRE_MISSING - 1, WHOLE_PLANE = 16 * 16 };

struct pyramid {
    mem *m;
    sample_type type;
    bool colours;
    const pyramid_rows *rows_of;
    uint32_t fine[3], coarse[3];
    uint32_t fed, done; /* fine slices so far; coarse slices so far */
    /* Fine slices filtered and thinned in x and y: sums in units of 1 / WHOLE_PLANE. Fine slice z
     * is in planes[z % TAPS]. */
    char *planes[TAPS];
    uint16_t *weights[TAPS]; /* f32: valid for dirty bands only */
    bool *dirty[TAPS];       /* per band: a non-finite sample went into it */
    /* With maps of busy tiles: maps of the planes, whose tiles are as wide as bands are high; and
     * the quiet value as a sum in planes and as a sample. */
    uint8_t *busy[TAPS];
    uint8_t quiet_sum[SLICE_SAMPLE_MAX], quiet[SLICE_SAMPLE_MAX];
    /* Per thread: rows filtered and thinned in x; fine row y is in row y % TAPS. */
    char *rows;
    uint16_t *row_weights;
};

static uint32_t clamped(int64_t i, uint32_t nodes) {
    return i < 0 ? 0 : i >= nodes ? nodes - 1 : (uint32_t)i;
}

/* ---- the same with missing samples: sums and their weights ---- */

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
        sums[i] = PYRAMID_WEIGH(double, v[0], v[1], v[2], v[3], v[4]);
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

/* weights: of each tap; NULL: nothing is missing there. */
static void z_missing(const double *const taps[TAPS], const uint16_t *const weights[TAPS],
                      float *samples, uint32_t coarse) {
    for (uint32_t i = 0; i < coarse; i++) {
        unsigned weight = 0;
        for (int d = 0; d < TAPS; d++)
            weight += tap_weights[d] *
                      (weights[d] ? weights[d][i] & (unsigned)WEIGHT_MASK : (unsigned)WHOLE_PLANE);
        bool missing = weights[2] && (weights[2][i] & CENTRE_MISSING);
        double sum =
            PYRAMID_WEIGH(double, taps[0][i], taps[1][i], taps[2][i], taps[3][i], taps[4][i]);
        const bool same = taps[0][i] == taps[1][i] && taps[1][i] == taps[2][i] &&
                          taps[2][i] == taps[3][i] && taps[3][i] == taps[4][i];
        const float mean = (float)(sum / weight);
        samples[i] = missing ? NAN : same ? mean : pyramid_rows_shorten(mean);
    }
}

/* ---- a band of coarse rows ---- */

typedef struct feeding {
    pyramid *p;
    const char *fine;
    const uint8_t *busy; /* NULL: there are no maps */
    uint32_t count;
    char *coarse;
    uint8_t *coarse_busy;
} feeding;

typedef struct band {
    uint32_t first, last; /* coarse rows [first, last) */
    uint32_t index;
    uint32_t tiles, fine_tiles[2]; /* coarse tiles along x; fine tiles along x and y */
    char *rows;                    /* TAPS rows of sums */
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

/* The fine rows that a band's coarse rows depend on. */
static void fine_rows(const pyramid *p, const band *b, uint32_t *from, uint32_t *to) {
    *from = clamped(2 * (int64_t)b->first - 2, p->fine[1]);
    *to = clamped(2 * (int64_t)(b->last - 1) + 2, p->fine[1]);
}

/* Returns whether a sample of the band is not finite. busy: the slice's map, or NULL; quiet tiles
 * are finite. */
static bool is_dirty(const pyramid *p, const band *b, const char *slice, const uint8_t *busy) {
    const size_t row = p->fine[0];
    uint32_t from, to;
    fine_rows(p, b, &from, &to);
    if (p->type != SAMPLE_F32 || p->colours)
        return false;
    for (uint32_t y = from; y <= to; y++) {
        const float *samples = (const float *)(const void *)slice + y * row;
        if (!busy && any_non_finite(samples, p->fine[0]))
            return true;
        for (uint32_t i = 0; busy && i < b->fine_tiles[0]; i++) {
            const size_t tile = (size_t)(y / SLICE_TILE) * b->fine_tiles[0] + i;
            const slice_tile t = slice_tiles_at(p->fine, tile);
            if (busy[tile] && any_non_finite(samples + t.x, t.end_x - t.x))
                return true;
        }
    }
    return false;
}

/* ---- tiles that are quiet are left out ---- */

static uint32_t at_most(uint32_t i, uint32_t most) {
    return i < most ? i : most;
}

/* Returns whether a coarse tile of the band depends on a busy tile of a fine slice. */
static bool reaches_busy(const band *b, const uint8_t *busy, uint32_t tile) {
    const uint32_t x0 = tile ? 2 * tile - 1 : 0, x1 = at_most(2 * tile + 2, b->fine_tiles[0] - 1);
    const uint32_t y0 = b->index ? 2 * b->index - 1 : 0,
                   y1 = at_most(2 * b->index + 2, b->fine_tiles[1] - 1);
    uint32_t any = 0;
    for (uint32_t y = y0; y <= y1; y++)
        for (uint32_t x = x0; x <= x1; x++)
            any |= busy[(size_t)y * b->fine_tiles[0] + x];
    return any;
}

/* Make a tile of the band quiet, in a slice or plane of `size` bytes per node. */
static void quieten(const pyramid *p, const band *b, uint32_t tile, size_t size, const void *value,
                    char *to, uint8_t *busy) {
    if (*busy) {
        const slice_tile t = slice_tiles_at(p->coarse, (size_t)b->index * b->tiles + tile);
        slice_tiles_fill(p->coarse, &t, size, value, to);
    }
    *busy = 0;
}

/* Find the run of coarse nodes in consecutive busy tiles from `tile` on. Returns the tile behind
 * it. */
static uint32_t busy_run(const pyramid *p, const band *b, const uint8_t *busy, uint32_t tile,
                         uint32_t run[2]) {
    run[0] = at_most(tile * SLICE_TILE, p->coarse[0]);
    while (tile < b->tiles && busy[tile])
        tile++;
    run[1] = at_most(tile * SLICE_TILE, p->coarse[0]);
    return tile;
}

/* ---- planes and slices ---- */

/* Filter and thin fine slice z in x and y: coarse nodes [run[0], run[1]) of the band. */
static void filter_run(pyramid *p, const band *b, const char *slice, uint32_t z, bool dirty,
                       const uint32_t run[2]) {
    const pyramid_rows *k = p->rows_of;
    const uint32_t width = p->coarse[0];
    const size_t row_bytes = p->fine[0] * sample_size(p->type), sum_bytes = width * k->sum_size;
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
                    k->x(slice + y * row_bytes, p->fine[0], sums, run[0], run[1]);
            }
            taps[d] = sums;
            weights[d] = row_weights;
        }
        k->y(taps, p->planes[z % TAPS] + j * sum_bytes, run[0], run[1]);
        if (dirty)
            add_weights(weights, p->weights[z % TAPS] + (size_t)j * width, width);
    }
}

/* Filter the band's part of fine slice z. */
static void filter_plane(pyramid *p, const band *b, const char *slice, const uint8_t *busy,
                         uint32_t z) {
    const bool dirty = is_dirty(p, b, slice, busy);
    uint32_t run[2] = {0, p->coarse[0]};
    p->dirty[z % TAPS][b->index] = dirty;
    if (!busy || dirty)
        filter_run(p, b, slice, z, dirty, run);
    if (!busy)
        return;
    uint8_t *map = p->busy[z % TAPS] + (size_t)b->index * b->tiles;
    for (uint32_t i = 0; i < b->tiles; i++) {
        if (dirty || reaches_busy(b, busy, i))
            map[i] = 1;
        else
            quieten(p, b, i, p->rows_of->sum_size, p->quiet_sum, p->planes[z % TAPS], &map[i]);
    }
    for (uint32_t i = 0; !dirty && i < b->tiles; i++) {
        i = busy_run(p, b, map, i, run);
        if (run[0] < run[1])
            filter_run(p, b, slice, z, false, run);
    }
}

/* Filter in z, from planes z: coarse nodes of a run of the band's part of a coarse slice. */
static void sum_planes(const pyramid *p, const band *b, const uint32_t z[TAPS], bool dirty,
                       const uint32_t run[2], char *slice) {
    const uint32_t width = p->coarse[0];
    const pyramid_rows *f = p->rows_of;
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
            f->z(taps, row, run[0], run[1]);
    }
}

/* Make the band's part of coarse slice k, from the planes around fine slice 2k. */
static void filter_slice(const pyramid *p, const band *b, uint32_t k, char *slice, uint8_t *busy) {
    uint32_t z[TAPS], run[2] = {0, p->coarse[0]};
    bool dirty = false;
    for (int d = 0; d < TAPS; d++) {
        z[d] = clamped(2 * (int64_t)k + d - 2, p->fine[2]) % TAPS;
        dirty |= p->dirty[z[d]][b->index];
    }
    if (!busy || dirty)
        sum_planes(p, b, z, dirty, run, slice);
    if (!busy)
        return;
    uint8_t *map = busy + (size_t)b->index * b->tiles;
    for (uint32_t i = 0; i < b->tiles; i++) {
        uint32_t any = dirty;
        for (int d = 0; d < TAPS; d++)
            any |= p->busy[z[d]][(size_t)b->index * b->tiles + i];
        if (any)
            map[i] = 1;
        else
            quieten(p, b, i, sample_size(p->type), p->quiet, slice, &map[i]);
    }
    for (uint32_t i = 0; !dirty && i < b->tiles; i++) {
        i = busy_run(p, b, map, i, run);
        if (run[0] < run[1])
            sum_planes(p, b, z, false, run, slice);
    }
}

/* Number of coarse slices that are complete after `seen` fine ones: slice k needs fine slices 2k -
 * 2 .. 2k + 2. */
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
        .tiles = slice_tiles_along(p->coarse[0]),
        .fine_tiles = {slice_tiles_along(p->fine[0]), slice_tiles_along(p->fine[1])},
        .rows = p->rows + (size_t)worker * row_sums * p->rows_of->sum_size,
        .row_weights = p->row_weights ? p->row_weights + (size_t)worker * row_sums : NULL,
    };
    uint32_t k = p->done;
    for (uint32_t i = 0; i < f->count; i++) {
        const uint8_t *busy = f->busy ? f->busy + i * slice_tiles_count(p->fine) : NULL;
        filter_plane(p, &b, f->fine + i * fine_bytes, busy, p->fed + i);
        for (; k < ready(p, p->fed + i + 1); k++) {
            uint8_t *map =
                f->busy ? f->coarse_busy + (k - p->done) * slice_tiles_count(p->coarse) : NULL;
            filter_slice(p, &b, k, f->coarse + (k - p->done) * coarse_bytes, map);
        }
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
    uint64_t each =
        pyramid_rows_for(CPU_SCALAR, type)->sum_size + (type == SAMPLE_F32 ? sizeof(uint16_t) : 0);
    return TAPS * each * (plane + (uint64_t)threads * width) + TAPS * bands(fine) +
           TAPS * (uint64_t)slice_tiles_along((uint32_t)width) * bands(fine) + sizeof(pyramid) +
           4096;
}

status pyramid_create(mem *m, sample_type type, bool colours, const uint32_t fine[3], int threads,
                      pyramid **out) {
    assert(type >= SAMPLE_U8 && type <= SAMPLE_F32 && (!colours || type == SAMPLE_F32));
    pyramid *p = mem_zalloc(m, sizeof *p);
    if (!p)
        return ST_NOMEM;
    p->m = m;
    p->type = type;
    p->colours = colours;
    for (int a = 0; a < 3; a++) {
        p->fine[a] = fine[a];
        p->coarse[a] = pyramid_coarse(fine[a]);
    }
    p->rows_of = colours ? pyramid_rows_of_colours() : pyramid_rows_for(cpu_best(), type);
    const size_t sum_size = p->rows_of->sum_size, plane = (size_t)p->coarse[0] * p->coarse[1];
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
        mem_free(p->m, p->busy[i]);
    }
    mem_free(p->m, p->rows);
    mem_free(p->m, p->row_weights);
    mem_free(p->m, p);
}

uint32_t pyramid_ready(const pyramid *p, uint32_t count) {
    return ready(p, p->fed + count) - p->done;
}

/* The kernels compute the quiet sum, so that it has the same bits. */
status pyramid_quiet(pyramid *p, const void *sample) {
    const pyramid_rows *k = p->rows_of;
    const size_t size = sample_size(p->type), tiles = slice_tiles_count(p->coarse);
    double sums[TAPS], plane[TAPS];
    char row[TAPS * SLICE_SAMPLE_MAX];
    for (size_t i = 0; i < TAPS; i++)
        memcpy(row + i * size, sample, size);
    k->x(row, TAPS, sums, 0, 1);
    const void *const taps[TAPS] = {sums, sums, sums, sums, sums};
    k->y(taps, plane, 0, 1);
    memcpy(p->quiet_sum, plane, k->sum_size);
    memcpy(p->quiet, sample, size);
    for (int i = 0; i < TAPS; i++) {
        p->busy[i] = mem_alloc(p->m, tiles);
        if (!p->busy[i])
            return ST_NOMEM;
        memset(p->busy[i], 1, tiles);
    }
    return ST_OK;
}

status pyramid_feed(pyramid *p, pool *workers, const void *fine, const uint8_t *busy,
                    uint32_t count, void *coarse, uint8_t *coarse_busy) {
    assert(p->fed + count <= p->fine[2] && (!busy || p->busy[0]));
    feeding f = {.p = p,
                 .fine = fine,
                 .busy = busy,
                 .count = count,
                 .coarse = coarse,
                 .coarse_busy = coarse_busy};
    status st = pool_run(workers, bands(p->fine), feed_band, &f);
    if (st != ST_OK)
        return st;
    p->fed += count;
    p->done = ready(p, p->fed);
    return ST_OK;
}

/* Save or load plane i of the window. */
static status keep_plane(pyramid *p, state_io *io, int i) {
    const size_t plane = (size_t)p->coarse[0] * p->coarse[1];
    status st = state_io_bytes(io, p->planes[i], plane * p->rows_of->sum_size);
    if (st == ST_OK)
        st = state_io_bytes(io, p->dirty[i], bands(p->fine) * sizeof *p->dirty[i]);
    if (st == ST_OK && p->weights[i])
        st = state_io_bytes(io, p->weights[i], plane * sizeof *p->weights[i]);
    if (st == ST_OK && p->busy[i])
        st = state_io_bytes(io, p->busy[i], slice_tiles_count(p->coarse));
    return st;
}

status pyramid_keep(pyramid *p, state_io *io) {
    bool maps = p->busy[0] != NULL;
    status st = STATE_IO(io, maps);
    if (st == ST_OK)
        st = STATE_IO(io, p->fed);
    if (st == ST_OK && (maps != (p->busy[0] != NULL) || p->fed > p->fine[2]))
        return state_io_fault(io);
    p->done = ready(p, p->fed);
    for (int i = 0; i < TAPS && st == ST_OK; i++)
        st = keep_plane(p, io, i);
    return st;
}
