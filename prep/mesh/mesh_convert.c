#include "prep/mesh/mesh_convert.h"

#include <assert.h>
#include <stdio.h>
#include <string.h>

#include "formats/base/clock.h"
#include "formats/base/file.h"
#include "formats/base/pool.h"
#include "prep/mesh/mesh_batches.h"
#include "prep/mesh/mesh_build.h"
#include "prep/mesh/mesh_coarse.h"
#include "prep/mesh/mesh_keys.h"

#ifndef LEAFCAST_VERSION
#define LEAFCAST_VERSION "0"
#endif

enum { BATCH_PER_THREAD = 32 }; /* treelets per thread between two progress reports */

/* Ends of the stages, as shares of the whole job. */
static const double READ_END = 0.25, KEYS_END = 0.4, SORT_END = 0.5, GRADIENTS_END = 0.6;

/* What is being done. Work can be saved within each. */
typedef enum stage { READING, SORTING, SORTED, BUILDING } stage;

typedef struct conversion {
    mem *m;
    const char *name;   /* of the data set */
    const char *output; /* beside which scratch files may lie */
    mesh_options o;     /* threads: those of the plan, if that is another run's */
    const progress *p;
    mesh_report *report; /* from the reader */
    mesh_gather *g;
    uint32_t stage; /* see above */
    double share;   /* of the job that is done */
    mesh_plan plan;
    pool *workers;
    mesh_runs *runs;
    mesh_keys *keys; /* only while sorting */
    mesh_keys_report sorted;
    uint32_t counted; /* the plan's treelets are exact */
    mesh_spool gradients;
    uint64_t bands; /* of gradients that are done, of all sets */
    leaf_writer *writer;
    mesh_batches batches;
    mesh_build *build;
    uint32_t first_step, end_step; /* range of steps being built */
    bool goes_on;                  /* this pass over the tets was begun by another run */
} conversion;

mesh_options mesh_options_default(void) {
    return (mesh_options){.file = leaf_parameters_default(),
                          .treelet_tets = MESH_TREELET_TETS,
                          .leaf_tets = MESH_LEAF_TETS,
                          .memory = (uint64_t)1 << 62,
                          .threads = 1};
}

static status tell(conversion *c, const char *stage_name, double from, double to, double part) {
    c->share = from + (to - from) * part;
    return progress_step(c->p, stage_name, c->share);
}

/* ---- setting up ---- */

static status begin_runs(conversion *c) {
    status st = pool_create(c->m, c->o.threads, &c->workers);
    if (st == ST_OK)
        st = mesh_runs_create(c->m, c->workers, c->output, &c->plan.runs, &c->runs);
    if (st != ST_OK)
        return st;
    mesh_runs_stop_by(c->runs, c->p);
    if (c->o.work)
        mesh_runs_keep_in(c->runs, c->o.work);
    return ST_OK;
}

static status begin_keys(conversion *c) {
    return mesh_keys_create(c->m, c->workers, c->g, c->plan.keys_window, &c->keys);
}

static status begin_batches(conversion *c) {
    const size_t most = (size_t)c->o.threads * BATCH_PER_THREAD;
    return mesh_batches_init(&c->batches, c->m, c->runs, c->sorted.tets, c->o.treelet_tets, most);
}

static status begin_writer(conversion *c) {
    const leaf_sets *sets = c->o.series ? &c->o.series->of.sets : NULL;
    const char *field = c->report->field;
    const char *const *names = sets && sets->names ? sets->names : &field;
    const leaf_target to = {c->output, c->o.force, c->o.work};
    const leaf_mesh parts = {.name = c->name,
                             .field = names[0],
                             .names = names,
                             .times = sets ? sets->times : NULL,
                             .treelets = (uint32_t)c->plan.treelets,
                             .treelet_tets = c->o.treelet_tets,
                             .leaf_tets = c->o.leaf_tets,
                             .fields = c->g->fields,
                             .steps = c->g->steps,
                             .gradients = c->o.gradients,
                             .moving = c->g->moving,
                             .coarse = c->o.coarse};
    const mesh_build_input in = {&c->o, &c->plan, c->g, &c->gradients, c->sorted.tets};
    status st = leaf_writer_create_mesh(c->m, &to, &parts, &c->o.file, &c->writer);
    return st == ST_OK ? mesh_build_create(c->m, c->workers, &in, c->writer, &c->build) : st;
}

/* ---- what another run needs to go on ---- */

static status keep_input(conversion *c, state_io *io) {
    status st = STATE_IO(io, c->stage);
    if (st == ST_OK)
        st = STATE_IO(io, c->share);
    if (st == ST_OK)
        st = STATE_IO(io, *c->report);
    if (st == ST_OK && c->stage > BUILDING)
        st = state_io_fault(io);
    c->report->field[MESH_NAME_MAX] = '\0';
    /* All has been read: the plan says what is in memory. */
    if (st == ST_OK && state_io_loads(io) && c->stage != READING)
        c->g->points.ceiling = c->g->values.ceiling = c->g->tets.ceiling = 0;
    return st == ST_OK ? mesh_gather_keep(c->g, io) : st;
}

static status keep_plan(conversion *c, state_io *io) {
    status st = mesh_plan_keep(&c->plan, &c->o, io);
    if (st != ST_OK || !state_io_loads(io))
        return st;
    if (c->g->done != c->g->steps || c->g->vertices == 0)
        return state_io_fault(io);
    c->o.threads = c->o.threads < c->plan.threads ? c->o.threads : c->plan.threads;
    st = begin_runs(c);
    return st == ST_OK && c->stage == SORTING ? begin_keys(c) : st;
}

static status keep_sorting(conversion *c, state_io *io) {
    const bool sorts = c->stage == SORTING;
    status st = keep_plan(c, io);
    if (st == ST_OK)
        st = mesh_runs_keep(c->runs, io);
    if (st == ST_OK)
        st = sorts ? mesh_keys_keep(c->keys, io) : STATE_IO(io, c->sorted);
    if (st == ST_OK)
        st = STATE_IO(io, c->counted);
    if (st != ST_OK || !state_io_loads(io))
        return st;
    const uint64_t records = sorts ? mesh_keys_put(c->keys) : c->sorted.tets;
    return records == 0 || records != mesh_runs_left(c->runs) ? state_io_fault(io) : ST_OK;
}

/* The gradients that are there after c->bands bands. */
static uint64_t gradients_count(const conversion *c) {
    const uint64_t all = c->g->vertices, band = c->plan.gradients.band;
    const uint64_t per_set = (all + band - 1) / band, rest = c->bands % per_set;
    return c->bands / per_set * all + rest * band;
}

static status keep_gradients(conversion *c, state_io *io) {
    if (!c->o.gradients)
        return ST_OK;
    status st = STATE_IO(io, c->bands);
    if (st == ST_OK)
        st = mesh_spool_keep(&c->gradients, io);
    return st == ST_OK && (c->gradients.count != gradients_count(c) ||
                           c->gradients.count > c->g->values.count)
               ? state_io_fault(io)
               : st;
}

static status keep_building(conversion *c, state_io *io) {
    status st = ST_OK;
    if (state_io_loads(io)) {
        c->goes_on = true;
        st = c->counted ? begin_batches(c) : state_io_fault(io);
        if (st == ST_OK)
            st = begin_writer(c);
    }
    if (st == ST_OK)
        st = leaf_writer_keep(c->writer, io);
    if (st == ST_OK)
        st = STATE_IO(io, c->first_step);
    if (st == ST_OK)
        st = STATE_IO(io, c->end_step);
    if (st == ST_OK && (c->first_step >= c->end_step || c->end_step > c->g->steps))
        st = state_io_fault(io);
    if (st == ST_OK)
        st = mesh_batches_keep(&c->batches, io);
    return st == ST_OK ? mesh_build_keep(c->build, io) : st;
}

/* Save all, or load it. What is loaded is made on the way. */
static status keep(void *ctx, state_io *io) {
    conversion *c = ctx;
    status st = convert_job_keep(c->o.job, io);
    if (st == ST_OK)
        st = keep_input(c, io);
    if (st == ST_OK && c->stage >= SORTING)
        st = keep_sorting(c, io);
    if (st == ST_OK && c->stage >= SORTED)
        st = keep_gradients(c, io);
    if (st == ST_OK && c->stage >= BUILDING)
        st = keep_building(c, io);
    return st == ST_OK ? state_io_end(io) : st;
}

/* Whether saving is worth it: several steps were read, or the mesh goes through scratch files. */
static bool is_kept(const conversion *c) {
    const mesh_gather *g = c->g;
    return c->o.work && (g->steps > 1 || c->plan.spill_bytes > 0 || !mesh_spool_held(&g->points) ||
                         !mesh_spool_held(&g->values) || !mesh_spool_held(&g->tets));
}

/* Sorted tets are in the runs. Remove their file, unless an earlier state is the last one. */
static void drop_tets(const conversion *c) {
    if (c->o.work && c->stage >= SORTED)
        work_folder_drop(c->o.work, WORK_TETS);
}

/* Save all if it is time to. */
static status save(conversion *c) {
    out_file *files[WORK_FILES] = {0};
    if (!is_kept(c) || !work_folder_due(c->o.work))
        return ST_OK;
    status st = mesh_gather_store(c->g);
    if (st == ST_OK)
        st = mesh_spool_store(&c->gradients);
    if (st == ST_OK && c->runs)
        st = mesh_runs_store(c->runs);
    if (st != ST_OK)
        return st;
    mesh_gather_files(c->g, files);
    files[WORK_GRADIENTS] = mesh_spool_file(&c->gradients);
    files[WORK_RUNS] = c->runs ? mesh_runs_file(c->runs) : NULL;
    if (c->writer)
        leaf_writer_files(c->writer, files);
    st = work_folder_save(c->o.work, files, c->share, keep, c);
    if (st == ST_OK)
        drop_tets(c);
    return st;
}

/* Go on where an earlier run ended. */
static status resume(conversion *c) {
    if (!c->o.work || !work_folder_resumes(c->o.work))
        return ST_OK;
    status st = work_folder_load(c->o.work, keep, c);
    if (st == ST_OK)
        drop_tets(c);
    return st;
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

static status begin_sorting(conversion *c) {
    status st = mesh_plan_make(c->m, c->g, &c->o, &c->plan);
    if (st == ST_OK)
        st = spill(c);
    if (st == ST_OK)
        st = begin_runs(c);
    if (st == ST_OK)
        st = begin_keys(c);
    c->stage = SORTING;
    return st;
}

static status check_sorted(const conversion *c) {
    const char *name = *c->name ? c->name : "the mesh";
    const uint64_t bad = c->report->bad_indices + c->sorted.bad,
                   repeated = c->report->repeated + c->sorted.repeated;
    if (c->sorted.tets > 0)
        return ST_OK;
    if (bad + repeated == 0)
        return status_describe(ST_UNSUPPORTED,
                               "%s: no tets; a surface of triangles is filled with them: `meshio "
                               "convert IN surface.ply' (python3-meshio), then `leafcast "
                               "tetrahedralize surface.ply -o F.mesh', and convert F.mesh",
                               name);
    return status_describe(ST_CORRUPT,
                           "%s: %llu tets with an id that is no point, %llu with a vertex twice, "
                           "and no tet besides",
                           name, (unsigned long long)bad, (unsigned long long)repeated);
}

/* Sort what is left of the tets. */
static status sort_rest(conversion *c) {
    status st = ST_OK;
    while (st == ST_OK && mesh_keys_done(c->keys) < 1) {
        st = mesh_keys_next(c->keys, c->runs);
        if (st == ST_OK)
            st = tell(c, "sort", READ_END, KEYS_END, mesh_keys_done(c->keys));
        if (st == ST_OK && mesh_runs_written(c->runs))
            st = save(c);
    }
    if (st == ST_OK)
        st = mesh_keys_end(c->keys, &c->sorted);
    mesh_keys_destroy(c->keys);
    c->keys = NULL;
    return st;
}

static status sort_tets(conversion *c) {
    status st = c->stage == READING ? begin_sorting(c) : ST_OK;
    if (st == ST_OK)
        st = sort_rest(c);
    if (st == ST_OK)
        st = mesh_runs_end(c->runs);
    mesh_spool_release(&c->g->tets);
    if (st == ST_OK)
        st = check_sorted(c);
    if (st != ST_OK)
        return st;
    c->stage = SORTED;
    if (c->o.work && !work_folder_resumes(c->o.work))
        drop_tets(c);
    st = tell(c, "sort", KEYS_END, SORT_END, 1);
    return st == ST_OK ? save(c) : st;
}

/* Go through all tets to count the treelets. */
static status count_treelets(conversion *c) {
    mesh_batches *b = &c->batches;
    status st = ST_OK;
    while (st == ST_OK && mesh_batches_more(b)) {
        st = mesh_batches_next(b);
        if (st == ST_OK)
            st = progress_ask(c->p, "sort");
        if (st == ST_OK && b->treelet > UINT32_MAX / 4)
            st = status_describe(ST_UNSUPPORTED, "too many treelets; make them larger");
    }
    if (st == ST_OK)
        st = mesh_plan_settle(&c->o, c->g, &c->plan, mesh_batches_end(b));
    c->counted = 1;
    return st == ST_OK ? save(c) : st;
}

/* ---- gradients ---- */

/* Share of the treelets that are done in this pass over the tets. */
static double pass_done(const conversion *c) {
    return (double)mesh_batches_end(&c->batches) / (double)c->plan.treelets;
}

/* Compute the gradients of the next band. all: the bands of all sets. */
static status sum_band(conversion *c, mesh_gradients *summing, uint64_t all) {
    mesh_batches *b = &c->batches;
    const uint64_t bands = mesh_gradients_bands(summing);
    const uint32_t set = (uint32_t)(c->bands / bands), step = set / c->g->fields;
    mesh_gradients_begin(summing, c->bands % bands, mesh_gather_points(c->g, step),
                         mesh_gather_values(c->g, step, set % c->g->fields));
    status st = mesh_batches_rewind(b);
    while (st == ST_OK && mesh_batches_more(b)) {
        st = mesh_batches_next(b);
        if (st == ST_OK)
            st = mesh_gradients_add(summing, b->records, b->first[b->count]);
        if (st == ST_OK)
            st = tell(c, "gradients", SORT_END, GRADIENTS_END,
                      ((double)c->bands + pass_done(c)) / (double)all);
    }
    return st == ST_OK ? mesh_gradients_end(summing, &c->gradients) : st;
}

/* Compute the gradients of all vertices in all sets, in the order of the values, into
 * c->gradients. */
static status make_gradients(conversion *c) {
    mesh_gather *g = c->g;
    mesh_gradients *summing = NULL;
    status st = c->plan.spill_gradients ? mesh_spool_spill(&c->gradients) : ST_OK;
    if (st == ST_OK)
        st = mesh_gradients_create(c->m, c->workers, &g->points, &g->values, g->vertices,
                                   &c->plan.gradients, &summing);
    const uint64_t all =
        st == ST_OK ? mesh_gradients_bands(summing) * g->fields * g->steps : c->bands;
    while (st == ST_OK && c->bands < all) {
        st = sum_band(c, summing, all);
        c->bands++;
        if (st == ST_OK)
            st = save(c);
    }
    mesh_gradients_destroy(summing);
    return st;
}

/* ---- building ---- */

/* Build the steps from c->first_step to before c->end_step of the treelets from here on. */
static status build_pass(conversion *c) {
    mesh_batches *b = &c->batches;
    const double from = c->o.gradients ? GRADIENTS_END : SORT_END;
    const uint32_t steps = c->end_step - c->first_step;
    status st = ST_OK;
    while (st == ST_OK && mesh_batches_more(b)) {
        st = mesh_batches_next(b);
        if (st == ST_OK && mesh_batches_end(b) > c->plan.treelets)
            st = status_describe(ST_CORRUPT, "%s: the sorted tets have changed meanwhile",
                                 c->output);
        if (st == ST_OK)
            st = mesh_build_take(c->build, b, c->first_step, c->end_step);
        if (st == ST_OK)
            st = tell(c, "build", from, 1, (c->first_step + pass_done(c) * steps) / c->g->steps);
        if (st == ST_OK)
            st = save(c);
    }
    return st;
}

/* Build all steps in one pass if points and values are in memory: there the values of a vertex at
 * all steps lie side by side. In scratch files each step lies elsewhere, and the page caches
 * (mesh_pages.h) would be loaded again and again: then build one step a pass. */
static status build_steps(conversion *c) {
    const bool held = mesh_spool_held(&c->g->points) && mesh_spool_held(&c->g->values);
    status st = ST_OK;
    for (; st == ST_OK && c->first_step < c->g->steps; c->first_step = c->end_step) {
        if (!c->goes_on) {
            c->end_step = held ? c->g->steps : c->first_step + 1;
            st = mesh_batches_rewind(&c->batches);
        }
        c->goes_on = false;
        if (st == ST_OK)
            st = build_pass(c);
    }
    return st;
}

static status build_treelets(conversion *c) {
    status st = c->stage == BUILDING ? ST_OK : begin_batches(c);
    if (st == ST_OK && !c->counted)
        st = count_treelets(c);
    if (st == ST_OK && c->o.gradients && c->stage != BUILDING)
        st = make_gradients(c);
    if (st == ST_OK && c->stage != BUILDING)
        st = begin_writer(c);
    c->stage = BUILDING;
    return st == ST_OK ? build_steps(c) : st;
}

/* Call it when all values have been put. A mesh without an array was given zeros. */
static status check_empty(const conversion *c) {
    const uint32_t sets = c->g->fields * c->g->steps;
    bool numbers = false, zeros = true;
    for (uint32_t set = 0; set < sets; set++) {
        double range[2];
        leaf_writer_range(c->writer, set, range);
        numbers = numbers || range[0] <= range[1];
        zeros = zeros && range[0] == 0 && range[1] == 0;
    }
    if (!c->o.refuse_empty || (numbers && (*c->report->field || !zeros)))
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

/* o is copied. */
static conversion conversion_of(mem *m, mesh_gather *g, const char *name, const char *output,
                                const mesh_options *o, const progress *p, mesh_report *report) {
    conversion c = {
        .m = m, .name = name, .output = output, .o = *o, .p = p, .g = g, .report = report};
    mesh_spool_init(&c.gradients, m, output, sizeof(float[3]), 0);
    c.gradients.p = p;
    if (o->work)
        mesh_spool_keep_in(&c.gradients, o->work, WORK_GRADIENTS);
    return c;
}

/* Free all but the writer, which leaf_writer_finish() consumes. */
static void release(conversion *c) {
    mesh_build_destroy(c->build);
    mesh_batches_release(&c->batches);
    mesh_keys_destroy(c->keys);
    mesh_runs_destroy(c->runs);
    mesh_spool_release(&c->gradients);
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

/* Make the treelet file of what has been read, or what is left of that. */
static status convert(conversion *c, mesh_result *result) {
    const mesh_report *r = c->report;
    leaf_facts facts = {0};
    double start = clock_seconds();
    status st = c->stage <= SORTING ? sort_tets(c) : ST_OK;
    result->sort_s = clock_seconds() - start;
    start = clock_seconds();
    if (st == ST_OK)
        st = build_treelets(c);
    if (st == ST_OK)
        mesh_build_end(c->build, &facts);
    if (st == ST_OK)
        st = check_empty(c);
    release(c);
    result->plan = c->plan;
    char provenance[256];
    describe_origin(&c->o, r, provenance, sizeof provenance);
    facts.provenance = provenance;
    facts.vertices = c->sorted.vertices;
    facts.non_finite = c->sorted.non_finite;
    facts.repeated = r->repeated + c->sorted.repeated;
    facts.bad = r->bad_indices + c->sorted.bad;
    if (st == ST_OK)
        st = embed_coarse(c->m, c->writer, c->output, &facts, &c->o, c->p);
    if (st != ST_OK) {
        leaf_writer_discard(c->writer);
        return st;
    }
    st = leaf_writer_finish(c->writer, &facts, &result->header);
    result->build_s = clock_seconds() - start;
    return st;
}

status mesh_convert_gathered(mem *m, mesh_gather *g, const char *name, const char *output,
                             const mesh_options *o, const progress *p, mesh_result *result) {
    assert(!o->work && (o->series || g->fields * g->steps == 1));
    conversion c = conversion_of(m, g, name, output, o, p, &result->report);
    return convert(&c, result);
}

/* ---- reading ---- */

/* Begin to read into g, which is new. */
static void begin_reading(mesh_gather *g, mesh_input *x, const mesh_options *o) {
    if (o->series)
        mesh_series_begin(o->series, x, g);
}

static status read_step(mem *m, mesh_input *x, const mesh_options *o, mesh_gather *g,
                        const mesh_sink *sink, mesh_report *report) {
    if (o->series)
        return mesh_series_read(m, o->series, x, g, sink, report);
    status st = mesh_gather_read(g, x, sink, report);
    g->done = 1;
    return st;
}

static status read_rest(conversion *c, mesh_input *x) {
    const mesh_sink sink = mesh_gather_sink(c->g);
    status st = ST_OK;
    while (st == ST_OK && c->g->done < c->g->steps) {
        st = read_step(c->m, x, &c->o, c->g, &sink, c->report);
        c->share = READ_END * c->g->done / c->g->steps;
        if (st == ST_OK)
            st = save(c);
    }
    return st;
}

/* Read everything, keep nothing, and plan. */
static status plan_counted(mem *m, mesh_input *x, const mesh_options *o, const progress *p,
                           mesh_result *result) {
    mesh_gather g;
    status st = ST_OK;
    mesh_gather_init(&g, m, "", 0, p);
    begin_reading(&g, x, o);
    const mesh_sink sink = mesh_gather_counter(&g);
    while (st == ST_OK && g.done < g.steps)
        st = read_step(m, x, o, &g, &sink, &result->report);
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
    mesh_gather g;
    *result = (mesh_result){0};
    const double start = clock_seconds();
    status st = out_file_check(m, output, o->force);
    if (st == ST_OK && !(o->work && work_folder_resumes(o->work)))
        st = check_budget(m, x, o, p, result);
    if (st != ST_OK)
        return st;
    mesh_gather_init(&g, m, output, (size_t)(o->memory / 2), p);
    g.share = READ_END;
    begin_reading(&g, x, o);
    if (o->work)
        mesh_gather_keep_in(&g, o->work);
    conversion c = conversion_of(m, &g, mesh_input_name(x), output, o, p, &result->report);
    st = resume(&c);
    if (st == ST_OK)
        st = read_rest(&c, x);
    if (st != ST_OK) {
        release(&c);
        leaf_writer_discard(c.writer);
        return st;
    }
    result->read_s = clock_seconds() - start;
    return convert(&c, result);
}

status mesh_convert_dry(mem *m, mesh_input *x, const mesh_options *o, const progress *p,
                        mesh_result *result) {
    *result = (mesh_result){0};
    return plan_counted(m, x, o, p, result);
}
