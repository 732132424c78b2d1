#include "prep/leafcast_prep.h"

#include <errno.h>
#include <limits.h>
#include <math.h>
#include <pthread.h>
#include <string.h>
#include <sys/stat.h>

#include "formats/base/file.h"
#include "formats/base/pool.h"
#include "formats/base/text.h"
#include "formats/public_status.h"
#include "prep/convert_input.h"
#include "prep/grid/convert.h"
#include "prep/mesh/mesh_convert.h"

_Static_assert((int)LEAFCAST_U8 == (int)SAMPLE_U8 && (int)LEAFCAST_I8 == (int)SAMPLE_I8 &&
                   (int)LEAFCAST_U16 == (int)SAMPLE_U16 && (int)LEAFCAST_I16 == (int)SAMPLE_I16 &&
                   (int)LEAFCAST_F32 == (int)SAMPLE_F32 && (int)LEAFCAST_U32 == (int)SAMPLE_U32 &&
                   (int)LEAFCAST_I32 == (int)SAMPLE_I32 && (int)LEAFCAST_F64 == (int)SAMPLE_F64,
               "public and internal sample types agree");

enum { ZSTD_LEVEL_MAX = 22 };

/* A call: its budget, and the caller's function that is told how far it is. */
typedef struct job {
    mem m;
    leafcast_convert_options o; /* the caller's, or the default */
    const char *out;
    progress p;
    pthread_mutex_t lock; /* of watch(), and of all that follows */
    const char *stage;
    double fraction;
    bool stopped;
} job;

/* ---- Arguments ---- */

static status in_range(const char *name, long long value, long long lo, long long hi) {
    if (value == 0 || (value >= lo && value <= hi))
        return ST_OK;
    return status_describe(ST_USAGE, "leafcast_convert_options.%s is %lld: 0, or %lld to %lld",
                           name, value, lo, hi);
}

static status check_options(const leafcast_convert_options *o) {
    status st = public_size("leafcast_convert_options", o->size, sizeof *o);
    if (st == ST_OK)
        st = in_range("threads", o->threads, 1, INT_MAX);
    if (st == ST_OK)
        st = in_range("zstd_level", o->zstd_level, 1, ZSTD_LEVEL_MAX);
    if (st == ST_OK)
        st = in_range("treelet_cells", o->treelet_cells, 1 << LEAF_CELLS_LOG2_MIN,
                      1 << LEAF_CELLS_LOG2_MAX);
    if (st == ST_OK && o->treelet_cells & (o->treelet_cells - 1))
        st = status_describe(ST_USAGE,
                             "leafcast_convert_options.treelet_cells is %u: 16, 32 and 64 are "
                             "possible",
                             o->treelet_cells);
    if (st == ST_OK)
        st = in_range("coarse_dims", o->coarse_dims, 2, GRID_DIM_MAX);
    if (st == ST_OK)
        st = in_range("treelet_tets", o->treelet_tets, 1, LEAF_TREELET_TETS_MAX);
    if (st == ST_OK)
        st = in_range("leaf_tets", o->leaf_tets, 1, LEAF_LEAF_TETS_MAX);
    if (st == ST_OK)
        st = in_range("field_count", o->field_count, 1, LEAF_SETS_MAX);
    return st == ST_OK ? in_range("component", o->component, 1, INT_MAX) : st;
}

/* Whether a file may give way. No input of a conversion is empty, or a treelet file. */
static status check_replaced(mem *m, const char *path) {
    char magic[sizeof LEAF_MAGIC - 1] = "";
    file *f = NULL;
    status st = file_open(m, path, &f);
    const uint64_t size = st == ST_OK ? file_size(f) : 0;
    if (size >= sizeof magic)
        st = file_read_at(f, 0, magic, sizeof magic);
    file_close(f);
    if (st == ST_OK && size && memcmp(magic, LEAF_MAGIC, sizeof magic) != 0)
        st = status_describe(ST_EXISTS, "%s: exists already, and is no treelet file", path);
    return st;
}

static status check_output(job *j) {
    struct stat info;
    if (lstat(j->out, &info) != 0)
        return ST_OK; /* or what the writer says */
    if (!j->o.replace)
        return status_describe(ST_EXISTS, "%s: exists already, and shall not be replaced", j->out);
    return stat(j->out, &info) == 0 && S_ISREG(info.st_mode) ? check_replaced(&j->m, j->out)
                                                             : ST_OK;
}

/* ---- A job ---- */

/* Stages that tell nothing (mesh_coarse.h) ask for a stop all the same: watch() then hears what it
 * heard before. */
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

/* In any case job_end() follows. */
static status job_begin(job *j, const char *out, const leafcast_convert_options *options) {
    *j = (job){.out = out, .o = {.size = sizeof j->o}, .stage = "begin"};
    pthread_mutex_init(&j->lock, NULL);
    status st = options ? check_options(options) : ST_OK;
    if (st != ST_OK)
        return st;
    if (options)
        j->o = *options;
    mem_init(&j->m, (size_t)(j->o.memory ? j->o.memory : CONVERT_MEMORY_DEFAULT));
    j->o.threads = j->o.threads ? j->o.threads : pool_default_threads();
    if (j->o.watch)
        j->p = (progress){.report = tell, .stop = must_stop, .ctx = j};
    return check_output(j);
}

static leafcast_status job_end(job *j, status st) {
    pthread_mutex_destroy(&j->lock);
    return public_status(st);
}

static leaf_parameters parameters_of(const job *j) {
    leaf_parameters p = convert_parameters_default();
    if (j->o.zstd_level) {
        p.codec = LEAF_CODEC_ZSTD;
        p.zstd_level = j->o.zstd_level;
    }
    if (j->o.treelet_cells)
        p.cells_log2 = (uint32_t)__builtin_ctz(j->o.treelet_cells);
    if (j->o.without_halo)
        p.halo = 0;
    return p;
}

/* ---- Grids ---- */

static volume_hints hints_of(const job *j) {
    return (volume_hints){
        .has_missing = j->o.has_missing, .missing = j->o.missing, .name = j->o.name};
}

static status convert_volume(job *j, volume *v) {
    const convert_options o = {.file = parameters_of(j),
                               .memory = j->m.limit,
                               .threads = j->o.threads,
                               .force = j->o.replace,
                               .refuse_empty = !j->o.allow_empty};
    convert_plan plan;
    convert_result result;
    status st = convert_plan_make(&j->m, volume_grid(v), &o, &plan);
    return st == ST_OK ? convert_run(&j->m, v, j->out, &o, &plan, &j->p, &result) : st;
}

static void place_nodes(const leafcast_grid *from, grid *g) {
    for (int row = 0; row < 3; row++) {
        g->to_world[row][row] = from->spacing[row] == 0 ? 1 : from->spacing[row];
        g->to_world[row][3] = from->origin[row];
    }
    if (from->to_world)
        memcpy(g->to_world, from->to_world, sizeof g->to_world);
}

/* Release it in any case. */
static status make_grid(mem *m, const leafcast_grid *from, grid *g) {
    status st = public_size("leafcast_grid", from->size, sizeof *from);
    *g = (grid){0};
    if (st != ST_OK)
        return st;
    grid_init(g, from->dims, (sample_type)from->type);
    place_nodes(from, g);
    st = grid_check(g, "leafcast_grid");
    for (int a = 0; a < 3 && st == ST_OK; a++)
        if (from->axis[a])
            st = grid_set_axis(g, m, "leafcast_grid", a, from->axis[a]);
    /* No file is malformed: the arguments are. */
    return st == ST_CORRUPT || st == ST_UNSUPPORTED ? ST_USAGE : st;
}

static status convert_source(job *j, const leafcast_grid *from, const volume_source *source) {
    const volume_hints hints = hints_of(j);
    volume *v = NULL;
    grid g;
    status st = make_grid(&j->m, from, &g);
    if (st != ST_OK) {
        grid_release(&g, &j->m);
        return st;
    }
    st = volume_open_source(&j->m, &g, source, &hints, &v);
    if (st == ST_OK)
        st = convert_volume(j, v);
    volume_close(v);
    return st;
}

typedef struct slices {
    leafcast_slice slice;
    void *ctx;
} slices;

static status call_slice(void *ctx, uint32_t z, void *to) {
    const slices *s = ctx;
    const leafcast_status st = s->slice(s->ctx, z, to);
    const bool known = st >= LEAFCAST_USAGE && st <= LEAFCAST_FAILED;
    if (st == LEAFCAST_OK)
        return ST_OK;
    return status_describe(known ? (status)st : ST_FAILED,
                           "slice %u: the caller's function ended with status %d", z, (int)st);
}

leafcast_status leafcast_convert_slices(const leafcast_grid *from, leafcast_slice slice, void *ctx,
                                        const char *out, const leafcast_convert_options *options) {
    job j;
    slices s = {slice, ctx};
    const volume_source source = {call_slice, &s};
    status st = job_begin(&j, out, options);
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

static status copy_slice(void *ctx, uint32_t z, void *to) {
    const array *a = ctx;
    char *at = to;
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
    return ST_OK;
}

leafcast_status leafcast_convert_array(const leafcast_grid *from, const void *samples,
                                       const ptrdiff_t strides[3], const char *out,
                                       const leafcast_convert_options *options) {
    job j;
    array a = {.samples = samples, .width = sample_size((sample_type)from->type)};
    const volume_source source = {copy_slice, &a};
    ptrdiff_t tight = (ptrdiff_t)a.width;
    for (int i = 0; i < 3; i++) {
        a.dims[i] = from->dims[i];
        a.strides[i] = strides ? strides[i] : tight;
        tight *= (ptrdiff_t)from->dims[i];
    }
    status st = job_begin(&j, out, options);
    if (st == ST_OK)
        st = convert_source(&j, from, &source);
    return job_end(&j, st);
}

/* ---- Meshes ---- */

static status convert_mesh(job *j, mesh_input *x, const mesh_series *series) {
    mesh_options o = mesh_options_default();
    mesh_result result;
    o.file = parameters_of(j);
    o.series = series;
    o.memory = j->m.limit;
    o.threads = j->o.threads;
    o.force = j->o.replace;
    o.gradients = j->o.gradients;
    o.coarse = j->o.coarse;
    o.coarse_dims = j->o.coarse_dims;
    o.refuse_empty = !j->o.allow_empty;
    o.treelet_tets = j->o.treelet_tets ? j->o.treelet_tets : o.treelet_tets;
    o.leaf_tets = j->o.leaf_tets ? j->o.leaf_tets : o.leaf_tets;
    return mesh_convert_run(&j->m, x, j->out, &o, &j->p, &result);
}

static status convert_arrays(job *j, const leafcast_tets *tets) {
    mesh_input *x = NULL;
    status st = public_size("leafcast_tets", tets->size, sizeof *tets);
    if (st == ST_OK && (tets->vertex_count > MESH_POINTS_MAX || !tets->values))
        st = status_describe(ST_USAGE, "leafcast_tets: %llu vertices%s",
                             (unsigned long long)tets->vertex_count,
                             tets->values ? ": too many" : " without values");
    if (st != ST_OK)
        return st;
    const mesh_arrays arrays = {.points = tets->vertex_count,
                                .tets = tets->tet_count,
                                .xyz = tets->vertices,
                                .values = tets->values,
                                .ids = tets->tets,
                                .field = tets->field};
    st = mesh_input_open_arrays(&j->m, &arrays, j->o.name, &x);
    if (st == ST_OK)
        st = convert_mesh(j, x, NULL);
    mesh_input_close(x);
    return st;
}

leafcast_status leafcast_convert_tets(const leafcast_tets *tets, const char *out,
                                      const leafcast_convert_options *options) {
    job j;
    status st = job_begin(&j, out, options);
    if (st == ST_OK)
        st = convert_arrays(&j, tets);
    return job_end(&j, st);
}

/* ---- Files ---- */

/* The names of the fields as files have them; NULL where none are given. */
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

static status convert_input_of(job *j, const convert_input *in, const mesh_series *series) {
    if (in->x) {
        status st = mesh_series_check(series);
        return st == ST_OK ? convert_mesh(j, in->x, series) : st;
    }
    if (series->steps > 1)
        return status_describe(ST_USAGE, "%s: only meshes have several steps", series->paths[0]);
    return convert_volume(j, in->v);
}

static status check_paths(const char *const *paths, uint32_t steps) {
    if (steps < 1 || steps > LEAF_SETS_MAX)
        return status_describe(ST_USAGE, "%u steps: 1 to %d are possible", steps, LEAF_SETS_MAX);
    for (uint32_t i = 0; i < steps; i++)
        if (strcmp(paths[i], "-") == 0)
            return status_describe(ST_USAGE, "-: standard input is none of the library's");
    return ST_OK;
}

static status convert_files(job *j, const char *const *paths, uint32_t steps, const double *times) {
    const volume_hints of_grids = hints_of(j);
    field_names fields = {0};
    convert_input in = {0};
    status st = check_paths(paths, steps);
    if (st == ST_OK)
        st = clean_fields(j, &fields);
    const mesh_series series = {.paths = paths,
                                .steps = steps,
                                .names = fields.names,
                                .fields = fields.names ? j->o.field_count : 1,
                                .times = times,
                                .hints = {.field = fields.names ? fields.names[0] : NULL,
                                          .component = j->o.component,
                                          .cells_to_points = j->o.cells_to_points,
                                          .name = j->o.name}};
    if (st == ST_OK)
        st = convert_input_open(&j->m, paths[0], &of_grids, &series.hints, &in);
    if (st == ST_OK)
        st = convert_input_of(j, &in, &series);
    convert_input_close(&in);
    mem_free(&j->m, fields.text);
    mem_free(&j->m, fields.names);
    return st;
}

leafcast_status leafcast_convert_steps(const char *const *in, uint32_t steps, const double *times,
                                       const char *out, const leafcast_convert_options *options) {
    job j;
    status st = job_begin(&j, out, options);
    if (st == ST_OK)
        st = convert_files(&j, in, steps, times);
    return job_end(&j, st);
}

leafcast_status leafcast_convert_path(const char *in, const char *out,
                                      const leafcast_convert_options *options) {
    return leafcast_convert_steps(&in, 1, NULL, out, options);
}
