#include "prep/mesh/mesh_convert.h"

#include <assert.h>
#include <stdio.h>
#include <string.h>

#include "formats/base/clock.h"
#include "formats/base/file.h"
#include "prep/further_step.h"
#include "prep/mesh/mesh_conversion.h"
#include "prep/mesh/mesh_earlier.h"
#include "prep/resample/coarse_grids.h"

#ifndef LEAFCAST_VERSION
#define LEAFCAST_VERSION "0"
#endif

/* Ends of the stages, as shares of the whole job. */
static const double READ_END = 0.25, KEYS_END = 0.4, SORT_END = 0.5, GRADIENTS_END = 0.6;

mesh_options mesh_options_default(void) {
    return (mesh_options){.file = leaf_parameters_default(),
                          .treelet_tets = MESH_TREELET_TETS,
                          .leaf_tets = MESH_LEAF_TETS,
                          .memory = (uint64_t)1 << 62,
                          .threads = 1};
}

/* ---- sorting ---- */

static status spill(mesh_conversion *c) {
    status st = c->plan.spill_tets ? mesh_spool_spill(&c->g->tets) : ST_OK;
    if (st == ST_OK && c->plan.spill_points)
        st = mesh_spool_spill(&c->g->points);
    if (st == ST_OK && c->plan.spill_points)
        st = mesh_spool_spill(&c->g->values);
    if (st == ST_OK && c->plan.spill_points && c->g->normals.count > 0)
        st = mesh_spool_spill(&c->g->normals);
    return st;
}

static status begin_sorting(mesh_conversion *c) {
    status st = mesh_plan_make(c->m, c->g, &c->o, &c->plan);
    if (st == ST_OK)
        st = spill(c);
    if (st == ST_OK)
        st = mesh_conversion_begin_runs(c);
    if (st == ST_OK)
        st = mesh_conversion_begin_keys(c);
    c->stage = MESH_SORTING;
    return st;
}

static status check_sorted(const mesh_conversion *c) {
    const char *name = *c->name ? c->name : "the mesh";
    const uint64_t bad = c->report->bad_indices + c->sorted.bad,
                   repeated = c->report->repeated + c->sorted.repeated;
    if (c->sorted.tets > 0)
        return ST_OK;
    if (c->g->corners == 3)
        return status_describe(bad + repeated ? ST_CORRUPT : ST_UNSUPPORTED,
                               "%s: %llu triangles with an id that is no point, %llu with a vertex "
                               "twice, and no triangle besides",
                               *c->name ? c->name : "the surface", (unsigned long long)bad,
                               (unsigned long long)repeated);
    if (bad + repeated == 0)
        return status_describe(ST_UNSUPPORTED,
                               "%s: no tets; a surface of triangles is converted as .ply: `meshio "
                               "convert IN surface.ply' (python3-meshio); or filled with tets: "
                               "then `leafcast tetrahedralize surface.ply -o F.mesh', and convert "
                               "F.mesh",
                               name);
    return status_describe(ST_CORRUPT,
                           "%s: %llu tets with an id that is no point, %llu with a vertex twice, "
                           "and no tet besides",
                           name, (unsigned long long)bad, (unsigned long long)repeated);
}

/* Sort what is left of the tets. */
static status sort_rest(mesh_conversion *c) {
    status st = ST_OK;
    while (st == ST_OK && mesh_keys_done(c->keys) < 1) {
        st = mesh_keys_next(c->keys, c->runs);
        if (st == ST_OK)
            st = mesh_conversion_tell(c, "sort", READ_END, KEYS_END, mesh_keys_done(c->keys));
        if (st == ST_OK && mesh_runs_written(c->runs))
            st = mesh_conversion_save(c);
    }
    if (st == ST_OK)
        st = mesh_keys_end(c->keys, &c->sorted);
    mesh_keys_destroy(c->keys);
    c->keys = NULL;
    return st;
}

static status sort_tets(mesh_conversion *c) {
    status st = c->stage == MESH_READING ? begin_sorting(c) : ST_OK;
    if (st == ST_OK)
        st = sort_rest(c);
    if (st == ST_OK)
        st = mesh_runs_end(c->runs);
    if (!mesh_gather_keeps(c->g))
        mesh_spool_release(&c->g->tets);
    if (st == ST_OK)
        st = check_sorted(c);
    if (st != ST_OK)
        return st;
    c->stage = MESH_SORTED;
    st = mesh_conversion_tell(c, "sort", KEYS_END, SORT_END, 1);
    return st == ST_OK ? mesh_conversion_save(c) : st;
}

/* Go through all tets to count the treelets. */
static status count_treelets(mesh_conversion *c) {
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
    return st == ST_OK ? mesh_conversion_save(c) : st;
}

/* ---- gradients ---- */

/* Share of the treelets that are done in this pass over the tets. */
static double pass_done(const mesh_conversion *c) {
    return (double)mesh_batches_end(&c->batches) / (double)c->plan.treelets;
}

/* Compute the gradients of the next band. all: the bands of all sets. */
static status sum_band(mesh_conversion *c, mesh_gradients *summing, uint64_t all) {
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
            st = mesh_conversion_tell(c, "gradients", SORT_END, GRADIENTS_END,
                                      ((double)c->bands + pass_done(c)) / (double)all);
    }
    return st == ST_OK ? mesh_gradients_end(summing, &c->gradients) : st;
}

/* Compute the gradients of all vertices in all sets, in the order of the values, into
 * c->gradients. */
static status make_gradients(mesh_conversion *c) {
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
            st = mesh_conversion_save(c);
    }
    mesh_gradients_destroy(summing);
    return st;
}

/* ---- normals ---- */

/* Make the normals of the next band. all: the bands of all steps. */
static status make_band(mesh_conversion *c, mesh_normals *making, uint64_t all) {
    mesh_batches *b = &c->batches;
    const uint64_t bands = mesh_normals_bands(making);
    status st = mesh_normals_begin(making, c->bands % bands,
                                   mesh_gather_points(c->g, (uint32_t)(c->bands / bands)));
    if (st == ST_OK)
        st = mesh_batches_rewind(b);
    while (st == ST_OK && mesh_batches_more(b)) {
        st = mesh_batches_next(b);
        if (st == ST_OK)
            st = mesh_normals_add(making, b->records, b->first[b->count]);
        if (st == ST_OK)
            st = mesh_conversion_tell(c, "normals", SORT_END, GRADIENTS_END,
                                      ((double)c->bands + pass_done(c)) / (double)all);
    }
    return st == ST_OK ? mesh_normals_end(making, &c->g->normals) : st;
}

/* Make the normals of all vertices, at each step at which they are elsewhere. */
static status make_normals(mesh_conversion *c) {
    mesh_gather *g = c->g;
    mesh_normals making;
    status st = c->plan.spill_gradients ? mesh_spool_spill(&g->normals) : ST_OK;
    if (st != ST_OK)
        return st;
    st = mesh_normals_init(&making, c->m, &g->points, g->vertices, &c->plan.normals);
    const uint64_t all = mesh_normals_bands(&making) * (g->moving ? g->steps : 1);
    while (st == ST_OK && c->bands < all) {
        st = make_band(c, &making, all);
        c->bands++;
        if (st == ST_OK)
            st = mesh_conversion_save(c);
    }
    mesh_normals_release(&making);
    return st;
}

/* ---- building ---- */

/* Build the steps from c->first_step to before c->end_step of the treelets from here on. */
static status build_pass(mesh_conversion *c) {
    mesh_batches *b = &c->batches;
    const double from =
        c->o.gradients || mesh_options_make_normals(&c->o) ? GRADIENTS_END : SORT_END;
    const uint32_t steps = c->end_step - c->first_step;
    status st = ST_OK;
    while (st == ST_OK && mesh_batches_more(b)) {
        st = mesh_batches_next(b);
        if (st == ST_OK && mesh_batches_end(b) > c->plan.treelets)
            st = mesh_batches_fault();
        if (st == ST_OK)
            st = mesh_build_take(c->build, b, c->first_step, c->end_step);
        if (st == ST_OK)
            st = mesh_conversion_tell(c, "build", from, 1,
                                      (c->first_step + pass_done(c) * steps) / c->g->steps);
        if (st == ST_OK)
            st = mesh_conversion_save(c);
    }
    return st;
}

/* Build all steps in one pass if points and values are in memory: there the values of a vertex at
 * all steps lie side by side. In scratch files each step lies elsewhere, and the page caches
 * (mesh_pages.h) would be loaded again and again: then build one step a pass. */
static status build_steps(mesh_conversion *c) {
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

/* Check, where the output grows, what is known of the mesh by now. */
static status check_growth(const mesh_conversion *c) {
    const char *input = c->g->first_name;
    const mesh_counts counts = {c->sorted.tets, c->sorted.vertices, c->plan.treelets};
    if (c->o.grows && c->g->moving)
        return status_describe(ST_USAGE,
                               "%s: --append: points that move from step to step: all steps of "
                               "such a mesh are converted at once",
                               input);
    if (!c->o.grow)
        return ST_OK;
    const leaf_file *before = leaf_grow_before(c->o.grow);
    status st = mesh_earlier_check(before, input, &counts);
    if (st == ST_OK && !c->o.series->of.sets.names)
        st = further_step_check_field(before, input, 0, c->report->field);
    return st;
}

static status build_treelets(mesh_conversion *c) {
    status st = c->stage == MESH_BUILDING ? ST_OK : mesh_conversion_begin_batches(c);
    if (st == ST_OK && !c->counted)
        st = count_treelets(c);
    if (st == ST_OK)
        st = check_growth(c);
    if (st == ST_OK && c->o.gradients && c->stage != MESH_BUILDING)
        st = make_gradients(c);
    if (st == ST_OK && mesh_options_make_normals(&c->o) && c->stage != MESH_BUILDING)
        st = make_normals(c);
    if (st == ST_OK && c->stage != MESH_BUILDING)
        st = mesh_conversion_begin_writer(c);
    c->stage = MESH_BUILDING;
    return st == ST_OK ? build_steps(c) : st;
}

/* Call it when all values have been put. A mesh without an array was given zeros. */
static status check_empty(const mesh_conversion *c) {
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
    const char *what = o->cells && o->cells->corners == 3 ? "a surface" : "a mesh";
    char steps[32];
    snprintf(steps, sizeof steps, "%s", what);
    if (o->series && o->series->of.sets.steps > 1)
        snprintf(steps, sizeof steps, "%s at %u steps", what, o->series->of.sets.steps);
    char codec[32] = "raw";
    if (o->file.codec == LEAF_CODEC_ZSTD)
        snprintf(codec, sizeof codec, "zstd:%d", o->file.zstd_level);
    uint64_t split = 0;
    for (int i = 0; i < CELL_SPLIT_SHAPES; i++)
        split += r->split[i];
    char cells[64] = "";
    if (split)
        snprintf(cells, sizeof cells, ", %llu cells split", (unsigned long long)split);
    if (o->cells) {
        const char *normals = mesh_options_make_normals(o) ? ", smooth normals"
                              : r->normals > 0             ? ", normals of its own"
                                                           : "";
        snprintf(text, size, "leafcast %s convert, from %s: Morton treelets of %u %s%s, %s",
                 LEAFCAST_VERSION, steps, o->treelet_tets, o->cells->cells, normals, codec);
        return;
    }
    snprintf(text, size,
             "leafcast %s convert, from %s: Morton treelets of %u tets, leaves of %u%s%s%s, %s",
             LEAFCAST_VERSION, steps, o->treelet_tets, o->leaf_tets, o->sah ? " by areas" : "",
             cells, o->gradients ? ", gradients" : "", codec);
}

static status embed_coarse(mem *m, leaf_writer *w, const char *output, const leaf_facts *facts,
                           const mesh_options *o, const progress *p) {
    if (!o->coarse)
        return ST_OK;
    const coarse_grids coarse = {.dims = o->coarse_dims,
                                 .file = o->file,
                                 .memory = o->memory,
                                 .threads = o->threads,
                                 .output = output};
    status st = leaf_writer_settle(w, facts);
    const coarse_maker maker = coarse_grids_maker(&coarse);
    progress_part rest = {p, mesh_conversion_share(o), 1.0};
    const progress of_rest = progress_of_part(&rest);
    return st == ST_OK ? coarse_parts_embed(m, w, output, &maker, &of_rest) : st;
}

/* Make the treelet file of what has been read, or what is left of that. */
static status convert(mesh_conversion *c, mesh_result *result) {
    const mesh_report *r = c->report;
    leaf_facts facts = {0};
    double start = clock_seconds();
    status st = c->stage <= MESH_SORTING ? sort_tets(c) : ST_OK;
    result->sort_s = clock_seconds() - start;
    start = clock_seconds();
    if (st == ST_OK)
        st = build_treelets(c);
    if (st == ST_OK)
        mesh_build_end(c->build, &facts);
    if (st == ST_OK)
        st = check_empty(c);
    mesh_conversion_release(c);
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
    mesh_conversion c = mesh_conversion_of(m, g, name, output, o, p, &result->report);
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

static status read_rest(mesh_conversion *c, mesh_input *x) {
    const mesh_sink sink = mesh_gather_sink(c->g);
    status st = ST_OK;
    while (st == ST_OK && c->g->done < c->g->steps) {
        st = read_step(c->m, x, &c->o, c->g, &sink, c->report);
        c->share = mesh_conversion_share(&c->o) * READ_END * c->g->done / c->g->steps;
        if (st == ST_OK)
            st = mesh_conversion_save(c);
    }
    return st;
}

/* Read everything, keep nothing, and plan. */
static status plan_counted(mem *m, mesh_input *x, const mesh_options *o, const progress *p,
                           mesh_result *result) {
    mesh_gather g;
    status st = ST_OK;
    mesh_gather_init(&g, m, "", 0, p);
    if (o->cells)
        mesh_gather_cells(&g, o->cells->corners);
    g.takes_normals = mesh_options_take_normals(o);
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
    status st = out_file_check(m, output, o->force || o->grow);
    if (st == ST_OK && !(o->work && work_folder_resumes(o->work)))
        st = check_budget(m, x, o, p, result);
    if (st != ST_OK)
        return st;
    mesh_gather_init(&g, m, output, (size_t)(o->memory / 2), p);
    g.share = mesh_conversion_share(o) * READ_END;
    if (o->cells)
        mesh_gather_cells(&g, o->cells->corners);
    g.takes_normals = mesh_options_take_normals(o);
    begin_reading(&g, x, o);
    if (o->work)
        mesh_gather_keep_in(&g, o->work);
    mesh_conversion c =
        mesh_conversion_of(m, &g, mesh_input_name(x), output, o, p, &result->report);
    st = mesh_conversion_resume(&c);
    if (st == ST_OK)
        st = read_rest(&c, x);
    if (st != ST_OK) {
        mesh_conversion_release(&c);
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
