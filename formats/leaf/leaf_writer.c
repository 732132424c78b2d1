#include "formats/leaf/leaf_writer.h"

#include <assert.h>
#include <math.h>
#include <string.h>

#include "formats/leaf/curvilinear_geometry.h"
#include "formats/leaf/deviation.h"
#include "formats/leaf/hex_treelet.h"
#include "formats/leaf/leaf_check.h"
#include "formats/leaf/leaf_head.h"
#include "formats/leaf/leaf_writer_private.h"
#include "formats/leaf/mesh_layout.h"

/* Memory per treelet of the layout, per range, and per payload of the directory. */
enum {
    LAYOUT_BYTES = 3 * sizeof(uint32_t) + sizeof(uint32_t) + 1,
    RANGE_BYTES = 2 * sizeof(float[2]) + 1,
    PAYLOAD_BYTES = 3 * sizeof(uint64_t),
    SERIES_BYTES = 2 * sizeof(uint32_t) + sizeof(uint64_t), /* of several sets, too */
    MESH_BYTES = sizeof(float[6]) + sizeof(uint32_t[4])
};

uint64_t leaf_writer_memory(const leaf_layout *l, int threads, bool grow) {
    uint64_t bytes = sizeof(leaf_writer) + sizeof(histogram) + 4096;
    for (int a = 0; a < 3; a++)
        bytes += l->level[0].dims[a] * sizeof(double);
    if (l->sets > 1 || grow)
        bytes += l->sets * (sizeof(histogram) + sizeof(char[64]) + sizeof(double)) +
                 l->payloads * (uint64_t)SERIES_BYTES;
    return bytes + l->treelets * (uint64_t)LAYOUT_BYTES +
           l->payloads * (uint64_t)(RANGE_BYTES + PAYLOAD_BYTES) +
           leaf_writer_families_memory(l, threads, l->sets > 1 || grow);
}

static mesh_layout_blocks blocks_of(const leaf_mesh *mesh) {
    return (mesh_layout_blocks){.treelets = mesh->treelets,
                                .fields = mesh->fields,
                                .steps = mesh->steps,
                                .gradients = mesh->gradients,
                                .moving = mesh->moving};
}

uint64_t leaf_writer_mesh_memory(const leaf_mesh *mesh, size_t payload_max, bool grow) {
    const mesh_layout_blocks blocks = blocks_of(mesh);
    const uint64_t sets = (uint64_t)mesh->fields * mesh->steps;
    const uint64_t each = LAYOUT_BYTES + MESH_BYTES + sets * RANGE_BYTES +
                          (mesh->moving ? mesh->steps - 1 : 0) * sizeof(float[6]);
    return sizeof(leaf_writer) + 4096 + payload_max + mesh->treelets * each +
           mesh->fields * sizeof(char[64]) + mesh->steps * sizeof(double) +
           (mesh->coarse ? sets * sizeof(leaf_part) : 0) +
           (sets <= LEAF_HISTOGRAMS_MAX ? sets * sizeof(histogram) : 0) +
           mesh_layout_payloads(&blocks) *
               (PAYLOAD_BYTES + sizeof(uint64_t) + (sets > 1 || grow ? sizeof(uint32_t) : 0));
}

static status allocate_histograms(leaf_writer *w) {
    const uint32_t sets = w->layout.sets;
    if (!w->p.histograms || sets > LEAF_HISTOGRAMS_MAX)
        return ST_OK;
    w->histograms = mem_array(w->m, sets, sizeof *w->histograms);
    return w->histograms ? ST_OK : ST_NOMEM;
}

/* Allocate the directory. ranges: elements of RANGES, OWN and FLAGS. */
static status allocate(leaf_writer *w, size_t ranges) {
    const size_t payloads = w->layout.payloads;
    w->ranges = mem_array(w->m, ranges, sizeof *w->ranges);
    w->own = mem_array(w->m, ranges, sizeof *w->own);
    w->flags = mem_array(w->m, ranges, sizeof *w->flags);
    w->offsets = mem_array(w->m, payloads, sizeof *w->offsets);
    w->sizes = mem_array(w->m, payloads, sizeof *w->sizes);
    w->checksums = mem_array(w->m, payloads, sizeof *w->checksums);
    if (!w->ranges || !w->own || !w->flags || !w->offsets || !w->sizes || !w->checksums)
        return ST_NOMEM;
    return allocate_histograms(w);
}

/* Allocate the deviations, all zero. */
static status allocate_deviations(leaf_writer *w) {
    const size_t bricks = deviation_count(&w->layout);
    if (!w->p.deviations || bricks == 0)
        return ST_OK;
    w->deviations = mem_array(w->m, bricks, sizeof *w->deviations);
    return w->deviations ? ST_OK : ST_NOMEM;
}

/* Allocate what leads from the payloads of several sets to earlier ones. */
static status allocate_series(leaf_writer *w, bool hashed) {
    const size_t payloads = w->layout.payloads;
    if (w->layout.sets == 1 && !w->grow)
        return ST_OK;
    w->same = mem_array(w->m, payloads, sizeof *w->same);
    if (!hashed)
        return w->same ? ST_OK : ST_NOMEM;
    w->bases = mem_array(w->m, payloads, sizeof *w->bases);
    w->hashes = mem_array(w->m, payloads, sizeof *w->hashes);
    return w->same && w->bases && w->hashes ? ST_OK : ST_NOMEM;
}

/* Treelets without samples are never put. */
static void enter_bare(leaf_writer *w) {
    const leaf_layout *l = &w->layout;
    for (uint32_t p = 0; p < l->sets * l->treelets; p++)
        if (leaf_layout_is_bare(l, p % l->treelets)) {
            w->own[p][0] = INFINITY;
            w->own[p][1] = -INFINITY;
        }
}

static status allocate_axes(leaf_writer *w, const grid *g) {
    if (!grid_is_rectilinear(g))
        return ST_OK;
    size_t nodes = (size_t)g->dims[0] + g->dims[1] + g->dims[2];
    w->axes = mem_array(w->m, nodes, sizeof *w->axes);
    if (!w->axes)
        return ST_NOMEM;
    double *to = w->axes;
    for (int a = 0; a < 3; to += g->dims[a++])
        memcpy(to, g->axis[a], g->dims[a] * sizeof *to);
    return ST_OK;
}

static status allocate_mesh(leaf_writer *w) {
    const size_t steps = w->layout.places;
    w->bounds = mem_array(w->m, w->layout.treelets * steps, sizeof *w->bounds);
    w->counts = mem_array(w->m, w->layout.treelets, sizeof *w->counts);
    return w->bounds && w->counts ? ST_OK : ST_NOMEM;
}

static status copy_labels(leaf_writer *w, const leaf_sets *sets) {
    if (sets->names) {
        w->names = mem_array(w->m, sets->fields, sizeof *w->names);
        if (!w->names)
            return ST_NOMEM;
        for (uint32_t i = 0; i < sets->fields; i++)
            leaf_head_text(w->names[i], sizeof w->names[i], sets->names[i]);
    }
    if (sets->times) {
        w->times = mem_array(w->m, sets->steps, sizeof *w->times);
        if (!w->times)
            return ST_NOMEM;
        memcpy(w->times, sets->times, sets->steps * sizeof *w->times);
    }
    return ST_OK;
}

static status allocate_parts(leaf_writer *w, bool coarse) {
    if (coarse) {
        w->parts = mem_array(w->m, w->layout.sets, sizeof *w->parts);
        if (!w->parts)
            return ST_NOMEM;
    }
    return ST_OK;
}

/* The labels; of further steps, as the file has them. */
static status label(leaf_writer *w, const leaf_sets *sets) {
    const leaf_file *before = w->before;
    leaf_sets own = *sets;
    if (!before)
        return copy_labels(w, sets);
    w->names = mem_array(w->m, own.fields, sizeof *w->names);
    if (!w->names)
        return ST_NOMEM;
    for (uint32_t i = 0; i < own.fields; i++)
        leaf_head_text(w->names[i], sizeof w->names[i], before->names[i]);
    own.names = NULL;
    own.times = before->has_times ? sets->times : NULL;
    return copy_labels(w, &own);
}

static status create_out(leaf_writer *w, const leaf_target *to) {
    w->path = to->path;
    return to->work ? work_folder_file(to->work, WORK_OUTPUT, to->force, &w->out)
                    : out_file_create(w->m, to->path, to->force, &w->out);
}

/* Create the scratch file for payloads whose places are known only in the end. */
static status create_scratch(leaf_writer *w, const leaf_target *to) {
    w->scratch_at = mem_array(w->m, w->layout.payloads, sizeof *w->scratch_at);
    for (uint32_t p = 0; p < w->layout.payloads; p++)
        w->sizes[p] = UNKNOWN_SIZE;
    if (!w->scratch_at)
        return ST_NOMEM;
    return to->work ? work_folder_file(to->work, WORK_WAITING, true, &w->scratch)
                    : out_file_scratch(w->m, to->path, &w->scratch);
}

static leaf_writer *new_writer(mem *m, const leaf_parameters *p) {
    leaf_writer *w = mem_zalloc(m, sizeof *w);
    if (!w)
        return NULL;
    w->m = m;
    w->p = *p;
    (void)pthread_mutex_init(&w->lock, NULL); /* neither can fail on Linux */
    (void)pthread_cond_init(&w->changed, NULL);
    return w;
}

static status lay_out_grid(leaf_writer *w, const grid *g, const leaf_sets *sets) {
    status st = leaf_layout_init(&w->layout, w->m, g->dims, w->p.cells_log2, w->p.halo,
                                 sample_stored(g->type));
    if (st == ST_OK &&
        !leaf_layout_repeat(&w->layout, sets->fields, sets->steps, w->p.codec != LEAF_CODEC_RAW))
        st = status_describe(ST_UNSUPPORTED, "more than 2^32 - 2 payloads; use larger treelets");
    w->layout.outside = w->p.outside != NULL;
    if (w->p.bare)
        leaf_layout_bare(&w->layout);
    assert(!w->layout.outside || (w->layout.coded && w->layout.sets == 1));
    return st;
}

/* What is written becomes a segment of the target. */
static void take_target(leaf_writer *w, const leaf_target *to) {
    w->grow = to->grow;
    w->before = to->grow ? leaf_grow_before(to->grow) : NULL;
}

/* Make the header that of a segment. */
static void head_segment(leaf_writer *w) {
    leaf_header *h = &w->header;
    if (!w->grow)
        return;
    leaf_grow_head(w->grow, h);
    memcpy(h->field, w->before->header.field, sizeof h->field);
    w->frame = w->before->frame;
}

status leaf_writer_create(mem *m, const leaf_target *to, const grid *g, const leaf_sets *sets,
                          const leaf_parameters *p, leaf_writer **out) {
    static const leaf_sets one = {.fields = 1, .steps = 1};
    leaf_writer *w = new_writer(m, p);
    if (!w)
        return ST_NOMEM;
    sets = sets ? sets : &one;
    assert(sets->fields > 0 && sets->steps > 0);
    assert((uint64_t)sets->fields * sets->steps <= LEAF_SETS_MAX);
    take_target(w, to);
    status st = lay_out_grid(w, g, sets);
    if (st == ST_OK)
        st = allocate(w, (size_t)w->layout.sets * w->layout.treelets);
    if (st == ST_OK)
        enter_bare(w);
    if (st == ST_OK && (w->layout.sets > 1 || to->grows || to->grow))
        st = label(w, sets);
    if (st == ST_OK)
        st = allocate_series(w, true);
    if (st == ST_OK)
        st = allocate_deviations(w);
    if (st == ST_OK)
        st = allocate_axes(w, g);
    if (st == ST_OK)
        st = create_out(w, to);
    if (st != ST_OK) {
        leaf_writer_discard(w);
        return st;
    }
    w->header.segments = to->grows;
    leaf_head_grid(&w->header, &w->layout, p, g, sets);
    w->frame = g->frame;
    if (sets->time_unit)
        world_frame_set_time_unit(&w->frame, sets->time_unit);
    head_segment(w);
    leaf_writer_place_sections(w);
    w->order = leaf_order_begin(&w->layout);
    *out = w;
    return ST_OK;
}

/* ---- curvilinear grids ---- */

static status lay_out_curvilinear(leaf_layout *l, const leaf_curvilinear *g) {
    uint64_t treelets = 0;
    for (uint32_t z = 0; z < g->zones && treelets < LEAF_NO_TREELET; z++)
        treelets += curvilinear_zones_treelets(g->nodes[z], LEAF_NO_TREELET);
    return curvilinear_layout(l, treelets, g->sets.fields, g->sets.steps, g->moving)
               ? ST_OK
               : status_describe(ST_UNSUPPORTED, "more than 2^32 - 2 payloads");
}

status leaf_writer_curvilinear_memory(const leaf_curvilinear *g, bool grow, uint64_t *bytes) {
    leaf_layout l;
    const status st = lay_out_curvilinear(&l, g);
    if (st == ST_OK)
        *bytes = sizeof(leaf_writer) + 4096 +
                 l.treelets * (LAYOUT_BYTES + sizeof(uint32_t[4]) + l.sets * (uint64_t)RANGE_BYTES +
                               l.places * sizeof(float[6])) +
                 l.payloads *
                     (PAYLOAD_BYTES + sizeof(uint64_t) + (uint64_t)(l.sets > 1 || grow ? 4 : 0)) +
                 (l.sets <= LEAF_HISTOGRAMS_MAX ? l.sets * sizeof(histogram) : 0) +
                 g->zones * sizeof(uint32_t[4]) + g->sets.fields * sizeof(char[64]) +
                 g->sets.steps * sizeof(double) + (g->coarse ? l.sets * sizeof(leaf_part) : 0);
    return st;
}

typedef struct counting {
    uint32_t (*counts)[4], next;
} counting;

static void count_cells(void *ctx, const uint32_t first[3], const uint32_t cells[3]) {
    counting *c = ctx;
    (void)first;
    memcpy(c->counts[c->next++], cells, sizeof(uint32_t[3]));
}

static status allocate_zones(leaf_writer *w, const leaf_curvilinear *g) {
    w->zones = mem_array(w->m, g->zones, sizeof *w->zones);
    if (!w->zones)
        return ST_NOMEM;
    counting c = {w->counts, 0};
    for (uint32_t z = 0; z < g->zones; z++) {
        memcpy(w->zones[z], g->nodes[z], sizeof g->nodes[z]);
        curvilinear_zones_walk(g->nodes[z], count_cells, &c);
    }
    leaf_layout_set_counts(&w->layout, (const uint32_t(*)[4])w->counts);
    return ST_OK;
}

status leaf_writer_create_curvilinear(mem *m, const leaf_target *to, const leaf_curvilinear *g,
                                      const leaf_parameters *p, leaf_writer **out) {
    assert(g->zones > 0);
    leaf_writer *w = new_writer(m, p);
    if (!w)
        return ST_NOMEM;
    take_target(w, to);
    status st = lay_out_curvilinear(&w->layout, g);
    if (st == ST_OK)
        st = leaf_layout_init_flat(&w->layout, m);
    if (st == ST_OK)
        st = allocate(w, (size_t)w->layout.treelets * w->layout.sets);
    if (st == ST_OK)
        st = allocate_series(w, false);
    if (st == ST_OK)
        st = allocate_mesh(w);
    if (st == ST_OK)
        st = allocate_zones(w, g);
    if (st == ST_OK)
        st = label(w, &g->sets);
    if (st == ST_OK)
        st = allocate_parts(w, g->coarse);
    if (st == ST_OK)
        st = create_out(w, to);
    if (st == ST_OK)
        st = create_scratch(w, to);
    if (st != ST_OK) {
        leaf_writer_discard(w);
        return st;
    }
    w->header.segments = to->grows;
    leaf_head_curvilinear(&w->header, &w->layout, p, g);
    head_segment(w);
    leaf_writer_place_sections(w);
    w->order = leaf_order_begin(&w->layout);
    if (g->sets.time_unit && !to->grow)
        world_frame_set_time_unit(&w->frame, g->sets.time_unit);
    *out = w;
    return ST_OK;
}

/* ---- meshes ---- */

status leaf_writer_create_mesh(mem *m, const leaf_target *to, const leaf_mesh *mesh,
                               const leaf_parameters *p, leaf_writer **out) {
    const uint64_t sets = (uint64_t)mesh->fields * mesh->steps;
    const mesh_layout_blocks blocks = blocks_of(mesh);
    assert(mesh->treelets > 0 && sets > 0 && sets <= LEAF_SETS_MAX);
    assert(!mesh->names || strncmp(mesh->names[0], mesh->field, sizeof(char[63])) == 0);
    assert(mesh->treelet_tets > 0 && mesh->treelet_tets <= LEAF_TREELET_TETS_MAX);
    const leaf_geometry *g = leaf_geometry_of(mesh->kind);
    assert(g->noded || (mesh->leaf_tets > 0 && mesh->leaf_tets <= LEAF_LEAF_TETS_MAX));
    assert(!g->noded ||
           (mesh->treelet_tets <= g->noded->cells_max && mesh->leaf_tets == 0 && !mesh->gradients));
    if (mesh_layout_payloads(&blocks) >= LEAF_NO_TREELET)
        return status_describe(ST_UNSUPPORTED, "more than 2^32 - 2 payloads; use larger treelets");
    leaf_writer *w = new_writer(m, p);
    if (!w)
        return ST_NOMEM;
    take_target(w, to);
    if (g->noded)
        (void)leaf_layout_blocks(&w->layout, g, mesh->treelets, mesh->fields, mesh->steps,
                                 mesh->moving);
    else
        mesh_layout_of(&w->layout, &blocks);
    status st = leaf_layout_init_flat(&w->layout, m);
    if (st == ST_OK)
        st = allocate(w, mesh->treelets * sets);
    if (st == ST_OK)
        st = allocate_series(w, false);
    if (st == ST_OK)
        st = allocate_mesh(w);
    w->layout.counts = (const uint32_t(*)[4])w->counts;
    if (st == ST_OK)
        st = label(w, &(leaf_sets){mesh->fields, mesh->steps, mesh->names, mesh->times, NULL});
    if (st == ST_OK)
        st = allocate_parts(w, mesh->coarse);
    if (st == ST_OK)
        st = create_out(w, to);
    if (st == ST_OK)
        st = create_scratch(w, to);
    if (st != ST_OK) {
        leaf_writer_discard(w);
        return st;
    }
    w->header.segments = to->grows;
    leaf_head_mesh(&w->header, &w->layout, p, mesh);
    head_segment(w);
    leaf_writer_place_sections(w);
    w->order = leaf_order_begin(&w->layout);
    *out = w;
    return ST_OK;
}

/* ---- keeping ---- */

void leaf_writer_files(const leaf_writer *w, out_file *files[WORK_FILES]) {
    files[WORK_OUTPUT] = w->out;
    files[WORK_WAITING] = w->scratch;
}

static status keep_payloads(leaf_writer *w, state_io *io) {
    const leaf_layout *l = &w->layout;
    const size_t ranges = (size_t)l->treelets * l->sets, payloads = l->payloads;
    const struct {
        void *bytes;
        size_t size;
    } arrays[] = {
        {w->own, ranges * sizeof *w->own},
        {w->flags, ranges * sizeof *w->flags},
        {w->offsets, payloads * sizeof *w->offsets},
        {w->sizes, payloads * sizeof *w->sizes},
        {w->checksums, payloads * sizeof *w->checksums},
        {w->same, payloads * sizeof *w->same},
        {w->bases, payloads * sizeof *w->bases},
        {w->hashes, payloads * sizeof *w->hashes},
        {w->scratch_at, payloads * sizeof *w->scratch_at},
        {w->bounds, (size_t)l->treelets * l->places * sizeof *w->bounds},
        {w->counts, l->treelets * sizeof *w->counts},
        {w->histograms, l->sets * sizeof *w->histograms},
        {w->deviations, w->deviations ? deviation_count(l) * sizeof *w->deviations : 0},
    };
    status st = ST_OK;
    for (size_t i = 0; i < sizeof arrays / sizeof *arrays && st == ST_OK; i++)
        st = arrays[i].bytes ? state_io_bytes(io, arrays[i].bytes, arrays[i].size) : ST_OK;
    return st;
}

/* The end of what has been written in the file. A mesh's payloads may have a place there while they
 * wait in the scratch file. */
static uint64_t written_end(const leaf_writer *w) {
    uint64_t end = 0;
    if (!w->scratch)
        return w->next.end > leaf_writer_payloads_at(w) ? w->next.end : 0;
    for (uint32_t p = 0; p < w->layout.payloads; p++)
        if (w->scratch_at[p] == NOT_THERE && w->sizes[p] != UNKNOWN_SIZE && w->sizes[p] > 0 &&
            w->offsets[p] + w->sizes[p] > end)
            end = w->offsets[p] + w->sizes[p];
    return end;
}

status leaf_writer_keep(leaf_writer *w, state_io *io) {
    assert(!w->waiting && !w->settled);
    status st = keep_payloads(w, io);
    if (st == ST_OK)
        st = STATE_IO(io, w->order);
    if (st == ST_OK)
        st = STATE_IO(io, w->next);
    if (st == ST_OK)
        st = STATE_IO(io, w->scratch_end);
    if (st != ST_OK || !state_io_loads(io))
        return st;
    if (w->order.p > w->layout.payloads || w->order.set > w->layout.sets ||
        out_file_size(w->out) < written_end(w) ||
        (w->scratch && out_file_size(w->scratch) < w->scratch_end))
        return state_io_fault(io);
    st = out_file_cut(w->out, w->next.end);
    return st == ST_OK && w->scratch ? out_file_cut(w->scratch, w->scratch_end) : st;
}

void leaf_writer_discard(leaf_writer *w) {
    if (!w)
        return;
    out_file_discard(w->out);
    out_file_discard(w->scratch);
    leaf_layout_release(&w->layout);
    mem_free(w->m, w->ranges);
    mem_free(w->m, w->own);
    mem_free(w->m, w->flags);
    mem_free(w->m, w->offsets);
    mem_free(w->m, w->sizes);
    mem_free(w->m, w->checksums);
    mem_free(w->m, w->same);
    mem_free(w->m, w->bases);
    mem_free(w->m, w->hashes);
    mem_free(w->m, w->scratch_at);
    mem_free(w->m, w->copy_buffer);
    mem_free(w->m, w->axes);
    mem_free(w->m, w->bounds);
    mem_free(w->m, w->counts);
    mem_free(w->m, w->zones);
    mem_free(w->m, w->names);
    mem_free(w->m, w->times);
    mem_free(w->m, w->parts);
    mem_free(w->m, w->histograms);
    mem_free(w->m, w->deviations);
    leaf_writer_free_families(w);
    (void)pthread_cond_destroy(&w->changed);
    (void)pthread_mutex_destroy(&w->lock);
    mem_free(w->m, w);
}

const leaf_layout *leaf_writer_layout(const leaf_writer *w) {
    return &w->layout;
}

histogram *leaf_writer_histograms(leaf_writer *w) {
    return w->histograms;
}

uint16_t *leaf_writer_deviations(leaf_writer *w) {
    return w->deviations;
}

void leaf_writer_range(const leaf_writer *w, uint32_t set, double range[2]) {
    const leaf_layout *l = &w->layout;
    const float(*own)[2] = (const float(*)[2])w->own + (size_t)set * l->treelets;
    range[0] = (double)INFINITY;
    range[1] = -(double)INFINITY;
    for (uint32_t t = 0; t < l->treelets; t++) {
        if (l->level_of[t] != 0)
            continue;
        range[0] = fmin(range[0], (double)own[t][0]);
        range[1] = fmax(range[1], (double)own[t][1]);
    }
}
