#include "formats/grid/zarr.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

#include "formats/grid/sample_place.h"
#include "formats/grid/zarr_array.h"
#include "formats/grid/zarr_present.h"

enum { HELD_MAX = 1 << 28 };

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
    chunk_shape shape;
    size_t slice_bytes;
    uint8_t *chunk, *held;
    uint8_t *coded;              /* a chunk before its filters are undone; NULL: no filters */
    uint64_t read;               /* bytes of chunks' files so far */
    uint32_t room, first, count; /* in slices */
    stored_samples in_file;      /* as the file has them; a.stored: as they are held */
    double rounding;             /* largest rounding error so far */
    char json[ZARR_PATH + 8];    /* path of the file that describes the array */
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

/* ---- chunks ---- */

/* Read a chunk into the one buffer for them. */
static status hold_chunk(void *ctx, const uint32_t index[ORDER_AXES], const uint8_t **numbers) {
    zarr *z = ctx;
    const chunk_home in = {
        .path = z->a.path, .trusted = z->folder, .follow_links = z->follow_links};
    bool there;
    const status st = chunk_array_read(z->m, &z->a.chunks, &z->shape, &in, index, z->chunk,
                                       z->coded, &there, &z->read);
    *numbers = there ? z->chunk : NULL;
    return st;
}

/* ---- slices ---- */

/* Hold slices from one on, at most up to the end of their layer of chunks. */
static status hold(zarr *z, uint32_t slice) {
    const uint32_t depth = z->shape.along[ORDER_Z], layer_end = (slice / depth + 1) * depth;
    const uint32_t last = layer_end < z->g.dims[2] ? layer_end : z->g.dims[2];
    const chunk_supply chunks = {.hold = hold_chunk, .ctx = z};
    z->first = slice;
    z->count = last - slice < z->room ? last - slice : z->room;
    const uint32_t first[ORDER_AXES] = {0, 0, slice, z->first_c, z->step};
    const uint32_t end[ORDER_AXES] = {z->g.dims[0], z->g.dims[1], slice + z->count,
                                      z->first_c + z->numbers, z->step + 1};
    const status st = chunk_array_gather(&z->a.chunks, &z->shape, first, end, &chunks, z->held);
    if (st != ST_OK)
        z->count = 0;
    return st;
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

/* Say where the chunks lie. */
static bool tell_place(void *ctx, sample_place *out) {
    const zarr *z = ctx;
    *out = (sample_place){.path = z->json,
                          .big_endian = z->a.chunks.big_endian,
                          .stored = z->in_file,
                          .chunks = &z->a.chunks,
                          .step = z->step,
                          .trusted = z->folder,
                          .follow_links = z->follow_links};
    return true;
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

static status set_grid(zarr *z, bool flat, grid *g) {
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
    return flat ? grid_check(g, a->path) : grid_check_volume(g, a->path);
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
    for (int i = 0; i < a->chunks.axes; i++) {
        const int r = a->chunks.role[i];
        const uint32_t from = r == ORDER_STEP ? z->step : r == ORDER_COMPONENT ? z->first_c : 0;
        const uint32_t count = r == ORDER_STEP        ? 1
                               : r == ORDER_COMPONENT ? z->numbers
                                                      : a->shape[i];
        range.first[i] = from / a->chunks.chunk[i];
        range.last[i] = (from + count - 1) / a->chunks.chunk[i];
        const uint64_t chunks = range.last[i] - range.first[i] + 1;
        if (__builtin_mul_overflow(absent->of, chunks, &absent->of))
            absent->of = UINT64_MAX;
    }
    status st = zarr_present_count(a, &range, &there);
    absent->count = absent->of > there ? absent->of - there : 0;
    return st == ST_OK ? absent_check(absent, a->path, allow_missing) : st;
}

/* Make room for a chunk, and for its bytes before filters are undone. */
static status make_chunk(zarr *z) {
    const chunk_array *chunks = &z->a.chunks;
    if (!chunk_array_measure(chunks, &z->shape))
        return status_describe(ST_CORRUPT, "%s/.zarray: \"chunks\": no memory holds one",
                               z->a.path);
    z->chunk = mem_alloc(z->m, z->shape.room);
    if (chunks->filters.count)
        z->coded = mem_alloc(z->m, z->shape.room);
    return z->chunk && (z->coded || !chunks->filters.count) ? ST_OK : ST_NOMEM;
}

static status make_room(zarr *z) {
    const size_t width = sample_size(z->a.stored.type);
    z->slice_bytes = (size_t)z->g.dims[0] * z->g.dims[1] * z->numbers * width;
    status st = make_chunk(z);
    if (st != ST_OK)
        return st;
    const uint64_t left = z->m->limit ? z->m->limit - mem_used(z->m) : UINT64_MAX;
    const uint64_t bytes = left / 4 < HELD_MAX ? left / 4 : HELD_MAX;
    const uint64_t room = bytes / z->slice_bytes, depth = z->shape.along[ORDER_Z];
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
        st = set_grid(z, hints->heights, &g);
    if (st == ST_OK)
        st = choose(z, hints, &g);
    z->g = g;
    if (st == ST_OK)
        st = count_absent(z, hints->trust.allow_missing);
    if (st == ST_OK)
        st = make_room(z);
    z->a.stored.rounding = &z->rounding;
    snprintf(z->json, sizeof z->json, "%s/.zarray", z->a.path);
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
                          .place = tell_place,
                          .place_ctx = z,
                          .close = close_zarr,
                          .ctx = z,
                          .rounding = &z->rounding,
                          .fields = tell_fields,
                          .fields_ctx = z};
    return ST_OK;
}
