#include "formats/leaf/live_samples.h"

#include <assert.h>
#include <math.h>
#include <string.h>

enum {
    PIECES = 8, /* of a block: bit a: only its first plane along axis a */
    ROW_KINDS = 4,
    ROW_BLOCKS = LIVE_ROW_MAX / LIVE_BLOCK
};

typedef struct live_block {
    uint64_t changed;            /* the writing that it changed with last */
    uint64_t have[LIVE_BUFFERS]; /* ... and what it is like in each buffer */
    live_range pieces[PIECES];
} live_block;

/* What a thread needs. */
typedef struct live_scratch {
    live_extent
        extent[ROW_KINDS]; /* of rows: bit 0: those at the block's first y, bit 1: first z */
    _Alignas(64) char row[LIVE_ROW_MAX * sizeof(double)];
    bool same[ROW_BLOCKS]; /* per block of a row: nothing has changed in it so far */
} live_scratch;

struct live_samples {
    mem *m;
    pool *threads;
    const live_rows *rows;
    sample_type type;
    size_t width;               /* bytes of a sample */
    uint32_t dims[3], count[3]; /* nodes and blocks per axis */
    size_t stride[3];           /* bytes to the next sample along each axis */
    uint64_t writing;           /* number of the present one, from 1 on */
    char *buffer[LIVE_BUFFERS];
    live_block *blocks;
    live_scratch *scratch; /* per thread */
};

/* ---- Making ---- */

status live_samples_create(mem *m, const uint32_t dims[3], sample_type type, cpu_isa isa,
                           int threads, live_samples **out) {
    live_samples *s = mem_zalloc(m, sizeof *s);
    if (!s)
        return ST_NOMEM;
    *s = (live_samples){.m = m,
                        .rows = live_rows_for(isa, type),
                        .type = type,
                        .width = sample_size(type),
                        .writing = 1};
    size_t blocks = 1, bytes = s->width;
    for (int a = 0; a < 3; a++) {
        s->dims[a] = dims[a];
        s->count[a] = (dims[a] + LIVE_BLOCK - 1) / LIVE_BLOCK;
        s->stride[a] = bytes;
        bytes *= dims[a];
        blocks *= s->count[a];
    }
    s->blocks = mem_array(m, blocks, sizeof *s->blocks);
    s->scratch = mem_array(m, (size_t)threads, sizeof *s->scratch);
    bool whole = s->blocks && s->scratch;
    for (int b = 0; b < LIVE_BUFFERS && whole; b++)
        whole = (s->buffer[b] = mem_zalloc(m, bytes)) != NULL;
    for (int i = 0; i < threads && whole; i++)
        s->scratch[i].extent[0].part = LIVE_PART;
    const status st = whole ? pool_create(m, threads, &s->threads) : ST_NOMEM;
    if (st != ST_OK) {
        live_samples_destroy(s);
        return st;
    }
    *out = s;
    return ST_OK;
}

void live_samples_destroy(live_samples *s) {
    if (!s)
        return;
    pool_destroy(s->threads);
    for (int b = 0; b < LIVE_BUFFERS; b++)
        mem_free(s->m, s->buffer[b]);
    mem_free(s->m, s->scratch);
    mem_free(s->m, s->blocks);
    mem_free(s->m, s);
}

static live_block *block_at(const live_samples *s, uint32_t x, uint32_t y, uint32_t z) {
    return &s->blocks[((size_t)z * s->count[1] + y) * s->count[0] + x];
}

static char *sample_at(const live_samples *s, int buffer, uint32_t x, uint32_t y, uint32_t z) {
    return s->buffer[buffer] + x * s->stride[0] + y * s->stride[1] + z * s->stride[2];
}

/* ---- Rows of blocks ---- */

/* A row of blocks along x, of at most ROW_BLOCKS: what one thread does at a time. */
typedef struct block_row {
    uint32_t block[3], blocks;  /* the first one, how many there are */
    uint32_t first[3], size[3]; /* the nodes that they have */
} block_row;

static block_row row_of(const live_samples *s, uint32_t x, uint32_t blocks, uint32_t y,
                        uint32_t z) {
    block_row r = {.block = {x, y, z}, .blocks = blocks};
    const uint32_t along[3] = {blocks, 1, 1};
    for (int a = 0; a < 3; a++) {
        const uint32_t end = (r.block[a] + along[a]) << LIVE_BLOCK_LOG2;
        r.first[a] = r.block[a] << LIVE_BLOCK_LOG2;
        r.size[a] = (end < s->dims[a] ? end : s->dims[a]) - r.first[a];
    }
    return r;
}

/* Bring one block of a row up to date in a buffer, from the other. */
static void renew(live_samples *s, int buffer, const block_row *r, uint32_t i) {
    live_block *b = block_at(s, r->block[0] + i, r->block[1], r->block[2]);
    if (b->have[buffer] == b->changed)
        return;
    const block_row one = row_of(s, r->block[0] + i, 1, r->block[1], r->block[2]);
    for (uint32_t z = one.first[2]; z < one.first[2] + one.size[2]; z++)
        for (uint32_t y = one.first[1]; y < one.first[1] + one.size[1]; y++)
            memcpy(sample_at(s, buffer, one.first[0], y, z),
                   sample_at(s, !buffer, one.first[0], y, z), one.size[0] * s->width);
    b->have[buffer] = b->changed;
}

/* ---- Putting a region ---- */

typedef struct putting {
    live_samples *s;
    const live_region *r;
    int buffer;
    uint32_t low[3], count[3]; /* the blocks that it touches; along x, pieces of ROW_BLOCKS */
    uint32_t blocks;           /* that it touches along x */
} putting;

static bool within(const live_region *r, int a, uint32_t first, uint32_t size) {
    return first >= r->first[a] && first + size <= r->first[a] + r->size[a];
}

/* Whether the region has all of block i of a row. */
static bool covers(const live_samples *s, const live_region *r, const block_row *of, uint32_t i) {
    const block_row one = row_of(s, of->block[0] + i, 1, of->block[1], of->block[2]);
    return within(r, 0, one.first[0], one.size[0]) && within(r, 1, one.first[1], one.size[1]) &&
           within(r, 2, one.first[2], one.size[2]);
}

/* The caller's samples of a row, from node x on, as they are stored: where they lie, or in room. */
static const char *fetch(const live_samples *s, const live_region *r, uint32_t x, uint32_t y,
                         uint32_t z, uint32_t count, char *room) {
    const char *at = r->samples + (ptrdiff_t)(x - r->first[0]) * r->strides[0] +
                     (ptrdiff_t)(y - r->first[1]) * r->strides[1] +
                     (ptrdiff_t)(z - r->first[2]) * r->strides[2];
    const size_t width = sample_size(r->type);
    const bool dense = r->strides[0] == (ptrdiff_t)width && (uintptr_t)at % width == 0;
    if (dense && r->type == s->type)
        return at;
    for (uint32_t i = 0; i < count && !dense; i++)
        memcpy(room + i * width, at + (ptrdiff_t)i * r->strides[0], width);
    (void)sample_to_stored(r->type, dense ? at : room, room, count);
    return room;
}

/* A line of nodes [from, to) that is given, and the line of the other buffer from its row's first
 * node on. */
typedef struct line_pair {
    const block_row *of;
    uint32_t from, to;
    const char *given, *there;
} line_pair;

/* Whether both have the same in blocks [first, end) of the row. */
static bool is_same(const live_samples *s, const line_pair *l, uint32_t first, uint32_t end) {
    const uint32_t low = l->of->first[0] + (first << LIVE_BLOCK_LOG2);
    const uint32_t high = l->of->first[0] + (end << LIVE_BLOCK_LOG2);
    const uint32_t at = low > l->from ? low : l->from, until = high < l->to ? high : l->to;
    return memcmp(l->given + (at - l->from) * s->width,
                  l->there + (at - l->of->first[0]) * s->width, (until - at) * s->width) == 0;
}

/* Note which blocks differ in a line. A block that differs is not looked at again: new samples cost
 * hardly any comparisons. */
static void compare(const live_samples *s, const line_pair *l, bool same[]) {
    const uint32_t first = (l->from - l->of->first[0]) >> LIVE_BLOCK_LOG2;
    const uint32_t end = ((l->to - 1 - l->of->first[0]) >> LIVE_BLOCK_LOG2) + 1;
    for (uint32_t i = first, run; i < end; i = run) {
        for (run = i; run < end && same[run];)
            run++;
        const bool all = run == i || is_same(s, l, i, run);
        for (uint32_t k = i; k < run && !all; k++)
            same[k] = is_same(s, l, k, k + 1);
        run += run == i;
    }
}

/* Put one row of nodes, and widen extents by all that the touched blocks then have in it. */
static void put_line(const putting *p, const block_row *of, uint32_t y, uint32_t z,
                     live_scratch *scratch) {
    const live_samples *s = p->s;
    const live_region *r = p->r;
    live_extent *all = &scratch->extent[0];
    char *line = sample_at(s, p->buffer, of->first[0], y, z);
    const uint32_t end = of->first[0] + of->size[0], region_end = r->first[0] + r->size[0];
    const uint32_t from = r->first[0] > of->first[0] ? r->first[0] : of->first[0];
    const uint32_t to = region_end < end ? region_end : end;
    if (within(r, 1, y, 1) && within(r, 2, z, 1)) {
        const char *given = fetch(s, r, from, y, z, to - from, scratch->row);
        const char *there = sample_at(s, !p->buffer, of->first[0], y, z);
        compare(s, &(line_pair){of, from, to, given, there}, scratch->same);
        if (to - from == of->size[0]) {
            s->rows->copy(all, given, line, of->size[0]);
        } else {
            memcpy(line + (from - of->first[0]) * s->width, given, (to - from) * s->width);
            s->rows->widen(all, line, of->size[0]);
        }
    } else {
        s->rows->widen(all, line, of->size[0]);
    }
    const unsigned kind = (y == of->first[1]) | (z == of->first[2]) << 1;
    for (unsigned k = 1; k < ROW_KINDS; k++)
        if ((k & kind) == k)
            s->rows->widen(&scratch->extent[k], line, of->size[0]);
}

/* Take what the extents of a row's lines say of its blocks that have changed. */
static void take_pieces(const putting *p, const block_row *of, const live_scratch *scratch) {
    const live_samples *s = p->s;
    for (uint32_t i = 0; i < of->blocks; i++) {
        live_block *b = block_at(s, of->block[0] + i, of->block[1], of->block[2]);
        if (!scratch->same[i])
            b->changed = s->writing;
        b->have[p->buffer] = b->changed;
        const uint32_t at = i << LIVE_BLOCK_LOG2, left = of->size[0] - at;
        for (unsigned k = 0; k < PIECES && !scratch->same[i]; k++)
            b->pieces[k] = s->rows->range(&scratch->extent[k >> 1], at,
                                          k & 1               ? 1
                                          : left < LIVE_BLOCK ? left
                                                              : LIVE_BLOCK);
    }
}

static status put_row(void *ctx, size_t index, int worker) {
    const putting *p = ctx;
    live_samples *s = p->s;
    live_scratch *scratch = &s->scratch[worker];
    const uint32_t x = (uint32_t)(index % p->count[0]) * ROW_BLOCKS, left = p->blocks - x;
    const block_row of = row_of(s, p->low[0] + x, left < ROW_BLOCKS ? left : ROW_BLOCKS,
                                p->low[1] + (uint32_t)(index / p->count[0] % p->count[1]),
                                p->low[2] + (uint32_t)(index / p->count[0] / p->count[1]));
    for (uint32_t i = 0; i < of.blocks; i++) {
        /* What has changed in this writing is not in the other buffer. */
        scratch->same[i] =
            block_at(s, of.block[0] + i, of.block[1], of.block[2])->changed < s->writing;
        if (!covers(s, p->r, &of, i))
            renew(s, p->buffer, &of, i);
    }
    for (int k = 0; k < ROW_KINDS; k++)
        s->rows->begin(&scratch->extent[k], of.size[0]);
    for (uint32_t z = of.first[2]; z < of.first[2] + of.size[2]; z++)
        for (uint32_t y = of.first[1]; y < of.first[1] + of.size[1]; y++)
            put_line(p, &of, y, z, scratch);
    take_pieces(p, &of, scratch);
    return ST_OK;
}

status live_samples_put(live_samples *s, int buffer, const live_region *r) {
    putting p = {.s = s, .r = r, .buffer = buffer};
    for (int a = 0; a < 3; a++) {
        assert(r->size[a] > 0 && r->first[a] + r->size[a] <= s->dims[a]);
        p.low[a] = r->first[a] >> LIVE_BLOCK_LOG2;
        p.count[a] = ((r->first[a] + r->size[a] - 1) >> LIVE_BLOCK_LOG2) + 1 - p.low[a];
    }
    p.blocks = p.count[0];
    p.count[0] = (p.blocks + ROW_BLOCKS - 1) / ROW_BLOCKS;
    return pool_run(s->threads, (size_t)p.count[0] * p.count[1] * p.count[2], put_row, &p);
}

/* ---- Finishing ---- */

typedef struct finishing {
    live_samples *s;
    int buffer;
} finishing;

static status finish_row(void *ctx, size_t index, int worker) {
    const finishing *f = ctx;
    const uint32_t *count = f->s->count;
    const block_row of =
        row_of(f->s, 0, count[0], (uint32_t)(index % count[1]), (uint32_t)(index / count[1]));
    (void)worker;
    for (uint32_t i = 0; i < of.blocks; i++)
        renew(f->s, f->buffer, &of, i);
    return ST_OK;
}

status live_samples_finish(live_samples *s, int buffer) {
    finishing f = {s, buffer};
    const status st = pool_run(s->threads, (size_t)s->count[1] * s->count[2], finish_row, &f);
    if (st == ST_OK)
        s->writing++;
    return st;
}

/* ---- Reading ---- */

static uint32_t nearest(int64_t i, uint32_t nodes) {
    return i < 0 ? 0 : i >= nodes ? nodes - 1 : (uint32_t)i;
}

void live_samples_load(const live_samples *s, int buffer, const int64_t first[3],
                       const uint32_t size[3], void *samples) {
    const uint32_t from = nearest(first[0], s->dims[0]);
    const uint32_t last = nearest(first[0] + size[0] - 1, s->dims[0]);
    const uint32_t before = (uint32_t)(from - first[0]), count = last - from + 1;
    char *to = samples;
    for (uint32_t k = 0; k < size[2]; k++)
        for (uint32_t j = 0; j < size[1]; j++, to += size[0] * s->width) {
            const char *row = sample_at(s, buffer, from, nearest(first[1] + j, s->dims[1]),
                                        nearest(first[2] + k, s->dims[2]));
            for (uint32_t i = 0; i < before; i++)
                memcpy(to + i * s->width, row, s->width);
            memcpy(to + before * s->width, row, count * s->width);
            for (uint32_t i = before + count; i < size[0]; i++)
                memcpy(to + i * s->width, row + (count - 1) * s->width, s->width);
        }
}

live_range live_samples_range(const live_samples *s, const uint32_t place[3]) {
    live_range all = {INFINITY, -INFINITY, false};
    for (unsigned k = 0; k < PIECES; k++) {
        const uint32_t x = place[0] + (k & 1), y = place[1] + (k >> 1 & 1), z = place[2] + (k >> 2);
        if (x >= s->count[0] || y >= s->count[1] || z >= s->count[2])
            continue;
        const live_range *r = &block_at(s, x, y, z)->pieces[k];
        all.lo = r->lo < all.lo ? r->lo : all.lo;
        all.hi = r->hi > all.hi ? r->hi : all.hi;
        all.bad |= r->bad;
    }
    return all;
}

uint64_t live_samples_stamp(const live_samples *s, const uint32_t place[3]) {
    uint32_t low[3], high[3];
    uint64_t latest = 0;
    for (int a = 0; a < 3; a++) {
        low[a] = place[a] > 0 ? place[a] - 1 : 0;
        high[a] = nearest((int64_t)place[a] + 1, s->count[a]);
    }
    for (uint32_t z = low[2]; z <= high[2]; z++)
        for (uint32_t y = low[1]; y <= high[1]; y++)
            for (uint32_t x = low[0]; x <= high[0]; x++) {
                const uint64_t changed = block_at(s, x, y, z)->changed;
                latest = changed > latest ? changed : latest;
            }
    return latest + 1;
}
