#include "formats/mesh/vtk_bytes.h"

#define ZLIB_CONST
#include <limits.h>
#include <zlib.h>

#include "formats/input/base64_stream.h"

enum { PACKED_BUFFER = 1 << 14 };

/* What is read from one byte of the file on: base64 or not. */
typedef struct input {
    byte_stream *from;
    base64_stream text;
} input;

struct vtk_bytes {
    mem *m;
    const vtk_array *array;
    input data, table; /* the table of the blocks' packed sizes; open with zlib alone */
    uint64_t size;

    uint64_t blocks, block_size, last_size; /* the table; last_size is never 0 */
    uint64_t block;                         /* the number of those begun */
    uint64_t block_left;                    /* bytes of the block to hand out */
    uint64_t packed_left;                   /* packed bytes of the block still in the file */
    bool block_ended;                       /* zlib says so */
    bool ready;                             /* z is initialised */
    z_stream z;
    uint8_t packed[PACKED_BUFFER];
};

/* ---- inputs ---- */

static status input_open(vtk_bytes *b, input *p) {
    status st = byte_stream_open(b->m, b->array->path, &p->from);
    if (st != ST_OK)
        return st;
    p->text.from = p->from;
    return byte_stream_skip(p->from, b->array->at);
}

static status ends_early(const vtk_bytes *b, const input *p, uint64_t missing, const char *what) {
    return vtk_array_fault(b->array, ST_CORRUPT, "ends before byte %llu, expected %llu more of %s",
                           (unsigned long long)byte_stream_position(p->from),
                           (unsigned long long)missing, what);
}

static status input_read(vtk_bytes *b, input *p, void *buffer, size_t size, const char *what) {
    size_t got;
    status st = b->array->coding == VTK_BASE64 ? base64_stream_read(&p->text, buffer, size, &got)
                                               : byte_stream_read(p->from, buffer, size, &got);
    return st == ST_OK && got < size ? ends_early(b, p, size - got, what) : st;
}

static status input_skip(vtk_bytes *b, input *p, uint64_t size, const char *what) {
    if (b->array->coding == VTK_RAW)
        return size > byte_stream_left(p->from) ? ends_early(b, p, size, what)
                                                : byte_stream_skip(p->from, size);
    uint8_t passed[1024];
    status st = ST_OK;
    while (st == ST_OK && size > 0) {
        size_t count = size < sizeof passed ? (size_t)size : sizeof passed;
        st = input_read(b, p, passed, count, what);
        size -= count;
    }
    return st;
}

/* One number of the head. */
static status input_number(vtk_bytes *b, input *p, uint64_t *out) {
    uint8_t bytes[8];
    bool big = b->array->big_endian;
    size_t width = b->array->head64 ? 8 : 4;
    status st = input_read(b, p, bytes, width, "its head");
    *out = 0;
    for (size_t i = 0; st == ST_OK && i < width; i++)
        *out = *out << 8 | bytes[big ? i : width - 1 - i];
    return st;
}

/* ---- the head ---- */

static status start_zlib(vtk_bytes *b) {
    b->z.zalloc = mem_zlib_alloc;
    b->z.zfree = mem_zlib_free;
    b->z.opaque = b->m;
    b->ready = inflateInit(&b->z) == Z_OK;
    return b->ready ? ST_OK : ST_NOMEM;
}

/* [blocks, bytes a block, bytes of the last one or 0 for a full one]: then both inputs stand at the
 * table. */
static status read_table(vtk_bytes *b) {
    uint64_t head[3], again;
    status st = input_open(b, &b->table);
    for (int i = 0; st == ST_OK && i < 3; i++) {
        st = input_number(b, &b->data, &head[i]);
        if (st == ST_OK)
            st = input_number(b, &b->table, &again);
    }
    if (st != ST_OK)
        return st;
    b->blocks = head[0];
    b->block_size = head[1];
    b->last_size = head[2] ? head[2] : head[1];
    uint64_t full;
    bool sound = b->blocks == 0 || (b->block_size > 0 && b->last_size <= b->block_size &&
                                    !__builtin_mul_overflow(b->blocks - 1, b->block_size, &full) &&
                                    !__builtin_add_overflow(full, b->last_size, &b->size) &&
                                    b->blocks < INT64_MAX / 8);
    if (!sound)
        return vtk_array_fault(
            b->array, ST_CORRUPT, "no sound head: %llu blocks of %llu bytes, the last of %llu",
            (unsigned long long)head[0], (unsigned long long)head[1], (unsigned long long)head[2]);
    st = input_skip(b, &b->data, b->blocks * (b->array->head64 ? 8 : 4), "its table of blocks");
    return st == ST_OK ? start_zlib(b) : st;
}

status vtk_bytes_open(mem *m, const vtk_array *a, vtk_bytes **out) {
    vtk_bytes *b = mem_zalloc(m, sizeof *b);
    if (!b)
        return ST_NOMEM;
    b->m = m;
    b->array = a;
    status st = input_open(b, &b->data);
    if (st == ST_OK)
        st = a->zlib ? read_table(b) : input_number(b, &b->data, &b->size);
    if (st != ST_OK) {
        vtk_bytes_close(b);
        return st;
    }
    *out = b;
    return ST_OK;
}

void vtk_bytes_close(vtk_bytes *b) {
    if (!b)
        return;
    if (b->ready)
        inflateEnd(&b->z);
    byte_stream_close(b->data.from);
    byte_stream_close(b->table.from);
    mem_free(b->m, b);
}

uint64_t vtk_bytes_size(const vtk_bytes *b) {
    return b->size;
}

/* ---- blocks ---- */

static status damaged(const vtk_bytes *b, const char *why) {
    return vtk_array_fault(b->array, ST_CORRUPT, "damaged zlib block %llu before byte %llu: %s",
                           (unsigned long long)b->block,
                           (unsigned long long)byte_stream_position(b->data.from), why);
}

static status next_block(vtk_bytes *b) {
    status st = input_number(b, &b->table, &b->packed_left);
    inflateReset(&b->z);
    b->z.avail_in = 0;
    b->block++;
    b->block_left = b->block == b->blocks ? b->last_size : b->block_size;
    b->block_ended = false;
    return st;
}

/* Decompress into size bytes; *got of them are filled, perhaps none. */
static status inflate_some(vtk_bytes *b, void *to, size_t size, size_t *got) {
    if (b->z.avail_in == 0 && b->packed_left > 0) {
        size_t count = b->packed_left < PACKED_BUFFER ? (size_t)b->packed_left : PACKED_BUFFER;
        status st = input_read(b, &b->data, b->packed, count, "its blocks");
        if (st != ST_OK)
            return st;
        b->packed_left -= count;
        b->z.next_in = b->packed;
        b->z.avail_in = (uInt)count;
    }
    b->z.next_out = to;
    b->z.avail_out = (uInt)(size < INT_MAX ? size : INT_MAX);
    uInt room = b->z.avail_out;
    bool starved = b->z.avail_in == 0;
    int result = inflate(&b->z, Z_NO_FLUSH);
    *got = room - b->z.avail_out;
    if (result == Z_MEM_ERROR)
        return ST_NOMEM;
    b->block_ended = result == Z_STREAM_END;
    if (result == Z_STREAM_END || result == Z_OK)
        return ST_OK;
    if (result == Z_BUF_ERROR)
        return starved ? damaged(b, "it ends too early") : ST_OK;
    return damaged(b, b->z.msg ? b->z.msg : "not compressed data");
}

/* Behind the block's last byte: its checksum, and nothing else. */
static status end_block(vtk_bytes *b) {
    while (!b->block_ended) {
        uint8_t more;
        size_t got;
        status st = inflate_some(b, &more, 1, &got);
        if (st != ST_OK)
            return st;
        if (got > 0)
            return damaged(b, "it holds more than its head says");
    }
    if (b->z.avail_in > 0 || b->packed_left > 0)
        return damaged(b, "bytes follow its end");
    return ST_OK;
}

static status read_blocks(vtk_bytes *b, uint8_t *to, size_t size) {
    while (size > 0) {
        size_t got = 0;
        status st = b->block_left == 0 ? next_block(b) : ST_OK;
        size_t want = size < b->block_left ? size : (size_t)b->block_left;
        if (st == ST_OK)
            st = inflate_some(b, to, want, &got);
        if (st != ST_OK)
            return st;
        to += got;
        size -= got;
        b->block_left -= got;
        if (b->block_left > 0 && b->block_ended)
            return damaged(b, "it holds less than its head says");
        if (b->block_left == 0)
            st = end_block(b);
        if (st != ST_OK)
            return st;
    }
    return ST_OK;
}

status vtk_bytes_read(vtk_bytes *b, void *buffer, size_t size) {
    return b->array->zlib ? read_blocks(b, buffer, size)
                          : input_read(b, &b->data, buffer, size, "its numbers");
}
