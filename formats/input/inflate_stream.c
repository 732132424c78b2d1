#include "formats/input/inflate_stream.h"

#define ZLIB_CONST
#include <limits.h>
#include <zlib.h>

struct inflate_stream {
    mem *m;
    byte_stream *from;
    z_stream z;
    bool ready; /* z is initialised */
    bool gzip;  /* else zlib */
    bool ended;
};

static status at_gzip_member(byte_stream *from, bool *yes) {
    const uint8_t *data;
    size_t size;
    status st = byte_stream_peek(from, 2, &data, &size);
    if (st == ST_OK)
        *yes = size >= 2 && data[0] == 0x1f && data[1] == 0x8b;
    return st;
}

status inflate_stream_open(mem *m, byte_stream *from, inflate_stream **out) {
    inflate_stream *s = mem_zalloc(m, sizeof *s);
    if (!s)
        return ST_NOMEM;
    s->m = m;
    s->from = from;
    s->z.zalloc = mem_zlib_alloc;
    s->z.zfree = mem_zlib_free;
    s->z.opaque = m;
    status st = at_gzip_member(from, &s->gzip);
    /* 15: the largest window; 32: gzip or zlib, as the first bytes say. */
    if (st == ST_OK && inflateInit2(&s->z, 15 + 32) != Z_OK)
        st = ST_NOMEM;
    s->ready = st == ST_OK;
    if (st != ST_OK) {
        inflate_stream_close(s);
        return st;
    }
    *out = s;
    return ST_OK;
}

void inflate_stream_close(inflate_stream *s) {
    if (!s)
        return;
    if (s->ready)
        inflateEnd(&s->z);
    mem_free(s->m, s);
}

static status damaged(const inflate_stream *s, const char *why) {
    return status_describe(ST_CORRUPT, "%s: damaged %s data before byte %llu: %s",
                           byte_stream_name(s->from), s->gzip ? "gzip" : "zlib",
                           (unsigned long long)byte_stream_position(s->from), why);
}

/* Decompress what one peek gives, at most to the end of a member. */
static status inflate_some(inflate_stream *s) {
    const uint8_t *data;
    size_t size;
    status st = byte_stream_peek(s->from, 1, &data, &size);
    if (st != ST_OK)
        return st;
    if (size == 0)
        return damaged(s, "the file ends here");
    s->z.next_in = data;
    s->z.avail_in = (uInt)size;
    int result = inflate(&s->z, Z_NO_FLUSH);
    byte_stream_take(s->from, size - s->z.avail_in);
    if (result == Z_MEM_ERROR)
        return ST_NOMEM;
    if (result != Z_OK && result != Z_STREAM_END)
        return damaged(s, s->z.msg ? s->z.msg : "not compressed data");
    if (result == Z_OK)
        return ST_OK;
    bool another = false;
    if (s->gzip)
        st = at_gzip_member(s->from, &another);
    if (st == ST_OK && another)
        inflateReset(&s->z);
    s->ended = !another;
    return st;
}

status inflate_stream_read(inflate_stream *s, void *buffer, size_t size, size_t *got) {
    *got = 0;
    while (*got < size && !s->ended) {
        size_t room = size - *got < INT_MAX ? size - *got : INT_MAX;
        s->z.next_out = (Bytef *)buffer + *got;
        s->z.avail_out = (uInt)room;
        status st = inflate_some(s);
        if (st != ST_OK)
            return st;
        *got += room - s->z.avail_out;
    }
    return ST_OK;
}
