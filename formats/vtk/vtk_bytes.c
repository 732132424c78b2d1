#include "formats/vtk/vtk_bytes.h"

#define ZLIB_CONST
#include <limits.h>
#include <lz4.h>
#include <lzma.h>
#include <string.h>
#include <zlib.h>

#include "formats/input/base64_stream.h"
#include "formats/input/unpack_stream.h"

enum {
    PACKED_BUFFER = 1 << 14,
    ZLIB_RATIO = UNPACK_ZLIB_RATIO,
    LZ4_RATIO = 255,
    LZMA_RATIO = 1 << 14, /* about twice what LZMA can reach */
    WHOLE_MAX = LZ4_MAX_INPUT_SIZE / 4,
    WHOLE_HEAD = 1 << 10, /* what packing may add to little data */
};

/* A reader of the file's bytes from one place on, base64 or not. */
typedef struct input {
    byte_stream *from;
    base64_stream text;
} input;

/* A compressor. begin: called when the table's entry of the next block has been read. some: unpacks
 * up to size bytes of the block, *got of them, perhaps none. end: called behind the block's last
 * byte. start and end are NULL where there is nothing to do. */
typedef struct unpacker {
    const char *name;
    uint64_t ratio; /* the most bytes that a packed byte of a block gives */
    status (*start)(vtk_bytes *b);
    status (*begin)(vtk_bytes *b);
    status (*some)(vtk_bytes *b, void *to, size_t size, size_t *got);
    status (*end)(vtk_bytes *b);
} unpacker;

static const unpacker unpackers[VTK_LZMA + 1];

struct vtk_bytes {
    mem *m;
    const vtk_array *array;
    const unpacker *unpacker; /* NULL: not packed */
    input data, table;        /* table: the blocks' packed sizes; open only with a compressor */
    uint64_t size;

    uint64_t blocks, block_size, last_size; /* the table; last_size is never 0 */
    uint64_t block;                         /* number of blocks begun */
    uint64_t block_left;                    /* bytes of the block to hand out */
    uint64_t packed_left;                   /* packed bytes of the block still in the file */

    bool block_ended; /* zlib has met the block's end */
    bool ready;       /* z is initialised */
    z_stream z;
    uint8_t packed[PACKED_BUFFER];

    uint8_t *whole[2]; /* LZ4, LZMA: a block, packed and not */
    size_t room[2];
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

/* Read one number of the head. */
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

/* Read [blocks, bytes a block, bytes of the last one or 0 for a full one]. Then both inputs stand
 * at the table. */
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
    return st == ST_OK && b->unpacker->start ? b->unpacker->start(b) : st;
}

/* Check that the file has room for the size, so that readers may rely on it. */
static status check_room(const vtk_bytes *b) {
    const uint64_t ratio = b->unpacker ? b->unpacker->ratio : 1;
    const uint64_t left = byte_stream_left(b->data.from);
    if (b->size / ratio <= left)
        return ST_OK;
    return vtk_array_fault(b->array, ST_CORRUPT,
                           "ends before byte %llu, too early for the %llu bytes of its head",
                           (unsigned long long)(byte_stream_position(b->data.from) + left),
                           (unsigned long long)b->size);
}

status vtk_bytes_open(mem *m, const vtk_array *a, vtk_bytes **out) {
    vtk_bytes *b = mem_zalloc(m, sizeof *b);
    if (!b)
        return ST_NOMEM;
    b->m = m;
    b->array = a;
    b->unpacker = a->packing ? &unpackers[a->packing] : NULL;
    status st = input_open(b, &b->data);
    if (st == ST_OK)
        st = b->unpacker ? read_table(b) : input_number(b, &b->data, &b->size);
    if (st == ST_OK)
        st = check_room(b);
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
    mem_free(b->m, b->whole[0]);
    mem_free(b->m, b->whole[1]);
    byte_stream_close(b->data.from);
    byte_stream_close(b->table.from);
    mem_free(b->m, b);
}

uint64_t vtk_bytes_size(const vtk_bytes *b) {
    return b->size;
}

/* ---- blocks ---- */

static status damaged(const vtk_bytes *b, const char *why) {
    return vtk_array_fault(b->array, ST_CORRUPT, "damaged %s block %llu before byte %llu: %s",
                           b->unpacker->name, (unsigned long long)b->block,
                           (unsigned long long)byte_stream_position(b->data.from), why);
}

static status next_block(vtk_bytes *b) {
    status st = input_number(b, &b->table, &b->packed_left);
    b->block++;
    b->block_left = b->block == b->blocks ? b->last_size : b->block_size;
    return st == ST_OK ? b->unpacker->begin(b) : st;
}

static status read_blocks(vtk_bytes *b, uint8_t *to, size_t size) {
    while (size > 0) {
        size_t got = 0;
        status st = b->block_left == 0 ? next_block(b) : ST_OK;
        size_t want = size < b->block_left ? size : (size_t)b->block_left;
        if (st == ST_OK)
            st = b->unpacker->some(b, to, want, &got);
        to += got;
        size -= got;
        b->block_left -= got;
        if (st == ST_OK && b->block_left == 0 && b->unpacker->end)
            st = b->unpacker->end(b);
        if (st != ST_OK)
            return st;
    }
    return ST_OK;
}

status vtk_bytes_read(vtk_bytes *b, void *buffer, size_t size) {
    return b->unpacker ? read_blocks(b, buffer, size)
                       : input_read(b, &b->data, buffer, size, "its numbers");
}

/* ---- zlib ---- */

static status start_zlib(vtk_bytes *b) {
    b->z.zalloc = mem_zlib_alloc;
    b->z.zfree = mem_zlib_free;
    b->z.opaque = b->m;
    b->ready = inflateInit(&b->z) == Z_OK;
    return b->ready ? ST_OK : ST_NOMEM;
}

static status begin_zlib(vtk_bytes *b) {
    inflateReset(&b->z);
    b->z.avail_in = 0;
    b->block_ended = false;
    return ST_OK;
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

/* Check that only the checksum follows the block's last byte. */
static status end_zlib(vtk_bytes *b) {
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

static status some_zlib(vtk_bytes *b, void *to, size_t size, size_t *got) {
    status st = inflate_some(b, to, size, got);
    return st == ST_OK && b->block_ended && *got < b->block_left
               ? damaged(b, "it holds less than its head says")
               : st;
}

/* ---- LZ4 and LZMA ---- */

static status make_room(vtk_bytes *b, int which, size_t size) {
    if (size <= b->room[which])
        return ST_OK;
    mem_free(b->m, b->whole[which]);
    b->room[which] = 0;
    b->whole[which] = mem_alloc(b->m, size);
    if (!b->whole[which])
        return ST_NOMEM;
    b->room[which] = size;
    return ST_OK;
}

/* Read the block's packed bytes into whole[0], and make room for the unpacked ones in whole[1]. */
static status read_whole(vtk_bytes *b) {
    const uint64_t packed = b->packed_left, size = b->block_left;
    if (size > WHOLE_MAX)
        return damaged(b, "larger than such a block can be");
    if (packed > 2 * size + WHOLE_HEAD || size > b->unpacker->ratio * packed)
        return damaged(b, "its length is not one of so many bytes");
    if (packed > byte_stream_left(b->data.from))
        return ends_early(b, &b->data, packed, "its blocks");
    status st = make_room(b, 0, (size_t)packed);
    if (st == ST_OK)
        st = make_room(b, 1, (size_t)size);
    return st == ST_OK ? input_read(b, &b->data, b->whole[0], (size_t)packed, "its blocks") : st;
}

static status begin_lz4(vtk_bytes *b) {
    status st = read_whole(b);
    if (st != ST_OK)
        return st;
    const int got = LZ4_decompress_safe((const char *)b->whole[0], (char *)b->whole[1],
                                        (int)b->packed_left, (int)b->block_left);
    return got == (int)b->block_left ? ST_OK : damaged(b, "not compressed data of its size");
}

/* Allocate memory that is not cleared, unlike mem_array(): each of VTK's blocks of 32 KiB takes a
 * window of 8 MiB. */
static void *lzma_alloc(void *m, size_t count, size_t size) {
    size_t bytes;
    return __builtin_mul_overflow(count, size, &bytes) ? NULL : mem_alloc(m, bytes);
}

static status begin_lzma(vtk_bytes *b) {
    status st = read_whole(b);
    if (st != ST_OK)
        return st;
    const lzma_allocator allocator = {lzma_alloc, mem_zlib_free, b->m};
    uint64_t limit = UINT64_MAX; /* the budget is the only limit */
    size_t in = 0, out = 0;
    const lzma_ret result =
        lzma_stream_buffer_decode(&limit, 0, &allocator, b->whole[0], &in, (size_t)b->packed_left,
                                  b->whole[1], &out, (size_t)b->block_left);
    if (result == LZMA_MEM_ERROR)
        return ST_NOMEM;
    return result == LZMA_OK && in == b->packed_left && out == b->block_left
               ? ST_OK
               : damaged(b, "not compressed data of its size");
}

static status some_whole(vtk_bytes *b, void *to, size_t size, size_t *got) {
    const uint64_t all = b->block == b->blocks ? b->last_size : b->block_size;
    memcpy(to, b->whole[1] + (all - b->block_left), size);
    *got = size;
    return ST_OK;
}

static const unpacker unpackers[VTK_LZMA + 1] = {
    [VTK_ZLIB] = {"zlib", ZLIB_RATIO, start_zlib, begin_zlib, some_zlib, end_zlib},
    [VTK_LZ4] = {"LZ4", LZ4_RATIO, NULL, begin_lz4, some_whole, NULL},
    [VTK_LZMA] = {"LZMA", LZMA_RATIO, NULL, begin_lzma, some_whole, NULL},
};
