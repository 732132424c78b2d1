#include "prep/mesh/mesh_plan.h"

#include "formats/mesh/mesh_coder.h"
#include "prep/mesh/mesh_earlier.h"
#include "prep/mesh/mesh_histogram.h"
#include "prep/mesh/mesh_keys.h"
#include "prep/mesh/mesh_pages.h"
#include "prep/mesh/mesh_sah.h"
#include "prep/mesh/mesh_treelet.h"

/* Memory not counted elsewhere: the thread pool, touched parts of stacks, rounding of blocks. */
enum { FIXED_BYTES = 512 << 10, THREAD_BYTES = 64 << 10 };

/* Input of a plan. */
typedef struct needs {
    const mesh_options *o;
    const mesh_gather *g;
    uint64_t packer;   /* bytes of a packer, outside of mem */
    uint64_t others;   /* bytes in use that are not gathered data */
    uint64_t treelets; /* estimated */
} needs;

/* What is spilled before all else. */
typedef enum spilling { SPILL_NOTHING, SPILL_TETS, SPILL_ALL, SPILLINGS } spilling;

static uint64_t larger(uint64_t a, uint64_t b) {
    return a > b ? a : b;
}

static uint64_t room_above(uint64_t budget, uint64_t used) {
    return budget > used ? budget - used : 0;
}

static uint64_t chunk_bytes(const mesh_spool *s) {
    return ((uint64_t)1 << MESH_SPOOL_LOG2) * s->element + 128;
}

static uint64_t held_bytes(const mesh_spool *s) {
    return s->chunk_count * chunk_bytes(s) + s->chunk_room * sizeof *s->chunks + 128;
}

/* Those of the file. */
static uint64_t normals_held(const mesh_gather *g) {
    return g->normals.count > 0 ? held_bytes(&g->normals) : 0;
}

/* Bytes of a spool that will be filled. In a file it has a buffer. */
static uint64_t filled_bytes(const mesh_spool *s, bool held) {
    const uint64_t chunks = held ? (s->count >> MESH_SPOOL_LOG2) + 1 : 1;
    return chunks * (chunk_bytes(s) + 4 * sizeof *s->chunks) + 4096;
}

/* ---- needs of the stages besides points, tets, runs and windows ---- */

static uint64_t keys_fixed(const needs *n) {
    return n->others + mesh_keys_memory(n->g->vertices, n->g->corners, n->o->threads) +
           mesh_sort_memory(n->o->threads);
}

static uint64_t writer_memory(const mesh_options *o, const mesh_gather *g, uint64_t treelets) {
    const leaf_mesh parts = {.treelets = (uint32_t)treelets,
                             .fields = g->fields,
                             .steps = g->steps,
                             .gradients = o->gradients,
                             .moving = g->moving};
    const size_t most = o->cells ? o->cells->most(o->treelet_tets).topology_bytes
                                 : mesh_treelet_payload_max(o->treelet_tets, o->leaf_tets);
    return leaf_writer_mesh_memory(&parts, most, o->grow != NULL);
}

/* Of cells as they are, with the ids of those of a treelet. */
static uint64_t cells_fixed(const needs *n) {
    const mesh_options *o = n->o;
    uint64_t thread = cell_builder_memory(o->cells, o->treelet_tets) +
                      o->treelet_tets * sizeof(uint32_t[CELL_ROW]) + n->packer + 512;
    if (o->grow)
        thread += mesh_earlier_memory(leaf_grow_before(o->grow));
    if (o->file.codec != LEAF_CODEC_RAW)
        thread += o->cells->most(o->treelet_tets).topology_bytes + 128;
    return n->others + writer_memory(o, n->g, n->treelets) + (uint64_t)o->threads * thread +
           (o->file.histograms ? mesh_histogram_memory() : 0);
}

static uint64_t build_fixed(const needs *n) {
    const mesh_options *o = n->o;
    if (o->cells)
        return cells_fixed(n);
    uint64_t thread = mesh_treelet_memory(o->treelet_tets, o->leaf_tets) + n->packer + 256;
    if (o->sah)
        thread += mesh_sah_memory(o->treelet_tets);
    if (o->grow)
        thread += mesh_earlier_memory(leaf_grow_before(o->grow));
    if (n->g->moving)
        thread += mesh_treelet_moved_memory(o->treelet_tets, o->leaf_tets);
    if (o->file.codec != LEAF_CODEC_RAW)
        thread += mesh_treelet_payload_max(o->treelet_tets, o->leaf_tets) + 128;
    return n->others + writer_memory(o, n->g, n->treelets) + (uint64_t)o->threads * thread +
           (o->file.histograms ? mesh_histogram_memory() : 0);
}

/* ---- choosing ---- */

/* The spool of gradients, or of normals, as large as it will be. */
static mesh_spool gradients_of(const needs *n) {
    const mesh_options *o = n->o;
    if (mesh_options_make_normals(n->o))
        return (mesh_spool){.element = sizeof(uint32_t), .count = n->g->points.count};
    if (n->g->normals.count > 0)
        return n->g->normals;
    return (mesh_spool){.element = sizeof(float[3]),
                        .count = o->gradients ? n->g->values.count : 0};
}

/* Plan the gradients, which are computed between sorting and building. plan->memory may grow. base:
 * bytes held besides. */
static void choose_gradients(const needs *n, bool paged, uint64_t base, uint64_t budget,
                             mesh_plan *plan) {
    const mesh_gather *g = n->g;
    const int threads = n->o->threads;
    const mesh_spool gradients = gradients_of(n);
    if (!n->o->gradients && !mesh_options_make_normals(n->o))
        return;
    base += filled_bytes(&gradients, !paged);
    plan->spill_gradients = paged;
    plan->spill_bytes += paged ? gradients.count * gradients.element : 0;
    if (mesh_options_make_normals(n->o)) {
        plan->normals =
            mesh_normals_plan_make(&g->points, g->vertices, paged, room_above(budget, base));
        plan->memory = larger(plan->memory, base + mesh_normals_memory(&plan->normals));
        return;
    }
    plan->gradients = mesh_gradients_plan_make(&g->points, &g->values, g->vertices, paged, threads,
                                               room_above(budget, base));
    plan->memory = larger(plan->memory, base + mesh_gradients_memory(&plan->gradients, threads));
}

/* Make the best plan for this spilling within the budget, or the smallest one: plan->memory
 * tells. */
static void choose(const needs *n, spilling how, uint64_t budget, mesh_plan *plan) {
    const mesh_gather *g = n->g;
    const uint64_t threads = (uint64_t)n->o->threads, count = g->tets.count;
    *plan = (mesh_plan){.spill_tets = how >= SPILL_TETS,
                        .spill_points = how == SPILL_ALL,
                        .treelets = n->treelets,
                        .threads = n->o->threads};
    const bool paged = how == SPILL_ALL || !mesh_spool_held(&g->points) ||
                       !mesh_spool_held(&g->values) || !mesh_spool_held(&g->normals);
    const uint64_t tets = how >= SPILL_TETS ? 0 : held_bytes(&g->tets);
    const uint64_t points =
        how == SPILL_ALL ? 0 : held_bytes(&g->points) + held_bytes(&g->values) + normals_held(g);
    const uint64_t least_points = paged ? mesh_pages_least(&g->points) : 0,
                   least_values = paged ? mesh_pages_least(&g->values) : 0;
    const mesh_spool gradients = gradients_of(n);
    const bool any = gradients.count > 0;
    const uint64_t least_gradients = any && paged ? mesh_pages_least(&gradients) : 0;
    const bool kept = mesh_gather_keeps(g),
               cells_paged = how >= SPILL_TETS || !mesh_spool_held(&g->tets);
    const uint64_t least_cells = kept && cells_paged ? mesh_pages_least(&g->tets) : 0;
    const uint64_t keys = keys_fixed(n) + points,
                   build = build_fixed(n) + points + (kept ? tets : 0) +
                           (any && !paged && g->normals.count == 0 ? filled_bytes(&gradients, true)
                                                                   : 0);
    const uint64_t keys_least = keys + threads * least_points,
                   build_least = build + threads * (least_points + least_values + least_gradients +
                                                    least_cells);
    /* Wide windows are worth as much as long runs: share equally. */
    const uint64_t share = paged || least_cells ? 2 : 1;
    plan->runs = mesh_runs_plan_make(count, (uint64_t)n->o->treelet_tets + 1,
                                     room_above(budget, keys_least) / share,
                                     room_above(budget, build_least) / share);
    const uint64_t keys_all =
        keys + larger(tets + mesh_runs_filling(&plan->runs),
                      (plan->runs.block ? tets : 0) + mesh_runs_sorting(&plan->runs));
    const uint64_t build_all = build + mesh_runs_merging(&plan->runs, count);
    if (paged) {
        /* Shares as the elements are: 3 for points and gradients, 1 for values and normals. */
        const uint64_t wide = gradients.element / sizeof(float);
        const uint64_t each = room_above(budget, build_all) / threads /
                              (any           ? 4 + wide
                               : least_cells ? 8
                                             : 4);
        plan->keys_window = mesh_pages_memory(
            &g->points, larger(room_above(budget, keys_all) / threads, least_points));
        plan->points_window = mesh_pages_memory(&g->points, larger(3 * each, least_points));
        plan->values_window = mesh_pages_memory(&g->values, larger(each, least_values));
        if (any)
            plan->gradients_window =
                mesh_pages_memory(&gradients, larger(wide * each, least_gradients));
    }
    if (least_cells) {
        const uint64_t each = room_above(budget, build_all) / threads / 8;
        plan->cells_window = mesh_pages_memory(&g->tets, larger(3 * each, least_cells));
    }
    plan->build_memory = build_all + threads * (plan->points_window + plan->values_window +
                                                plan->gradients_window + plan->cells_window);
    plan->memory = larger(keys_all + threads * plan->keys_window, plan->build_memory);
    plan->spill_bytes =
        mesh_runs_spill(&plan->runs, count) + (tets ? 0 : count * g->tets.element) +
        (paged ? g->points.count * g->points.element + g->values.count * g->values.element +
                     g->normals.count * g->normals.element
               : 0);
    choose_gradients(n, paged, n->others + points + mesh_runs_merging(&plan->runs, count), budget,
                     plan);
}

static status needs_of(mem *m, const mesh_gather *g, const mesh_options *o, needs *n) {
    const uint64_t held = g->counted ? 0
                                     : held_bytes(&g->points) + held_bytes(&g->values) +
                                           held_bytes(&g->tets) + normals_held(g);
    *n = (needs){.o = o, .g = g};
    n->others = FIXED_BYTES + (uint64_t)o->threads * THREAD_BYTES + room_above(mem_used(m), held) +
                (o->work ? state_io_memory() : 0);
    /* On average treelets are 70 % full, and less if much of a mesh is sparse. */
    n->treelets = 3 * (g->tets.count / o->treelet_tets) + 64;
    if (n->treelets > g->tets.count)
        n->treelets = g->tets.count;
    uint32_t counts[4];
    if (o->cells)
        return leaf_packer_memory(m, NULL, o->cells->coder, o->cells->most(o->treelet_tets).counts,
                                  &o->file, &n->packer);
    mesh_treelet_counts_max(o->treelet_tets, o->leaf_tets, counts);
    return leaf_packer_memory(m, NULL, &mesh_coder, counts, &o->file, &n->packer);
}

status mesh_plan_refuse(const mesh_options *o, uint64_t least) {
    return status_describe(
        ST_NOMEM,
        "a memory budget of %llu MiB is too small: this mesh needs %llu MiB with %d threads",
        (unsigned long long)(o->memory >> 20), (unsigned long long)((least >> 20) + 1), o->threads);
}

static uint64_t least_of(const needs *n) {
    uint64_t least = UINT64_MAX;
    for (spilling how = SPILL_NOTHING; how < SPILLINGS; how++) {
        mesh_plan plan;
        choose(n, how, 0, &plan);
        least = plan.memory < least ? plan.memory : least;
    }
    return least;
}

status mesh_plan_least(mem *m, const mesh_options *o, uint64_t *least) {
    mesh_gather g;
    mesh_gather_init(&g, m, "", 0, NULL);
    if (o->cells)
        mesh_gather_cells(&g, o->cells->corners);
    g.takes_normals = mesh_options_take_normals(o);
    g.points.count = g.values.count = g.vertices = 4;
    g.tets.count = 1;
    needs n;
    status st = needs_of(m, &g, o, &n);
    if (st == ST_OK)
        *least =
            larger(least_of(&n),
                   n.others + mesh_gather_least(&g, o->series ? o->series->of.sets.fields : 1));
    return st;
}

status mesh_plan_make(mem *m, const mesh_gather *g, const mesh_options *o, mesh_plan *plan) {
    needs n;
    status st = needs_of(m, g, o, &n);
    if (st != ST_OK)
        return st;
    const uint64_t least = least_of(&n);
    for (spilling how = SPILL_NOTHING; how < SPILLINGS; how++) {
        choose(&n, how, o->memory, plan);
        plan->memory_least = least;
        /* If runs are merged, tets in memory take room that longer runs could have. */
        const bool wasteful = how == SPILL_NOTHING && plan->runs.block && mesh_spool_held(&g->tets);
        if (plan->memory <= o->memory && !wasteful)
            return ST_OK;
    }
    return mesh_plan_refuse(o, least);
}

status mesh_plan_settle(const mesh_options *o, const mesh_gather *g, mesh_plan *plan,
                        uint64_t treelets) {
    const uint64_t expected = plan->treelets;
    plan->treelets = treelets;
    if (treelets <= expected)
        return ST_OK;
    const uint64_t more = writer_memory(o, g, treelets) - writer_memory(o, g, expected);
    if (plan->build_memory + more > o->memory)
        return mesh_plan_refuse(o, larger(plan->memory_least, plan->build_memory) + more);
    plan->build_memory += more;
    plan->memory = larger(plan->memory, plan->build_memory);
    return ST_OK;
}

/* Whether sizes that were loaded can be those of a plan. */
static bool makes_sense(const mesh_plan *plan, const mesh_options *o) {
    const mesh_runs_plan *r = &plan->runs;
    return r->run > 0 && (!r->block || r->window > o->treelet_tets) &&
           (!o->gradients || plan->gradients.band > 0) &&
           (!mesh_options_make_normals(o) || plan->normals.band > 0) && plan->threads > 0 &&
           plan->treelets > 0 && plan->treelets < UINT32_MAX;
}

status mesh_plan_keep(mesh_plan *plan, const mesh_options *o, state_io *io) {
    status st = STATE_IO(io, *plan);
    if (st != ST_OK || !state_io_loads(io))
        return st;
    if (!makes_sense(plan, o))
        return state_io_fault(io);
    return plan->memory <= o->memory ? ST_OK : mesh_plan_refuse(o, plan->memory);
}
