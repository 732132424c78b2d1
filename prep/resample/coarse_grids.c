#include "prep/resample/coarse_grids.h"

#include <stdio.h>
#include <string.h>

#include "formats/grid/nrrd_writer.h"
#include "prep/grid/convert.h"
#include "prep/resample/grid_cover.h"
#include "prep/resample/resample.h"
#include "prep/resample/resample_cells.h"

static const double RESAMPLE_SHARE = 0.9; /* of the whole, a guess, for progress alone */

typedef struct embedding {
    mem *m;
    const coarse_grids *o;
    const progress *p;
    leaf_file *f;               /* what is resampled */
    const char *samples, *grid; /* paths */
} embedding;

typedef struct receiver {
    nrrd_writer *writer;
    grid_cover cover; /* of a grid that is inside another */
} receiver;

static status receive(void *ctx, const float *samples, size_t count) {
    receiver *r = ctx;
    if (r->cover.node)
        grid_cover_take(&r->cover, samples, count);
    return nrrd_writer_append(r->writer, samples, count);
}

/* The most nodes: so many times as many as by default, or as this. A grid that is larger by far
 * than what it stands for would sooner fill a disk than help. */
enum { MOST_TIMES = 64, MOST_NODES = 1 << 24 };

/* Of a grid inside another: the nodes for each cell, the most nodes, and what it must show. */
enum { INSIDE_TIMES = 8, INSIDE_MOST = 1 << 20, SHOWN = 7, SHOWN_OF = 8 };

static uint64_t usual_nodes(const embedding *e) {
    const uint64_t usual = resample_cells_of(e->f)->coarse(e->f), times = usual * INSIDE_TIMES;
    return !e->o->inside ? usual : times < INSIDE_MOST ? times : INSIDE_MOST;
}

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
                           e->o->output, g->dims[0], g->dims[1], g->dims[2],
                           (unsigned long long)most, (unsigned long long)usual);
}

static status resample(const embedding *e, uint32_t set, bool *shows) {
    const leaf_header *h = &e->f->header;
    const uint64_t usual = usual_nodes(e);
    const resample_wish wish = {.dims = {e->o->dims}, .nodes = usual};
    const resample_options options = {.set = set, .memory = e->o->memory, .threads = e->o->threads};
    resample_grid g;
    grid described;
    receiver r = {0};
    uint64_t cells = 0, covered = 0;
    resample_result result;
    status st = resample_grid_choose(&wish, h->bounds, h->name, &g, &described);
    *shows = !e->o->inside;
    if (e->o->inside && st == ST_UNSUPPORTED) /* it is flat */
        return ST_OK;
    if (st == ST_OK)
        st = check_size(e, &g, usual);
    if (st == ST_OK)
        st = nrrd_writer_create(e->m, e->samples, true, &described, &r.writer);
    if (st == ST_OK && e->o->inside)
        st = grid_cover_init(&r.cover, e->m, &g);
    if (st == ST_OK)
        st = resample_run(e->m, e->f, &g, &options, e->p, receive, &r, &result);
    if (st == ST_OK && e->o->inside)
        st = grid_cover_count(&r.cover, e->f, set, &cells, &covered);
    *shows = !e->o->inside || (covered > 0 && covered * SHOWN_OF >= cells * SHOWN);
    grid_cover_release(&r.cover);
    if (st == ST_OK)
        return nrrd_writer_commit(r.writer);
    nrrd_writer_discard(r.writer);
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

/* The samples wait in a file beside the grid's. */
static status make(const void *ctx, mem *m, leaf_file *f, uint32_t set, const char *path,
                   const progress *p, bool *made) {
    const coarse_grids *o = ctx;
    bool shows;
    const size_t size = strlen(path) + COARSE_PARTS_SUFFIX;
    char *samples = mem_alloc(m, size);
    if (!samples)
        return ST_NOMEM;
    snprintf(samples, size, "%s.nrrd", path);
    progress_part parts[2] = {{p, 0.0, RESAMPLE_SHARE}, {p, RESAMPLE_SHARE, 1.0}};
    const progress of_part[2] = {progress_of_part(&parts[0]), progress_of_part(&parts[1])};
    embedding e = {.m = m, .o = o, .p = &of_part[0], .f = f, .samples = samples, .grid = path};
    status st = resample(&e, set, &shows);
    *made = st == ST_OK && shows;
    e.p = &of_part[1];
    if (*made)
        st = convert(&e);
    coarse_parts_remove(samples);
    mem_free(m, samples);
    return st;
}

coarse_maker coarse_grids_maker(const coarse_grids *o) {
    return (coarse_maker){o, make};
}
