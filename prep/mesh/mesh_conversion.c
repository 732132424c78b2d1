#include "prep/mesh/mesh_conversion.h"

enum { BATCH_PER_THREAD = 32 }; /* treelets per thread between two progress reports */

/* ---- setting up ---- */

mesh_conversion mesh_conversion_of(mem *m, mesh_gather *g, const char *name, const char *output,
                                   const mesh_options *o, const progress *p, mesh_report *report) {
    mesh_conversion c = {
        .m = m, .name = name, .output = output, .o = *o, .p = p, .g = g, .report = report};
    if (o->cells && !o->cells->histograms)
        c.o.file.histograms = false;
    mesh_spool_init(&c.gradients, m, output, sizeof(float[3]), 0);
    c.gradients.p = p;
    if (o->work && o->gradients)
        mesh_spool_keep_in(&c.gradients, o->work, WORK_GRADIENTS);
    return c;
}

void mesh_conversion_release(mesh_conversion *c) {
    mesh_build_destroy(c->build);
    mesh_batches_release(&c->batches);
    mesh_keys_destroy(c->keys);
    mesh_runs_destroy(c->runs);
    mesh_spool_release(&c->gradients);
    pool_destroy(c->workers);
    mesh_gather_release(c->g);
}

status mesh_conversion_begin_runs(mesh_conversion *c) {
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

status mesh_conversion_begin_keys(mesh_conversion *c) {
    return mesh_keys_create(c->m, c->workers, c->g, c->plan.keys_window, &c->keys);
}

status mesh_conversion_begin_batches(mesh_conversion *c) {
    const size_t most = (size_t)c->o.threads * BATCH_PER_THREAD;
    status st =
        mesh_batches_init(&c->batches, c->m, c->runs, c->sorted.tets, c->o.treelet_tets, most);
    if (c->resumed && mesh_gather_keeps(c->g))
        mesh_batches_doubt_cells(&c->batches, c->g->tets.count);
    else if (c->resumed)
        mesh_batches_doubt(&c->batches, c->g->vertices, c->g->corners);
    return st;
}

status mesh_conversion_begin_writer(mesh_conversion *c) {
    const leaf_sets *sets = c->o.series ? &c->o.series->of.sets : NULL;
    const char *field = c->report->field;
    const char *const *names = sets && sets->names ? sets->names : &field;
    const leaf_target to = {.path = c->output,
                            .force = c->o.force || c->o.grow,
                            .work = c->o.work,
                            .grows = c->o.grows && !c->o.grow,
                            .grow = c->o.grow};
    const leaf_mesh parts = {.name = c->name,
                             .field = names[0],
                             .names = names,
                             .times = sets ? sets->times : NULL,
                             .treelets = (uint32_t)c->plan.treelets,
                             .treelet_tets = c->o.treelet_tets,
                             .leaf_tets = c->o.cells ? 0 : c->o.leaf_tets,
                             .kind = c->o.cells ? c->o.cells->kind : LEAF_KIND_MESH,
                             .fields = c->g->fields,
                             .steps = c->g->steps,
                             .gradients = c->o.gradients,
                             .moving = c->g->moving,
                             .coarse = c->o.coarse};
    const mesh_build_input in = {&c->o, &c->plan, c->g, &c->gradients, c->sorted.tets};
    status st = leaf_writer_create_mesh(c->m, &to, &parts, &c->o.file, &c->writer);
    if (st != ST_OK)
        return st;
    leaf_writer_stop_by(c->writer, c->p);
    return mesh_build_create(c->m, c->workers, &in, c->writer, &c->build);
}

double mesh_conversion_share(const mesh_options *o) {
    return o->coarse ? 0.5 : 1.0;
}

status mesh_conversion_tell(mesh_conversion *c, const char *stage, double from, double to,
                            double part) {
    c->share = mesh_conversion_share(&c->o) * (from + (to - from) * part);
    return progress_step(c->p, stage, c->share);
}

/* ---- what another run needs to go on ---- */

static status keep_input(mesh_conversion *c, state_io *io) {
    status st = STATE_IO(io, c->stage);
    if (st == ST_OK)
        st = STATE_IO(io, c->share);
    if (st == ST_OK)
        st = STATE_IO(io, *c->report);
    if (st == ST_OK && c->stage > MESH_BUILDING)
        st = state_io_fault(io);
    c->report->field[MESH_NAME_MAX] = '\0';
    /* All has been read: the plan says what is in memory. */
    if (st == ST_OK && state_io_loads(io) && c->stage != MESH_READING)
        c->g->points.ceiling = c->g->values.ceiling = c->g->tets.ceiling = c->g->normals.ceiling =
            0;
    return st == ST_OK ? mesh_gather_keep(c->g, io) : st;
}

static status keep_plan(mesh_conversion *c, state_io *io) {
    status st = mesh_plan_keep(&c->plan, &c->o, io);
    if (st != ST_OK || !state_io_loads(io))
        return st;
    if (c->g->done != c->g->steps || c->g->vertices == 0)
        return state_io_fault(io);
    c->o.threads = c->o.threads < c->plan.threads ? c->o.threads : c->plan.threads;
    st = mesh_conversion_begin_runs(c);
    return st == ST_OK && c->stage == MESH_SORTING ? mesh_conversion_begin_keys(c) : st;
}

static status keep_sorting(mesh_conversion *c, state_io *io) {
    const bool sorts = c->stage == MESH_SORTING;
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
static uint64_t gradients_count(const mesh_conversion *c) {
    const uint64_t all = c->g->vertices, band = c->plan.gradients.band;
    const uint64_t per_set = (all + band - 1) / band, rest = c->bands % per_set;
    return c->bands / per_set * all + rest * band;
}

/* The normals that are there after c->bands bands. */
static uint64_t normals_count(const mesh_conversion *c) {
    const uint64_t all = c->g->vertices, band = c->plan.normals.band;
    const uint64_t each = (all + band - 1) / band, rest = c->bands % each;
    return c->bands / each * all + rest * band;
}

static status keep_normals(mesh_conversion *c, state_io *io) {
    const status st = STATE_IO(io, c->bands);
    return st == ST_OK && c->g->normals.count != normals_count(c) ? state_io_fault(io) : st;
}

static status keep_gradients(mesh_conversion *c, state_io *io) {
    if (mesh_options_make_normals(&c->o))
        return keep_normals(c, io);
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

static status keep_building(mesh_conversion *c, state_io *io) {
    status st = ST_OK;
    if (state_io_loads(io)) {
        c->goes_on = true;
        st = c->counted ? mesh_conversion_begin_batches(c) : state_io_fault(io);
        if (st == ST_OK)
            st = mesh_conversion_begin_writer(c);
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
    mesh_conversion *c = ctx;
    status st = convert_job_keep(c->o.job, io);
    if (st == ST_OK)
        st = keep_input(c, io);
    if (st == ST_OK && c->stage >= MESH_SORTING)
        st = keep_sorting(c, io);
    if (st == ST_OK && c->stage >= MESH_SORTED)
        st = keep_gradients(c, io);
    if (st == ST_OK && c->stage >= MESH_BUILDING)
        st = keep_building(c, io);
    return st == ST_OK ? state_io_end(io) : st;
}

/* Whether saving is worth it: several steps were read, or the mesh goes through scratch files. */
static bool is_kept(const mesh_conversion *c) {
    const mesh_gather *g = c->g;
    return c->o.work && (g->steps > 1 || c->plan.spill_bytes > 0 || !mesh_spool_held(&g->points) ||
                         !mesh_spool_held(&g->values) || !mesh_spool_held(&g->tets) ||
                         !mesh_spool_held(&g->normals));
}

/* Remove the file of tets once they are sorted. No state may need it. */
static void drop_tets(mesh_conversion *c) {
    if (!c->o.work || mesh_gather_keeps(c->g) || c->stage < MESH_SORTED || c->dropped)
        return;
    work_folder_drop(c->o.work, WORK_TETS);
    c->dropped = true;
}

/* Write what is in memory alone to the files of the work. */
static status store(mesh_conversion *c) {
    status st = mesh_gather_store(c->g);
    if (st == ST_OK)
        st = mesh_spool_store(&c->gradients);
    return st == ST_OK && c->runs ? mesh_runs_store(c->runs) : st;
}

/* The disk has no room for that, but may have for the output: go on without saving. */
static void give_up_saving(mesh_conversion *c) {
    c->unsaved = true;
    if (work_folder_states(c->o.work) > 0)
        return;
    mesh_gather_unstore(c->g);
    mesh_spool_unstore(&c->gradients);
    if (c->runs)
        mesh_runs_unstore(c->runs);
}

static status save_stored(mesh_conversion *c) {
    const uint64_t states = work_folder_states(c->o.work);
    out_file *files[WORK_FILES] = {0};
    mesh_gather_files(c->g, files);
    if (c->o.gradients)
        files[WORK_GRADIENTS] = mesh_spool_file(&c->gradients);
    files[WORK_RUNS] = c->runs ? mesh_runs_file(c->runs) : NULL;
    if (c->writer)
        leaf_writer_files(c->writer, files);
    status st = work_folder_save(c->o.work, files, c->share, keep, c);
    if (st == ST_OK && work_folder_states(c->o.work) > states)
        drop_tets(c);
    return st;
}

status mesh_conversion_save(mesh_conversion *c) {
    if (c->o.work && !work_folder_resumes(c->o.work))
        drop_tets(c);
    if (!is_kept(c) || c->unsaved || !work_folder_due(c->o.work))
        return ST_OK;
    status st = store(c);
    if (st == ST_NOSPACE) {
        give_up_saving(c);
        return ST_OK;
    }
    return st == ST_OK ? save_stored(c) : st;
}

status mesh_conversion_resume(mesh_conversion *c) {
    if (!c->o.work || !work_folder_resumes(c->o.work))
        return ST_OK;
    c->resumed = true;
    status st = work_folder_load(c->o.work, keep, c);
    if (st == ST_OK)
        drop_tets(c);
    return st;
}
