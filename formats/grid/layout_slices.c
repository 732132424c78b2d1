#include "formats/grid/layout_slices.h"

#include <endian.h>
#include <string.h>

#include "formats/grid/sample_place.h"
#include "formats/grid/volume.h"
#include "formats/input/text_stream.h"
#include "formats/input/unpack_stream.h"

enum { CHUNK_BYTES = 1 << 16, HELD_MAX = 1 << 28 };

/* Slices whose samples lie in another order than the grid's. One pass over the input gathers as
 * many slices as there is room for. They are handed out one by one. */
typedef struct held_slices {
    sample_order order;
    uint32_t first_component, end_component; /* range of the stored components */
    size_t slice_bytes;                      /* bytes of a held slice */
    char *slices, *run;
    uint32_t room, first, count;
    byte_stream *again; /* stream of the second and later passes */
    uint64_t start;     /* where the samples begin */
    bool passed;        /* the first pass is over */
} held_slices;

typedef struct layout_slices {
    volume_layout layout;            /* the source owns its grid; sizes and type are kept here */
    char time_unit[WORLD_TIME_UNIT]; /* unit of the grid's frame, which is handed on */
    stored_samples in_file;          /* as the file has them; layout.stored: as they are held */
    unpack_stream *packed;
    uint64_t start;  /* of the stream: its first sample */
    uint64_t behind; /* bytes of later steps, if they lie behind this one */
    char *chunk;     /* stored samples; NULL: they need no conversion */
    held_slices held;
    double rounding; /* largest rounding error so far */
} layout_slices;

static const char *name_of(const layout_slices *s) {
    return byte_stream_name(s->layout.data);
}

static byte_stream *data_of(const layout_slices *s) {
    return s->held.again ? s->held.again : s->layout.data;
}

/* ---- bytes, as they are stored ---- */

/* Read stored bytes, in the file's byte order (native for VOLUME_TEXT). *got is smaller only at the
 * end. */
static status read_encoded(layout_slices *s, void *buffer, size_t size, size_t *got) {
    const volume_layout *l = &s->layout;
    size_t width = sample_size(l->stored.type);
    status st = ST_OK;
    switch (l->encoding) {
    case VOLUME_RAW: return byte_stream_read(data_of(s), buffer, size, got);
    case VOLUME_DEFLATE:
    case VOLUME_BZIP2: return unpack_stream_read(s->packed, buffer, size, got);
    case VOLUME_TEXT:
        st = text_stream_read(l->data, l->stored.type, buffer, size / width, got);
        *got *= width;
        break;
    }
    return st;
}

static status ends_early(const layout_slices *s, uint32_t slice) {
    return status_describe(
        ST_CORRUPT, "%s: ends at byte %llu, inside slice %u of %u (counted from 0)", name_of(s),
        (unsigned long long)byte_stream_position(data_of(s)), slice, s->layout.g.dims[2]);
}

/* Skip bytes in front of, between or behind the samples. */
static status skip_encoded(void *ctx, uint64_t bytes) {
    layout_slices *s = ctx;
    char waste[4096];
    if (s->layout.encoding == VOLUME_RAW)
        return byte_stream_skip(data_of(s), bytes);
    while (bytes > 0) {
        size_t got = 0, want = bytes < sizeof waste ? (size_t)bytes : sizeof waste;
        status st = read_encoded(s, waste, want, &got);
        if (st != ST_OK)
            return st;
        if (got < want)
            return status_describe(ST_CORRUPT, "%s: the data ends %llu bytes before the samples do",
                                   name_of(s), (unsigned long long)(bytes - got));
        bytes -= got;
    }
    return ST_OK;
}

static void make_native(const layout_slices *s, void *numbers, size_t bytes) {
    const volume_layout *l = &s->layout;
    const bool big_here = __BYTE_ORDER == __BIG_ENDIAN;
    if (l->encoding != VOLUME_TEXT && l->big_endian != big_here)
        sample_swap(l->stored.type, numbers, bytes / sample_size(l->stored.type));
}

/* ---- slices ---- */

/* Convert stored samples of native byte order. at: number of samples in front of them in the grid.
 */
static status take(layout_slices *s, void *in, void *out, uint64_t at, size_t count) {
    const uint64_t slice = (uint64_t)s->layout.g.dims[0] * s->layout.g.dims[1];
    const size_t bad = stored_samples_take(&s->layout.stored, in, s->layout.g.type, out, count);
    if (bad == count)
        return ST_OK;
    return status_describe(ST_UNSUPPORTED,
                           "%s: slice %llu (counted from 0): the sample with index %llu is a %s "
                           "with more than the 53 bits that a double holds",
                           name_of(s), (unsigned long long)((at + bad) / slice),
                           (unsigned long long)((at + bad) % slice),
                           sample_name(s->layout.stored.type));
}

/* Read samples that need no conversion straight to where they belong. */
static status read_plain(layout_slices *s, uint32_t first, uint32_t count, void *slices) {
    const size_t bytes = grid_slice_bytes(&s->layout.g), size = count * bytes;
    size_t got = 0;
    status st = read_encoded(s, slices, size, &got);
    if (st != ST_OK)
        return st;
    if (got < size)
        return ends_early(s, first + (uint32_t)(got / bytes));
    make_native(s, slices, size);
    return ST_OK;
}

/* Read and convert samples, chunk by chunk. */
static status read_chunks(layout_slices *s, uint32_t first, uint32_t count, char *slices) {
    const grid *g = &s->layout.g;
    const size_t width = stored_samples_bytes(&s->layout.stored), most = CHUNK_BYTES / width;
    const uint64_t slice = (uint64_t)g->dims[0] * g->dims[1], all = slice * count;
    for (uint64_t done = 0, n; done < all; done += n) {
        size_t got = 0;
        n = all - done < most ? all - done : most;
        status st = read_encoded(s, s->chunk, n * width, &got);
        if (st != ST_OK)
            return st;
        if (got < n * width)
            return ends_early(s, first + (uint32_t)((done + got / width) / slice));
        make_native(s, s->chunk, got);
        st = take(s, s->chunk, slices + done * sample_size(g->type), first * slice + done, n);
        if (st != ST_OK)
            return st;
    }
    return ST_OK;
}

/* ---- slices of another order ---- */

/* Read through the stream's buffer, which byte_stream_read() bypasses: runs are short. */
static status read_buffered(layout_slices *s, void *to, size_t bytes, size_t *got) {
    const uint8_t *data;
    status st = byte_stream_peek(data_of(s), bytes, &data, got);
    if (st != ST_OK)
        return st;
    *got = *got < bytes ? *got : bytes;
    memcpy(to, data, *got);
    byte_stream_take(data_of(s), *got);
    return ST_OK;
}

static status read_exactly(void *ctx, void *to, size_t bytes) {
    layout_slices *s = ctx;
    const bool small = s->layout.encoding == VOLUME_RAW && bytes <= BYTE_STREAM_BUFFER / 4;
    size_t got = 0;
    status st = small ? read_buffered(s, to, bytes, &got) : read_encoded(s, to, bytes, &got);
    return st == ST_OK && got < bytes ? ends_early(s, s->held.first) : st;
}

/* Go back to where the samples begin. */
static status begin_again(layout_slices *s) {
    held_slices *h = &s->held;
    byte_stream_close(h->again);
    h->again = NULL;
    status st = byte_stream_open_stored(s->layout.m, byte_stream_path(s->layout.data), &h->again);
    return st == ST_OK ? byte_stream_skip(h->again, h->start) : st;
}

static status gather(layout_slices *s, uint32_t slice) {
    held_slices *h = &s->held;
    const uint32_t *dims = s->layout.g.dims;
    const uint32_t left = dims[2] - slice;
    h->first = slice;
    h->count = left < h->room ? left : h->room;
    const uint32_t step = s->layout.step;
    const uint32_t first[ORDER_AXES] = {0, 0, slice, h->first_component, step};
    const uint32_t end[ORDER_AXES] = {dims[0], dims[1], slice + h->count, h->end_component,
                                      step + 1};
    const sample_bytes from = {read_exactly, skip_encoded, s};
    status st = h->passed ? begin_again(s) : ST_OK;
    h->passed = true;
    if (st == ST_OK)
        st = sample_order_gather(&h->order, &from, first, end, h->run, h->slices);
    if (st == ST_OK)
        make_native(s, h->slices, h->count * h->slice_bytes);
    return st;
}

static status read_held(layout_slices *s, uint32_t first, uint32_t count, char *slices) {
    held_slices *h = &s->held;
    const uint64_t slice = (uint64_t)s->layout.g.dims[0] * s->layout.g.dims[1];
    for (uint32_t z = first; z < first + count; z++) {
        status st = z < h->first + h->count ? ST_OK : gather(s, z);
        if (st == ST_OK)
            st = take(s, h->slices + (z - h->first) * h->slice_bytes,
                      slices + (z - first) * grid_slice_bytes(&s->layout.g), z * slice, slice);
        if (st != ST_OK)
            return st;
    }
    return ST_OK;
}

static status read_slices(void *ctx, uint32_t first, uint32_t count, void *slices) {
    layout_slices *s = ctx;
    if (s->held.slices)
        return read_held(s, first, count, slices);
    return s->chunk ? read_chunks(s, first, count, slices) : read_plain(s, first, count, slices);
}

/* A file that is not packed can be gone through anywhere. */
static bool seeks(const layout_slices *s) {
    return s->layout.encoding == VOLUME_RAW && byte_stream_left(s->layout.data) != UINT64_MAX;
}

static status skip_slices(void *ctx, uint32_t count) {
    layout_slices *s = ctx;
    const uint64_t slice = (uint64_t)s->layout.g.dims[0] * s->layout.g.dims[1];
    return s->held.slices
               ? ST_OK
               : skip_encoded(s, count * slice * stored_samples_bytes(&s->layout.stored));
}

static bool find_place(void *ctx, sample_place *out) {
    const layout_slices *s = ctx;
    const volume_layout *l = &s->layout;
    if (!seeks(s) || s->held.slices)
        return false;
    *out = (sample_place){.path = byte_stream_path(l->data),
                          .offset = s->start,
                          .big_endian = l->big_endian,
                          .stored = l->stored};
    out->stored.rounding = NULL;
    return true;
}

/* ---- what follows ---- */

/* Take and count the bytes that are left. */
static status drain(layout_slices *s, uint64_t *count) {
    uint8_t waste[4096];
    for (size_t got = 1; got > 0; *count += got) {
        status st = s->packed ? unpack_stream_read(s->packed, waste, sizeof waste, &got)
                              : byte_stream_read(data_of(s), waste, sizeof waste, &got);
        if (st != ST_OK)
            return st;
        if (*count > VOLUME_TRAILING_MAX)
            return status_describe(ST_CORRUPT, "%s: more than %d bytes behind the last sample",
                                   name_of(s), VOLUME_TRAILING_MAX);
    }
    return ST_OK;
}

static status count_trailing(layout_slices *s, uint64_t *trailing) {
    *trailing = 0;
    status st = s->behind ? skip_encoded(s, s->behind) : ST_OK;
    if (st != ST_OK)
        return st;
    const uint64_t left = byte_stream_left(data_of(s));
    if (s->packed || left == UINT64_MAX)
        return drain(s, trailing);
    *trailing = left;
    return ST_OK;
}

static void next_step(void *ctx) {
    layout_slices *s = ctx;
    s->layout.step++;
    s->behind -= volume_layout_step_bytes(&s->layout);
}

static status finish(void *ctx, uint64_t *trailing) {
    layout_slices *s = ctx;
    *trailing = 0;
    if (s->layout.all_steps && s->behind > 0)
        return ST_OK;
    status st = count_trailing(s, trailing);
    if (s->layout.has_tail)
        *trailing = 0;
    return st;
}

/* ---- opening ---- */

/* Tell the one field, which may have several steps. */
static status tell_fields(void *ctx, const slice_fields *to) {
    const layout_slices *s = ctx;
    const volume_layout *l = &s->layout;
    slice_field one = {.name = "", .steps = l->steps ? l->steps : 1, .taken = true};
    stored_samples_tell(&s->in_file, &one);
    if (l->time_step == 0 || one.steps == 1)
        return to->take(to->ctx, &one);
    double *times = mem_array(l->m, one.steps, sizeof *times);
    if (!times)
        return ST_NOMEM;
    for (uint32_t i = 0; i < one.steps; i++)
        times[i] = l->first_time + i * l->time_step;
    one.times = times;
    one.time_unit = s->time_unit[0] ? s->time_unit : NULL;
    const status st = to->take(to->ctx, &one);
    mem_free(l->m, times);
    return st;
}

static void close_slices(void *ctx) {
    layout_slices *s = ctx;
    unpack_stream_close(s->packed);
    byte_stream_close(s->held.again);
    byte_stream_close(s->layout.data);
    mem_free(s->layout.m, s->held.slices);
    mem_free(s->layout.m, s->held.run);
    mem_free(s->layout.m, s->chunk);
    mem_free(s->layout.m, s);
}

/* Returns how many slices to hold. A file can be read again, so memory sets their number; of
 * anything else all are held. */
static uint32_t held_room(const layout_slices *s) {
    const volume_layout *l = &s->layout;
    const uint32_t all = l->g.dims[2];
    if (!seeks(s))
        return all;
    const uint64_t left = l->m->limit ? l->m->limit - mem_used(l->m) : UINT64_MAX;
    const uint64_t bytes = left / 4 < HELD_MAX ? left / 4 : HELD_MAX;
    const uint64_t room = bytes / s->held.slice_bytes;
    return room < 1 ? 1 : room < all ? (uint32_t)room : all;
}

static status hold(layout_slices *s) {
    volume_layout *l = &s->layout;
    held_slices *h = &s->held;
    const uint32_t components = l->stored.components ? l->stored.components : 1;
    h->order = (sample_order){
        .count = {l->g.dims[0], l->g.dims[1], l->g.dims[2], components, l->steps ? l->steps : 1},
        .width = sample_size(l->stored.type),
    };
    memcpy(h->order.axis, l->order, sizeof l->order);
    h->start = byte_stream_position(l->data);
    h->first_component = l->stored.component ? l->stored.component - 1 : 0;
    h->end_component = l->stored.component ? l->stored.component : components;
    l->stored.components = h->end_component - h->first_component;
    l->stored.component = 0;
    h->slice_bytes = (size_t)l->g.dims[0] * l->g.dims[1] * stored_samples_bytes(&l->stored);
    h->room = held_room(s);
    h->slices = mem_alloc(l->m, h->room * h->slice_bytes);
    h->run = mem_alloc(l->m, h->order.count[h->order.axis[0]] * h->order.width);
    if (h->slices && h->run)
        return ST_OK;
    return status_describe(
        ST_NOMEM,
        "%s: its samples do not lie in order of x, y and z: %llu bytes of memory "
        "are needed%s",
        name_of(s), (unsigned long long)(h->room * h->slice_bytes),
        h->room > 1 ? ", fewer where it is a file and not packed" : "");
}

static status prepare(layout_slices *s) {
    volume_layout *l = &s->layout;
    const packer *packed = volume_layout_packer(l);
    status st = packed ? unpack_stream_open(l->m, packed, l->data, &s->packed) : ST_OK;
    if (st == ST_OK && packed)
        st = skip_encoded(s, l->skip_decoded);
    if (st == ST_OK && l->ordered)
        return hold(s);
    if (st == ST_OK && l->steps > 1) {
        s->behind = (l->steps - 1 - l->step) * volume_layout_step_bytes(l);
        st = skip_encoded(s, l->step * volume_layout_step_bytes(l));
    }
    s->start = byte_stream_position(l->data);
    if (st != ST_OK || stored_samples_plain(&l->stored))
        return st;
    s->chunk = mem_alloc(l->m, CHUNK_BYTES);
    return s->chunk ? ST_OK : ST_NOMEM;
}

status layout_slices_open(volume_layout *l, slice_source *out) {
    layout_slices *s = mem_zalloc(l->m, sizeof *s);
    if (!s)
        return ST_NOMEM;
    s->layout = *l;
    s->layout.stored.rounding = &s->rounding;
    s->in_file = l->stored;
    memcpy(s->time_unit, l->g.frame.time_unit, sizeof s->time_unit);
    const bool several = l->steps > 1 || l->stored.components > 1;
    status st = prepare(s);
    if (st != ST_OK) {
        s->layout.data = NULL; /* the caller keeps it */
        close_slices(s);
        return st;
    }
    *out = (slice_source){.name = name_of(s),
                          .has_fields = several,
                          .has_missing = l->has_missing,
                          .missing = l->missing,
                          .m = l->m,
                          .g = l->g,
                          .read = read_slices,
                          .skip = seeks(s) ? skip_slices : NULL,
                          .place = find_place,
                          .place_ctx = s,
                          .finish = finish,
                          .next_step = l->all_steps ? next_step : NULL,
                          .close = close_slices,
                          .ctx = s,
                          .rounding = &s->rounding,
                          .fields = tell_fields,
                          .fields_ctx = s};
    for (int a = 0; a < 3; a++)
        s->layout.g.axis[a] = NULL;
    l->data = NULL;
    l->g = (grid){0};
    return ST_OK;
}
