#include "prep/resample/coarse_grids.h"

#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "formats/base/file_guard.h"
#include "formats/grid/nrrd_writer.h"
#include "prep/grid/convert.h"
#include "prep/resample/resample.h"
#include "prep/resample/resample_cells.h"

enum { SUFFIX_ROOM = 64 };

typedef struct embedding {
    mem *m;
    const coarse_grids *o;
    const progress *p;
    leaf_file *f;         /* what is resampled */
    char *samples, *grid; /* paths of the two scratch files */
    const char *output;
} embedding;

static status append(void *ctx, const float *samples, size_t count) {
    return nrrd_writer_append(ctx, samples, count);
}

/* The most nodes: so many times as many as by default, or as this. A grid that is larger by far
 * than what it stands for would sooner fill a disk than help. */
enum { MOST_TIMES = 64, MOST_NODES = 1 << 24 };

static status check_size(const embedding *e, const resample_grid *g, uint64_t usual) {
    const uint64_t most = usual * MOST_TIMES > MOST_NODES ? usual * MOST_TIMES : MOST_NODES;
    double nodes = 1.0;
    for (int a = 0; a < 3; a++)
        nodes *= g->dims[a];
    if (nodes <= (double)most)
        return ST_OK;
    return status_describe(ST_UNSUPPORTED,
                           "%s: --coarse: a grid of %u x %u x %u nodes is far larger than the "
                           "volume it stands for; at most %llu nodes, by default there are %llu",
                           e->output, g->dims[0], g->dims[1], g->dims[2], (unsigned long long)most,
                           (unsigned long long)usual);
}

static status resample(const embedding *e, uint32_t set) {
    const leaf_header *h = &e->f->header;
    const uint64_t usual = resample_cells_of(e->f)->coarse(e->f);
    const resample_wish wish = {.dims = {e->o->dims}, .nodes = usual};
    const resample_options options = {.set = set, .memory = e->o->memory, .threads = e->o->threads};
    resample_grid g;
    grid described;
    nrrd_writer *writer = NULL;
    resample_result result;
    status st = resample_grid_choose(&wish, h->bounds, h->name, &g, &described);
    if (st == ST_OK)
        st = check_size(e, &g, usual);
    if (st == ST_OK)
        st = nrrd_writer_create(e->m, e->samples, true, &described, &writer);
    if (st == ST_OK)
        st = resample_run(e->m, e->f, &g, &options, e->p, append, writer, &result);
    if (st == ST_OK)
        return nrrd_writer_commit(writer);
    nrrd_writer_discard(writer);
    return st;
}

static status convert(const embedding *e) {
    const coarse_grids *o = e->o;
    const leaf_parameters plain = leaf_parameters_default();
    convert_options options = {
        .file = o->file, .memory = o->memory, .threads = o->threads, .force = true};
    options.file.cells_log2 = plain.cells_log2;
    options.file.halo = plain.halo;
    volume *v = NULL;
    convert_plan plan;
    convert_result result;
    status st = volume_open(e->m, e->samples, &(volume_hints){0}, &v);
    if (st == ST_OK)
        st = convert_plan_make(e->m, volume_grid(v), &options, &plan);
    if (st == ST_OK)
        st = convert_run(e->m, v, e->grid, &options, &plan, e->p, &result);
    volume_close(v);
    return st;
}

static char *beside(mem *m, const char *output, const char *suffix) {
    const size_t size = strlen(output) + SUFFIX_ROOM;
    char *path = mem_alloc(m, size);
    if (path)
        snprintf(path, size, "%s.coarse-%ld.%s", output, (long)getpid(), suffix);
    return path;
}

static void remove_scratch(const char *path) {
    file_guard_forget(path);
    (void)unlink(path);
}

static status embed_sets(embedding *e, leaf_writer *w) {
    status st = leaf_file_open(e->m, leaf_writer_path(w), &e->f);
    for (uint32_t set = 0; st == ST_OK && set < e->f->layout.sets; set++) {
        st = resample(e, set);
        if (st == ST_OK)
            st = convert(e);
        if (st == ST_OK)
            st = leaf_writer_embed(w, set, e->grid);
        remove_scratch(e->samples);
        remove_scratch(e->grid);
    }
    leaf_file_close(e->f);
    return st;
}

status coarse_grids_embed(mem *m, leaf_writer *w, const char *output, const coarse_grids *o,
                          const progress *p) {
    /* Do not report progress: this is a small rest of the whole job. */
    const progress quiet = {.stop = p ? p->stop : NULL, .ctx = p ? p->ctx : NULL};
    embedding e = {.m = m,
                   .o = o,
                   .p = &quiet,
                   .samples = beside(m, output, "nrrd"),
                   .grid = beside(m, output, "leaf"),
                   .output = output};
    const status st = e.samples && e.grid ? embed_sets(&e, w) : ST_NOMEM;
    mem_free(m, e.samples);
    mem_free(m, e.grid);
    return st;
}
