#include "prep/grid/convert.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "formats/base/colour_field.h"
#include "formats/leaf/leaf_histogram.h"
#include "prep/grid/grid_levels.h"

#ifndef LEAFCAST_VERSION
#define LEAFCAST_VERSION "0"
#endif

/* ---- setting up ---- */

static status create_benches(grid_conversion *c) {
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
        grid_bench *b = &c->benches[i];
        b->family = leaf_writer_take_family(c->writer);
        b->scratch = mem_alloc(c->m, grid_codes_scratch_bytes(leaf_node_levels(c->layout)));
        if (!b->scratch)
            return ST_NOMEM;
        if (payload_bytes && !(b->payload = mem_alloc(c->m, payload_bytes)))
            return ST_NOMEM;
        if (shell_bytes && !(b->shell = mem_alloc(c->m, shell_bytes)))
            return ST_NOMEM;
        st = leaf_packer_create(c->m, c->layout, NULL, NULL, &c->o->file, &b->packer);
        if (st != ST_OK)
            return st;
    }
    return ST_OK;
}

/* Whether the samples of c->set are an image's colours (formats/HEIGHTS.md). */
static bool are_colours(const grid_conversion *c, const grid *g) {
    const leaf_sets *sets = c->o->series ? &c->o->series->of.sets : NULL;
    return g->heights && c->layout->type == SAMPLE_F32 && sets && sets->names &&
           strcmp(sets->names[c->set / sets->steps], COLOUR_FIELD) == 0;
}

static status create_stages(grid_conversion *c, const grid *g, const char *output) {
    for (uint32_t level = 0; level < c->layout->sampled; level++) {
        grid_stage *s = &c->stages[level];
        slab_plan how = convert_plan_slab(c->plan, level, c->o->threads);
        status st = slab_create(c->m, c->layout, level, &how, output, &s->slab);
        if (st != ST_OK)
            return st;
        if (level + 1 == c->layout->sampled)
            break;
        st = pyramid_create(c->m, c->layout->type, are_colours(c, g), c->layout->level[level].dims,
                            c->o->threads, &s->up);
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

static status begin_deviations(grid_conversion *c, const grid *g) {
    uint16_t *codes = leaf_writer_deviations(c->writer);
    status st = ST_OK;
    for (uint32_t level = 0; codes && level + 1 < c->layout->levels && st == ST_OK; level++)
        st = deviation_build_create(c->m, c->layout, level, c->set, g, c->o->threads, codes,
                                    &c->stages[level].deviation);
    return st;
}

static void end_deviations(const grid_conversion *c, const grid *g) {
    uint16_t *codes = leaf_writer_deviations(c->writer);
    double range[2];
    leaf_writer_range(c->writer, c->set, range);
    if (codes)
        deviation_build_end(c->layout, c->set, grid_is_rectilinear(g), range, codes);
}

/* Keep maps of the tiles that have one value for all levels. */
static status begin_maps(grid_conversion *c) {
    c->quiet = read_ahead_quiet(c->input);
    for (uint32_t level = 0; level < c->layout->sampled; level++)
        slab_quiet(c->stages[level].slab, c->quiet);
    for (uint32_t level = 0; level + 1 < c->layout->sampled; level++) {
        grid_stage *s = &c->stages[level];
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
static status check_empty(const grid_conversion *c, const grid *g) {
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

static status begin_histogram(grid_conversion *c, const grid *g) {
    if (!leaf_writer_histograms(c->writer))
        return ST_OK;
    c->draw = histogram_draw_grid(g->dims);
    c->space = histogram_space_of(&g->to_world[0][0]);
    for (int a = 0; a < 3 && grid_is_rectilinear(g); a++)
        c->space.axis[a] = g->axis[a];
    c->cells = mem_array(c->m, c->draw.count, sizeof *c->cells);
    return c->cells ? ST_OK : ST_NOMEM;
}

static void end_histogram(grid_conversion *c, const grid *g) {
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
static void release_set(grid_conversion *c) {
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
static void release(grid_conversion *c) {
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

static void describe_origin(const grid_conversion *c, sample_type source, char *text, size_t size) {
    const convert_options *o = c->o;
    const bool bare = c->layout->sampled < c->layout->levels;
    char codec[32] = "raw";
    if (o->file.codec == LEAF_CODEC_ZSTD)
        snprintf(codec, sizeof codec, "zstd:%d", o->file.zstd_level);
    snprintf(text, size, "leafcast %s convert, from %s: treelets of %d^3 cells, halo %u, %s%s%s",
             LEAFCAST_VERSION, sample_name(source), 1 << o->file.cells_log2, o->file.halo, codec,
             bare ? ", level 0 alone" : "", o->file.outside ? ", in place" : "");
}

static void take_facts(grid_conversion *c, const grid *g) {
    const read_ahead_facts now = read_ahead_seen(c->input);
    c->seen.non_finite += now.non_finite;
    c->seen.rounding_error = fmax(c->seen.rounding_error, now.rounding_error);
    c->seen.trailing_bytes += now.trailing_bytes;
    absent_add(&c->absent, &g->absent);
}

/* Convert all of v into set c->set, or what an earlier run left of it. */
static status convert_set(grid_conversion *c, volume *v, const char *output) {
    const grid *g = volume_grid(v);
    c->slices_done = c->resumes ? c->slices_done : 0;
    c->slabs = leaf_slabs_begin(c->layout);
    (void)grid_levels_pass(c);
    status st = create_stages(c, g, output);
    if (st == ST_OK)
        st = begin_histogram(c, g);
    if (st == ST_OK)
        st = begin_deviations(c, g);
    if (st == ST_OK) {
        const slice_ring ring = slab_ring(c->stages[0].slab);
        st = read_ahead_create(c->m, v, &ring, c->resumes ? &c->past : NULL, c->slices_done,
                               &c->input);
    }
    if (st == ST_OK)
        st = begin_maps(c);
    if (st == ST_OK && c->resumes)
        st = work_folder_load(c->o->work, grid_conversion_keep, c);
    c->resumes = false;
    if (st == ST_OK)
        st = grid_levels_run(c);
    if (st == ST_OK) {
        end_histogram(c, g);
        end_deviations(c, g);
        take_facts(c, g);
    }
    release_set(c);
    return st;
}

/* Open the volume of c->set in the place of another. */
static status open_volume(const grid_conversion *c, volume *first, volume **v) {
    volume_rest(first);
    if (*v != first)
        volume_close(*v);
    *v = NULL;
    return grid_series_open(c->m, c->o->series, c->set, v);
}

/* Get the volume of c->set: by reading on in the previous one, or by opening another. */
static status next_volume(const grid_conversion *c, volume *first, volume **v) {
    const step_series *series = &c->o->series->of;
    if (step_series_follows(series, c->set % series->sets.steps) && volume_next_step(*v))
        return ST_OK;
    return open_volume(c, first, v);
}

/* first: volume of the first set. The others are opened here, one at a time. */
static status convert_sets(grid_conversion *c, volume *first, const char *output) {
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
static status resume(grid_conversion *c) {
    if (!c->o->work || !work_folder_resumes(c->o->work))
        return ST_OK;
    c->resumes = true;
    status st = work_folder_load(c->o->work, grid_conversion_keep_head, c);
    if (st == ST_OK && (c->set >= c->layout->sets || c->slices_done > c->layout->level[0].dims[2]))
        st = status_describe(ST_CORRUPT, "the unfinished work is not of this input");
    return st;
}

status convert_run(mem *m, volume *v, const char *output, const convert_options *o,
                   const convert_plan *plan, const progress *p, convert_result *result) {
    grid_conversion c = {.m = m, .o = o, .plan = plan, .p = p};
    const grid *g = volume_grid(v);
    const leaf_sets *sets = o->series ? &o->series->of.sets : NULL;
    const leaf_target to = {.path = output,
                            .force = o->force || o->grow,
                            .work = o->work,
                            .grows = o->grows && !o->grow,
                            .grow = o->grow};
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
    describe_origin(&c, grid_source(g), provenance, sizeof provenance);
    leaf_facts facts = {.non_finite = c.seen.non_finite,
                        .rounding_error = c.seen.rounding_error,
                        .provenance = provenance};
    result->trailing_bytes = c.seen.trailing_bytes;
    result->absent = c.absent;
    result->marker = c.marker;
    return leaf_writer_finish(c.writer, &facts, &result->header);
}
