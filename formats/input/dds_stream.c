#include "formats/input/dds_stream.h"

#include <string.h>

enum {
    MAGIC_BYTES = 8,
    HISTORY = 1 << 17, /* above the longest row, and a power of two */
    BLOCK_VOXELS = 1 << 24,
    STRAIGHT_BYTES = 1 << 16
};

typedef struct dds_stream {
    mem *m;
    byte_stream *from;
    uint32_t bits; /* bits that are read but not taken */
    int bit_count;
    uint32_t skip, strip;           /* bytes of a voxel, of a row */
    uint64_t count;                 /* values so far */
    uint32_t run;                   /* values left of the run */
    int width;                      /* bits of each */
    bool apart_to_end, ended, past; /* past: zeros behind the end of the file were taken */
    uint8_t last;
    uint8_t *block, *mixed; /* values as they come; mixed: voxels put together */
    size_t room, size, taken;
    uint8_t history[HISTORY];
} dds_stream;

bool dds_stream_known(const uint8_t *start, size_t size) {
    return size >= MAGIC_BYTES && memcmp(start, "DDS v3", 6) == 0 &&
           (start[6] == 'd' || start[6] == 'e') && start[7] == '\n';
}

/* ---- bits ---- */

static status ends_early(const dds_stream *s) {
    return status_describe(ST_CORRUPT, "%s: ends at byte %llu, inside the DDS data",
                           byte_stream_name(s->from),
                           (unsigned long long)byte_stream_position(s->from));
}

static status take_byte(dds_stream *s, uint8_t *out) {
    const uint8_t *data;
    size_t size;
    status st = byte_stream_peek(s->from, 1, &data, &size);
    if (st != ST_OK)
        return st;
    s->past = size == 0;
    *out = size ? *data : 0;
    byte_stream_take(s->from, size ? 1 : 0);
    return ST_OK;
}

/* Take up to 16 bits. */
static status take_bits(dds_stream *s, int count, uint32_t *out) {
    while (s->bit_count < count) {
        uint8_t byte = 0;
        status st = take_byte(s, &byte);
        if (st != ST_OK)
            return st;
        s->bits = s->bits << 8 | byte;
        s->bit_count += 8;
    }
    s->bit_count -= count;
    *out = s->bits >> s->bit_count & ((1u << count) - 1);
    return ST_OK;
}

/* ---- values ---- */

/* Read the head of a run. At the end of the file the zeros that end the runs may be missing, but
 * nothing else. */
static status begin_run(dds_stream *s) {
    uint32_t width = 0;
    status st = take_bits(s, 7, &s->run);
    s->ended = s->run == 0;
    if (st == ST_OK && !s->ended)
        st = take_bits(s, 3, &width);
    s->width = width ? (int)width + 1 : 0;
    return st == ST_OK && !s->ended && s->past ? ends_early(s) : st;
}

static uint8_t before(const dds_stream *s, uint64_t distance) {
    return s->history[(s->count - distance) % HISTORY];
}

static status take_value(dds_stream *s, uint8_t *out) {
    uint32_t difference = 0;
    status st = s->width ? take_bits(s, s->width, &difference) : ST_OK;
    if (st == ST_OK && s->past)
        st = ends_early(s);
    if (st != ST_OK)
        return st;
    uint32_t value = s->last + difference - (s->width ? 1u << (s->width - 1) : 0);
    if (s->strip > 1 && s->count > s->strip)
        value += (uint32_t)before(s, s->strip) - before(s, s->strip + 1);
    s->last = s->history[s->count % HISTORY] = (uint8_t)value;
    *out = s->last;
    s->count++;
    s->run--;
    return ST_OK;
}

/* ---- blocks ---- */

static status grow(dds_stream *s) {
    const size_t room = s->room ? 2 * s->room : STRAIGHT_BYTES;
    uint8_t *block = mem_alloc(s->m, room), *mixed = s->skip > 1 ? mem_alloc(s->m, room) : NULL;
    if (!block || (s->skip > 1 && !mixed)) {
        mem_free(s->m, block);
        mem_free(s->m, mixed);
        return ST_NOMEM;
    }
    if (s->size)
        memcpy(block, s->block, s->size);
    mem_free(s->m, s->block);
    mem_free(s->m, s->mixed);
    s->block = block;
    s->mixed = mixed;
    s->room = room;
    return ST_OK;
}

static void put_together(dds_stream *s) {
    const uint8_t *from = s->block;
    for (size_t c = 0; c < s->skip; c++)
        for (size_t i = c; i < s->size; i += s->skip)
            s->mixed[i] = *from++;
}

static status fill(dds_stream *s) {
    const size_t block = (size_t)s->skip * BLOCK_VOXELS;
    const size_t most = s->skip == 1 ? STRAIGHT_BYTES : s->apart_to_end ? SIZE_MAX : block;
    status st = ST_OK;
    s->size = s->taken = 0;
    while (st == ST_OK && !s->ended && s->size < most) {
        if (s->run == 0)
            st = begin_run(s);
        if (st == ST_OK && !s->ended && s->size == s->room)
            st = grow(s);
        while (st == ST_OK && s->run > 0 && s->size < s->room && s->size < most) {
            st = take_value(s, s->block + s->size);
            s->size += st == ST_OK;
        }
    }
    if (st == ST_OK && s->skip > 1)
        put_together(s);
    return st;
}

static status read_some(void *ctx, void *to, size_t size, size_t *got) {
    dds_stream *s = ctx;
    *got = 0;
    if (s->taken == s->size && !s->ended) {
        status st = fill(s);
        if (st != ST_OK)
            return st;
    }
    const size_t left = s->size - s->taken;
    *got = size < left ? size : left;
    if (*got)
        memcpy(to, (s->skip > 1 ? s->mixed : s->block) + s->taken, *got);
    s->taken += *got;
    return ST_OK;
}

static void close_all(void *ctx) {
    dds_stream *s = ctx;
    byte_stream_close(s->from);
    mem_free(s->m, s->block);
    mem_free(s->m, s->mixed);
    mem_free(s->m, s);
}

static status read_header(dds_stream *s) {
    const uint8_t *start;
    size_t size;
    status st = byte_stream_peek(s->from, MAGIC_BYTES, &start, &size);
    if (st != ST_OK)
        return st;
    s->apart_to_end = size > 6 && start[6] == 'd';
    byte_stream_take(s->from, size < MAGIC_BYTES ? size : MAGIC_BYTES);
    st = take_bits(s, 2, &s->skip);
    if (st == ST_OK)
        st = take_bits(s, 16, &s->strip);
    s->skip++;
    s->strip++;
    return st;
}

status dds_stream_open(mem *m, byte_stream *from, byte_stream **out) {
    dds_stream *s = mem_zalloc(m, sizeof *s);
    if (!s) {
        byte_stream_close(from);
        return ST_NOMEM;
    }
    s->m = m;
    s->from = from;
    status st = read_header(s);
    if (st != ST_OK) {
        close_all(s);
        return st;
    }
    return byte_stream_open_source(m, byte_stream_path(from),
                                   &(byte_source){read_some, close_all, s}, out);
}
