#include "formats/grid/zarr.h"

#include <endian.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

#include "formats/grid/zarr_array.h"
#include "formats/grid/zarr_present.h"
#include "formats/input/named_file.h"

enum { HELD_MAX = 1 << 28, NAME_ROOM = ZARR_AXES * 12 };

/* An open array. It holds the samples of one layer of chunks, or of a part of it, as stored but in
 * a grid's order. */
typedef struct zarr {
    mem *m;
    zarr_array a;
    char *folder; /* as it was given */
    bool follow_links;
    grid g;                    /* sizes and type */
    uint32_t step;             /* the step to take */
    uint32_t first_c, numbers; /* range of a sample's numbers that are held */
    size_t width;              /* bytes of a number */
    size_t chunk_bytes, slice_bytes;
    size_t
        stride[ORDER_AXES]; /* distance in a chunk, in numbers, from one to the next along a role */
    uint8_t *chunk, *held;
    uint8_t *coded; /* a chunk before its filters are undone; NULL: no filters */
    size_t coded_bytes;
    uint32_t room, first, count; /* in slices */
    stored_samples in_file;      /* as the file has them; a.stored: as they are held */
    double rounding;             /* largest rounding error so far */
} zarr;

bool zarr_known(const char *folder) {
    static const char *const names[] = {".zarray", ".zgroup", "zarr.json"};
    char path[ZARR_PATH];
    struct stat info;
    for (int i = 0; i < 3; i++)
        if (snprintf(path, sizeof path, "%s/%s", folder, names[i]) < (int)sizeof path &&
            stat(path, &info) == 0)
            return true;
    return false;
}

static uint32_t chunk_of(const zarr *z, int role) {
    return z->a.axis[role] < 0 ? 1 : z->a.chunk[z->a.axis[role]];
}

/* ---- chunks ---- */

/* Read the chunk of these indices, one a role: unpacked, in native byte order. An absent chunk is
 * the fill value. */
static status read_chunk(zarr *z, const uint32_t index[ORDER_AXES]) {
    const zarr_array *a = &z->a;
    char path[ZARR_PATH + NAME_ROOM];
    int length = snprintf(path, sizeof path, "%s", a->path);
    bool there = false;
    for (int i = 0; i < a->axes; i++)
        length += snprintf(path + length, sizeof path - (size_t)length, "%c%u",
                           i ? a->separator : '/', a->role[i] < 0 ? 0 : index[a->role[i]]);
    status st = named_file_check(z->folder, path, z->follow_links);
    if (st == ST_OK)
        st = zarr_chunk_read(z->m, a->codec, path, z->coded ? z->coded : z->chunk, z->coded_bytes,
                             &there);
    if (st == ST_OK && there && z->coded)
        st = zarr_filters_undo(&a->filters, path, z->chunk_bytes / z->width, z->coded, z->chunk);
    if (st != ST_OK)
        return st;
    for (size_t at = 0; !there && at < z->chunk_bytes; at += z->width)
        memcpy(z->chunk + at, a->fill, z->width);
    if (there && a->big_endian != (__BYTE_ORDER == __BIG_ENDIAN))
        sample_swap(a->stored.type, z->chunk, z->chunk_bytes / z->width);
    return ST_OK;
}

/* Copy a row of a chunk, from one number on, to where it is held. */
static void copy_row(const zarr *z, size_t from, uint8_t *to, uint32_t count) {
    const size_t step = z->stride[ORDER_X] * z->width, apart = z->numbers * z->width;
    const uint8_t *number = z->chunk + from * z->width;
    if (step == z->width && apart == z->width) {
        memcpy(to, number, count * z->width);
        return;
    }
    for (uint32_t i = 0; i < count; i++)
        memcpy(to + i * apart, number + i * step, z->width);
}

/* Copy the part of a chunk that lies in the slices held in memory. box: this part, as first and end
 * per role. */
static void copy_chunk(const zarr *z, const uint32_t index[ORDER_AXES],
                       const uint32_t box[2][ORDER_AXES]) {
    size_t from = 0;
    uint32_t origin[ORDER_AXES];
    for (int r = 0; r < ORDER_AXES; r++) {
        origin[r] = index[r] * chunk_of(z, r);
        from += (box[0][r] - origin[r]) * z->stride[r];
    }
    for (uint32_t k = box[0][ORDER_Z]; k < box[1][ORDER_Z]; k++)
        for (uint32_t j = box[0][ORDER_Y]; j < box[1][ORDER_Y]; j++)
            for (uint32_t c = box[0][ORDER_COMPONENT]; c < box[1][ORDER_COMPONENT]; c++) {
                const size_t at = from + (k - box[0][ORDER_Z]) * z->stride[ORDER_Z] +
                                  (j - box[0][ORDER_Y]) * z->stride[ORDER_Y] +
                                  (c - box[0][ORDER_COMPONENT]) * z->stride[ORDER_COMPONENT];
                const size_t row = (size_t)(k - z->first) * z->g.dims[1] + j;
                uint8_t *to = z->held + ((row * z->g.dims[0] + box[0][ORDER_X]) * z->numbers + c -
                                         z->first_c) *
                                            z->width;
                copy_row(z, at, to, box[1][ORDER_X] - box[0][ORDER_X]);
            }
}

/* Find the first chunk that meets first .. end - 1 along each role, and the next one (false behind
 * the last). */
static void first_chunk(const zarr *z, const uint32_t first[ORDER_AXES],
                        uint32_t index[ORDER_AXES]) {
    for (int r = 0; r < ORDER_AXES; r++)
        index[r] = first[r] / chunk_of(z, r);
}

static bool next_chunk(const zarr *z, const uint32_t first[ORDER_AXES],
                       const uint32_t end[ORDER_AXES], uint32_t index[ORDER_AXES]) {
    for (int r = 0; r < ORDER_AXES; r++) {
        if (++index[r] <= (end[r] - 1) / chunk_of(z, r))
            return true;
        index[r] = first[r] / chunk_of(z, r);
    }
    return false;
}

/* ---- slices ---- */

/* Hold slices from one on, at most up to the end of their layer of chunks. */
static status hold(zarr *z, uint32_t slice) {
    const uint32_t depth = chunk_of(z, ORDER_Z), layer_end = (slice / depth + 1) * depth;
    const uint32_t last = layer_end < z->g.dims[2] ? layer_end : z->g.dims[2];
    z->first = slice;
    z->count = last - slice < z->room ? last - slice : z->room;
    const uint32_t first[ORDER_AXES] = {0, 0, slice, z->first_c, z->step};
    const uint32_t end[ORDER_AXES] = {z->g.dims[0], z->g.dims[1], slice + z->count,
                                      z->first_c + z->numbers, z->step + 1};
    uint32_t index[ORDER_AXES];
    first_chunk(z, first, index);
    do {
        uint32_t box[2][ORDER_AXES];
        for (int r = 0; r < ORDER_AXES; r++) {
            const uint64_t from = (uint64_t)index[r] * chunk_of(z, r), to = from + chunk_of(z, r);
            box[0][r] = from > first[r] ? (uint32_t)from : first[r];
            box[1][r] = to < end[r] ? (uint32_t)to : end[r];
        }
        status st = read_chunk(z, index);
        if (st != ST_OK) {
            z->count = 0;
            return st;
        }
        copy_chunk(z, index, (const uint32_t(*)[ORDER_AXES])box);
    } while (next_chunk(z, first, end, index));
    return ST_OK;
}

static status read_slices(void *ctx, uint32_t first, uint32_t count, void *slices) {
    zarr *z = ctx;
    const size_t samples = (size_t)z->g.dims[0] * z->g.dims[1];
    for (uint32_t k = first; k < first + count; k++) {
        status st = k >= z->first && k < z->first + z->count ? ST_OK : hold(z, k);
        if (st != ST_OK)
            return st;
        const size_t bad =
            stored_samples_take(&z->a.stored, z->held + (k - z->first) * z->slice_bytes, z->g.type,
                                (char *)slices + (k - first) * grid_slice_bytes(&z->g), samples);
        if (bad < samples)
            return status_describe(ST_UNSUPPORTED,
                                   "%s: slice %u (counted from 0): the sample with index %zu is a "
                                   "%s with more than the 53 bits that a double holds",
                                   z->a.path, k, bad, sample_name(z->a.stored.type));
    }
    return ST_OK;
}

/* ---- opening ---- */

static void close_zarr(void *ctx) {
    zarr *z = ctx;
    mem_free(z->m, z->chunk);
    mem_free(z->m, z->coded);
    mem_free(z->m, z->held);
    mem_free(z->m, z->folder);
    mem_free(z->m, z);
}

static status set_grid(zarr *z, grid *g) {
    static const uint32_t none[3] = {1, 1, 1};
    const zarr_array *a = &z->a;
    grid_init(g, none, SAMPLE_U8);
    for (int r = 0; r < 3; r++) {
        const int axis = a->axis[r];
        if (axis < 0)
            continue;
        g->dims[r] = a->shape[axis];
        g->to_world[r][r] = a->scale[axis];
        g->to_world[r][3] = a->translation[axis];
        world_frame_set_unit(&g->frame, r, a->unit[axis]);
    }
    memcpy(g->name, a->name, sizeof g->name);
    return grid_check(g, a->path);
}

static uint32_t steps_of(const zarr *z) {
    const int t = z->a.axis[ORDER_STEP];
    return t < 0 ? 1 : z->a.shape[t];
}

/* Make the times of the steps, which increase, by OME's scale and translation. NULL where these are
 * what writers without times put there. */
static status make_times(const zarr *z, double **out) {
    const zarr_array *a = &z->a;
    const int t = a->axis[ORDER_STEP];
    if (t < 0 || a->shape[t] < 2 || !(a->scale[t] > 0) || !isfinite(a->scale[t]) ||
        !isfinite(a->translation[t]) ||
        (a->scale[t] == 1 && a->translation[t] == 0 && !a->unit[t][0]))
        return ST_OK;
    *out = mem_array(z->m, a->shape[t], sizeof **out);
    for (uint32_t i = 0; *out && i < a->shape[t]; i++)
        (*out)[i] = a->translation[t] + i * a->scale[t];
    return *out ? ST_OK : ST_NOMEM;
}

static status tell_fields(void *ctx, const slice_fields *to) {
    const zarr *z = ctx;
    slice_field one = {.name = "", .steps = steps_of(z), .taken = true};
    double *times = NULL;
    stored_samples_tell(&z->in_file, &one);
    status st = make_times(z, &times);
    if (st != ST_OK)
        return st;
    one.times = times;
    if (times && z->a.unit[z->a.axis[ORDER_STEP]][0])
        one.time_unit = z->a.unit[z->a.axis[ORDER_STEP]];
    st = to->take(to->ctx, &one);
    mem_free(z->m, times);
    return st;
}

/* Choose a step, and which numbers of a sample to read. z->a.stored then describes the chosen
 * numbers. */
static status choose(zarr *z, const volume_hints *hints, grid *g) {
    const uint32_t steps = steps_of(z);
    stored_samples *s = &z->a.stored;
    if (hints->step >= steps)
        return status_describe(ST_USAGE, "%s: no step %u: there %s %u, counted from 0", z->a.path,
                               hints->step, steps == 1 ? "is" : "are", steps);
    z->step = hints->step;
    status st = stored_samples_choose(s, z->a.path, hints, g);
    z->in_file = *s;
    z->first_c = s->component ? s->component - 1 : 0;
    z->numbers = s->component ? 1 : s->components;
    s->components = z->numbers;
    s->component = 0;
    return st;
}

/* Count the chunks that will be read, and those of them that have no file. */
static status count_absent(zarr *z, bool allow_missing) {
    const zarr_array *a = &z->a;
    absent_parts *absent = &z->g.absent;
    zarr_range range;
    uint64_t there = 0;
    *absent = (absent_parts){.of = 1, .parts = "chunks"};
    for (int i = 0; i < a->axes; i++) {
        const int r = a->role[i];
        const uint32_t from = r == ORDER_STEP ? z->step : r == ORDER_COMPONENT ? z->first_c : 0;
        const uint32_t count = r == ORDER_STEP        ? 1
                               : r == ORDER_COMPONENT ? z->numbers
                                                      : a->shape[i];
        range.first[i] = from / a->chunk[i];
        range.last[i] = (from + count - 1) / a->chunk[i];
        const uint64_t chunks = range.last[i] - range.first[i] + 1;
        if (__builtin_mul_overflow(absent->of, chunks, &absent->of))
            absent->of = UINT64_MAX;
    }
    status st = zarr_present_count(a, &range, &there);
    absent->count = absent->of > there ? absent->of - there : 0;
    return st == ST_OK ? absent_check(absent, a->path, allow_missing) : st;
}

static status set_strides(zarr *z) {
    const zarr_array *a = &z->a;
    uint64_t stride = 1;
    for (int i = 0; i < a->axes; i++) {
        const int axis = a->fortran ? i : a->axes - 1 - i;
        if (a->role[axis] >= 0)
            z->stride[a->role[axis]] = stride;
        if (__builtin_mul_overflow(stride, (uint64_t)a->chunk[axis], &stride) || stride >> 48)
            return status_describe(ST_CORRUPT, "%s/.zarray: \"chunks\": no memory holds one",
                                   a->path);
    }
    z->chunk_bytes = stride * z->width;
    return ST_OK;
}

/* Make room for a chunk, and for its bytes before filters are undone. */
static status make_chunk(zarr *z) {
    const zarr_array *a = &z->a;
    const zarr_number array = {a->stored.type, a->big_endian};
    const size_t numbers = z->chunk_bytes / z->width;
    size_t most;
    z->coded_bytes = numbers * zarr_filters_width(&a->filters, array, &most);
    z->chunk = mem_alloc(z->m, numbers * most);
    if (a->filters.count)
        z->coded = mem_alloc(z->m, numbers * most);
    return z->chunk && (z->coded || !a->filters.count) ? ST_OK : ST_NOMEM;
}

static status make_room(zarr *z) {
    z->width = sample_size(z->a.stored.type);
    z->slice_bytes = (size_t)z->g.dims[0] * z->g.dims[1] * z->numbers * z->width;
    status st = set_strides(z);
    if (st != ST_OK)
        return st;
    st = make_chunk(z);
    if (st != ST_OK)
        return st;
    const uint64_t left = z->m->limit ? z->m->limit - mem_used(z->m) : UINT64_MAX;
    const uint64_t bytes = left / 4 < HELD_MAX ? left / 4 : HELD_MAX;
    const uint64_t room = bytes / z->slice_bytes, depth = chunk_of(z, ORDER_Z);
    const uint64_t most = depth < z->g.dims[2] ? depth : z->g.dims[2];
    z->room = (uint32_t)(room < 1 ? 1 : room < most ? room : most);
    z->held = mem_alloc(z->m, z->room * z->slice_bytes);
    return z->held ? ST_OK : ST_NOMEM;
}

status zarr_open(mem *m, const char *folder, const volume_hints *hints, slice_source *out) {
    zarr *z = mem_zalloc(m, sizeof *z);
    if (!z)
        return ST_NOMEM;
    z->m = m;
    grid g;
    z->folder = mem_copy_text(m, folder);
    z->follow_links = hints->trust.follow_links;
    status st = z->folder ? zarr_array_read(m, folder, hints, &z->a) : ST_NOMEM;
    if (st == ST_OK)
        st = set_grid(z, &g);
    if (st == ST_OK)
        st = choose(z, hints, &g);
    z->g = g;
    if (st == ST_OK)
        st = count_absent(z, hints->trust.allow_missing);
    if (st == ST_OK)
        st = make_room(z);
    z->a.stored.rounding = &z->rounding;
    if (st != ST_OK) {
        close_zarr(z);
        return st;
    }
    *out = (slice_source){.format = "Zarr",
                          .name = z->a.path,
                          .has_fields = true,
                          .m = m,
                          .g = z->g,
                          .read = read_slices,
                          .close = close_zarr,
                          .ctx = z,
                          .rounding = &z->rounding,
                          .fields = tell_fields,
                          .fields_ctx = z};
    return ST_OK;
}
