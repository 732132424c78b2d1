#include "prep/mesh/mesh_convert.h"

#include <assert.h>
#include <stdio.h>
#include <string.h>

#include "formats/base/clock.h"
#include "formats/base/file.h"
#include "formats/base/pool.h"
#include "prep/mesh/mesh_coarse.h"
#include "prep/mesh/mesh_cut.h"
#include "prep/mesh/mesh_histogram.h"
#include "prep/mesh/mesh_keys.h"
#include "prep/mesh/mesh_sah.h"
#include "prep/mesh/mesh_treelet.h"

#ifndef LEAFCAST_VERSION
#define LEAFCAST_VERSION "0"
#endif

enum { BATCH_PER_THREAD = 32 }; /* treelets per thread between two progress reports */

/* Ends of the stages, as shares of the whole job. */
static const double READ_END = 0.25, KEYS_END = 0.4, SORT_END = 0.5, GRADIENTS_END = 0.6;

/* Buffers and counts of one thread. */
typedef struct bench {
    mesh_treelet_builder *builder;
    mesh_sah *sah; /* NULL: trees by keys */
    mesh_pages points, values, gradients;
    leaf_packer *packer;
    void *pack;
    uint64_t flat, positive, negative;
} bench;

/* Treelets that are built at once. Treelet i of the batch has the records [first[i], first[i +
 * 1]). */
typedef struct batch {
    const mesh_record *records;
    size_t *first;
    size_t count, most;
    uint32_t treelet; /* index of the batch's first treelet */
    uint64_t tet;     /* number of the batch's first tet */
} batch;

typedef struct conversion {
    mem *m;
    const char *name; /* of the data set */
    const mesh_options *o;
    const progress *p;
    mesh_gather *g;
    mesh_plan plan;
    pool *workers;
    mesh_runs *runs;
    uint64_t tets; /* kept */
    mesh_spool gradients;
    mesh_gradients *summing;
    double band, band_end; /* share of all gradients: begin and end of the current part */
    leaf_writer *writer;
    bench *benches;
    batch batch;
    uint32_t first_step, end_step; /* range of steps being built */
    mesh_histogram histogram;
} conversion;

mesh_options mesh_options_default(void) {
    return (mesh_options){.file = leaf_parameters_default(),
                          .treelet_tets = MESH_TREELET_TETS,
                          .leaf_tets = MESH_LEAF_TETS,
                          .memory = (uint64_t)1 << 62,
                          .threads = 1};
}

/* ---- sorting ---- */

static status spill(conversion *c) {
    status st = c->plan.spill_tets ? mesh_spool_spill(&c->g->tets) : ST_OK;
    if (st == ST_OK && c->plan.spill_points)
        st = mesh_spool_spill(&c->g->points);
    if (st == ST_OK && c->plan.spill_points)
        st = mesh_spool_spill(&c->g->values);
    return st;
}

static status sort_tets(conversion *c, const char *output, leaf_facts *facts) {
    mesh_keys_report seen;
    status st = mesh_runs_create(c->m, c->workers, output, &c->plan.runs, &c->runs);
    if (st == ST_OK)
        st = mesh_keys_make(c->m, c->workers, c->g, c->plan.keys_window, c->runs, READ_END,
                            KEYS_END, &seen);
    mesh_spool_release(&c->g->tets);
    if (st == ST_OK)
        st = mesh_runs_end(c->runs);
    if (st != ST_OK)
        return st;
    c->tets = seen.tets;
    facts->vertices = seen.vertices;
    facts->non_finite = seen.non_finite;
    facts->repeated += seen.repeated;
    facts->bad += seen.bad;
    if (seen.tets + facts->bad + facts->repeated == 0)
        return status_describe(ST_UNSUPPORTED,
                               "%s: no tets; a surface of triangles is filled with them: `meshio "
                               "convert IN surface.ply' (python3-meshio), then `leafcast "
                               "tetrahedralize surface.ply -o F.mesh', and convert F.mesh",
                               *c->name ? c->name : "the mesh");
    if (seen.tets == 0)
        return status_describe(ST_CORRUPT,
                               "%s: %llu tets with an id that is no point, %llu with a vertex "
                               "twice, and no tet besides",
                               *c->name ? c->name : "the mesh", (unsigned long long)facts->bad,
                               (unsigned long long)facts->repeated);
    return progress_step(c->p, "sort", SORT_END);
}

/* ---- cutting ---- */

/* Call take() for one batch of treelets after the other, in order. */
static status for_each_batch(conversion *c, status (*take)(conversion *c)) {
    batch *b = &c->batch;
    uint64_t before = 0, done = 0;
    size_t used = 0;
    b->treelet = 0;
    for (bool last = false; done < c->tets;) {
        size_t count;
        status st = mesh_runs_window(c->runs, used, &b->records, &count, &last);
        b->count = 0;
        b->tet = done;
        for (used = 0; b->count < b->most && used < count;) {
            if (!last && count - used <= c->o->treelet_tets)
                break;
            const uint64_t *key = done > 0 ? &before : NULL;
            b->first[b->count++] = used;
            used += mesh_cut_next(b->records + used, count - used, key, c->o->treelet_tets);
            done += used - b->first[b->count - 1];
            before = b->records[used - 1].key;
        }
        b->first[b->count] = used;
        if (st == ST_OK)
            st = take(c);
        if (st != ST_OK)
            return st;
        b->treelet += (uint32_t)b->count;
    }
    return ST_OK;
}

static status count_batch(conversion *c) {
    return c->batch.treelet > UINT32_MAX / 4
               ? status_describe(ST_UNSUPPORTED, "too many treelets; make them larger")
               : ST_OK;
}

/* ---- gradients ---- */

static status sum_batch(conversion *c) {
    const batch *b = &c->batch;
    const mesh_record *first = b->records + b->first[0];
    status st = mesh_gradients_add(c->summing, first, b->first[b->count] - b->first[0]);
    const double part = (b->treelet + (double)b->count) / (double)c->plan.treelets;
    const double done = c->band + (c->band_end - c->band) * part;
    return st == ST_OK
               ? progress_step(c->p, "gradients", SORT_END + (GRADIENTS_END - SORT_END) * done)
               : st;
}

static status sum_gradients(conversion *c, uint32_t step, uint32_t field) {
    const mesh_gather *g = c->g;
    const uint64_t bands = mesh_gradients_bands(c->summing);
    const uint64_t before = ((uint64_t)step * g->fields + field) * bands;
    status st = ST_OK;
    for (uint64_t band = 0; st == ST_OK && band < bands; band++) {
        c->band = (double)(before + band) / (double)(bands * g->fields * g->steps);
        c->band_end = (double)(before + band + 1) / (double)(bands * g->fields * g->steps);
        mesh_gradients_begin(c->summing, band, mesh_gather_points(g, step),
                             mesh_gather_values(g, step, field));
        st = mesh_runs_rewind(c->runs);
        if (st == ST_OK)
            st = for_each_batch(c, sum_batch);
        if (st == ST_OK)
            st = mesh_gradients_end(c->summing, &c->gradients);
    }
    return st;
}

/* Compute the gradients of all vertices in all sets, in the order of the values, into
 * c->gradients. */
static status make_gradients(conversion *c, const char *output) {
    mesh_gather *g = c->g;
    mesh_spool_init(&c->gradients, c->m, output, sizeof(float[3]), 0);
    status st = c->plan.spill_gradients ? mesh_spool_spill(&c->gradients) : ST_OK;
    if (st == ST_OK)
        st = mesh_gradients_create(c->m, c->workers, &g->points, &g->values, g->vertices,
                                   &c->plan.gradients, &c->summing);
    for (uint32_t step = 0; step < g->steps; step++)
        for (uint32_t field = 0; st == ST_OK && field < g->fields; field++)
            st = sum_gradients(c, step, field);
    mesh_gradients_destroy(c->summing);
    c->summing = NULL;
    return st;
}

/* ---- building ---- */

/* The input of one treelet. */
typedef struct piece {
    uint32_t treelet;
    uint64_t first_tet;
    const mesh_record *records;
    size_t count;
} piece;

/* k->values must be those of the set. */
static status take_histogram(const conversion *c, bench *k, const piece *p, uint32_t step,
                             uint32_t set) {
    k->points.first = mesh_gather_points(c->g, step);
    return mesh_histogram_take(&c->histogram, set, p->first_tet, p->records, p->count, &k->points,
                               &k->values);
}

/* Build the topology, and the first field at the first step. */
static status build_first(const conversion *c, bench *k, const piece *p, mesh_treelet *t) {
    const uint32_t treelet = p->treelet;
    k->points.first = k->values.first = 0;
    status st = mesh_treelet_build(k->builder, p->records, p->count, &k->points, &k->values, t);
    if (st != ST_OK)
        return st;
    k->flat += t->flat;
    k->positive += t->positive;
    k->negative += t->negative;
    st = leaf_writer_put_topology(c->writer, k->packer, treelet, t->bounds, t->counts, t->topology,
                                  k->pack);
    if (st == ST_OK)
        st =
            leaf_writer_put_values(c->writer, k->packer, 0, treelet, &t->entry, t->values, k->pack);
    return st == ST_OK ? take_histogram(c, k, p, 0, 0) : st;
}

static status build_values(const conversion *c, bench *k, const piece *p, uint32_t step,
                           uint32_t field, mesh_treelet *t) {
    k->values.first = mesh_gather_values(c->g, step, field);
    status st = mesh_treelet_revalue(k->builder, &k->values, t);
    if (st != ST_OK)
        return st;
    const uint32_t set = leaf_layout_set(leaf_writer_layout(c->writer), field, step);
    st = leaf_writer_put_values(c->writer, k->packer, set, p->treelet, &t->entry, t->values,
                                k->pack);
    return st == ST_OK ? take_histogram(c, k, p, step, set) : st;
}

static status build_positions(const conversion *c, bench *k, uint32_t treelet, uint32_t step,
                              mesh_treelet *t) {
    k->points.first = mesh_gather_points(c->g, step);
    status st = mesh_treelet_move(k->builder, &k->points, t);
    return st == ST_OK ? leaf_writer_put_positions(c->writer, k->packer, step, treelet,
                                                   t->moved_bounds, t->positions, k->pack)
                       : st;
}

/* Store the gradients of all sets. Do this last: it overwrites the topology. */
static status put_gradients(const conversion *c, bench *k, uint32_t treelet,
                            const mesh_treelet *t) {
    status st = ST_OK;
    for (uint32_t step = c->first_step; step < c->end_step; step++) {
        for (uint32_t field = 0; st == ST_OK && field < c->g->fields; field++) {
            const uint32_t set = leaf_layout_set(leaf_writer_layout(c->writer), field, step);
            const void *payload = NULL;
            k->gradients.first = mesh_gather_values(c->g, step, field);
            st = mesh_treelet_gradients(k->builder, t, &k->gradients, &payload);
            if (st == ST_OK)
                st =
                    leaf_writer_put_gradients(c->writer, k->packer, set, treelet, payload, k->pack);
        }
    }
    return st;
}

static status build_one(void *ctx, size_t index, int worker) {
    const conversion *c = ctx;
    bench *k = &c->benches[worker];
    const batch *b = &c->batch;
    const mesh_record *records = b->records + b->first[index];
    const size_t count = b->first[index + 1] - b->first[index];
    const uint32_t treelet = b->treelet + (uint32_t)index;
    piece p = {
        .treelet = treelet, .first_tet = b->tet + (b->first[index] - b->first[0]), .count = count};
    mesh_treelet t;
    status st = ST_OK;
    k->points.first = 0;
    if (k->sah)
        st = mesh_sah_order(k->sah, records, count, &k->points, &records);
    if (st != ST_OK)
        return st;
    p.records = records;
    if (c->first_step == 0)
        st = build_first(c, k, &p, &t);
    else
        mesh_treelet_begin(k->builder, records, count, &t);
    for (uint32_t step = c->first_step; step < c->end_step; step++) {
        for (uint32_t field = step ? 0 : 1; st == ST_OK && field < c->g->fields; field++)
            st = build_values(c, k, &p, step, field, &t);
        if (st == ST_OK && step > 0 && c->g->moving)
            st = build_positions(c, k, treelet, step, &t);
    }
    return st == ST_OK && c->o->gradients ? put_gradients(c, k, treelet, &t) : st;
}

static status build_batch(conversion *c) {
    status st = pool_run(c->workers, c->batch.count, build_one, c);
    const double part = (double)(c->batch.treelet + c->batch.count) / (double)c->plan.treelets;
    const double done =
        (c->first_step + part * (c->end_step - c->first_step)) / (double)c->g->steps;
    const double from = c->o->gradients ? GRADIENTS_END : SORT_END;
    return st == ST_OK ? progress_step(c->p, "build", from + (1 - from) * done) : st;
}

/* Build all steps in one pass if points and values are in memory: there the values of a vertex at
 * all steps lie side by side. In scratch files each step lies elsewhere, and the page caches
 * (mesh_pages.h) would be loaded again and again: then build one step a pass. */
static status build_steps(conversion *c) {
    const bool held = mesh_spool_held(&c->g->points) && mesh_spool_held(&c->g->values);
    status st = ST_OK;
    for (c->first_step = 0; st == ST_OK && c->first_step < c->g->steps;
         c->first_step = c->end_step) {
        c->end_step = held ? c->g->steps : c->first_step + 1;
        st = mesh_runs_rewind(c->runs);
        if (st == ST_OK)
            st = for_each_batch(c, build_batch);
    }
    return st;
}

static status create_benches(conversion *c) {
    c->benches = mem_array(c->m, (size_t)c->o->threads, sizeof *c->benches);
    if (!c->benches)
        return ST_NOMEM;
    const mesh_options *o = c->o;
    uint32_t counts[4];
    mesh_treelet_counts_max(o->treelet_tets, o->leaf_tets, counts);
    for (int i = 0; i < o->threads; i++) {
        bench *k = &c->benches[i];
        status st = mesh_treelet_create(c->m, o->treelet_tets, o->leaf_tets, &k->builder);
        if (st == ST_OK && o->sah)
            st = mesh_sah_create(c->m, o->treelet_tets, o->leaf_tets, &k->sah);
        if (st == ST_OK)
            st = mesh_pages_init(&k->points, &c->g->points, c->plan.points_window);
        if (st == ST_OK)
            st = mesh_pages_init(&k->values, &c->g->values, c->plan.values_window);
        if (st == ST_OK && o->gradients)
            st = mesh_pages_init(&k->gradients, &c->gradients, c->plan.gradients_window);
        if (st == ST_OK)
            st = leaf_packer_create(c->m, leaf_writer_layout(c->writer), counts, &c->o->file,
                                    &k->packer);
        if (st == ST_OK && k->packer) {
            k->pack = mem_alloc(c->m, mesh_treelet_payload_max(o->treelet_tets, o->leaf_tets));
            st = k->pack ? ST_OK : ST_NOMEM;
        }
        if (st != ST_OK)
            return st;
    }
    return ST_OK;
}

static void release_benches(conversion *c, leaf_facts *facts) {
    uint64_t positive = 0, negative = 0;
    for (int i = 0; c->benches && i < c->o->threads; i++) {
        bench *k = &c->benches[i];
        facts->flat += k->flat;
        positive += k->positive;
        negative += k->negative;
        mesh_treelet_destroy(k->builder);
        mesh_sah_destroy(k->sah);
        mesh_pages_release(&k->points);
        mesh_pages_release(&k->values);
        mesh_pages_release(&k->gradients);
        if (k->packer)
            leaf_packer_destroy(c->m, k->packer);
        mem_free(c->m, k->pack);
    }
    mem_free(c->m, c->benches);
    c->benches = NULL;
    /* Formats disagree about orientation. The majority of the tets decides. */
    facts->inverted = positive < negative ? positive : negative;
}

static status build_treelets(conversion *c, const char *field, const char *output) {
    c->batch.most = (size_t)c->o->threads * BATCH_PER_THREAD;
    c->batch.first = mem_array(c->m, c->batch.most + 1, sizeof *c->batch.first);
    if (!c->batch.first)
        return ST_NOMEM;
    status st = for_each_batch(c, count_batch);
    const uint32_t treelets = c->batch.treelet;
    if (st == ST_OK)
        st = mesh_plan_check(c->o, c->g, &c->plan, treelets);
    if (st != ST_OK)
        return st;
    c->plan.treelets = treelets;
    const mesh_series *series = c->o->series;
    const leaf_target to = {output, c->o->force, NULL};
    const leaf_mesh parts = {
        .name = c->name,
        .field = series && series->of.sets.names ? series->of.sets.names[0] : field,
        .names = series && series->of.sets.names ? series->of.sets.names : &field,
        .times = series ? series->of.sets.times : NULL,
        .treelets = treelets,
        .treelet_tets = c->o->treelet_tets,
        .leaf_tets = c->o->leaf_tets,
        .fields = c->g->fields,
        .steps = c->g->steps,
        .gradients = c->o->gradients,
        .moving = c->g->moving,
        .coarse = c->o->coarse};
    if (c->o->gradients)
        st = make_gradients(c, output);
    if (st == ST_OK)
        st = leaf_writer_create_mesh(c->m, &to, &parts, &c->o->file, &c->writer);
    if (st == ST_OK)
        st = create_benches(c);
    if (st == ST_OK && leaf_writer_histograms(c->writer))
        st = mesh_histogram_begin(&c->histogram, c->m, c->tets, c->g->fields * c->g->steps);
    if (st == ST_OK)
        st = build_steps(c);
    if (st == ST_OK)
        mesh_histogram_end(&c->histogram, c->writer);
    return st;
}

/* Call it when all values have been put. A mesh without an array was given zeros. */
static status check_empty(const conversion *c, const mesh_report *r) {
    const uint32_t sets = c->g->fields * c->g->steps;
    bool numbers = false, zeros = true;
    for (uint32_t set = 0; set < sets; set++) {
        double range[2];
        leaf_writer_range(c->writer, set, range);
        numbers = numbers || range[0] <= range[1];
        zeros = zeros && range[0] == 0 && range[1] == 0;
    }
    if (!c->o->refuse_empty || (numbers && (*r->field || !zeros)))
        return ST_OK;
    return status_describe(ST_UNSUPPORTED,
                           "%s: there is nothing to draw (--allow-empty converts it all the same)",
                           numbers ? "the mesh has no array of values"
                                   : "none of the mesh's values is a finite number");
}

/* ---- all of it ---- */

static void describe_origin(const mesh_options *o, const mesh_report *r, char *text, size_t size) {
    char steps[32] = "a mesh";
    if (o->series && o->series->of.sets.steps > 1)
        snprintf(steps, sizeof steps, "a mesh at %u steps", o->series->of.sets.steps);
    char codec[32] = "raw";
    if (o->file.codec == LEAF_CODEC_ZSTD)
        snprintf(codec, sizeof codec, "zstd:%d", o->file.zstd_level);
    uint64_t split = 0;
    for (int i = 0; i < MESH_SPLIT_KINDS; i++)
        split += r->split[i];
    char cells[64] = "";
    if (split)
        snprintf(cells, sizeof cells, ", %llu cells split", (unsigned long long)split);
    snprintf(text, size,
             "leafcast %s convert, from %s: Morton treelets of %u tets, leaves of %u%s%s%s, %s",
             LEAFCAST_VERSION, steps, o->treelet_tets, o->leaf_tets, o->sah ? " by areas" : "",
             cells, o->gradients ? ", gradients" : "", codec);
}

/* Free all but the writer, which leaf_writer_finish() consumes. */
static void release(conversion *c, leaf_facts *facts) {
    release_benches(c, facts);
    mesh_runs_destroy(c->runs);
    mesh_histogram_release(&c->histogram);
    mesh_spool_release(&c->gradients);
    mem_free(c->m, c->batch.first);
    pool_destroy(c->workers);
    mesh_gather_release(c->g);
}

static status embed_coarse(mem *m, leaf_writer *w, const char *output, const leaf_facts *facts,
                           const mesh_options *o, const progress *p) {
    if (!o->coarse)
        return ST_OK;
    const mesh_coarse coarse = {
        .dims = o->coarse_dims, .file = o->file, .memory = o->memory, .threads = o->threads};
    status st = leaf_writer_settle(w, facts);
    return st == ST_OK ? mesh_coarse_embed(m, w, output, &coarse, p) : st;
}

status mesh_convert_gathered(mem *m, mesh_gather *g, const char *name, const char *output,
                             const mesh_options *o, const progress *p, mesh_result *result) {
    assert(o->series || g->fields * g->steps == 1);
    conversion c = {.m = m, .name = name, .o = o, .p = p, .g = g};
    const mesh_report *r = &result->report;
    leaf_facts facts = {.repeated = r->repeated, .bad = r->bad_indices};
    double start = clock_seconds();
    status st = mesh_plan_make(m, g, o, &c.plan);
    if (st == ST_OK)
        st = spill(&c);
    if (st == ST_OK)
        st = pool_create(m, o->threads, &c.workers);
    if (st == ST_OK)
        st = sort_tets(&c, output, &facts);
    result->sort_s = clock_seconds() - start;
    start = clock_seconds();
    if (st == ST_OK)
        st = build_treelets(&c, r->field, output);
    if (st == ST_OK)
        st = check_empty(&c, r);
    release(&c, &facts);
    result->plan = c.plan;
    if (st != ST_OK) {
        leaf_writer_discard(c.writer);
        return st;
    }
    char provenance[256];
    describe_origin(o, r, provenance, sizeof provenance);
    facts.provenance = provenance;
    st = embed_coarse(m, c.writer, output, &facts, o, p);
    if (st != ST_OK) {
        leaf_writer_discard(c.writer);
        return st;
    }
    st = leaf_writer_finish(c.writer, &facts, &result->header);
    result->build_s = clock_seconds() - start;
    return st;
}

static status read_all(mem *m, mesh_input *x, const mesh_options *o, mesh_gather *g, bool count,
                       mesh_report *report) {
    if (o->series)
        g->steps = o->series->of.sets.steps;
    const mesh_sink sink = count ? mesh_gather_counter(g) : mesh_gather_sink(g);
    return o->series ? mesh_series_read(m, o->series, x, g, &sink, report)
                     : mesh_gather_read(g, x, &sink, report);
}

/* Read everything, keep nothing, and plan. */
static status plan_counted(mem *m, mesh_input *x, const mesh_options *o, const progress *p,
                           mesh_result *result) {
    mesh_gather g;
    mesh_gather_init(&g, m, "", 0, p);
    status st = read_all(m, x, o, &g, true, &result->report);
    return st == ST_OK ? mesh_plan_make(m, &g, o, &result->plan) : st;
}

/* Refuse a budget that is too small for any mesh: the mesh could not even be read into memory.
 * First count what this mesh needs, for the message. */
static status check_budget(mem *m, mesh_input *x, const mesh_options *o, const progress *p,
                           mesh_result *result) {
    uint64_t least = 0;
    status st = mesh_plan_least(m, o, &least);
    if (st != ST_OK || least <= o->memory)
        return st;
    st = plan_counted(m, x, o, p, result);
    return st == ST_OK ? mesh_plan_refuse(o, least) : st;
}

status mesh_convert_run(mem *m, mesh_input *x, const char *output, const mesh_options *o,
                        const progress *p, mesh_result *result) {
    mesh_gather g = {0};
    *result = (mesh_result){0};
    const double start = clock_seconds();
    status st = out_file_check(m, output, o->force);
    if (st == ST_OK)
        st = check_budget(m, x, o, p, result);
    if (st != ST_OK)
        return st;
    mesh_gather_init(&g, m, output, (size_t)(o->memory / 2), p);
    g.share = READ_END;
    st = read_all(m, x, o, &g, false, &result->report);
    if (st != ST_OK) {
        mesh_gather_release(&g);
        return st;
    }
    result->read_s = clock_seconds() - start;
    return mesh_convert_gathered(m, &g, mesh_input_name(x), output, o, p, result);
}

status mesh_convert_dry(mem *m, mesh_input *x, const mesh_options *o, const progress *p,
                        mesh_result *result) {
    *result = (mesh_result){0};
    return plan_counted(m, x, o, p, result);
}
