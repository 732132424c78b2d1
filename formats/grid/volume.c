#include "formats/grid/volume.h"

#include <endian.h>
#include <math.h>
#include <string.h>

#include "formats/base/file.h"
#include "formats/base/num.h"
#include "formats/base/text.h"
#include "formats/grid/metaimage.h"
#include "formats/grid/nrrd.h"
#include "formats/grid/rawfile.h"
#include "formats/grid/volume_layout.h"
#include "formats/input/byte_stream.h"
#include "formats/input/inflate_stream.h"
#include "formats/input/text_stream.h"

struct volume {
    mem *m;
    volume_layout layout;
    const char *format;
    sample_type type;        /* of the samples in the file; layout.g.type: as they are handed out */
    inflate_stream *inflate; /* VOLUME_DEFLATE */
    volume_source from;      /* instead of layout.data */
    uint32_t slice;          /* the next one */
    bool has_missing;
    double missing; /* read as NaN */
};

/* For messages. */
static const char *name_of(const volume *v) {
    return v->layout.data ? byte_stream_name(v->layout.data) : "slices";
}

/* ---- opening ---- */

static status open_header(volume *v, const char *path, const volume_hints *hints) {
    volume_layout *l = &v->layout;
    const uint8_t *start;
    size_t size;
    status st = byte_stream_peek(l->data, 16, &start, &size);
    if (st != ST_OK)
        return st;
    v->format = "NRRD";
    if (nrrd_known(start, size))
        return nrrd_open(l);
    v->format = "MetaImage";
    if (metaimage_known(path, start, size))
        return metaimage_open(l);
    v->format = VOLUME_RAW_SAMPLES;
    return rawfile_open(l, path, hints);
}

static void apply_spacing(grid *g, int a, double spacing) {
    double x = g->to_world[0][a], y = g->to_world[1][a], z = g->to_world[2][a];
    double length = sqrt(x * x + y * y + z * z);
    for (int row = 0; row < 3; row++)
        g->to_world[row][a] = g->to_world[row][a] / length * spacing;
}

/* The whole of a text file, NUL-terminated. */
static status read_text(mem *m, const char *path, char **out) {
    file *f = NULL;
    char *text = NULL;
    status st = file_open(m, path, &f);
    if (st != ST_OK)
        return st;
    const size_t size = (size_t)file_size(f);
    if (size > TEXT_LINE_MAX)
        st = status_describe(ST_UNSUPPORTED, "%s: expected a text file of coordinates", path);
    else if (!(text = mem_alloc(m, size + 1)))
        st = ST_NOMEM;
    else
        st = file_read_at(f, 0, text, size);
    file_close(f);
    if (st != ST_OK) {
        mem_free(m, text);
        return st;
    }
    text[size] = 0;
    *out = text;
    return ST_OK;
}

static status apply_axis_file(volume_layout *l, int a, const char *path) {
    char *text = NULL;
    status st = read_text(l->m, path, &text);
    if (st == ST_OK)
        st = volume_layout_axis(l, path, a, text);
    mem_free(l->m, text);
    return st;
}

static status apply_hints(volume_layout *l, const volume_hints *hints) {
    for (int a = 0; a < 3; a++) {
        /* Coordinates first: they set the axis' step, which the hint replaces. */
        status st = hints->axis_file[a] ? apply_axis_file(l, a, hints->axis_file[a]) : ST_OK;
        if (st != ST_OK)
            return st;
        if (hints->spacing[a] != 0)
            apply_spacing(&l->g, a, hints->spacing[a]);
        if (hints->has_origin)
            l->g.to_world[a][3] = hints->origin[a];
    }
    return ST_OK;
}

/* Integers have no NaN: with a value for missing data they are handed out as floats. */
static status apply_missing(volume *v, const volume_hints *hints) {
    grid *g = &v->layout.g;
    char value[NUM_TEXT_MAX];
    v->type = g->type;
    v->has_missing = hints->has_missing;
    v->missing = hints->missing;
    if (!v->has_missing)
        return ST_OK;
    if (!sample_holds(g->type, v->missing))
        return status_describe(ST_USAGE,
                               "%s: its samples are of type %s: none can be %s, the value for "
                               "missing data",
                               name_of(v), sample_name(g->type), num_print(v->missing, value));
    if (sample_is_integer(g->type)) {
        g->source = g->type;
        g->type = SAMPLE_F32;
    }
    return ST_OK;
}

/* Decompressed bytes in front of the samples go. */
static status skip_decoded(volume *v) {
    uint8_t waste[4096];
    for (uint64_t left = v->layout.skip_decoded; left > 0;) {
        size_t got = 0, want = left < sizeof waste ? (size_t)left : sizeof waste;
        status st = inflate_stream_read(v->inflate, waste, want, &got);
        if (st != ST_OK)
            return st;
        if (got < want)
            return status_describe(ST_CORRUPT, "%s: the data ends %llu bytes before the samples",
                                   byte_stream_name(v->layout.data),
                                   (unsigned long long)(left - got));
        left -= got;
    }
    return ST_OK;
}

static status open_volume(volume *v, const char *path, const volume_hints *hints) {
    volume_layout *l = &v->layout;
    status st = open_header(v, path, hints);
    if (st == ST_OK)
        st = volume_layout_check(l);
    if (st == ST_OK)
        st = apply_hints(l, hints);
    if (st == ST_OK)
        st = apply_missing(v, hints);
    if (st == ST_OK)
        st = grid_check(&l->g, byte_stream_name(l->data));
    if (st != ST_OK)
        return st;
    /* Never the file's: the same samples are the same data set. */
    text_name(l->g.name, sizeof l->g.name, hints->name ? hints->name : l->g.name);
    if (l->encoding != VOLUME_DEFLATE)
        return ST_OK;
    st = inflate_stream_open(v->m, l->data, &v->inflate);
    return st == ST_OK ? skip_decoded(v) : st;
}

/* path: s may be closed for another one, of the file that a header names. */
static status open_named(mem *m, const char *path, byte_stream *s, const volume_hints *hints,
                         volume **out) {
    static const volume_hints none;
    volume *v = mem_zalloc(m, sizeof *v);
    if (!v) {
        byte_stream_close(s);
        return ST_NOMEM;
    }
    v->m = m;
    v->layout.m = m;
    v->layout.data = s;
    status st = open_volume(v, path, hints ? hints : &none);
    if (st != ST_OK) {
        volume_close(v);
        return st;
    }
    *out = v;
    return ST_OK;
}

status volume_open(mem *m, const char *path, const volume_hints *hints, volume **out) {
    byte_stream *s;
    status st = byte_stream_open(m, path, &s);
    return st == ST_OK ? open_named(m, path, s, hints, out) : st;
}

status volume_open_stream(mem *m, byte_stream *s, const volume_hints *hints, volume **out) {
    char *path = mem_copy_text(m, byte_stream_path(s));
    if (!path) {
        byte_stream_close(s);
        return ST_NOMEM;
    }
    status st = open_named(m, path, s, hints, out);
    mem_free(m, path);
    return st;
}

status volume_open_source(mem *m, grid *g, const volume_source *from, const volume_hints *hints,
                          volume **out) {
    static const volume_hints none;
    volume *v = mem_zalloc(m, sizeof *v);
    if (!v) {
        grid_release(g, m);
        return ST_NOMEM;
    }
    const volume_hints *h = hints ? hints : &none;
    *v = (volume){.m = m, .layout = {.m = m, .g = *g}, .format = "slices", .from = *from};
    status st = apply_missing(v, h);
    if (st != ST_OK) {
        volume_close(v);
        return st;
    }
    text_name(v->layout.g.name, sizeof v->layout.g.name, h->name ? h->name : v->layout.g.name);
    *out = v;
    return ST_OK;
}

void volume_close(volume *v) {
    if (!v)
        return;
    inflate_stream_close(v->inflate);
    volume_layout_release(&v->layout);
    mem_free(v->m, v);
}

const grid *volume_grid(const volume *v) {
    return &v->layout.g;
}

const char *volume_format(const volume *v) {
    return v->format;
}

/* ---- reading ---- */

/* Samples of the file's byte order, native for VOLUME_TEXT; *got counts bytes. */
static status read_encoded(volume *v, void *buffer, size_t size, size_t *got) {
    const volume_layout *l = &v->layout;
    size_t width = sample_size(v->type);
    status st = ST_OK;
    switch (l->encoding) {
    case VOLUME_RAW: return byte_stream_read(l->data, buffer, size, got);
    case VOLUME_DEFLATE: return inflate_stream_read(v->inflate, buffer, size, got);
    case VOLUME_TEXT:
        st = text_stream_read(l->data, v->type, buffer, size / width, got);
        *got *= width;
        break;
    }
    return st;
}

static bool is_foreign(const volume_layout *l) {
    bool big_here = __BYTE_ORDER == __BIG_ENDIAN;
    return l->encoding != VOLUME_TEXT && l->big_endian != big_here;
}

/* Missing data is NaN from here on. Compared in the samples' own precision, as it was written.
 * at: the samples, at the end of buffer. */
static status mark_missing(const volume *v, const void *at, void *buffer, size_t count) {
    if (v->type == SAMPLE_F32) {
        float *f = buffer, missing = (float)v->missing;
        for (size_t i = 0; i < count; i++)
            f[i] = f[i] == missing ? NAN : f[i];
    } else if (v->type == SAMPLE_F64) {
        double *d = buffer;
        for (size_t i = 0; i < count; i++)
            d[i] = d[i] == v->missing ? (double)NAN : d[i];
    } else {
        const grid *g = &v->layout.g;
        const uint64_t slice = (uint64_t)g->dims[0] * g->dims[1];
        const size_t bad = sample_to_floats(v->type, at, buffer, count, v->missing);
        if (bad < count)
            return status_describe(ST_UNSUPPORTED,
                                   "%s: slice %u (counted from 0): with a value for missing data, "
                                   "samples of type %s are kept as f32, which cannot hold the one "
                                   "with index %llu, near %.0f",
                                   name_of(v), v->slice + (uint32_t)(bad / slice),
                                   sample_name(v->type), (unsigned long long)(bad % slice),
                                   (double)((const float *)buffer)[bad]);
    }
    return ST_OK;
}

/* Slices of `bytes` bytes as the file has them, in native byte order. */
static status read_file(volume *v, uint32_t count, size_t bytes, char *at) {
    const size_t size = count * bytes;
    size_t got = 0;
    status st = read_encoded(v, at, size, &got);
    if (st != ST_OK)
        return st;
    if (got < size)
        return status_describe(ST_CORRUPT,
                               "%s: ends at byte %llu, inside slice %u of %u (counted from 0)",
                               name_of(v), (unsigned long long)byte_stream_position(v->layout.data),
                               v->slice + (uint32_t)(got / bytes), v->layout.g.dims[2]);
    if (is_foreign(&v->layout))
        sample_swap(v->type, at, size / sample_size(v->type));
    return ST_OK;
}

static status read_source(const volume *v, uint32_t count, size_t bytes, char *at) {
    status st = ST_OK;
    for (uint32_t i = 0; i < count && st == ST_OK; i++)
        st = v->from.read(v->from.ctx, v->slice + i, at + i * bytes);
    return st;
}

status volume_read(volume *v, uint32_t count, void *buffer) {
    const grid *g = &v->layout.g;
    const size_t slice = (size_t)g->dims[0] * g->dims[1], width = sample_size(v->type);
    const size_t samples = slice * count;
    char *at = (char *)buffer + samples * (sample_size(g->type) - width);
    status st = v->from.read ? read_source(v, count, slice * width, at)
                             : read_file(v, count, slice * width, at);
    if (st != ST_OK)
        return st;
    if (v->has_missing)
        st = mark_missing(v, at, buffer, samples);
    v->slice += count;
    return st;
}

/* Bytes that are left, taken and counted. */
static status drain(volume *v, uint64_t *count) {
    uint8_t waste[4096];
    bool deflate = v->layout.encoding == VOLUME_DEFLATE;
    for (size_t got = 1; got > 0; *count += got) {
        status st = deflate ? inflate_stream_read(v->inflate, waste, sizeof waste, &got)
                            : byte_stream_read(v->layout.data, waste, sizeof waste, &got);
        if (st != ST_OK)
            return st;
        if (*count > VOLUME_TRAILING_MAX)
            return status_describe(ST_CORRUPT, "%s: more than %d bytes behind the last sample",
                                   byte_stream_name(v->layout.data), VOLUME_TRAILING_MAX);
    }
    return ST_OK;
}

status volume_finish(volume *v, uint64_t *trailing) {
    uint64_t count = 0, left = v->from.read ? 0 : byte_stream_left(v->layout.data);
    status st = ST_OK;
    if (v->layout.encoding == VOLUME_DEFLATE || left == UINT64_MAX)
        st = drain(v, &count);
    else
        count = left;
    if (st == ST_OK && trailing)
        *trailing = count;
    return st;
}
