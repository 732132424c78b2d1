#include "formats/grid/tile_stream.h"

#include <string.h>

#include "formats/grid/nrrd_writer.h"

static const char magic[8] = {'L', 'F', 'T', 'I', 'L', 'E', 'S', '\n'};

/* ---- writing ---- */

status tile_stream_begin(out_stream *out, const grid *g, const void *quiet) {
    char value[SLICE_SAMPLE_MAX] = {0};
    memcpy(value, quiet, sample_size(g->type));
    status st = out_stream_write(out, magic, sizeof magic);
    if (st == ST_OK)
        st = out_stream_write(out, value, sizeof value);
    return st == ST_OK ? nrrd_write_header(out, g) : st;
}

status tile_stream_slice(out_stream *out, const grid *g, const void *slice, const uint8_t *busy,
                         void *packed) {
    const size_t bytes = slice_tiles_gather(g->dims, sample_size(g->type), slice, busy, packed);
    const status st = out_stream_write(out, busy, slice_tiles_count(g->dims));
    return st == ST_OK ? out_stream_write(out, packed, bytes) : st;
}

/* ---- reading ---- */

typedef struct tile_stream {
    mem *m;
    byte_stream *data;
    uint32_t dims[3];
    size_t width; /* bytes of a sample */
    uint8_t quiet[SLICE_SAMPLE_MAX];
    char *packed;           /* room for a slice */
    uint8_t *busy, *before; /* maps of a slice */
} tile_stream;

status tile_stream_known(volume_layout *l, bool *known, uint8_t quiet[SLICE_SAMPLE_MAX]) {
    const uint8_t *bytes;
    const size_t head = sizeof magic + SLICE_SAMPLE_MAX;
    size_t size;
    const status st = byte_stream_peek(l->data, head, &bytes, &size);
    *known = st == ST_OK && size >= head && memcmp(bytes, magic, sizeof magic) == 0;
    if (!*known)
        return st;
    memcpy(quiet, bytes + sizeof magic, SLICE_SAMPLE_MAX);
    byte_stream_take(l->data, head);
    return ST_OK;
}

static status take(const tile_stream *s, void *to, size_t size) {
    size_t got = 0;
    const status st = byte_stream_read(s->data, to, size, &got);
    if (st != ST_OK || got == size)
        return st;
    return status_describe(ST_CORRUPT, "%s: its importer's samples end early",
                           byte_stream_name(s->data));
}

static size_t busy_bytes(const tile_stream *s) {
    size_t bytes = 0;
    for (size_t i = 0; i < slice_tiles_count(s->dims); i++)
        if (s->busy[i]) {
            const slice_tile t = slice_tiles_at(s->dims, i);
            bytes += (size_t)(t.end_x - t.x) * (t.end_y - t.y) * s->width;
        }
    return bytes;
}

static status read_slice(const tile_stream *s, char *slice, uint8_t *busy) {
    const size_t count = slice_tiles_count(s->dims);
    status st = take(s, s->busy, count);
    if (st == ST_OK)
        st = take(s, s->packed, busy_bytes(s));
    if (st != ST_OK)
        return st;
    slice_tiles_scatter(s->dims, s->width, s->packed, s->busy, slice);
    for (size_t i = 0; i < count; i++) {
        if (busy[i] && !s->busy[i]) {
            const slice_tile t = slice_tiles_at(s->dims, i);
            slice_tiles_fill(s->dims, &t, s->width, s->quiet, slice);
        }
        busy[i] = s->busy[i] != 0;
    }
    return ST_OK;
}

static status read_tiles(void *ctx, uint32_t first, uint32_t count, void *slices, uint8_t *busy) {
    const tile_stream *s = ctx;
    const size_t bytes = (size_t)s->dims[0] * s->dims[1] * s->width;
    status st = ST_OK;
    (void)first;
    for (uint32_t i = 0; i < count && st == ST_OK; i++)
        st = read_slice(s, (char *)slices + i * bytes, busy + i * slice_tiles_count(s->dims));
    return st;
}

static status read_all(void *ctx, uint32_t first, uint32_t count, void *slices) {
    const tile_stream *s = ctx;
    const size_t bytes = (size_t)s->dims[0] * s->dims[1] * s->width;
    status st = ST_OK;
    (void)first;
    for (uint32_t i = 0; i < count && st == ST_OK; i++) {
        memset(s->before, 1, slice_tiles_count(s->dims));
        st = read_slice(s, (char *)slices + i * bytes, s->before);
    }
    return st;
}

/* Check the end: the importer may still report that it has failed. */
static status finish(void *ctx, uint64_t *trailing) {
    const tile_stream *s = ctx;
    char byte;
    size_t got = 0;
    const status st = byte_stream_read(s->data, &byte, 1, &got);
    *trailing = got;
    return st;
}

static void close_stream(void *ctx) {
    tile_stream *s = ctx;
    byte_stream_close(s->data);
    mem_free(s->m, s->packed);
    mem_free(s->m, s->busy);
    mem_free(s->m, s->before);
    mem_free(s->m, s);
}

status tile_stream_open(volume_layout *l, const uint8_t quiet[SLICE_SAMPLE_MAX],
                        slice_source *out) {
    tile_stream *s = mem_zalloc(l->m, sizeof *s);
    if (!s)
        return ST_NOMEM;
    s->m = l->m;
    s->width = sample_size(l->g.type);
    memcpy(s->dims, l->g.dims, sizeof s->dims);
    memcpy(s->quiet, quiet, SLICE_SAMPLE_MAX);
    s->packed = mem_alloc(l->m, grid_slice_bytes(&l->g));
    s->busy = mem_alloc(l->m, slice_tiles_count(s->dims));
    s->before = mem_alloc(l->m, slice_tiles_count(s->dims));
    if (!s->packed || !s->busy || !s->before) {
        close_stream(s);
        return ST_NOMEM;
    }
    s->data = l->data;
    *out = (slice_source){.name = byte_stream_name(l->data),
                          .m = l->m,
                          .g = l->g,
                          .read = read_all,
                          .read_tiles = read_tiles,
                          .finish = finish,
                          .close = close_stream,
                          .ctx = s};
    memcpy(out->quiet, quiet, SLICE_SAMPLE_MAX);
    l->data = NULL;
    l->g = (grid){0};
    return ST_OK;
}
