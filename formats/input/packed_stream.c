/* packed_stream.c - byte_stream_open(): a file as it is, or unpacked. */
#include "formats/input/byte_stream.h"
#include "formats/input/dicom_mark.h"
#include "formats/input/unpack_stream.h"

/* A source of unpacked bytes. */
typedef struct unpacked {
    mem *m;
    byte_stream *packed;
    unpack_stream *bytes;
} unpacked;

static status read_unpacked(void *ctx, void *to, size_t size, size_t *got) {
    return unpack_stream_read(((unpacked *)ctx)->bytes, to, size, got);
}

static void close_unpacked(void *ctx) {
    unpacked *u = ctx;
    unpack_stream_close(u->bytes);
    byte_stream_close(u->packed);
    mem_free(u->m, u);
}

/* Make a stream of unpacked bytes. packed is taken over. */
static status unpack(mem *m, const packer *how, byte_stream *packed, byte_stream **out) {
    *out = NULL;
    unpacked *u = mem_zalloc(m, sizeof *u);
    if (!u) {
        byte_stream_close(packed);
        return ST_NOMEM;
    }
    *u = (unpacked){.m = m, .packed = packed};
    const byte_source from = {read_unpacked, close_unpacked, u};
    status st = unpack_stream_open(m, how, packed, &u->bytes);
    if (st != ST_OK) {
        close_unpacked(u);
        return st;
    }
    st = byte_stream_open_source(m, byte_stream_path(packed), &from, out);
    if (st == ST_OK && packer_is_suffix(byte_stream_kind(*out)))
        byte_stream_drop_suffix(*out);
    return st;
}

status byte_stream_open(mem *m, const char *path, byte_stream **out) {
    const uint8_t *start;
    size_t size = 0;
    status st = byte_stream_open_stored(m, path, out);
    if (st != ST_OK || !(byte_stream_is_pipe(*out) || packer_is_suffix(path)))
        return st;
    st = byte_stream_peek(*out, DICOM_MARK_END, &start, &size);
    if (st != ST_OK) {
        byte_stream_close(*out);
        *out = NULL;
        return st;
    }
    const packer *how = dicom_mark_is_at(start, size) ? NULL : packer_find(start, size);
    return how ? unpack(m, how, *out, out) : ST_OK;
}
