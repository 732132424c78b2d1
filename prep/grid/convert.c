#include "prep/grid/convert.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "formats/base/pool.h"
#include "formats/leaf/leaf_histogram.h"
#include "formats/leaf/leaf_writer.h"
#include "prep/grid/deviation_build.h"
#include "prep/grid/pyramid.h"
#include "prep/grid/read_ahead.h"
#include "prep/grid/slab.h"
#include "prep/grid/treelet_build.h"

#ifndef LEAFCAST_VERSION
#define LEAFCAST_VERSION "0"
#endif

/* So many bytes of slices at once, as nothing can be stopped meanwhile. */
enum { PUSH_BYTES = 64 << 20 };

/* Buffers of one thread. */
typedef struct bench {
    grid_codes_scratch *scratch;
    void *payload; /* of a treelet, before it is compressed; NULL: it is not */
    void *shell;   /* what a family shares; NULL: the file has no shells */
    leaf_packer *packer;
    leaf_family *family;
} bench;

/* State of one level. */
typedef struct stage {
    slab *slab;
    pyramid *up;                /* makes the next level's slices; NULL at the last */
    char *coarse;               /* buffer for those slices */
    uint8_t *busy;              /* maps of those slices; NULL: there are none */
    deviation_build *deviation; /* of the next level; NULL: the file has none */
} stage;

typedef struct conversion {
    mem *m;
    const convert_options *o;
    const convert_plan *plan;
    const progress *p;
    leaf_writer *writer;
    const leaf_layout *layout;
    uint32_t set; /* the current one */
    bool resumes; /* the current set has been begun by an earlier run */
    /* Facts of the sets before the current one; of this one, as far as an earlier run knew them. */
    read_ahead_facts seen, past;
    absent_parts absent;
    pool *workers;
    bench *benches; /* one per worker */
    stage stages[LEAF_LEVELS_MAX];
    read_ahead *input;
    const void *quiet; /* value of tiles that maps call not busy; NULL: there are no maps */
    uint32_t slices_done;
    leaf_slabs slabs; /* at the one that is complete next */
    /* For the histogram; cells is NULL if the file has none. */
    histogram_draw draw;
    histogram_space space;
    histogram_cell *cells;
    histogram_marker marker;
} conversion;

/* ---- from slabs to payloads ---- */

typedef struct cutting {
    const conversion *c;
    const slab_box *box;
    uint32_t level;
} cutting;

/* Record a treelet of which all samples are the quiet value. */
static void imply_treelet(const conversion *c, leaf_family *f, uint32_t t) {
    const float value = sample_get(c->layout->type, c->quiet, 0);
    const leaf_entry entry = {.own = {value, value}};
    if (c->cells && c->layout->level_of[t] == 0)
        leaf_histogram_take_one(c->layout, &c->draw, &c->space, t, c->quiet, c->cells);
    leaf_writer_put_implied(c->writer, f, t, &entry);
}

static void make_treelet(const conversion *c, const bench *b, const sample_box *box, uint32_t t) {
    grid_summary summary;
    if (treelet_build_quiet(c->layout, t, box)) {
        imply_treelet(c, b->family, t);
        return;
    }
    void *payload = b->payload ? b->payload : leaf_family_room(b->family);
    treelet_build(c->layout, t, box, b->scratch, payload, &summary);
    leaf_entry entry = {.own = {summary.own[0], summary.own[1]}, .flags = summary.flags};
    if (c->cells && c->layout->level_of[t] == 0)
        leaf_histogram_take(c->layout, &c->draw, &c->space, t, payload, c->cells);
    leaf_writer_put(c->writer, b->family, b->packer, t, &entry, payload);
}

/* Make the treelets below treelet p, and put what they share, if any of them has bytes. */
static void make_siblings(const conversion *c, const bench *b, const sample_box *box, uint32_t p) {
    const leaf_layout *l = c->layout;
    const int siblings = __builtin_popcount(leaf_layout_children(l, p));
    for (int i = 0; i < siblings; i++)
        make_treelet(c, b, box, l->first_child[p] + (uint32_t)i);
    if (!l->shells)
        return;
    const bool needed = siblings > 1 && leaf_family_bytes(b->family) > 0;
    if (needed)
        treelet_build_shell(l, p, box, b->shell);
    leaf_writer_put_shell(c->writer, b->family, b->packer, p, needed ? b->shell : NULL);
}

static status make_family(void *ctx, size_t index, int worker) {
    const cutting *job = ctx;
    const conversion *c = job->c;
    bench *b = &c->benches[worker];
    const slab_box *box = job->box;
    const uint32_t x = box->first[0] + (uint32_t)index % box->count[0];
    const uint32_t y = box->first[1] + (uint32_t)index / box->count[0];
    const leaf_slab of = {.level = job->level, .z = box->first[2]};
    const uint32_t in_slab = y * slab_families(c->layout, job->level, 0) + x;
    leaf_family_begin(b->family, c->set, &of, in_slab);
    const uint32_t parent = leaf_slab_parent(c->layout, &of, in_slab);
    if (parent == LEAF_NO_TREELET)
        make_treelet(c, b, &box->samples, 0);
    else
        make_siblings(c, b, &box->samples, parent);
    status st = progress_ask(c->p, "convert");
    if (st == ST_OK)
        st = leaf_writer_end_family(c->writer, &b->family);
    if (st != ST_OK)
        leaf_writer_give_up(c->writer);
    return st;
}

/* Share of the work on all sets that is done. */
static double done(const conversion *c) {
    return (c->set + (double)c->slices_done / c->layout->level[0].dims[2]) / c->layout->sets;
}

static status take_slab(conversion *c, uint32_t level) {
    slab *s = c->stages[level].slab;
    for (uint32_t i = 0; i < slab_boxes(s); i++) {
        status st = progress_step(c->p, "convert", done(c));
        slab_box box;
        if (st == ST_OK)
            st = slab_take(s, i, &box);
        if (st != ST_OK)
            return st;
        cutting job = {.c = c, .box = &box, .level = level};
        st = pool_run(c->workers, (size_t)box.count[0] * box.count[1], make_family, &job);
        if (st != ST_OK)
            return st;
    }
    slab_next(s);
    return ST_OK;
}

/* ---- slices go up the pyramid ---- */

static status store_slices(conversion *c, uint32_t level, read_slices in) {
    slab *s = c->stages[level].slab;
    const uint32_t *dims = c->layout->level[level].dims;
    const size_t slice_bytes = (size_t)dims[0] * dims[1] * sample_size(c->layout->type);
    while (in.count > 0) {
        uint32_t room = slab_room(s), some = in.count < room ? in.count : room;
        status st = slab_store(s, c->workers, in.samples, in.busy, some);
        while (st == ST_OK && slab_complete(s))
            st = take_slab(c, level);
        if (st != ST_OK)
            return st;
        in.samples += some * slice_bytes;
        if (in.busy)
            in.busy += some * slice_tiles_count(dims);
        in.count -= some;
    }
    return ST_OK;
}

/* Go on to the first slab that is not complete. Returns whether there was any that is. */
static bool pass_slabs(conversion *c) {
    bool any = false;
    while (c->slices_done >= c->slabs.at.slices) {
        any = true;
        if (!leaf_slabs_next(&c->slabs, c->layout))
            break;
    }
    return any;
}

/* ---- what a later run needs to go on ---- */

/* What must be known before anything is set up. */
static status keep_head(void *ctx, state_io *io) {
    conversion *c = ctx;
    if (c->input)
        c->past = read_ahead_seen(c->input);
    status st = convert_job_keep(c->o->job, io);
    if (st == ST_OK)
        st = STATE_IO(io, c->set);
    if (st == ST_OK)
        st = STATE_IO(io, c->slices_done);
    if (st == ST_OK)
        st = STATE_IO(io, c->seen);
    if (st == ST_OK)
        st = STATE_IO(io, c->past);
    if (st == ST_OK)
        st = STATE_IO(io, c->absent);
    return st == ST_OK ? STATE_IO(io, c->marker) : st;
}

static status keep_stage(stage *s, state_io *io) {
    status st = slab_keep(s->slab, io);
    if (st == ST_OK && s->up)
        st = pyramid_keep(s->up, io);
    return st == ST_OK && s->deviation ? deviation_build_keep(s->deviation, io) : st;
}

static status keep(void *ctx, state_io *io) {
    conversion *c = ctx;
    status st = keep_head(c, io);
    if (st == ST_OK)
        st = leaf_writer_keep(c->writer, io);
    if (st == ST_OK && c->cells)
        st = state_io_bytes(io, c->cells, c->draw.count * sizeof *c->cells);
    for (uint32_t level = 0; level < c->layout->levels && st == ST_OK; level++)
        st = keep_stage(&c->stages[level], io);
    return st == ST_OK ? state_io_end(io) : st;
}

static status save(conversion *c) {
    out_file *files[WORK_FILES] = {0};
    leaf_writer_files(c->writer, files);
    return work_folder_save(c->o->work, files, done(c), keep, c);
}

/* ---- slices ---- */

/* Take slices that complete no slab, but by the last of them: then slabs are complete in the order
 * of the file. */
static status push(conversion *c, read_slices in) {
    for (uint32_t level = 0; in.count > 0; level++) {
        status st = store_slices(c, level, in);
        const stage *s = &c->stages[level];
        if (st != ST_OK || !s->up)
            return st;
        uint32_t coarse = pyramid_ready(s->up, in.count);
        st = pyramid_feed(s->up, c->workers, in.samples, in.busy, in.count, s->coarse, s->busy);
        if (st == ST_OK && s->deviation)
            st = deviation_build_feed(s->deviation, c->workers, in.samples, in.count, s->coarse,
                                      coarse);
        if (st != ST_OK)
            return st;
        in = (read_slices){s->coarse, s->busy, coarse};
    }
    return ST_OK;
}

/* *complete: set when a slab is. */
static status push_batch(conversion *c, read_slices in, bool *complete) {
    const uint32_t *dims = c->layout->level[0].dims;
    const size_t slice_bytes = (size_t)dims[0] * dims[1] * sample_size(c->layout->type);
    while (in.count > 0) {
        const uint32_t until = c->slabs.at.slices - c->slices_done;
        uint32_t some = in.count < until ? in.count : until;
        if (some * slice_bytes > PUSH_BYTES)
            some = slice_bytes < PUSH_BYTES ? (uint32_t)(PUSH_BYTES / slice_bytes) : 1;
        status st = push(c, (read_slices){in.samples, in.busy, some});
        if (st == ST_OK)
            st = progress_ask(c->p, "convert");
        if (st != ST_OK)
            return st;
        c->slices_done += some;
        *complete |= pass_slabs(c);
        in.samples += some * slice_bytes;
        if (in.busy)
            in.busy += some * slice_tiles_count(dims);
        in.count -= some;
    }
    return ST_OK;
}

static status convert_slices(conversion *c) {
    for (bool complete = false;;) {
        read_slices in;
        status st = read_ahead_next(c->input, &in);
        if (st != ST_OK || in.count == 0)
            return st;
        st = push_batch(c, in, &complete);
        if (st == ST_OK)
            st = progress_step(c->p, "convert", done(c));
        if (st == ST_OK && complete && c->o->work && work_folder_due(c->o->work)) {
            st = save(c);
            complete = false;
        }
        if (st != ST_OK)
            return st;
    }
}

/* ---- setting up ---- */

static status create_benches(conversion *c) {
    c->benches = mem_array(c->m, (size_t)c->o->threads, sizeof *c->benches);
    if (!c->benches)
        return ST_NOMEM;
    status st = leaf_writer_make_families(c->writer, c->o->threads);
    if (st != ST_OK)
        return st;
    const size_t payload_bytes = c->layout->coded ? leaf_layout_payload_max(c->layout) : 0;
    const size_t shell_bytes =
        c->layout->shells ? leaf_layout_shell_max(c->layout) * sample_size(c->layout->type) : 0;
    for (int i = 0; i < c->o->threads; i++) {
        bench *b = &c->benches[i];
        b->family = leaf_writer_take_family(c->writer);
        b->scratch = mem_alloc(c->m, grid_codes_scratch_bytes());
        if (!b->scratch)
            return ST_NOMEM;
        if (payload_bytes && !(b->payload = mem_alloc(c->m, payload_bytes)))
            return ST_NOMEM;
        if (shell_bytes && !(b->shell = mem_alloc(c->m, shell_bytes)))
            return ST_NOMEM;
        st = leaf_packer_create(c->m, c->layout, NULL, &c->o->file, &b->packer);
        if (st != ST_OK)
            return st;
    }
    return ST_OK;
}

static status create_stages(conversion *c, const char *output) {
    for (uint32_t level = 0; level < c->layout->levels; level++) {
        stage *s = &c->stages[level];
        slab_plan how = convert_plan_slab(c->plan, level, c->o->threads);
        status st = slab_create(c->m, c->layout, level, &how, output, &s->slab);
        if (st != ST_OK)
            return st;
        if (level + 1 == c->layout->levels)
            break;
        st = pyramid_create(c->m, c->layout->type, c->layout->level[level].dims, c->o->threads,
                            &s->up);
        if (st != ST_OK)
            return st;
        const uint32_t *coarse = c->layout->level[level + 1].dims;
        s->coarse = mem_alloc(c->m, (size_t)coarse[0] * coarse[1] * sample_size(c->layout->type) *
                                        convert_plan_slices(c->plan, level + 1));
        if (!s->coarse)
            return ST_NOMEM;
    }
    return ST_OK;
}

static status begin_deviations(conversion *c, const grid *g) {
    uint16_t *codes = leaf_writer_deviations(c->writer);
    status st = ST_OK;
    for (uint32_t level = 0; codes && level + 1 < c->layout->levels && st == ST_OK; level++)
        st = deviation_build_create(c->m, c->layout, level, c->set, g, c->o->threads, codes,
                                    &c->stages[level].deviation);
    return st;
}

static void end_deviations(const conversion *c, const grid *g) {
    uint16_t *codes = leaf_writer_deviations(c->writer);
    double range[2];
    leaf_writer_range(c->writer, c->set, range);
    if (codes)
        deviation_build_end(c->layout, c->set, grid_is_rectilinear(g), range, codes);
}

/* If the input tells which tiles have one value, keep such maps for all levels. */
static status begin_maps(conversion *c) {
    c->quiet = read_ahead_quiet(c->input);
    for (uint32_t level = 0; c->quiet && level + 1 < c->layout->levels; level++) {
        stage *s = &c->stages[level];
        const size_t bytes = slice_tiles_count(c->layout->level[level + 1].dims) *
                             convert_plan_slices(c->plan, level + 1);
        s->busy = mem_alloc(c->m, bytes);
        if (!s->busy)
            return ST_NOMEM;
        memset(s->busy, 1, bytes);
        const status st = pyramid_quiet(s->up, c->quiet);
        if (st != ST_OK)
            return st;
    }
    return ST_OK;
}

/* Refuse a volume without any finite sample, unless --allow-empty. Valid once all samples of all
 * sets are written: before that, ranges are not known. */
static status check_empty(const conversion *c, const grid *g) {
    bool empty = c->o->refuse_empty;
    for (uint32_t set = 0; set < c->layout->sets && empty; set++) {
        double range[2];
        leaf_writer_range(c->writer, set, range);
        empty = range[0] > range[1];
    }
    if (!empty)
        return ST_OK;
    return status_describe(ST_UNSUPPORTED,
                           "none of the volume's %llu samples is a finite number: there is nothing "
                           "to draw (--allow-empty converts it all the same)",
                           (unsigned long long)grid_samples(g) * c->layout->sets);
}

static status begin_histogram(conversion *c, const grid *g) {
    if (!leaf_writer_histograms(c->writer))
        return ST_OK;
    c->draw = histogram_draw_grid(g->dims);
    c->space = histogram_space_of(&g->to_world[0][0]);
    for (int a = 0; a < 3 && grid_is_rectilinear(g); a++)
        c->space.axis[a] = g->axis[a];
    c->cells = mem_array(c->m, c->draw.count, sizeof *c->cells);
    return c->cells ? ST_OK : ST_NOMEM;
}

static void end_histogram(conversion *c, const grid *g) {
    double range[2];
    if (!c->cells)
        return;
    leaf_writer_range(c->writer, c->set, range);
    histogram_build(leaf_writer_histograms(c->writer) + c->set, c->cells, c->draw.count,
                    c->layout->type, range, grid_samples(g));
    if (c->marker.share == 0.0)
        (void)histogram_find_marker(c->cells, c->draw.count, range, &c->marker);
}

/* Free what belongs to one set. */
static void release_set(conversion *c) {
    mem_free(c->m, c->cells);
    read_ahead_destroy(c->input);
    for (uint32_t level = 0; level < LEAF_LEVELS_MAX; level++) {
        slab_destroy(c->stages[level].slab);
        pyramid_destroy(c->stages[level].up);
        mem_free(c->m, c->stages[level].coarse);
        mem_free(c->m, c->stages[level].busy);
        deviation_build_destroy(c->stages[level].deviation);
    }
    memset(c->stages, 0, sizeof c->stages);
    c->cells = NULL;
    c->input = NULL;
}

/* Free all but the writer, which leaf_writer_finish() consumes. */
static void release(conversion *c) {
    release_set(c);
    for (int i = 0; c->benches && i < c->o->threads; i++) {
        mem_free(c->m, c->benches[i].scratch);
        mem_free(c->m, c->benches[i].payload);
        mem_free(c->m, c->benches[i].shell);
        leaf_packer_destroy(c->m, c->benches[i].packer);
    }
    mem_free(c->m, c->benches);
    pool_destroy(c->workers);
}

static void describe_origin(const convert_options *o, sample_type source, char *text, size_t size) {
    char codec[32] = "raw";
    if (o->file.codec == LEAF_CODEC_ZSTD)
        snprintf(codec, sizeof codec, "zstd:%d", o->file.zstd_level);
    snprintf(text, size, "leafcast %s convert, from %s: treelets of %d^3 cells, halo %u, %s",
             LEAFCAST_VERSION, sample_name(source), 1 << o->file.cells_log2, o->file.halo, codec);
}

static void take_facts(conversion *c, const grid *g) {
    const read_ahead_facts now = read_ahead_seen(c->input);
    c->seen.non_finite += now.non_finite;
    c->seen.rounding_error = fmax(c->seen.rounding_error, now.rounding_error);
    c->seen.trailing_bytes += now.trailing_bytes;
    absent_add(&c->absent, &g->absent);
}

/* Convert all of v into set c->set, or what an earlier run left of it. */
static status convert_set(conversion *c, volume *v, const char *output) {
    const grid *g = volume_grid(v);
    c->slices_done = c->resumes ? c->slices_done : 0;
    c->slabs = leaf_slabs_begin(c->layout);
    (void)pass_slabs(c);
    status st = create_stages(c, output);
    if (st == ST_OK)
        st = begin_histogram(c, g);
    if (st == ST_OK)
        st = begin_deviations(c, g);
    if (st == ST_OK)
        st = read_ahead_create(c->m, v, c->plan->batch, c->resumes ? &c->past : NULL,
                               c->slices_done, &c->input);
    if (st == ST_OK)
        st = begin_maps(c);
    if (st == ST_OK && c->resumes)
        st = work_folder_load(c->o->work, keep, c);
    c->resumes = false;
    if (st == ST_OK)
        st = convert_slices(c);
    if (st == ST_OK) {
        end_histogram(c, g);
        end_deviations(c, g);
        take_facts(c, g);
    }
    release_set(c);
    return st;
}

/* Open the volume of c->set in the place of another. */
static status open_volume(const conversion *c, volume *first, volume **v) {
    volume_rest(first);
    if (*v != first)
        volume_close(*v);
    *v = NULL;
    return grid_series_open(c->m, c->o->series, c->set, v);
}

/* Get the volume of c->set: by reading on in the previous one, or by opening another. */
static status next_volume(const conversion *c, volume *first, volume **v) {
    const step_series *series = &c->o->series->of;
    if (step_series_follows(series, c->set % series->sets.steps) && volume_next_step(*v))
        return ST_OK;
    return open_volume(c, first, v);
}

/* first: volume of the first set. The others are opened here, one at a time. */
static status convert_sets(conversion *c, volume *first, const char *output) {
    volume *v = first;
    status st = c->set > 0 ? open_volume(c, first, &v) : ST_OK;
    if (st == ST_OK)
        st = convert_set(c, v, output);
    for (c->set++; c->set < c->layout->sets && st == ST_OK; c->set++) {
        st = next_volume(c, first, &v);
        if (st == ST_OK)
            st = convert_set(c, v, output);
    }
    volume_rest(first);
    if (v != first)
        volume_close(v);
    return st;
}

/* Find out where an earlier run ended. */
static status resume(conversion *c) {
    if (!c->o->work || !work_folder_resumes(c->o->work))
        return ST_OK;
    c->resumes = true;
    status st = work_folder_load(c->o->work, keep_head, c);
    if (st == ST_OK && (c->set >= c->layout->sets || c->slices_done > c->layout->level[0].dims[2]))
        st = status_describe(ST_CORRUPT, "the unfinished work is not of this input");
    return st;
}

status convert_run(mem *m, volume *v, const char *output, const convert_options *o,
                   const convert_plan *plan, const progress *p, convert_result *result) {
    conversion c = {.m = m, .o = o, .plan = plan, .p = p};
    const grid *g = volume_grid(v);
    const leaf_sets *sets = o->series ? &o->series->of.sets : NULL;
    const leaf_target to = {output, o->force, o->work};
    status st = leaf_writer_create(m, &to, g, sets, &o->file, &c.writer);
    if (st != ST_OK)
        return st;
    c.layout = leaf_writer_layout(c.writer);
    st = resume(&c);
    if (st == ST_OK)
        st = pool_create(m, o->threads, &c.workers);
    if (st == ST_OK)
        st = create_benches(&c);
    if (st == ST_OK)
        st = convert_sets(&c, v, output);
    if (st == ST_OK)
        st = check_empty(&c, g);
    release(&c);
    if (st != ST_OK) {
        leaf_writer_discard(c.writer);
        return st;
    }
    char provenance[256];
    describe_origin(o, grid_source(g), provenance, sizeof provenance);
    leaf_facts facts = {.non_finite = c.seen.non_finite,
                        .rounding_error = c.seen.rounding_error,
                        .provenance = provenance};
    result->trailing_bytes = c.seen.trailing_bytes;
    result->absent = c.absent;
    result->marker = c.marker;
    return leaf_writer_finish(c.writer, &facts, &result->header);
}
