#include "prep/grid/deviation_build.h"

#include <math.h>
#include <string.h>

#include "formats/grid/slice_tiles.h"

enum { KEPT = 3, FINE_ROWS = 2 * DEVIATION_BRICK }; /* FINE_ROWS: cells of a band, along y */

struct deviation_build {
    mem *m;
    const leaf_layout *l;
    uint32_t fine, set;
    uint16_t *codes;
    size_t slice_bytes[2]; /* of the fine level; of the coarse level */
    uint32_t bands;
    char *band;    /* one per coarse row of bricks: slices since the last layer of fine bricks */
    char *scratch; /* one per thread */
    double *weights[3];                   /* per axis; NULL: 1/2 */
    uint32_t seen[2];                     /* slices so far */
    uint32_t next;                        /* first fine slice that has not been compared */
    char *kept[KEPT];                     /* from there on, fine slice z is in kept[z % KEPT] */
    char *last;                           /* the last coarse slice */
    uint8_t *kept_busy[KEPT], *last_busy; /* their maps */
};

/* The slices being fed. */
typedef struct feeding {
    deviation_build *b;
    const deviation_slices *fine, *coarse;
    uint32_t until;
} feeding;

/* ---- A layer of fine bricks ---- */

/* Bricks of a level along x, from one treelet to the next. */
typedef struct brick_row {
    const deviation_build *b;
    uint32_t level, y, z;
    uint32_t treelet; /* on x, whose bricks start at `at` */
    uint16_t *at;
} brick_row;

static brick_row brick_row_of(const deviation_build *b, uint32_t level, uint32_t y, uint32_t z) {
    return (brick_row){.b = b, .level = level, .y = y, .z = z, .treelet = UINT32_MAX};
}

/* Where the code of brick x is stored. */
static uint16_t *code_at(brick_row *r, uint32_t x) {
    const leaf_layout *l = r->b->l;
    const uint32_t log2 = l->cells_log2 - DEVIATION_BRICK_LOG2, side = deviation_side(l);
    if (x >> log2 != r->treelet) {
        const uint32_t place[3] = {x >> log2, r->y >> log2, r->z >> log2};
        const uint32_t t = leaf_layout_find(l, r->level, place);
        r->treelet = place[0];
        r->at = r->b->codes + deviation_at(l, r->b->set, t) +
                side * ((r->y & (side - 1)) + side * (r->z & (side - 1)));
    }
    return r->at + (x & (side - 1));
}

static uint32_t bricks_along(const leaf_layout *l, uint32_t level, int axis) {
    return (l->level[level].cells[axis] + DEVIATION_BRICK - 1) / DEVIATION_BRICK;
}

/* Fold layer z of a band's fine bricks, which is complete, into the codes of the coarse level. */
static void fold(const deviation_build *b, uint32_t index, const deviation_band *band, uint32_t z) {
    const uint32_t rows = bricks_along(b->l, b->fine, 1), width = bricks_along(b->l, b->fine, 0);
    brick_row above = brick_row_of(b, b->fine + 1, index, z / 2);
    for (uint32_t row = 0; row < 2 && 2 * index + row < rows; row++) {
        brick_row below = brick_row_of(b, b->fine, 2 * index + row, z);
        for (uint32_t x = 0; x < width; x++) {
            double most = deviation_of_brick(band, x, row);
            if (b->fine > 0)
                most += deviation_value(*code_at(&below, x));
            const uint16_t code = deviation_code(most);
            uint16_t *to = code_at(&above, x / 2);
            *to = code > *to ? code : *to;
        }
    }
}

/* ---- Slices ---- */

static const char *fine_slice(const feeding *f, uint32_t z) {
    const deviation_build *b = f->b;
    return z < b->seen[0] ? b->kept[z % KEPT]
                          : f->fine->samples + (z - b->seen[0]) * b->slice_bytes[0];
}

static const char *coarse_slice(const feeding *f, uint32_t z) {
    const deviation_build *b = f->b;
    return z < b->seen[1] ? b->last : f->coarse->samples + (z - b->seen[1]) * b->slice_bytes[1];
}

/* The map of a slice of the fine level (0) or the coarse one (1); NULL: all tiles are busy. */
static const uint8_t *map_of(const feeding *f, uint32_t coarse, uint32_t z) {
    const deviation_build *b = f->b;
    const deviation_slices *fed = coarse ? f->coarse : f->fine;
    if (z < b->seen[coarse])
        return coarse ? b->last_busy : b->kept_busy[z % KEPT];
    const size_t tiles = slice_tiles_count(b->l->level[b->fine + coarse].dims);
    return fed->busy ? fed->busy + (z - b->seen[coarse]) * tiles : NULL;
}

/* Whether rows [from, to] of a coarse slice have a busy tile. */
static bool rows_busy(const feeding *f, uint32_t z, uint32_t from, uint32_t to) {
    const uint8_t *busy = map_of(f, 1, z);
    bool any = !busy;
    for (uint32_t row = from / SLICE_TILE; !any && row <= to / SLICE_TILE; row++)
        any = slice_tiles_row_busy(f->b->l->level[f->b->fine + 1].dims, busy, row);
    return any;
}

/* Whether a band of fine slice z has but the quiet value, as the coarse slices around it have:
 * there is no difference then. Where these are quiet, the fine slice is. */
static bool band_quiet(const feeding *f, uint32_t row, uint32_t rows, uint32_t z) {
    const uint32_t first = row / 2, last = first + rows / 2;
    return !rows_busy(f, z / 2, first, last) && !rows_busy(f, (z + 1) / 2, first, last);
}

static status feed_band(void *ctx, size_t index, int worker) {
    const feeding *f = ctx;
    const deviation_build *b = f->b;
    const leaf_level *fine = &b->l->level[b->fine], *coarse = &b->l->level[b->fine + 1];
    const size_t size = sample_size(b->l->type), row = index * FINE_ROWS;
    const uint32_t left = fine->dims[1] - (uint32_t)row;
    deviation_band *band =
        (deviation_band *)(void *)(b->band + index * deviation_band_bytes(fine->dims[0]));
    char *scratch = b->scratch + (size_t)worker * deviation_scratch_bytes(fine->dims[0]);
    deviation_slice s = {.type = b->l->type,
                         .nodes = fine->dims[0],
                         .rows = left < FINE_ROWS + 1 ? left : FINE_ROWS + 1,
                         .fine_row = fine->dims[0],
                         .coarse_row = coarse->dims[0],
                         .weight = {b->weights[0], b->weights[1]}};
    if (s.weight[1])
        s.weight[1] += row / 2;
    for (uint32_t z = b->next; z < f->until; z++) {
        const bool last = z + 1 == fine->dims[2];
        const bool quiet = band_quiet(f, (uint32_t)row, s.rows, z);
        s.fine = fine_slice(f, z) + row * fine->dims[0] * size;
        for (uint32_t k = 0; k < 2; k++)
            s.coarse[k] = coarse_slice(f, (z + k) / 2) + row / 2 * coarse->dims[0] * size;
        s.weight_z = z % 2 == 0 ? 0.0 : b->weights[2] ? b->weights[2][z / 2] : 0.5;
        if (!quiet)
            deviation_compare(&s, scratch, band);
        if (z == 0 || (z % DEVIATION_BRICK && !last))
            continue;
        fold(b, (uint32_t)index, band, (z - 1) / DEVIATION_BRICK);
        deviation_band_begin(band, fine->dims[0]);
        if (!last && !quiet) /* it is the first one of the next layer, too */
            deviation_compare(&s, scratch, band);
    }
    return ST_OK;
}

/* Keep a slice with its map. */
static void keep_slice(const deviation_build *b, uint32_t coarse, const char *slice,
                       const uint8_t *busy, char *to, uint8_t *to_busy) {
    const uint32_t *dims = b->l->level[b->fine + coarse].dims;
    if (busy) {
        slice_tiles_copy(dims, sample_size(b->l->type), slice, busy, to, to_busy);
        return;
    }
    memcpy(to, slice, b->slice_bytes[coarse]);
    memset(to_busy, 1, slice_tiles_count(dims));
}

/* Keep the slices that later ones will be compared with. */
static void keep(const feeding *f) {
    const deviation_build *b = f->b;
    for (uint32_t z = f->until; z < b->seen[0] + f->fine->count; z++)
        if (z >= b->seen[0])
            keep_slice(b, 0, fine_slice(f, z), map_of(f, 0, z), b->kept[z % KEPT],
                       b->kept_busy[z % KEPT]);
    if (f->coarse->count > 0) {
        const uint32_t z = b->seen[1] + f->coarse->count - 1;
        keep_slice(b, 1, coarse_slice(f, z), map_of(f, 1, z), b->last, b->last_busy);
    }
}

status deviation_build_feed(deviation_build *b, pool *workers, const deviation_slices *fine,
                            const deviation_slices *coarse) {
    const uint32_t all = b->l->level[b->fine].dims[2], there = b->seen[1] + coarse->count;
    const uint32_t have = b->seen[0] + fine->count;
    /* Fine slices up to the one that lies on the last coarse slice can be compared. */
    uint32_t until = there > 0 ? 2 * there - 1 : 0;
    until = until < have ? until : have;
    const feeding f = {b, fine, coarse, until < all ? until : all};
    const status st = pool_run(workers, b->bands, feed_band, (void *)&f);
    if (st != ST_OK)
        return st;
    keep(&f);
    b->next = f.until;
    b->seen[0] = have;
    b->seen[1] = there;
    return ST_OK;
}

/* ---- The level ---- */

static uint32_t bands_of(const leaf_layout *l, uint32_t fine) {
    return bricks_along(l, fine + 1, 1);
}

static size_t slice_bytes(const leaf_layout *l, uint32_t level) {
    return (size_t)l->level[level].dims[0] * l->level[level].dims[1] * sample_size(l->type);
}

static size_t map_bytes(const leaf_layout *l, uint32_t level) {
    return slice_tiles_count(l->level[level].dims);
}

uint64_t deviation_build_memory(const leaf_layout *l, uint32_t fine, bool rectilinear,
                                int threads) {
    const leaf_level *v = &l->level[fine];
    uint64_t bytes = sizeof(deviation_build) + 4096 +
                     KEPT * (uint64_t)(slice_bytes(l, fine) + map_bytes(l, fine)) +
                     slice_bytes(l, fine + 1) + map_bytes(l, fine + 1) +
                     bands_of(l, fine) * (uint64_t)deviation_band_bytes(v->dims[0]) +
                     (uint64_t)threads * deviation_scratch_bytes(v->dims[0]);
    for (int a = 0; a < 3 && rectilinear; a++)
        bytes += v->dims[a] * sizeof(double);
    return bytes;
}

static status make_weights(deviation_build *b, const grid *g) {
    for (int a = 0; a < 3 && grid_is_rectilinear(g); a++) {
        const uint32_t cells = b->l->level[b->fine + 1].cells[a];
        b->weights[a] = mem_array(b->m, cells, sizeof *b->weights[a]);
        if (!b->weights[a])
            return ST_NOMEM;
        for (uint32_t i = 0; i < cells; i++)
            b->weights[a][i] = deviation_weight(g->axis[a], g->dims[a] - 1, b->fine, i);
    }
    return ST_OK;
}

/* A map of a slice that is not there yet: all tiles are busy. */
static uint8_t *make_map(const deviation_build *b, uint32_t coarse) {
    const size_t bytes = map_bytes(b->l, b->fine + coarse);
    uint8_t *map = mem_alloc(b->m, bytes);
    if (map)
        memset(map, 1, bytes);
    return map;
}

static status allocate(deviation_build *b, const grid *g, int threads) {
    const uint32_t nodes = b->l->level[b->fine].dims[0];
    const size_t bytes = deviation_band_bytes(nodes);
    b->band = mem_alloc(b->m, b->bands * bytes);
    b->scratch = mem_alloc(b->m, (size_t)threads * deviation_scratch_bytes(nodes));
    b->last = mem_alloc(b->m, b->slice_bytes[1]);
    b->last_busy = make_map(b, 1);
    if (!b->band || !b->scratch || !b->last || !b->last_busy)
        return ST_NOMEM;
    for (uint32_t i = 0; i < b->bands; i++)
        deviation_band_begin((deviation_band *)(void *)(b->band + i * bytes), nodes);
    for (int i = 0; i < KEPT; i++) {
        b->kept[i] = mem_alloc(b->m, b->slice_bytes[0]);
        b->kept_busy[i] = make_map(b, 0);
        if (!b->kept[i] || !b->kept_busy[i])
            return ST_NOMEM;
    }
    return make_weights(b, g);
}

status deviation_build_create(mem *m, const leaf_layout *l, uint32_t fine, uint32_t set,
                              const grid *g, int threads, uint16_t *codes, deviation_build **out) {
    deviation_build *b = mem_zalloc(m, sizeof *b);
    if (!b)
        return ST_NOMEM;
    b->m = m;
    b->l = l;
    b->fine = fine;
    b->set = set;
    b->codes = codes;
    b->bands = bands_of(l, fine);
    for (uint32_t i = 0; i < 2; i++)
        b->slice_bytes[i] = slice_bytes(l, fine + i);
    if (allocate(b, g, threads) != ST_OK) {
        deviation_build_destroy(b);
        return ST_NOMEM;
    }
    *out = b;
    return ST_OK;
}

void deviation_build_destroy(deviation_build *b) {
    if (!b)
        return;
    for (int i = 0; i < KEPT; i++) {
        mem_free(b->m, b->kept[i]);
        mem_free(b->m, b->kept_busy[i]);
    }
    mem_free(b->m, b->last_busy);
    for (int a = 0; a < 3; a++)
        mem_free(b->m, b->weights[a]);
    mem_free(b->m, b->band);
    mem_free(b->m, b->scratch);
    mem_free(b->m, b->last);
    mem_free(b->m, b);
}

status deviation_build_keep(deviation_build *b, state_io *io) {
    const leaf_level *v = &b->l->level[b->fine];
    status st = STATE_IO(io, b->seen);
    if (st == ST_OK)
        st = STATE_IO(io, b->next);
    if (st == ST_OK && (b->seen[0] > v->dims[2] || b->seen[1] > v[1].dims[2] ||
                        b->next > b->seen[0] || b->seen[0] - b->next > KEPT))
        return state_io_fault(io);
    if (st == ST_OK)
        st = state_io_bytes(io, b->band, b->bands * deviation_band_bytes(v->dims[0]));
    for (int i = 0; i < KEPT && st == ST_OK; i++)
        st = state_io_bytes(io, b->kept[i], b->slice_bytes[0]);
    return st == ST_OK ? state_io_bytes(io, b->last, b->slice_bytes[1]) : st;
}

void deviation_build_end(const leaf_layout *l, uint32_t set, bool rectilinear,
                         const double range[2], uint16_t *codes) {
    for (uint32_t level = 1; level < l->levels; level++) {
        const double rounding = deviation_rounding(l->type, rectilinear, range, level);
        const leaf_level *v = &l->level[level];
        if (rounding == 0.0)
            continue;
        for (uint32_t t = v->first; t < v->first + v->count; t++)
            for (uint32_t i = 0; i < deviation_bricks(l); i++) {
                uint16_t *code = codes + deviation_at(l, set, t) + i;
                if (deviation_has_cells(l, t, i))
                    *code = deviation_code(deviation_value(*code) + rounding);
            }
    }
}
