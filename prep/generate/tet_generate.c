#include "prep/generate/tet_generate.h"

#include <limits.h>
#include <stdio.h>
#include <string.h>

#include "formats/base/pool.h"
#include "formats/base/portable_math.h"
#include "formats/mesh/mesh_stream.h"
#include "prep/generate/generate_steps.h"

enum {
    BLOCK_BYTES = 4 << 20,  /* of points and tets: a block stays in a cache until it is written */
    VALUE_BYTES = 32 << 20, /* of values: large, since the attractor starts again for each block */
    PIECE_BYTES = 64 << 10, /* bytes that a thread makes at a time */
};

typedef struct job {
    tet_lattice lattice;
    const tet_generate_options *options;
    pool *threads;
    const mesh_sink *sink;
    const progress *progress;
    double done, whole; /* in bytes of the mesh stream */
    double time;        /* of the field */
} job;

static size_t room(const mem *m, size_t bytes) {
    return m->limit && m->limit / 4 < bytes ? m->limit / 4 : bytes;
}

static status advance(job *j, size_t bytes) {
    j->done += (double)bytes;
    return progress_step(j->progress, "generating", j->done / j->whole);
}

/* ---- points and tets: rows that are independent of each other ---- */

typedef struct row_job {
    job *j;
    bool tets;           /* else points */
    uint64_t count;      /* rows in the whole mesh */
    size_t size;         /* bytes of a row */
    uint32_t items;      /* points or tets of a row */
    uint64_t first;      /* first row of the block */
    size_t block, piece; /* rows in a block; rows a thread makes at a time */
    char *buffer;
} row_job;

static status make_piece(void *ctx, size_t index, int worker) {
    (void)worker;
    const row_job *r = ctx;
    size_t last = (index + 1) * r->piece < r->block ? (index + 1) * r->piece : r->block;
    for (size_t n = index * r->piece; n < last; n++) {
        void *to = r->buffer + n * r->size;
        if (r->tets)
            tet_lattice_tets(&r->j->lattice, r->first + n, to);
        else
            tet_lattice_points(&r->j->lattice, r->first + n, to);
    }
    return ST_OK;
}

static status hand_over(const row_job *r) {
    const mesh_sink *sink = r->j->sink;
    size_t count = r->block * r->items;
    if (r->tets)
        return sink->tets(sink->ctx, count, (const uint32_t(*)[4])(void *)r->buffer);
    return sink->points(sink->ctx, r->first * r->items, count,
                        (const float(*)[3])(void *)r->buffer);
}

static status make_blocks(row_job *r, size_t most) {
    status st = ST_OK;
    for (r->first = 0; st == ST_OK && r->first < r->count; r->first += r->block) {
        uint64_t left = r->count - r->first;
        r->block = left < most ? (size_t)left : most;
        st = pool_run(r->j->threads, (r->block + r->piece - 1) / r->piece, make_piece, r);
        if (st == ST_OK)
            st = hand_over(r);
        if (st == ST_OK)
            st = advance(r->j, r->block * r->size);
    }
    return st;
}

static status make_rows(mem *m, job *j, bool tets) {
    const tet_lattice *l = &j->lattice;
    row_job r = {.j = j,
                 .tets = tets,
                 .count = tets ? l->tet_rows : l->point_rows,
                 .items = tets ? l->row_tets : l->row_points};
    r.size = r.items * (tets ? sizeof(uint32_t[4]) : sizeof(float[3]));
    r.piece = PIECE_BYTES / r.size + 1;
    size_t most = room(m, BLOCK_BYTES) / r.size + 1;
    most = most < r.count ? most : (size_t)r.count;
    r.buffer = mem_alloc(m, most * r.size);
    status st = r.buffer ? make_blocks(&r, most) : ST_NOMEM;
    mem_free(m, r.buffer);
    return st;
}

/* ---- values: copy after copy ---- */

typedef struct value_job {
    job *j;
    field *f;
    field_block block; /* with the largest sizes */
    size_t count;      /* samples of the largest block */
    float *samples;
} value_job;

/* Choose whole slices if one fits, otherwise rows. */
static field_block choose_block(size_t bytes, const uint32_t dims[3]) {
    uint64_t row = dims[0] * sizeof(float), slice = row * dims[1];
    uint64_t slices = bytes / slice, count = bytes / row;
    if (slices > 0)
        return (field_block){.slices = slices < dims[2] ? (uint32_t)slices : dims[2],
                             .rows = dims[1]};
    return (field_block){.slices = 1, .rows = count > 0 ? (uint32_t)count : 1};
}

static status hand_values(value_job *v, const field_block *b, uint32_t copy, bool filled) {
    job *j = v->j;
    const uint32_t *dims = j->lattice.shape.dims;
    size_t count = (size_t)b->slices * b->rows * dims[0];
    uint64_t first = ((uint64_t)b->slice * dims[1] + b->row) * dims[0];
    first += (uint64_t)copy * j->lattice.copy_points;
    status st = filled ? ST_OK : field_fill(v->f, j->threads, b, SAMPLE_F32, v->samples);
    if (st == ST_OK)
        st = j->sink->values(j->sink->ctx, first, count, v->samples);
    return st == ST_OK ? advance(j, count * sizeof(float)) : st;
}

/* Hand over the values of one copy. The first copy's values are reused if one block holds all. */
static status hand_copy(value_job *v, uint32_t copy) {
    const uint32_t *dims = v->j->lattice.shape.dims;
    const bool filled = copy > 0 && v->count == v->j->lattice.copy_points;
    field_block b = {0};
    for (b.slice = 0; b.slice < dims[2]; b.slice += b.slices) {
        b.slices = v->block.slices < dims[2] - b.slice ? v->block.slices : dims[2] - b.slice;
        for (b.row = 0; b.row < dims[1]; b.row += b.rows) {
            b.rows = v->block.rows < dims[1] - b.row ? v->block.rows : dims[1] - b.row;
            status st = hand_values(v, &b, copy, filled);
            if (st != ST_OK)
                return st;
        }
    }
    return ST_OK;
}

static status make_values(mem *m, job *j) {
    const uint32_t *dims = j->lattice.shape.dims;
    const field_choice which = {j->options->info, j->options->seed, j->time};
    value_job v = {.j = j, .block = choose_block(room(m, VALUE_BYTES), dims)};
    v.count = (size_t)v.block.slices * v.block.rows * dims[0];
    v.samples = mem_alloc(m, v.count * sizeof(float));
    status st = v.samples ? ST_OK : ST_NOMEM;
    if (st == ST_OK)
        st = field_create(m, &which, dims, v.count, &v.f);
    for (uint32_t copy = 0; st == ST_OK && copy < j->lattice.copies; copy++)
        st = hand_copy(&v, copy);
    field_destroy(v.f);
    mem_free(m, v.samples);
    return st;
}

/* ---- the mesh ---- */

/* Generate step `step` of a series of `steps` meshes. */
static status generate(mem *m, const tet_generate_options *options, const mesh_sink *sink,
                       const progress *p, uint32_t step, uint32_t steps) {
    job j = {
        .options = options, .sink = sink, .progress = p, .time = generate_steps_time(steps, step)};
    status st = tet_lattice_init(&j.lattice, m, &options->shape);
    double bytes = (double)j.lattice.points * sizeof(float[4]);
    bytes += (double)j.lattice.tets * sizeof(uint32_t[4]);
    j.whole = bytes * steps;
    j.done = bytes * step;
    if (st == ST_OK)
        st = pool_create(m, options->threads, &j.threads);
    if (st == ST_OK)
        st = advance(&j, 0);
    if (st == ST_OK)
        st = make_rows(m, &j, false);
    if (st == ST_OK)
        st = make_values(m, &j);
    if (st == ST_OK)
        st = make_rows(m, &j, true);
    pool_destroy(j.threads);
    tet_lattice_release(&j.lattice, m);
    return st;
}

status tet_generate(mem *m, const tet_generate_options *options, const mesh_sink *sink,
                    const progress *p) {
    status st = tet_lattice_check(&options->shape);
    return st == ST_OK ? generate(m, options, sink, p, 0, 1) : st;
}

/* ---- files ---- */

static status write_points(void *writer, uint64_t first, size_t count, const float (*xyz)[3]) {
    (void)first;
    return mesh_stream_points(writer, count, xyz);
}

static status write_values(void *writer, uint64_t first, size_t count, const float *values) {
    (void)first;
    return mesh_stream_values(writer, count, values);
}

static status write_tets(void *writer, size_t count, const uint32_t (*ids)[4]) {
    return mesh_stream_tets(writer, count, ids);
}

typedef struct series {
    tet_generate_options options; /* for the current step */
    bool force;
    const progress *progress;
    uint32_t step, steps;
} series;

static status write_file(mem *m, const series *s, const char *path) {
    const tet_lattice_shape *shape = &s->options.shape;
    mesh_stream_header header = {.points = tet_lattice_count_points(shape),
                                 .tets = tet_lattice_count_tets(shape)};
    snprintf(header.name, sizeof header.name, "%s", s->options.info->name);
    snprintf(header.field, sizeof header.field, "%s", s->options.info->name);
    mesh_stream_writer *writer;
    status st = mesh_stream_create(m, path, s->force, &header, &writer);
    if (st != ST_OK)
        return st;
    const mesh_sink sink = {
        .ctx = writer, .points = write_points, .values = write_values, .tets = write_tets};
    st = generate(m, &s->options, &sink, s->progress, s->step, s->steps);
    if (st == ST_OK)
        return mesh_stream_commit(writer);
    mesh_stream_discard(writer);
    return st;
}

status tet_generate_files(mem *m, const tet_generate_options *options, const char *output,
                          bool force, const progress *p) {
    const uint32_t steps = options->steps;
    series s = {.options = *options, .force = force, .progress = p, .steps = steps ? steps : 1};
    status st = tet_lattice_check(&options->shape);
    if (st == ST_OK)
        st = generate_steps_check(output, steps, force);
    for (s.step = 0; st == ST_OK && s.step < s.steps; s.step++) {
        char path[PATH_MAX];
        if (steps > 0)
            s.options.shape.deform = options->shape.deform * portable_sin((double)s.step / steps);
        st = generate_steps_name(output, steps, s.step, path);
        if (st == ST_OK)
            st = write_file(m, &s, path);
    }
    return st;
}
