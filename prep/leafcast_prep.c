#include "prep/leafcast_prep.h"

#include <errno.h>
#include <math.h>
#include <pthread.h>
#include <string.h>
#include <sys/stat.h>

#include "formats/base/file.h"
#include "formats/base/file_guard.h"
#include "formats/base/pool.h"
#include "formats/base/text.h"
#include "formats/curvilinear/curvilinear_input_kind.h"
#include "formats/input_open.h"
#include "formats/mesh/mesh_input_kind.h"
#include "formats/public_grid.h"
#include "formats/public_status.h"
#include "formats/surface/surface_input_kind.h"
#include "formats/surface/surface_readers.h"
#include "prep/convert_defaults.h"
#include "prep/curvilinear/curvilinear_files.h"
#include "prep/grid/convert.h"
#include "prep/mesh/mesh_convert.h"
#include "prep/mesh/mixed_treelet.h"
#include "prep/mesh/triangle_treelet.h"
#include "prep/prep_arguments.h"

_Static_assert((int)LEAFCAST_U8 == (int)SAMPLE_U8 && (int)LEAFCAST_I8 == (int)SAMPLE_I8 &&
                   (int)LEAFCAST_U16 == (int)SAMPLE_U16 && (int)LEAFCAST_I16 == (int)SAMPLE_I16 &&
                   (int)LEAFCAST_F32 == (int)SAMPLE_F32 && (int)LEAFCAST_U32 == (int)SAMPLE_U32 &&
                   (int)LEAFCAST_I32 == (int)SAMPLE_I32 && (int)LEAFCAST_F64 == (int)SAMPLE_F64,
               "public and internal sample types agree");

/* One call: its memory budget, and the caller's function for progress. */
typedef struct job {
    mem m;
    leafcast_convert_options o; /* the caller's options, or the default */
    const char *out;
    file_guard_target target; /* the file that `out` replaces */
    progress p;
    pthread_mutex_t lock; /* guards calls of watch() and all fields below */
    const char *stage;
    double fraction;
    bool stopped;
} job;

/* ---- Arguments ---- */

/* Returns ST_OK if an existing file may be replaced. Inputs are checked elsewhere. */
static status check_replaced(const char *path) {
    char magic[sizeof LEAF_MAGIC - 1] = "";
    file *f = NULL;
    mem m; /* not the job's, which refuses to open its own output */
    mem_init(&m, 0);
    status st = file_open(&m, path, &f);
    const uint64_t size = st == ST_OK ? file_size(f) : 0;
    if (size >= sizeof magic)
        st = file_read_at(f, 0, magic, sizeof magic);
    file_close(f);
    if (st == ST_OK && size && memcmp(magic, LEAF_MAGIC, sizeof magic) != 0)
        st = status_describe(ST_EXISTS, "%s: exists already, and is no treelet file", path);
    return st;
}

/* in: count paths of inputs. Files that these lead to are refused when they are opened. */
static status check_output(job *j, const char *const *in, uint32_t count) {
    struct stat info;
    status st = ST_OK;
    if (lstat(j->out, &info) != 0)
        return ST_OK; /* if it cannot be made, the writer reports that */
    file_guard_aim(&j->m, &j->target, j->out);
    for (uint32_t i = 0; i < count && st == ST_OK; i++)
        st = file_guard_named(&j->m, in[i]);
    if (st == ST_OK && !j->o.replace)
        st = status_describe(ST_EXISTS, "%s: exists already, and shall not be replaced", j->out);
    return st;
}

/* Call this after the inputs are open: an output that is also an input is reported first. */
static status check_gives_way(const job *j) {
    struct stat info;
    return stat(j->out, &info) == 0 && S_ISREG(info.st_mode) ? check_replaced(j->out) : ST_OK;
}

/* ---- A job ---- */

/* What reports no progress still asks whether to stop. watch() then gets the last values again. */
static void tell(void *ctx, const char *stage, double fraction) {
    job *j = ctx;
    pthread_mutex_lock(&j->lock);
    j->stage = stage;
    j->fraction = fraction;
    pthread_mutex_unlock(&j->lock);
}

static bool must_stop(void *ctx) {
    job *j = ctx;
    pthread_mutex_lock(&j->lock);
    const bool stopped = j->stopped || !j->o.watch(j->o.watch_ctx, j->stage, j->fraction);
    j->stopped = stopped;
    pthread_mutex_unlock(&j->lock);
    return stopped;
}

/* Call job_end() in any case. */
static status job_begin(job *j, const char *const *in, uint32_t count, const char *out,
                        const leafcast_convert_options *options) {
    *j = (job){.out = out, .o = {.size = sizeof j->o}, .stage = "begin"};
    pthread_mutex_init(&j->lock, NULL);
    status st = options ? prep_arguments_check_options(options) : ST_OK;
    if (st != ST_OK)
        return st;
    if (options)
        j->o = *options;
    mem_init(&j->m, (size_t)(j->o.memory ? j->o.memory : CONVERT_MEMORY_DEFAULT));
    j->o.threads = j->o.threads ? j->o.threads : pool_default_threads();
    if (j->o.watch)
        j->p = (progress){.report = tell, .stop = must_stop, .ctx = j};
    return check_output(j, in, count);
}

static leafcast_status job_end(job *j, status st) {
    pthread_mutex_destroy(&j->lock);
    return public_status(st);
}

static leaf_parameters parameters_of(const job *j) {
    leaf_parameters p = convert_parameters_default();
    if (j->o.zstd_level)
        leaf_parameters_compress(&p, j->o.zstd_level);
    if (j->o.treelet_cells)
        p.cells_log2 = (uint32_t)__builtin_ctz(j->o.treelet_cells);
    if (j->o.without_halo)
        p.halo = 0;
    return p;
}

/* ---- Grids ---- */

static volume_hints hints_of(const job *j) {
    return (volume_hints){.has_missing = j->o.has_missing,
                          .missing = j->o.missing,
                          .exaggerate = j->o.exaggerate,
                          .name = j->o.name,
                          .trust = {j->o.follow_links, j->o.allow_missing}};
}

static status convert_volume(job *j, volume *v) {
    convert_options o = {.file = parameters_of(j),
                         .memory = j->m.limit,
                         .threads = j->o.threads,
                         .force = j->o.replace,
                         .refuse_empty = !j->o.allow_empty};
    convert_plan plan;
    convert_result result;
    o.file.bare = j->o.without_levels;
    status st = check_gives_way(j);
    if (st == ST_OK)
        st = convert_plan_make(&j->m, volume_grid(v), &o, &plan);
    return st == ST_OK ? convert_run(&j->m, v, j->out, &o, &plan, &j->p, &result) : st;
}

/* source: its grid is set here. */
static status convert_source(job *j, const leafcast_grid *from, slice_source *source) {
    const volume_hints hints = hints_of(j);
    volume *v = NULL;
    source->format = source->name = "slices";
    source->m = &j->m;
    status st = public_grid_make(&j->m, from, &source->g);
    if (st == ST_OK)
        st = volume_open_slices(&j->m, source, &hints, &v);
    if (st == ST_OK)
        st = convert_volume(j, v);
    slice_source_close(source);
    volume_close(v);
    return st;
}

typedef struct slices {
    leafcast_slice slice;
    void *ctx;
    size_t bytes; /* of a slice */
} slices;

static size_t slice_bytes(const leafcast_grid *g) {
    return (size_t)g->dims[0] * g->dims[1] * sample_size((sample_type)g->type);
}

static status call_slice(const slices *s, uint32_t z, void *to) {
    const leafcast_status st = s->slice(s->ctx, z, to);
    const bool known = st >= LEAFCAST_USAGE && st <= LEAFCAST_FAILED;
    if (st == LEAFCAST_OK)
        return ST_OK;
    return status_describe(known ? (status)st : ST_FAILED,
                           "slice %u: the caller's function ended with status %d", z, (int)st);
}

static status call_slices(void *ctx, uint32_t first, uint32_t count, void *to) {
    const slices *s = ctx;
    status st = ST_OK;
    for (uint32_t i = 0; i < count && st == ST_OK; i++)
        st = call_slice(s, first + i, (char *)to + i * s->bytes);
    return st;
}

leafcast_status leafcast_convert_slices(const leafcast_grid *from, leafcast_slice slice, void *ctx,
                                        const char *out, const leafcast_convert_options *options) {
    job j;
    status st = public_needs(__func__, "grid slice out",
                             (const void *[]){from, slice ? (const void *)from : NULL, out});
    if (st == ST_OK)
        st = public_grid_check(from);
    if (st != ST_OK)
        return public_status(st);
    slices s = {.slice = slice, .ctx = ctx, .bytes = slice_bytes(from)};
    slice_source source = {.read = call_slices, .ctx = &s};
    st = job_begin(&j, NULL, 0, out, options);
    if (st == ST_OK)
        st = convert_source(&j, from, &source);
    return job_end(&j, st);
}

typedef struct array {
    const char *samples;
    size_t width;
    uint32_t dims[3];
    ptrdiff_t strides[3];
} array;

static char *copy_slice(const array *a, uint32_t z, char *at) {
    for (uint32_t y = 0; y < a->dims[1]; y++) {
        const char *row = a->samples + (ptrdiff_t)z * a->strides[2] + (ptrdiff_t)y * a->strides[1];
        if (a->strides[0] == (ptrdiff_t)a->width) {
            memcpy(at, row, a->dims[0] * a->width);
            at += a->dims[0] * a->width;
            continue;
        }
        for (uint32_t x = 0; x < a->dims[0]; x++, at += a->width)
            memcpy(at, row + (ptrdiff_t)x * a->strides[0], a->width);
    }
    return at;
}

static status copy_slices(void *ctx, uint32_t first, uint32_t count, void *to) {
    for (uint32_t i = 0; i < count; i++)
        to = copy_slice(ctx, first + i, to);
    return ST_OK;
}

leafcast_status leafcast_convert_array(const leafcast_grid *from, const void *samples,
                                       const ptrdiff_t strides[3], const char *out,
                                       const leafcast_convert_options *options) {
    job j;
    status st = public_needs(__func__, "grid samples out", (const void *[]){from, samples, out});
    if (st == ST_OK)
        st = public_grid_check(from);
    if (st != ST_OK)
        return public_status(st);
    const ptrdiff_t width = (ptrdiff_t)sample_size((sample_type)from->type),
                    row = width * (ptrdiff_t)from->dims[0];
    const ptrdiff_t tight[3] = {width, row, row * (ptrdiff_t)from->dims[1]};
    array a = {.samples = samples, .width = (size_t)width};
    memcpy(a.dims, from->dims, sizeof a.dims);
    memcpy(a.strides, strides ? strides : tight, sizeof a.strides);
    slice_source source = {.read = copy_slices, .ctx = &a};
    st = public_grid_check_strides(from->dims, a.strides);
    if (st != ST_OK)
        return public_status(st);
    st = job_begin(&j, NULL, 0, out, options);
    if (st == ST_OK)
        st = convert_source(&j, from, &source);
    return job_end(&j, st);
}

/* ---- Meshes ---- */

/* cells: NULL: tets. */
static status convert_cells(job *j, mesh_input *x, const mesh_series *series,
                            const cell_treelets *cells) {
    mesh_options o = mesh_options_default();
    mesh_result result;
    o.file = parameters_of(j);
    o.series = series;
    o.memory = j->m.limit;
    o.threads = j->o.threads;
    o.force = j->o.replace;
    o.gradients = j->o.gradients;
    o.coarse = j->o.coarse;
    o.cells = cells;
    o.normals = (surface_normals)j->o.normals;
    o.coarse_dims = j->o.coarse_dims;
    o.refuse_empty = !j->o.allow_empty && cells != &triangle_treelets;
    o.treelet_tets = j->o.treelet_tets ? j->o.treelet_tets : o.treelet_tets;
    o.leaf_tets = j->o.leaf_tets ? j->o.leaf_tets : o.leaf_tets;
    status st = check_gives_way(j);
    return st == ST_OK ? mesh_convert_run(&j->m, x, j->out, &o, &j->p, &result) : st;
}

static status convert_mesh(job *j, mesh_input *x, const mesh_series *series) {
    return convert_cells(j, x, series, j->o.whole_cells ? &mixed_treelets : NULL);
}

/* The values of a surface may be none, and what is made of cells of a volume is not made of it. */
static status convert_surface(job *j, mesh_input *x, const mesh_series *series) {
    const struct {
        bool given;
        const char *what;
    } without[] = {{j->o.gradients, "gradients"},
                   {j->o.coarse, "coarse"},
                   {j->o.leaf_tets, "leaf_tets"},
                   {j->o.whole_cells, "whole_cells"}};
    for (size_t i = 0; i < sizeof without / sizeof *without; i++)
        if (without[i].given)
            return status_describe(ST_USAGE,
                                   "%s: a surface is converted without "
                                   "leafcast_convert_options.%s",
                                   series->of.paths[0], without[i].what);
    mesh_series of = *series;
    of.readers = &surface_readers;
    return convert_cells(j, x, &of, &triangle_treelets);
}

static status convert_arrays(job *j, const leafcast_tets *tets) {
    mesh_input *x = NULL;
    const mesh_arrays arrays = {.points = tets->vertex_count,
                                .tets = tets->tet_count,
                                .xyz = tets->vertices,
                                .values = tets->values,
                                .ids = tets->tets,
                                .field = tets->field};
    status st = mesh_input_open_arrays(&j->m, &arrays, j->o.name, &x);
    if (st == ST_OK)
        st = convert_mesh(j, x, NULL);
    mesh_input_close(x);
    return st;
}

leafcast_status leafcast_convert_tets(const leafcast_tets *tets, const char *out,
                                      const leafcast_convert_options *options) {
    job j;
    status st = public_needs(__func__, "tets out", (const void *[]){tets, out});
    if (st == ST_OK)
        st = prep_arguments_check_tets(tets);
    if (st != ST_OK)
        return public_status(st);
    st = job_begin(&j, NULL, 0, out, options);
    if (st == ST_OK)
        st = convert_arrays(&j, tets);
    return job_end(&j, st);
}

/* ---- Files ---- */

/* Field names as files have them; NULL: none are given. */
typedef struct field_names {
    char (*text)[MESH_NAME_MAX + 1];
    const char **names;
} field_names;

static status clean_fields(job *j, field_names *f) {
    const uint32_t count = j->o.field_count;
    if (!count)
        return ST_OK;
    f->text = mem_array(&j->m, count, sizeof *f->text);
    f->names = mem_array(&j->m, count, sizeof *f->names);
    if (!f->text || !f->names)
        return ST_NOMEM;
    for (uint32_t i = 0; i < count; i++) {
        text_name(f->text[i], sizeof *f->text, j->o.fields[i]);
        f->names[i] = f->text[i];
    }
    return ST_OK;
}

static curvilinear_hints hints_of_zones(const job *j) {
    return (curvilinear_hints){.component = j->o.component,
                               .name = j->o.name,
                               .cells_to_points = j->o.cells_to_points,
                               .trust = hints_of(j).trust};
}

static status convert_curvilinear(job *j, curvilinear_input *x, const step_series *series) {
    curvilinear_files files = {
        .m = &j->m,
        .of = *series,
        .hints = hints_of_zones(j),
        .first = x,
    };
    const curvilinear_options o = {.file = parameters_of(j),
                                   .memory = j->m.limit,
                                   .threads = j->o.threads,
                                   .force = j->o.replace,
                                   .refuse_empty = !j->o.allow_empty};
    curvilinear_result result;
    files.of.fields = series->sets.names;
    status st = step_series_check(series);
    if (st == ST_OK && !j->o.allow_empty)
        st = curvilinear_files_check(&files);
    if (st == ST_OK)
        st = check_gives_way(j);
    const curvilinear_series steps = curvilinear_files_series(&files);
    if (st == ST_OK)
        st = curvilinear_convert(&j->m, &steps, curvilinear_input_name(x), j->out, &o, &j->p,
                                 &result);
    curvilinear_files_release(&files);
    return st;
}

static status convert_input_of(job *j, const input *in, const mesh_series *series) {
    if (in->kind == &curvilinear_input_kind)
        return convert_curvilinear(j, in->own, &series->of);
    if (in->kind == &mesh_input_kind || in->kind == &surface_input_kind) {
        const status st = step_series_check(&series->of);
        if (st != ST_OK)
            return st;
        return in->kind == &mesh_input_kind ? convert_mesh(j, in->own, series)
                                            : convert_surface(j, in->own, series);
    }
    if (series->of.sets.steps > 1)
        return status_describe(ST_USAGE,
                               "%s: only meshes, surfaces and curvilinear grids have several steps",
                               series->of.paths[0]);
    return convert_volume(j, in->own);
}

static status convert_files(job *j, const char *const *paths, uint32_t steps, const double *times) {
    const volume_hints of_grids = hints_of(j);
    field_names fields = {0};
    input in = {0};
    status st = clean_fields(j, &fields);
    const leaf_sets sets = {.fields = fields.names ? j->o.field_count : 1,
                            .steps = steps,
                            .names = fields.names,
                            .times = times};
    const mesh_series series = {.of = {.paths = paths, .sets = sets},
                                .hints = {.field = fields.names ? fields.names[0] : NULL,
                                          .component = j->o.component,
                                          .cells_to_points = j->o.cells_to_points,
                                          .by_corners = j->o.by_corners,
                                          .name = j->o.name,
                                          .trust = of_grids.trust}};
    input_hints hints = {of_grids, series.hints, hints_of_zones(j)};
    hints.curvilinear.field = series.hints.field;
    if (st == ST_OK)
        st = input_open(&j->m, paths[0], &hints, &in);
    if (st == ST_OK)
        st = convert_input_of(j, &in, &series);
    input_close(&in);
    mem_free(&j->m, fields.text);
    mem_free(&j->m, fields.names);
    return st;
}

leafcast_status leafcast_convert_steps(const char *const *in, uint32_t steps, const double *times,
                                       const char *out, const leafcast_convert_options *options) {
    job j;
    status st = public_needs(__func__, "in out", (const void *[]){in, out});
    if (st == ST_OK)
        st = prep_arguments_check_paths(in, steps);
    if (st != ST_OK)
        return public_status(st);
    st = job_begin(&j, in, steps, out, options);
    if (st == ST_OK)
        st = convert_files(&j, in, steps, times);
    return job_end(&j, st);
}

leafcast_status leafcast_convert_path(const char *in, const char *out,
                                      const leafcast_convert_options *options) {
    return leafcast_convert_steps(&in, 1, NULL, out, options);
}
