#include "formats/grid/volume.h"

#include <math.h>
#include <string.h>
#include <sys/stat.h>

#include "formats/base/file.h"
#include "formats/base/num.h"
#include "formats/base/text.h"
#include "formats/grid/grid_reader.h"
#include "formats/grid/heights_files.h"
#include "formats/grid/heights_slices.h"
#include "formats/grid/imported.h"
#include "formats/grid/layout_slices.h"
#include "formats/grid/metaimage.h"
#include "formats/grid/mgh.h"
#include "formats/grid/mrc.h"
#include "formats/grid/nifti.h"
#include "formats/grid/npy.h"
#include "formats/grid/nrrd.h"
#include "formats/grid/pvm.h"
#include "formats/grid/rawfile.h"
#include "formats/grid/slc.h"
#include "formats/grid/usgs_dem.h"
#include "formats/grid/vtk_grid_legacy.h"
#include "formats/grid/vtk_grid_parts.h"
#include "formats/grid/vtk_grid_xml.h"
#include "formats/grid/xdmf.h"
#include "formats/grid/zarr.h"
#include "formats/input/dicom_mark.h"
#include "formats/input/foreign.h"

struct volume {
    mem *m;
    bool rests;
    slice_source from;
    grid g;         /* the grid of the slices handed out; from.g owns its axes */
    uint32_t slice; /* the next slice */
    bool has_missing;
    double missing; /* the value that is read as NaN */
};

/* The formats. The first that recognises a file reads it; raw samples accept any file. */
static const grid_reader *const readers[] = {
    &nrrd_reader,
    &metaimage_reader,
    &nifti_reader,
    &npy_reader,
    &mrc_reader,
    &mgh_reader,
    &pvm_reader,
    &slc_reader,
    &vtk_grid_xml_reader,
    &vtk_grid_parts_reader,
    &vtk_grid_legacy_reader,
    &xdmf_reader,
    &heights_asc_reader,
    &heights_hgt_reader,
    &usgs_dem_reader,
    &imported_reader,
    &raw_reader,
};

/* ---- hints ---- */

static void apply_spacing(grid *g, int a, double spacing) {
    double x = g->to_world[0][a], y = g->to_world[1][a], z = g->to_world[2][a];
    double length = sqrt(x * x + y * y + z * z);
    for (int row = 0; row < 3; row++)
        g->to_world[row][a] = g->to_world[row][a] / length * spacing;
}

/* Read a whole text file, NUL-terminated. */
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

/* Apply a file of coordinates, which replace the spacing. */
static status apply_axis_file(slice_source *from, int a, const char *path) {
    char *text = NULL;
    status st = read_text(from->m, path, &text);
    apply_spacing(&from->g, a, 1);
    if (st == ST_OK)
        st = grid_set_axis_text(&from->g, from->m, path, a, text);
    mem_free(from->m, text);
    return st;
}

/* The grid's axis that the user calls x, y or z: a height field's y is its third. */
static int axis_of(const grid *g, int a) {
    return g->heights && a > 0 ? 3 - a : a;
}

static status apply_axis(slice_source *from, int a, const char *path) {
    if (!path)
        return ST_OK;
    if (!from->g.heights)
        return apply_axis_file(from, a, path);
    return status_describe(ST_USAGE, "%s: a height field has even spacings, no file of coordinates",
                           from->name);
}

static status apply_hints(slice_source *from, const volume_hints *hints) {
    for (int a = 0; a < 3; a++) {
        /* Apply coordinates first: they set the axis' step, which the hint replaces. */
        status st = apply_axis(from, a, hints->axis_file[a]);
        if (st != ST_OK)
            return st;
        if (hints->spacing[a] != 0)
            apply_spacing(&from->g, axis_of(&from->g, a), hints->spacing[a]);
        if (hints->unit)
            world_frame_set_unit(&from->g.frame, a, hints->unit);
    }
    for (int c = 0; hints->exaggerate != 0 && c < 4; c++)
        from->g.to_world[2][c] *= hints->exaggerate;
    for (int a = 0; hints->has_origin && a < 3; a++)
        from->g.to_world[a][3] = hints->origin[a];
    if (hints->has_axes)
        from->g.frame.axes = hints->axes;
    return ST_OK;
}

/* Apply the value for missing data. Integers have no NaN, so they are then handed out as floats. */
static status apply_missing(volume *v, const volume_hints *hints) {
    grid *g = &v->g;
    char value[NUM_TEXT_MAX];
    v->has_missing = hints->has_missing || v->from.has_missing;
    v->missing = hints->has_missing ? hints->missing : v->from.missing;
    if (!v->has_missing)
        return ST_OK;
    if (!sample_holds(g->type, v->missing))
        return status_describe(ST_USAGE,
                               "%s: its samples are of type %s: none can be %s, the value for "
                               "missing data",
                               v->from.name, sample_name(g->type), num_print(v->missing, value));
    if (sample_is_integer(g->type)) {
        g->source = grid_source(g);
        g->type = SAMPLE_F32;
    }
    return ST_OK;
}

/* ---- opening ---- */

/* Find the reader. If the hints give sizes, the file is raw samples even where it begins like a
 * format of an importer. */
static const grid_reader *find_reader(const char *path, const uint8_t *start, size_t size,
                                      const volume_hints *hints) {
    const grid_reader *const *r = readers;
    if (!hints->dims[0] && dicom_mark_is_at(start, size))
        return &imported_reader;
    while ((hints->dims[0] && *r == &imported_reader) || !(*r)->known(path, start, size))
        r++;
    return *r;
}

static status open_layout(const grid_reader *r, volume_layout *l, const volume_hints *hints,
                          slice_source *out) {
    status st = r->layout(l, hints);
    if (st == ST_OK)
        st = volume_layout_settle(l, hints);
    if (st == ST_OK && (hints->heights || l->g.terrain))
        heights_layout(l);
    if (st == ST_OK)
        st = volume_layout_check(l);
    return st == ST_OK ? layout_slices_open(l, out) : st;
}

static status open_reader(volume_layout *l, const volume_hints *hints, slice_source *out) {
    const uint8_t *start;
    size_t size;
    status st = byte_stream_peek(l->data, GRID_READER_PEEK, &start, &size);
    if (st != ST_OK)
        return st;
    const grid_reader *r = find_reader(byte_stream_kind(l->data), start, size, hints);
    if (r->slices)
        st = r->slices(l, hints, out);
    else
        st = open_layout(r, l, hints, out);
    out->format = out->format ? out->format : r->format;
    return st;
}

/* Apply the hints. v->from must be set. */
static status begin(volume *v, const volume_hints *hints) {
    const bool terrain = hints->heights || v->from.g.heights || v->from.g.terrain;
    status st = terrain ? heights_slices(&v->from) : ST_OK;
    if (st == ST_OK)
        st = apply_hints(&v->from, hints);
    v->g = v->from.g;
    if (st == ST_OK)
        st = apply_missing(v, hints);
    if (st == ST_OK)
        st = grid_check_volume(&v->g, v->from.name);
    /* The file's own place was sound, so the options are at fault. */
    if (st == ST_CORRUPT && (hints->has_origin || hints->spacing[0] != 0 || hints->exaggerate != 0))
        st = ST_USAGE;
    /* Never use the file's name: renaming the input does not change what is made of it. */
    text_name(v->g.name, sizeof v->g.name, hints->name ? hints->name : v->from.g.name);
    return st;
}

status volume_open_slices(mem *m, slice_source *from, const volume_hints *hints, volume **out) {
    static const volume_hints none;
    volume *v = mem_zalloc(m, sizeof *v);
    if (!v) {
        slice_source_close(from);
        return ST_NOMEM;
    }
    *v = (volume){.m = m, .from = *from};
    *from = (slice_source){0};
    status st = begin(v, hints ? hints : &none);
    if (st != ST_OK) {
        volume_close(v);
        return st;
    }
    *out = v;
    return ST_OK;
}

status volume_open_stream(mem *m, byte_stream *s, const volume_hints *hints, volume **out) {
    static const volume_hints none;
    slice_source from = {0};
    volume_layout l = {.m = m, .data = s, .path = mem_copy_text(m, byte_stream_path(s))};
    status st = l.path ? open_reader(&l, hints ? hints : &none, &from) : ST_NOMEM;
    volume_layout_release(&l);
    if (st != ST_OK) {
        slice_source_close(&from);
        return st;
    }
    return volume_open_slices(m, &from, hints, out);
}

static status open_folder(mem *m, const char *path, const volume_hints *hints, volume **out) {
    slice_source from = {0};
    status st = foreign_check_folder(m, path);
    if (st == ST_OK)
        st = zarr_known(path) ? zarr_open(m, path, hints, &from)
                              : imported_folder(m, path, hints, &from);
    return st == ST_OK ? volume_open_slices(m, &from, hints, out) : st;
}

bool volume_is_folder(const char *path) {
    struct stat info;
    return stat(path, &info) == 0 && S_ISDIR(info.st_mode);
}

status volume_open(mem *m, const char *path, const volume_hints *hints, volume **out) {
    static const volume_hints none;
    byte_stream *s;
    if (volume_is_folder(path))
        return open_folder(m, path, hints ? hints : &none, out);
    status st = byte_stream_open(m, path, &s);
    return st == ST_OK ? volume_open_stream(m, s, hints, out) : st;
}

void volume_close(volume *v) {
    if (!v)
        return;
    slice_source_close(&v->from);
    mem_free(v->m, v);
}

const grid *volume_grid(const volume *v) {
    return &v->g;
}

const char *volume_format(const volume *v) {
    return v->from.format;
}

bool volume_has_fields(const volume *v) {
    return v->from.has_fields;
}

status volume_fields(const volume *v, const slice_fields *to) {
    const slice_field one = {.name = "", .steps = 1, .taken = true};
    return v->from.fields ? v->from.fields(v->from.fields_ctx, to) : to->take(to->ctx, &one);
}

const char *volume_importer(const volume *v) {
    return v->from.importer;
}

/* ---- reading ---- */

/* Turn missing data into NaN. at: the samples, at the end of buffer. */
static status mark_missing(const volume *v, const void *at, void *buffer, size_t count) {
    const uint64_t slice = (uint64_t)v->g.dims[0] * v->g.dims[1];
    const sample_type type = v->from.g.type;
    const size_t bad = sample_mark_missing(type, at, buffer, count, v->missing);
    if (bad == count)
        return ST_OK;
    return status_describe(ST_UNSUPPORTED,
                           "%s: slice %u (counted from 0): with a value for missing data, samples "
                           "of type %s are kept as f32, which cannot hold the one with index %llu, "
                           "near %.0f",
                           v->from.name, v->slice + (uint32_t)(bad / slice), sample_name(type),
                           (unsigned long long)(bad % slice), (double)((const float *)buffer)[bad]);
}

status volume_read(volume *v, uint32_t count, void *buffer) {
    const size_t samples = (size_t)v->g.dims[0] * v->g.dims[1] * count;
    const size_t wider = sample_size(v->g.type) - sample_size(v->from.g.type);
    char *at = (char *)buffer + samples * wider;
    status st = v->from.read(v->from.ctx, v->slice, count, at);
    if (st == ST_OK && v->has_missing)
        st = mark_missing(v, at, buffer, samples);
    v->slice += count;
    return st;
}

bool volume_skips(const volume *v) {
    return v->from.skip != NULL;
}

status volume_skip(volume *v, uint32_t count) {
    v->slice += count;
    return v->from.skip(v->from.ctx, count);
}

bool volume_place(const volume *v, sample_place *out) {
    if (!v->from.place || !v->from.place(v->from.place_ctx, out))
        return false;
    if (out->refused)
        return true;
    if (v->has_missing && out->has_missing)
        out->refused = "it has a value for missing data of its own, beside the one given";
    if (v->has_missing) {
        out->has_missing = true;
        out->missing = v->missing;
    }
    return true;
}

bool volume_quiet(const volume *v, uint8_t sample[SLICE_SAMPLE_MAX]) {
    memcpy(sample, v->from.quiet, SLICE_SAMPLE_MAX);
    return v->from.read_tiles && !v->has_missing;
}

status volume_read_tiles(volume *v, uint32_t count, void *buffer, uint8_t *busy) {
    const status st = v->from.read_tiles(v->from.ctx, v->slice, count, buffer, busy);
    v->slice += count;
    return st;
}

double volume_rounding(const volume *v) {
    return v->from.rounding ? *v->from.rounding : 0;
}

status volume_finish(volume *v, uint64_t *trailing) {
    uint64_t count = 0;
    status st = v->from.finish ? v->from.finish(v->from.ctx, &count) : ST_OK;
    if (st == ST_OK && trailing)
        *trailing = count;
    return st;
}

bool volume_next_step(volume *v) {
    if (!v->from.next_step)
        return false;
    v->from.next_step(v->from.ctx);
    v->slice = 0;
    return true;
}

void volume_rest(volume *v) {
    slice_source *from = &v->from;
    if (from->close)
        from->close(from->ctx);
    from->close = NULL;
    from->fields = NULL;
    from->rounding = NULL;
    from->name = NULL;
    v->rests = true;
}

bool volume_rests(const volume *v) {
    return v->rests;
}
