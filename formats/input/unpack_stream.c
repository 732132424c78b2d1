#include "formats/input/unpack_stream.h"

#define ZLIB_CONST
#define ZSTD_STATIC_LINKING_ONLY /* for our own allocator */
#include <bzlib.h>
#include <limits.h>
#include <lzma.h>
#include <string.h>
#include <zlib.h>
#include <zstd.h>
#include <zstd_errors.h>

#include "formats/base/text.h"

/* Input and output of one step, which moves both on. */
typedef struct span {
    const uint8_t *in;
    size_t in_size;
    uint8_t *out;
    size_t room;
} span;

typedef enum unpacked { UNPACKED_MORE, UNPACKED_MEMBER, UNPACKED_DAMAGED, UNPACKED_NOMEM } unpacked;

struct packer {
    const char *name, *suffix, *magic;
    size_t magic_size;
    bool (*open)(unpack_stream *s); /* false: no memory */
    unpacked (*step)(unpack_stream *s, span *x);
    bool (*again)(unpack_stream *s); /* called when another member follows */
    void (*close)(unpack_stream *s);
};

struct unpack_stream {
    mem *m;
    byte_stream *from;
    const packer *how;
    bool ready, ended;
    bool marked;     /* the data has a mark; zlib data has none, and is one member */
    const char *why; /* the library's message on damage; NULL: none */
    union {
        z_stream z;
        bz_stream bz;
        lzma_stream xz;
        ZSTD_DCtx *zstd;
    };
    lzma_allocator allocator;
};

static unsigned at_most(size_t size) {
    return size < INT_MAX ? (unsigned)size : INT_MAX;
}

/* ---- zlib and gzip ---- */

static bool zlib_open(unpack_stream *s) {
    s->z.zalloc = mem_zlib_alloc;
    s->z.zfree = mem_zlib_free;
    s->z.opaque = s->m;
    /* 15: the largest window; 32: gzip or zlib, as the first bytes say. */
    return inflateInit2(&s->z, 15 + 32) == Z_OK;
}

static unpacked zlib_step(unpack_stream *s, span *x) {
    s->z.next_in = x->in;
    s->z.avail_in = at_most(x->in_size);
    s->z.next_out = x->out;
    s->z.avail_out = at_most(x->room);
    const int result = inflate(&s->z, Z_NO_FLUSH);
    *x = (span){s->z.next_in, x->in_size - (size_t)(s->z.next_in - x->in), s->z.next_out,
                x->room - (size_t)(s->z.next_out - x->out)};
    s->why = s->z.msg;
    switch (result) {
    case Z_OK: return UNPACKED_MORE;
    case Z_STREAM_END: return UNPACKED_MEMBER;
    case Z_MEM_ERROR: return UNPACKED_NOMEM;
    default: return UNPACKED_DAMAGED;
    }
}

static bool zlib_again(unpack_stream *s) {
    return inflateReset(&s->z) == Z_OK;
}

static void zlib_close(unpack_stream *s) {
    inflateEnd(&s->z);
}

/* ---- bzip2 ---- */

static void *bzip2_alloc(void *m, int count, int size) {
    return mem_array(m, (size_t)count, (size_t)size);
}

static bool bzip2_open(unpack_stream *s) {
    s->bz = (bz_stream){.bzalloc = bzip2_alloc, .bzfree = mem_zlib_free, .opaque = s->m};
    return BZ2_bzDecompressInit(&s->bz, 0, 0) == BZ_OK;
}

static unpacked bzip2_step(unpack_stream *s, span *x) {
    const unsigned in = at_most(x->in_size), room = at_most(x->room);
    s->bz.next_in = (char *)(uintptr_t)x->in;
    s->bz.avail_in = in;
    s->bz.next_out = (char *)x->out;
    s->bz.avail_out = room;
    const int result = BZ2_bzDecompress(&s->bz);
    const unsigned used = in - s->bz.avail_in, made = room - s->bz.avail_out;
    *x = (span){x->in + used, x->in_size - used, x->out + made, x->room - made};
    switch (result) {
    case BZ_OK: return UNPACKED_MORE;
    case BZ_STREAM_END: return UNPACKED_MEMBER;
    case BZ_MEM_ERROR: return UNPACKED_NOMEM;
    default: return UNPACKED_DAMAGED;
    }
}

static void bzip2_close(unpack_stream *s) {
    BZ2_bzDecompressEnd(&s->bz);
}

static bool bzip2_again(unpack_stream *s) {
    bzip2_close(s);
    return bzip2_open(s);
}

/* ---- xz ---- */

static void *xz_alloc(void *m, size_t count, size_t size) {
    return mem_array(m, count, size);
}

static bool xz_open(unpack_stream *s) {
    s->allocator = (lzma_allocator){xz_alloc, mem_zlib_free, s->m};
    s->xz = (lzma_stream)LZMA_STREAM_INIT;
    s->xz.allocator = &s->allocator;
    return lzma_stream_decoder(&s->xz, UINT64_MAX, 0) == LZMA_OK;
}

static unpacked xz_step(unpack_stream *s, span *x) {
    s->xz.next_in = x->in;
    s->xz.avail_in = x->in_size;
    s->xz.next_out = x->out;
    s->xz.avail_out = x->room;
    const lzma_ret result = lzma_code(&s->xz, LZMA_RUN);
    *x = (span){s->xz.next_in, s->xz.avail_in, s->xz.next_out, s->xz.avail_out};
    switch (result) {
    case LZMA_OK: return UNPACKED_MORE;
    case LZMA_STREAM_END: return UNPACKED_MEMBER;
    case LZMA_MEM_ERROR: return UNPACKED_NOMEM;
    default: return UNPACKED_DAMAGED;
    }
}

static bool xz_again(unpack_stream *s) {
    return lzma_stream_decoder(&s->xz, UINT64_MAX, 0) == LZMA_OK;
}

static void xz_close(unpack_stream *s) {
    lzma_end(&s->xz);
}

/* ---- zstd ---- */

static void *zstd_alloc(void *m, size_t size) {
    return mem_alloc(m, size);
}

static bool zstd_open(unpack_stream *s) {
    s->zstd = ZSTD_createDCtx_advanced((ZSTD_customMem){zstd_alloc, mem_zlib_free, s->m});
    /* The budget is the only limit. */
    return s->zstd && !ZSTD_isError(ZSTD_DCtx_setParameter(s->zstd, ZSTD_d_windowLogMax,
                                                           sizeof(size_t) == 4 ? 30 : 31));
}

static unpacked zstd_step(unpack_stream *s, span *x) {
    ZSTD_inBuffer in = {x->in, x->in_size, 0};
    ZSTD_outBuffer out = {x->out, x->room, 0};
    const size_t result = ZSTD_decompressStream(s->zstd, &out, &in);
    *x = (span){x->in + in.pos, x->in_size - in.pos, x->out + out.pos, x->room - out.pos};
    if (result == 0)
        return UNPACKED_MEMBER;
    if (!ZSTD_isError(result))
        return UNPACKED_MORE;
    s->why = ZSTD_getErrorName(result);
    return ZSTD_getErrorCode(result) == ZSTD_error_memory_allocation ? UNPACKED_NOMEM
                                                                     : UNPACKED_DAMAGED;
}

static bool zstd_again(unpack_stream *s) {
    return !ZSTD_isError(ZSTD_DCtx_reset(s->zstd, ZSTD_reset_session_only));
}

static void zstd_close(unpack_stream *s) {
    ZSTD_freeDCtx(s->zstd);
}

/* ---- the table ---- */

#define MAGIC(text) text, sizeof(text) - 1

const packer packer_zlib = {"gzip",     ".gz",     MAGIC("\x1f\x8b\x08"), zlib_open, zlib_step,
                            zlib_again, zlib_close};
const packer packer_bzip2 = {"bzip2",    ".bz2",      MAGIC("BZh"), bzip2_open,
                             bzip2_step, bzip2_again, bzip2_close};
/* FreeSurfer's name for a .mgh that gzip has packed. */
static const packer packer_mgz = {
    "gzip", ".mgz", MAGIC("\x1f\x8b\x08"), zlib_open, zlib_step, zlib_again, zlib_close};
static const packer packer_xz = {"xz",     ".xz",   MAGIC("\xfd\x37zXZ\0"), xz_open, xz_step,
                                 xz_again, xz_close};
static const packer packer_zstd = {
    "zstd", ".zst", MAGIC("\x28\xb5\x2f\xfd"), zstd_open, zstd_step, zstd_again, zstd_close};
static const packer *const packers[] = {&packer_zlib, &packer_bzip2, &packer_xz, &packer_zstd,
                                        &packer_mgz};

enum { PACKERS = sizeof packers / sizeof *packers };

static bool is_packed_by(const packer *p, const uint8_t *start, size_t size) {
    return size >= p->magic_size && memcmp(start, p->magic, p->magic_size) == 0;
}

const packer *packer_find(const uint8_t *start, size_t size) {
    for (int i = 0; i < PACKERS; i++)
        if (is_packed_by(packers[i], start, size))
            return packers[i];
    return NULL;
}

bool packer_is_suffix(const char *path) {
    for (int i = 0; i < PACKERS; i++)
        if (text_ends_in(path, packers[i]->suffix))
            return true;
    return false;
}

/* ---- the stream ---- */

status unpack_stream_open(mem *m, const packer *p, byte_stream *from, unpack_stream **out) {
    unpack_stream *s = mem_zalloc(m, sizeof *s);
    if (!s)
        return ST_NOMEM;
    s->m = m;
    s->from = from;
    s->how = p;
    const uint8_t *start;
    size_t size;
    status st = byte_stream_peek(from, PACKER_PEEK, &start, &size);
    if (st == ST_OK) {
        s->marked = is_packed_by(p, start, size);
        s->ready = p->open(s);
        st = s->ready ? ST_OK : ST_NOMEM;
    }
    if (st != ST_OK) {
        unpack_stream_close(s);
        return st;
    }
    *out = s;
    return ST_OK;
}

void unpack_stream_close(unpack_stream *s) {
    if (!s)
        return;
    if (s->ready)
        s->how->close(s);
    mem_free(s->m, s);
}

static status damaged(const unpack_stream *s, const char *why) {
    return status_describe(ST_CORRUPT, "%s: damaged %s data before byte %llu: %s",
                           byte_stream_name(s->from), s->marked ? s->how->name : "zlib",
                           (unsigned long long)byte_stream_position(s->from), why);
}

/* Returns whether a zstd frame without content comes; tools put these between others. */
static bool is_skippable(const packer *p, const uint8_t *start, size_t size) {
    return p == &packer_zstd && size >= 4 && start[0] >> 4 == 5 &&
           memcmp(start + 1, "\x2a\x4d\x18", 3) == 0;
}

/* Behind a member, find out whether the data end or another member follows. */
static status next_member(unpack_stream *s) {
    const uint8_t *data;
    size_t size;
    status st = byte_stream_peek(s->from, PACKER_PEEK, &data, &size);
    if (st != ST_OK)
        return st;
    s->ended =
        !s->marked || (!is_packed_by(s->how, data, size) && !is_skippable(s->how, data, size));
    return s->ended || s->how->again(s) ? ST_OK : ST_NOMEM;
}

/* Unpack what one peek gives, at most up to the end of a member. */
static status unpack_some(unpack_stream *s, uint8_t **out, size_t *room) {
    const uint8_t *data;
    size_t size;
    status st = byte_stream_peek(s->from, 1, &data, &size);
    if (st != ST_OK)
        return st;
    span x = {data, size, *out, *room};
    const unpacked result = s->how->step(s, &x);
    const bool idle = x.in == data && x.out == *out;
    byte_stream_take(s->from, (size_t)(x.in - data));
    *out = x.out;
    *room = x.room;
    if (size == 0 && idle && result != UNPACKED_MEMBER)
        return damaged(s, "the file ends here");
    switch (result) {
    case UNPACKED_MEMBER: return next_member(s);
    case UNPACKED_NOMEM: return ST_NOMEM;
    case UNPACKED_DAMAGED: return damaged(s, s->why ? s->why : "not compressed data");
    default: return ST_OK;
    }
}

status unpack_stream_read(unpack_stream *s, void *buffer, size_t size, size_t *got) {
    uint8_t *out = buffer;
    size_t room = size;
    status st = ST_OK;
    while (room > 0 && !s->ended && st == ST_OK)
        st = unpack_some(s, &out, &room);
    *got = size - room;
    return st;
}
