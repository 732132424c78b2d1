#include "prep/generate/curvilinear_generate.h"

#include <limits.h>
#include <stdio.h>
#include <string.h>

#include "formats/base/out_stream.h"
#include "formats/base/pool.h"
#include "formats/base/portable_math.h"
#include "prep/generate/generate_steps.h"

/* ---- shapes ---- */

bool curvilinear_shape_find(const char *name, curvilinear_shape *out) {
    static const char *const names[CURVILINEAR_SHAPES] = {"warp", "annulus", "twisted"};
    for (int i = 0; i < CURVILINEAR_SHAPES; i++)
        if (strcmp(name, names[i]) == 0) {
            *out = (curvilinear_shape)i;
            return true;
        }
    return false;
}

/* Each coordinate sways with the two others: by less than a tenth, at slopes below 0.9. */
static void warp(const double at[3], double out[3]) {
    for (int a = 0; a < 3; a++) {
        const double b = at[(a + 1) % 3], c = at[(a + 2) % 3];
        out[a] =
            at[a] + 0.05 * portable_sin(b) * portable_cos(0.5 * c) + 0.03 * portable_sin(2 * c);
    }
}

static void annulus(const double at[3], double out[3]) {
    const double radius = 0.5 + 0.5 * at[1];
    double sine, cosine;
    portable_sincos(at[0] < 1 ? at[0] : 0, &sine, &cosine);
    out[0] = radius * cosine;
    out[1] = radius * sine;
    out[2] = at[2];
}

static void twist(const double at[3], double out[3]) {
    const double x = at[0] - 0.5, y = at[1] - 0.5;
    double sine, cosine;
    portable_sincos(0.75 * at[2], &sine, &cosine);
    out[0] = x * cosine - y * sine;
    out[1] = x * sine + y * cosine;
    out[2] = 2 * at[2];
}

void curvilinear_shape_place(curvilinear_shape shape, const double at[3], float out[3]) {
    double place[3];
    switch (shape) {
    case CURVILINEAR_WARP: warp(at, place); break;
    case CURVILINEAR_ANNULUS: annulus(at, place); break;
    default: twist(at, place); break;
    }
    for (int a = 0; a < 3; a++)
        out[a] = (float)place[a];
}

/* ---- a file ---- */

typedef struct writing {
    const curvilinear_generate_options *o;
    const progress *p;
    pool *threads;
    out_stream *out;
    field *f;
    uint32_t step, steps, k;
    float (*places)[3]; /* of a plane of nodes */
    float *values;      /* the same */
} writing;

static size_t plane_nodes(const curvilinear_generate_options *o) {
    return (size_t)o->dims[0] * o->dims[1];
}

static status write_head(const writing *w) {
    const curvilinear_generate_options *o = w->o;
    const unsigned long long nodes = (unsigned long long)plane_nodes(o) * o->dims[2];
    char extent[64], text[1024];
    snprintf(extent, sizeof extent, "0 %u 0 %u 0 %u", o->dims[0] - 1, o->dims[1] - 1,
             o->dims[2] - 1);
    snprintf(text, sizeof text,
             "<?xml version=\"1.0\"?>\n"
             "<VTKFile type=\"StructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" "
             "header_type=\"UInt64\">\n"
             "<StructuredGrid WholeExtent=\"%s\">\n<Piece Extent=\"%s\">\n"
             "<Points>\n<DataArray type=\"Float32\" Name=\"Points\" NumberOfComponents=\"3\" "
             "format=\"appended\" offset=\"0\"/>\n</Points>\n"
             "<PointData Scalars=\"%s\">\n<DataArray type=\"Float32\" Name=\"%s\" "
             "format=\"appended\" offset=\"%llu\"/>\n</PointData>\n"
             "</Piece>\n</StructuredGrid>\n<AppendedData encoding=\"raw\">\n_",
             extent, extent, o->info->name, o->info->name,
             (unsigned long long)sizeof(uint64_t) + 12 * nodes);
    return out_stream_text(w->out, text);
}

static status write_size(const writing *w, uint64_t bytes) {
    uint8_t little[sizeof bytes];
    for (size_t i = 0; i < sizeof little; i++)
        little[i] = (uint8_t)(bytes >> 8 * i);
    return out_stream_write(w->out, little, sizeof little);
}

static status place_row(void *ctx, size_t j, int worker) {
    const writing *w = ctx;
    const uint32_t *dims = w->o->dims;
    double at[3] = {0, (double)j / (dims[1] - 1), (double)w->k / (dims[2] - 1)};
    (void)worker;
    for (uint32_t i = 0; i < dims[0]; i++) {
        at[0] = (double)i / (dims[0] - 1);
        curvilinear_shape_place(w->o->shape, at, w->places[i + j * dims[0]]);
    }
    return ST_OK;
}

/* half: 0 while places are written, 1 while values are. */
static status tell(const writing *w, int half) {
    const double done = 0.5 * (half + (double)w->k / w->o->dims[2]);
    return progress_step(w->p, "generating", (w->step + done) / w->steps);
}

static status write_places(writing *w) {
    const size_t plane = plane_nodes(w->o);
    status st = write_size(w, (uint64_t)plane * w->o->dims[2] * sizeof *w->places);
    for (w->k = 0; w->k < w->o->dims[2] && st == ST_OK; w->k++) {
        st = tell(w, 0);
        if (st == ST_OK)
            st = pool_run(w->threads, w->o->dims[1], place_row, w);
        if (st == ST_OK)
            st = out_stream_samples(w->out, SAMPLE_F32, w->places, 3 * plane);
    }
    return st;
}

static status write_values(writing *w) {
    const size_t plane = plane_nodes(w->o);
    status st = write_size(w, (uint64_t)plane * w->o->dims[2] * sizeof *w->values);
    for (w->k = 0; w->k < w->o->dims[2] && st == ST_OK; w->k++) {
        const field_block block = {w->k, 1, 0, w->o->dims[1]};
        st = tell(w, 1);
        if (st == ST_OK)
            st = field_fill(w->f, w->threads, &block, SAMPLE_F32, w->values);
        if (st == ST_OK)
            st = out_stream_samples(w->out, SAMPLE_F32, w->values, plane);
    }
    return st;
}

static status write_file(writing *w) {
    status st = write_head(w);
    if (st == ST_OK)
        st = write_places(w);
    if (st == ST_OK)
        st = write_values(w);
    return st == ST_OK ? out_stream_text(w->out, "\n</AppendedData>\n</VTKFile>\n") : st;
}

static status write_step(mem *m, writing *w) {
    const curvilinear_generate_options *o = w->o;
    const field_choice which = {o->info, o->seed, generate_steps_time(w->steps, w->step)};
    char path[PATH_MAX];
    status st = generate_steps_name(o->output, o->steps, w->step, path);
    if (st == ST_OK)
        st = field_create(m, &which, o->dims, plane_nodes(o), &w->f);
    if (st == ST_OK)
        st = out_stream_create(m, path, o->force, false, &w->out);
    if (st == ST_OK)
        st = write_file(w);
    if (st == ST_OK) {
        st = out_stream_commit(w->out);
        w->out = NULL;
    }
    out_stream_discard(w->out);
    field_destroy(w->f);
    w->out = NULL;
    w->f = NULL;
    return st;
}

status curvilinear_generate(mem *m, const curvilinear_generate_options *o, const progress *p) {
    writing w = {.o = o, .p = p, .steps = o->steps > 0 ? o->steps : 1};
    status st = generate_steps_check(o->output, o->steps, o->force);
    if (st == ST_OK)
        st = pool_create(m, o->threads, &w.threads);
    if (st == ST_OK) {
        w.places = mem_array(m, plane_nodes(o), sizeof *w.places);
        w.values = mem_array(m, plane_nodes(o), sizeof *w.values);
        st = w.places && w.values ? ST_OK : ST_NOMEM;
    }
    for (; w.step < w.steps && st == ST_OK; w.step++)
        st = write_step(m, &w);
    mem_free(m, w.places);
    mem_free(m, w.values);
    pool_destroy(w.threads);
    return st;
}
