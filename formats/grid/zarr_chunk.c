#include "formats/grid/zarr_chunk.h"

#include <dlfcn.h>
#include <errno.h>
#include <limits.h>
#include <lz4.h>
#include <stdint.h>
#include <string.h>
#include <sys/stat.h>

#include "formats/base/file.h"
#include "formats/input/binary_fields.h"
#include "formats/input/lzf.h"
#include "formats/input/unpack_stream.h"

zarr_codec zarr_codec_find(const char *id) {
    static const struct {
        const char *id;
        zarr_codec codec;
    } codecs[] = {{"zlib", ZARR_STREAM}, {"gzip", ZARR_STREAM}, {"zstd", ZARR_STREAM},
                  {"bz2", ZARR_STREAM},  {"lzma", ZARR_STREAM}, {"blosc", ZARR_BLOSC},
                  {"lz4", ZARR_LZ4}};
    for (size_t i = 0; i < sizeof codecs / sizeof *codecs; i++)
        if (strcmp(id, codecs[i].id) == 0)
            return codecs[i].codec;
    return (zarr_codec)0;
}

static status wrong_size(const char *path, size_t size) {
    return status_describe(ST_CORRUPT, "%s: this chunk does not hold the %zu bytes expected", path,
                           size);
}

/* ---- as a stream ---- */

static status read_stream(byte_stream *s, unpack_stream *packed, void *to, size_t size,
                          size_t *got) {
    return packed ? unpack_stream_read(packed, to, size, got) : byte_stream_read(s, to, size, got);
}

static status read_exactly(byte_stream *s, unpack_stream *packed, void *to, size_t size,
                           bool or_more) {
    char more;
    size_t got = 0, rest = 0;
    status st = read_stream(s, packed, to, size, &got);
    if (st == ST_OK && got == size && !or_more)
        st = read_stream(s, packed, &more, 1, &rest);
    return st == ST_OK && (got < size || rest) ? wrong_size(byte_stream_name(s), size) : st;
}

/* Unpack a stream, which is closed in any case. */
static status take_stream(mem *m, bool is_packed, byte_stream *s, void *to, size_t size,
                          bool or_more, uint64_t *read) {
    unpack_stream *packed = NULL;
    const uint8_t *start;
    size_t held = 0;
    status st = ST_OK;
    if (is_packed) {
        st = byte_stream_peek(s, PACKER_PEEK, &start, &held);
        const packer *how = st == ST_OK ? packer_find(start, held) : NULL;
        if (st == ST_OK)
            st = unpack_stream_open(m, how ? how : &packer_zlib, s, &packed);
    }
    if (st == ST_OK)
        st = read_exactly(s, packed, to, size, or_more);
    *read += byte_stream_position(s);
    unpack_stream_close(packed);
    byte_stream_close(s);
    return st;
}

/* ---- a chunk as a whole ---- */

typedef int blosc_validate(const void *from, size_t bytes, size_t *unpacked);
typedef int blosc_unpack(const void *from, void *to, size_t room, int threads);

/* Report a lack of memory. Libraries do not tell it from a damaged chunk, or from their own
 * absence. */
static status no_memory(const char *path, const char *to) {
    return status_describe(ST_NOMEM, "%s: the system has no memory to %s", path, to);
}

enum {
    BLOSC_ROOM = 4 << 20
}; /* bytes that the library takes, and that a block needs besides itself */

/* Find a function of blosc. Few files need blosc, so it is loaded on demand. */
static status find_blosc(const char *path, const char *symbol, void **out) {
    static const char library[] = "libblosc.so.1";
    void *handle = dlopen(library, RTLD_NOW); /* stays open: it is the same one, however often */
    *out = handle ? dlsym(handle, symbol) : NULL;
    if (*out)
        return ST_OK;
    if (!mem_room(BLOSC_ROOM))
        return no_memory(path, "load blosc");
    return status_describe(ST_UNSUPPORTED,
                           "%s: %s, which unpacks this chunk, is not there: install it "
                           "(scripts/setup-debian)",
                           path, library);
}

/* ISO C has no conversion from an object's pointer to a function's. */
#define AS_FUNCTION(to, symbol) memcpy(&(to), &(symbol), sizeof(to))

static status take_blosc(const char *path, const uint8_t *bytes, size_t count, void *to,
                         size_t size) {
    void *validate_symbol, *unpack_symbol;
    blosc_validate *validate;
    blosc_unpack *unpack;
    size_t unpacked = 0;
    status st = find_blosc(path, "blosc_cbuffer_validate", &validate_symbol);
    if (st == ST_OK)
        st = find_blosc(path, "blosc_decompress_ctx", &unpack_symbol);
    if (st != ST_OK)
        return st;
    AS_FUNCTION(validate, validate_symbol);
    AS_FUNCTION(unpack, unpack_symbol);
    if (count < 16 || validate(bytes, count, &unpacked) != 0)
        return status_describe(ST_CORRUPT, "%s: damaged blosc data", path);
    if (unpacked != size)
        return wrong_size(path, size);
    const int result = unpack(bytes, to, size, 1);
    if (result >= 0 && (size_t)result == size)
        return ST_OK;
    if (!mem_room(BLOSC_ROOM + 3 * size)) /* its blocks are no larger than the chunk */
        return no_memory(path, "unpack it");
    return status_describe(ST_CORRUPT, "%s: damaged blosc data", path);
}

/* Unpack LZ4: the length, then one block. */
static status take_lz4(const char *path, const uint8_t *bytes, size_t count, void *to,
                       size_t size) {
    if (count < 4 || count > INT_MAX || size > INT_MAX || binary_unsigned(bytes, 4, false) != size)
        return wrong_size(path, size);
    const int result = LZ4_decompress_safe((const char *)bytes + 4, to, (int)count - 4, (int)size);
    if (result < 0 || (size_t)result != size)
        return status_describe(ST_CORRUPT, "%s: damaged lz4 data", path);
    return ST_OK;
}

/* Unpack LZF, whose stream tells its size. */
static status take_lzf(const char *path, const uint8_t *bytes, size_t count, void *to,
                       size_t size) {
    size_t unpacked = 0;
    const char *why = lzf_size(bytes, count, &unpacked);
    if (why)
        return status_describe(ST_CORRUPT, "%s: damaged lzf data: %s", path, why);
    if (unpacked != size)
        return wrong_size(path, size);
    lzf_unpack(bytes, count, to);
    return ST_OK;
}

static status take_whole(mem *m, zarr_codec codec, const zarr_part *part, void *to, size_t size) {
    uint8_t *bytes = mem_alloc(m, part->bytes);
    status st = bytes ? file_read_at(part->in, part->offset, bytes, part->bytes) : ST_NOMEM;
    if (st == ST_OK)
        st = (codec == ZARR_BLOSC ? take_blosc
              : codec == ZARR_LZ4 ? take_lz4
                                  : take_lzf)(part->name, bytes, part->bytes, to, size);
    mem_free(m, bytes);
    return st;
}

static status take_file(mem *m, zarr_codec codec, const char *path, void *to, size_t size,
                        uint64_t *read) {
    file *f = NULL;
    status st = file_open(m, path, &f);
    if (st != ST_OK)
        return st;
    const zarr_part all = {f, 0, (size_t)file_size(f), path};
    st = take_whole(m, codec, &all, to, size);
    *read += all.bytes;
    file_close(f);
    return st;
}

/* A part as a source of bytes. */
static status read_part(void *ctx, void *to, size_t size, size_t *got) {
    zarr_part *left = ctx;
    *got = size < left->bytes ? size : left->bytes;
    const status st = file_read_at(left->in, left->offset, to, *got);
    left->offset += *got;
    left->bytes -= *got;
    return st;
}

static void close_part(void *ctx) {
    (void)ctx;
}

status zarr_chunk_read_part(mem *m, zarr_codec codec, const zarr_part *part, void *to, size_t size,
                            bool or_more) {
    zarr_part left = *part;
    byte_stream *s = NULL;
    uint64_t read = 0;
    if (codec == ZARR_RAW)
        return part->bytes == size || (or_more && part->bytes > size)
                   ? file_read_at(part->in, part->offset, to, size)
                   : wrong_size(part->name, size);
    if (codec != ZARR_STREAM)
        return take_whole(m, codec, part, to, size);
    const status st =
        byte_stream_open_source(m, part->name, &(byte_source){read_part, close_part, &left}, &s);
    return st == ST_OK ? take_stream(m, true, s, to, size, or_more, &read) : st;
}

status zarr_chunk_read(mem *m, zarr_codec codec, const char *path, void *to, size_t size,
                       bool *there, uint64_t *read) {
    struct stat info;
    /* A link that leads nowhere counts as there: opening it will fail. */
    *there = lstat(path, &info) == 0 || (errno != ENOENT && errno != ENOTDIR);
    if (!*there)
        return ST_OK;
    if (codec != ZARR_RAW && codec != ZARR_STREAM)
        return take_file(m, codec, path, to, size, read);
    byte_stream *s = NULL;
    const status st = byte_stream_open_stored(m, path, &s);
    return st == ST_OK ? take_stream(m, codec == ZARR_STREAM, s, to, size, false, read) : st;
}
