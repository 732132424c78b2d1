#include "formats/grid/xdmf.h"

#include <string.h>

#include "formats/base/name_list.h"
#include "formats/base/text.h"
#include "formats/grid/imported.h"
#include "formats/grid/layout_slices.h"
#include "formats/grid/xdmf_file.h"

/* An open XDMF file, and the source of one attribute's samples. */
typedef struct xdmf {
    mem *m;
    char *path; /* path of the XDMF file */
    xdmf_file file;
    const xdmf_field *field; /* the field taken */
    slice_source from;
} xdmf;

/* ---- fields ---- */

static const xdmf_field *find_field(const xdmf *x, const char *name) {
    for (size_t i = 0; i < x->file.count; i++)
        if (!name || text_same_name(x->file.fields[i].name, name, GRID_NAME_MAX))
            return &x->file.fields[i];
    return NULL;
}

static status choose_field(xdmf *x, const char *name) {
    name_list names = {0};
    x->field = find_field(x, name);
    for (size_t i = 0; i < x->file.count; i++)
        name_list_add(&names, x->file.fields[i].name);
    return x->field ? ST_OK
                    : status_describe(ST_USAGE, "%s: no attribute \"%s\"; it has %s", x->path, name,
                                      name_list_print(&names));
}

/* Returns the numbers a sample: the fourth dimension, if there is one. */
static uint32_t components_of(const xdmf_field *f) {
    return f->rank == 4 && f->dims[3] <= STORED_SAMPLES_COMPONENTS ? (uint32_t)f->dims[3] : 1;
}

static status tell_fields(void *ctx, const slice_fields *to) {
    const xdmf *x = ctx;
    status st = ST_OK;
    for (size_t i = 0; st == ST_OK && i < x->file.count; i++) {
        const xdmf_field *f = &x->file.fields[i];
        st = to->take(to->ctx, &(slice_field){.name = f->name,
                                              .steps = x->file.steps,
                                              .times = x->file.times,
                                              .taken = f == x->field,
                                              .components = components_of(f)});
    }
    return st;
}

/* ---- samples ---- */

/* Check that there are as many samples as the grid has nodes, or cells, along each axis. */
static status check_dims(const xdmf *x) {
    const xdmf_field *f = x->field;
    for (int a = 0; a < 3; a++) {
        const uint64_t expected = x->file.nodes[a] - f->cells;
        if (f->rank < 3 || f->dims[2 - a] != expected)
            return status_describe(ST_CORRUPT,
                                   "%s: the attribute \"%s\" has other dimensions than its grid",
                                   x->path, f->name);
    }
    if (f->rank == 4 && (f->inside || f->dims[3] > STORED_SAMPLES_COMPONENTS))
        return status_describe(ST_UNSUPPORTED,
                               "%s: the attribute \"%s\" has %llu numbers a sample, which are "
                               "read of raw files alone, up to %d",
                               x->path, f->name, (unsigned long long)f->dims[3],
                               STORED_SAMPLES_COMPONENTS);
    return ST_OK;
}

static status open_raw(const xdmf_field *f, volume_layout *l, const volume_hints *hints,
                       slice_source *out) {
    uint32_t dims[3];
    for (int a = 0; a < 3; a++)
        dims[a] = (uint32_t)f->dims[2 - a];
    grid_init(&l->g, dims, SAMPLE_U8);
    l->stored = (stored_samples){.type = f->type, .components = components_of(f)};
    l->encoding = VOLUME_RAW;
    l->big_endian = f->big_endian;
    l->has_tail = true; /* other attributes */
    if (f->seek > INT64_MAX)
        return status_describe(ST_CORRUPT, "%s: cannot skip %llu bytes", l->path,
                               (unsigned long long)f->seek);
    status st = volume_layout_skip(l, 0, (int64_t)f->seek);
    if (st == ST_OK)
        st = volume_layout_settle(l, &(volume_hints){.component = hints->component});
    if (st == ST_OK)
        st = volume_layout_check(l);
    return st == ST_OK ? layout_slices_open(l, out) : st;
}

static status open_hdf5(const xdmf *x, volume_layout *l, const volume_hints *hints,
                        slice_source *out) {
    const uint8_t *start;
    size_t size;
    status st = byte_stream_peek(l->data, GRID_READER_PEEK, &start, &size);
    if (st == ST_OK && (size < 8 || memcmp(start, "\x89HDF\r\n\x1a\n", 8) != 0))
        st = status_describe(ST_CORRUPT, "%s: names %s, expected a file of HDF5", x->path, l->path);
    const volume_hints asked = {.field = x->field->inside, .trust = hints->trust};
    if (st == ST_OK)
        st = imported_reader.slices(l, &asked, out);
    if (st == ST_OK)
        for (int a = 0; a < 3; a++)
            if (out->g.dims[a] != x->field->dims[2 - a])
                return status_describe(ST_CORRUPT,
                                       "%s: the attribute \"%s\" has other dimensions than the "
                                       "data set %s of %s",
                                       x->path, x->field->name, x->field->inside, x->field->file);
    return st;
}

static status open_samples(xdmf *x, const volume_hints *hints) {
    volume_layout l = {.m = x->m, .path = mem_copy_text(x->m, x->field->file)};
    status st = l.path ? check_dims(x) : ST_NOMEM;
    if (st == ST_OK)
        st = byte_stream_open_stored(x->m, l.path, &l.data);
    if (st == ST_OK)
        st = x->field->inside ? open_hdf5(x, &l, hints, &x->from)
                              : open_raw(x->field, &l, hints, &x->from);
    volume_layout_release(&l);
    return st;
}

/* ---- the grid ---- */

/* Place the samples as the XDMF file says, not as their own file does. */
static status place(const xdmf *x, grid *g) {
    const xdmf_file *f = &x->file;
    const bool cells = x->field->cells;
    grid_release(g, x->m);
    memset(g->to_world, 0, sizeof g->to_world);
    g->frame = (world_frame){0};
    *g->note = *g->name = 0;
    for (int a = 0; a < 3; a++) {
        g->to_world[a][a] = f->axis[a] ? 1 : f->spacing[a];
        g->to_world[a][3] = f->axis[a] ? 0 : f->origin[a] + (cells ? f->spacing[a] / 2 : 0);
    }
    for (int a = 0; a < 3 && f->axis[a]; a++) {
        double *c = f->axis[a];
        for (uint32_t i = 0; cells && i + 1 < f->nodes[a]; i++)
            c[i] += (c[i + 1] - c[i]) / 2;
        status st = grid_set_axis(g, x->m, x->path, a, c);
        if (st != ST_OK)
            return st;
    }
    return grid_check(g, x->path);
}

static status read_slices(void *ctx, uint32_t first, uint32_t count, void *slices) {
    const xdmf *x = ctx;
    return x->from.read(x->from.ctx, first, count, slices);
}

static status read_tiles(void *ctx, uint32_t first, uint32_t count, void *slices, uint8_t *busy) {
    const xdmf *x = ctx;
    return x->from.read_tiles(x->from.ctx, first, count, slices, busy);
}

static status finish(void *ctx, uint64_t *trailing) {
    const xdmf *x = ctx;
    return x->from.finish ? x->from.finish(x->from.ctx, trailing) : ST_OK;
}

static void close_xdmf(void *ctx) {
    xdmf *x = ctx;
    slice_source_close(&x->from);
    xdmf_file_release(&x->file);
    mem_free(x->m, x->path);
    mem_free(x->m, x);
}

/* Hand out the samples' own source, with another place and other fields. */
static void give(xdmf *x, slice_source *out) {
    *out = x->from;
    out->name = x->path;
    out->has_fields = true;
    out->read = read_slices;
    out->read_tiles = x->from.read_tiles ? read_tiles : NULL;
    out->finish = finish;
    out->next_step = NULL;
    out->close = close_xdmf;
    out->fields = tell_fields;
    out->ctx = out->fields_ctx = x;
    for (int a = 0; a < 3; a++)
        x->from.g.axis[a] = NULL; /* out owns them now */
}

static status open_xdmf(xdmf *x, volume_layout *l, const volume_hints *hints) {
    x->path = mem_copy_text(l->m, l->path);
    if (!x->path)
        return ST_NOMEM;
    status st =
        xdmf_file_read(l->m, l->path, l->data, hints->trust.follow_links, hints->step, &x->file);
    if (st == ST_OK)
        st = choose_field(x, hints->field);
    if (st == ST_OK)
        st = open_samples(x, hints);
    return st == ST_OK ? place(x, &x->from.g) : st;
}

static status open_slices(volume_layout *l, const volume_hints *hints, slice_source *out) {
    xdmf *x = mem_zalloc(l->m, sizeof *x);
    if (!x)
        return ST_NOMEM;
    x->m = x->file.m = l->m;
    status st = open_xdmf(x, l, hints);
    if (st == ST_OK)
        give(x, out);
    else
        close_xdmf(x);
    out->format = "XDMF";
    return st;
}

static bool known(const char *path, const uint8_t *start, size_t size) {
    return memmem(start, size, "<Xdmf", 5) != NULL || text_ends_in(path, ".xdmf") ||
           text_ends_in(path, ".xmf");
}

const grid_reader xdmf_reader = {.format = "XDMF", .known = known, .slices = open_slices};
