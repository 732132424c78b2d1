#include "prep/generate/generate.h"

#include <limits.h>

#include "formats/base/pool.h"
#include "formats/grid/nrrd_writer.h"
#include "prep/generate/generate_steps.h"

enum { BLOCK_BYTES = 32 << 20 };

typedef struct job {
    const grid *g;
    field *f;
    pool *threads;
    nrrd_writer *writer;
    const generate_options *options;
    const progress *progress;
    uint32_t step, steps; /* steps: at least 1 */
    field_block block;    /* with the largest sizes; the last blocks are smaller */
    void *samples;
} job;

/* Choose blocks of whole slices if one fits, otherwise of rows. */
static field_block choose_block(const mem *m, const grid *g) {
    uint64_t room = m->limit && m->limit / 4 < BLOCK_BYTES ? m->limit / 4 : BLOCK_BYTES;
    uint64_t slices = room / grid_slice_bytes(g);
    if (slices > 0)
        return (field_block){.slices = (uint32_t)(slices < g->dims[2] ? slices : g->dims[2]),
                             .rows = g->dims[1]};
    uint64_t rows = room / (g->dims[0] * sample_size(g->type));
    return (field_block){.slices = 1, .rows = rows > 0 ? (uint32_t)rows : 1};
}

static status write_block(job *j, const field_block *b) {
    double done = (b->slice + (double)b->row / j->g->dims[1]) / j->g->dims[2];
    status st = progress_step(j->progress, "generating", (j->step + done) / j->steps);
    if (st == ST_OK)
        st = field_fill(j->f, j->threads, b, j->g->type, j->samples);
    if (st == ST_OK)
        st = nrrd_writer_append(j->writer, j->samples, (size_t)b->slices * b->rows * j->g->dims[0]);
    return st;
}

static uint32_t least(uint32_t a, uint32_t b) {
    return a < b ? a : b;
}

static status write_blocks(job *j) {
    const uint32_t *dims = j->g->dims;
    field_block b = {0};
    for (b.slice = 0; b.slice < dims[2]; b.slice += b.slices) {
        b.slices = least(j->block.slices, dims[2] - b.slice);
        for (b.row = 0; b.row < dims[1]; b.row += b.rows) {
            b.rows = least(j->block.rows, dims[1] - b.row);
            status st = write_block(j, &b);
            if (st != ST_OK)
                return st;
        }
    }
    return progress_step(j->progress, "generating", (j->step + 1.0) / j->steps);
}

static size_t block_samples(const job *j) {
    return (size_t)j->block.slices * j->block.rows * j->g->dims[0];
}

static status write_step(mem *m, job *j) {
    const generate_options *o = j->options;
    const field_choice which = {o->info, o->seed, generate_steps_time(j->steps, j->step)};
    char path[PATH_MAX];
    status st = generate_steps_name(o->output, o->steps, j->step, path);
    if (st == ST_OK)
        st = field_create(m, &which, j->g->dims, block_samples(j), &j->f);
    if (st == ST_OK)
        st = nrrd_writer_create(m, path, o->force, j->g, &j->writer);
    if (st == ST_OK)
        st = write_blocks(j);
    if (st == ST_OK) {
        st = nrrd_writer_commit(j->writer);
        j->writer = NULL;
    }
    nrrd_writer_discard(j->writer);
    field_destroy(j->f);
    j->writer = NULL;
    j->f = NULL;
    return st;
}

static status run(mem *m, job *j) {
    status st = pool_create(m, j->options->threads, &j->threads);
    if (st == ST_OK && !(j->samples = mem_array(m, block_samples(j), sample_size(j->g->type))))
        st = ST_NOMEM;
    for (j->step = 0; j->step < j->steps && st == ST_OK; j->step++)
        st = write_step(m, j);
    return st;
}

status generate_volume(mem *m, const grid *g, const generate_options *options, const progress *p) {
    status st = grid_check_volume(g, options->output);
    if (st == ST_OK)
        st = generate_steps_check(options->output, options->steps, options->force);
    if (st != ST_OK)
        return st;
    job j = {.g = g,
             .options = options,
             .progress = p,
             .steps = options->steps > 0 ? options->steps : 1,
             .block = choose_block(m, g)};
    st = run(m, &j);
    mem_free(m, j.samples);
    pool_destroy(j.threads);
    return st;
}
