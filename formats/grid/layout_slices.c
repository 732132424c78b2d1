#include "formats/grid/layout_slices.h"

#include <endian.h>

#include "formats/grid/volume.h"
#include "formats/input/text_stream.h"
#include "formats/input/unpack_stream.h"

typedef struct layout_slices {
    volume_layout layout; /* its grid has gone to the source, but for sizes and type */
    unpack_stream *packed;
} layout_slices;

static const char *name_of(const layout_slices *s) {
    return byte_stream_name(s->layout.data);
}

/* ---- reading ---- */

/* Samples of the file's byte order, native for VOLUME_TEXT; *got counts bytes. */
static status read_encoded(layout_slices *s, void *buffer, size_t size, size_t *got) {
    const volume_layout *l = &s->layout;
    size_t width = sample_size(l->g.type);
    status st = ST_OK;
    switch (l->encoding) {
    case VOLUME_RAW: return byte_stream_read(l->data, buffer, size, got);
    case VOLUME_DEFLATE: return unpack_stream_read(s->packed, buffer, size, got);
    case VOLUME_TEXT:
        st = text_stream_read(l->data, l->g.type, buffer, size / width, got);
        *got *= width;
        break;
    }
    return st;
}

static bool is_foreign(const volume_layout *l) {
    bool big_here = __BYTE_ORDER == __BIG_ENDIAN;
    return l->encoding != VOLUME_TEXT && l->big_endian != big_here;
}

static status read_slices(void *ctx, uint32_t first, uint32_t count, void *slices) {
    layout_slices *s = ctx;
    const grid *g = &s->layout.g;
    const size_t bytes = grid_slice_bytes(g), size = count * bytes;
    size_t got = 0;
    status st = read_encoded(s, slices, size, &got);
    if (st != ST_OK)
        return st;
    if (got < size)
        return status_describe(ST_CORRUPT,
                               "%s: ends at byte %llu, inside slice %u of %u (counted from 0)",
                               name_of(s), (unsigned long long)byte_stream_position(s->layout.data),
                               first + (uint32_t)(got / bytes), g->dims[2]);
    if (is_foreign(&s->layout))
        sample_swap(g->type, slices, size / sample_size(g->type));
    return ST_OK;
}

/* Bytes that are left, taken and counted. */
static status drain(layout_slices *s, uint64_t *count) {
    uint8_t waste[4096];
    for (size_t got = 1; got > 0; *count += got) {
        status st = s->packed ? unpack_stream_read(s->packed, waste, sizeof waste, &got)
                              : byte_stream_read(s->layout.data, waste, sizeof waste, &got);
        if (st != ST_OK)
            return st;
        if (*count > VOLUME_TRAILING_MAX)
            return status_describe(ST_CORRUPT, "%s: more than %d bytes behind the last sample",
                                   name_of(s), VOLUME_TRAILING_MAX);
    }
    return ST_OK;
}

static status finish(void *ctx, uint64_t *trailing) {
    layout_slices *s = ctx;
    *trailing = 0;
    const uint64_t left = byte_stream_left(s->layout.data);
    if (s->packed || left == UINT64_MAX)
        return drain(s, trailing);
    *trailing = left;
    return ST_OK;
}

/* ---- opening ---- */

/* Decompressed bytes in front of the samples go. */
static status skip_decoded(layout_slices *s) {
    uint8_t waste[4096];
    for (uint64_t left = s->layout.skip_decoded; left > 0;) {
        size_t got = 0, want = left < sizeof waste ? (size_t)left : sizeof waste;
        status st = unpack_stream_read(s->packed, waste, want, &got);
        if (st != ST_OK)
            return st;
        if (got < want)
            return status_describe(ST_CORRUPT, "%s: the data ends %llu bytes before the samples",
                                   name_of(s), (unsigned long long)(left - got));
        left -= got;
    }
    return ST_OK;
}

static void close_slices(void *ctx) {
    layout_slices *s = ctx;
    unpack_stream_close(s->packed);
    byte_stream_close(s->layout.data);
    mem_free(s->layout.m, s);
}

status layout_slices_open(volume_layout *l, slice_source *out) {
    layout_slices *s = mem_zalloc(l->m, sizeof *s);
    if (!s)
        return ST_NOMEM;
    s->layout = *l;
    status st = ST_OK;
    if (l->encoding == VOLUME_DEFLATE) {
        st = unpack_stream_open(l->m, &packer_zlib, l->data, &s->packed);
        if (st == ST_OK)
            st = skip_decoded(s);
    }
    if (st != ST_OK) {
        s->layout.data = NULL; /* still the caller's */
        close_slices(s);
        return st;
    }
    *out = (slice_source){.name = name_of(s),
                          .m = l->m,
                          .g = l->g,
                          .read = read_slices,
                          .finish = finish,
                          .close = close_slices,
                          .ctx = s};
    for (int a = 0; a < 3; a++)
        s->layout.g.axis[a] = NULL;
    l->data = NULL;
    l->g = (grid){0};
    return ST_OK;
}
