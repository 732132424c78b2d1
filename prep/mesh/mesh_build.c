#include "prep/mesh/mesh_build.h"

#include <string.h>

#include "formats/mesh/mesh_coder.h"
#include "prep/mesh/mesh_earlier.h"
#include "prep/mesh/mesh_histogram.h"
#include "prep/mesh/mesh_sah.h"
#include "prep/mesh/mesh_treelet.h"

/* Tets by the sign of their volume. */
typedef struct signs {
    uint64_t flat, positive, negative;
} signs;

/* Buffers and counts of one thread. */
typedef struct bench {
    mesh_treelet_builder *builder; /* or, of cells as they are: */
    cell_builder *of_cells;
    mesh_pages input;                     /* cells, as they were gathered, if these are kept */
    uint32_t (*cells)[CELL_ROW];          /* of the treelet */
    mesh_sah *sah;                        /* NULL: trees by keys */
    mesh_earlier earlier;                 /* if the output is added to */
    mesh_pages points, values, gradients; /* gradients: or normals of a surface */
    leaf_packer *packer;
    void *pack;
    signs seen;
} bench;

struct mesh_build {
    mem *m;
    pool *workers;
    mesh_build_input in;
    leaf_writer *writer;
    int threads;
    bench *benches;
    signs before; /* those of an earlier run */
    mesh_histogram histogram;
    /* The current work: */
    const mesh_batches *batch;
    uint32_t first_step, end_step;
};

/* ---- making and releasing ---- */

/* A packer, and room for what it makes of a payload. */
static status create_packer(const mesh_build *b, bench *k, const leaf_coder *coder,
                            const uint32_t counts[4], size_t payload_max) {
    const status st = leaf_packer_create(b->m, leaf_writer_layout(b->writer), coder, counts,
                                         &b->in.o->file, &k->packer);
    if (st != ST_OK || !k->packer)
        return st;
    k->pack = mem_alloc(b->m, payload_max);
    return k->pack ? ST_OK : ST_NOMEM;
}

/* Of tets: the builder, and what options ask for. */
static status create_tets(const mesh_build *b, bench *k, const uint32_t counts[4]) {
    const mesh_options *o = b->in.o;
    const mesh_plan *plan = b->in.plan;
    status st = mesh_treelet_create(b->m, o->treelet_tets, o->leaf_tets, &k->builder);
    if (st == ST_OK && o->sah)
        st = mesh_sah_create(b->m, o->treelet_tets, o->leaf_tets, &k->sah);
    if (st == ST_OK && o->gradients)
        st = mesh_pages_init(&k->gradients, b->in.gradients, plan->gradients_window);
    if (st == ST_OK)
        st = create_packer(b, k, &mesh_coder, counts,
                           mesh_treelet_payload_max(o->treelet_tets, o->leaf_tets));
    return st;
}

static status create_cells(const mesh_build *b, bench *k) {
    const cell_treelets *row = b->in.o->cells;
    const uint32_t most = b->in.o->treelet_tets;
    const cell_treelet_most largest = row->most(most);
    status st = cell_builder_create(row, b->m, most, &k->of_cells);
    if (st == ST_OK && mesh_gather_keeps(b->in.g))
        st = mesh_pages_init(&k->input, &b->in.g->tets, b->in.plan->cells_window);
    if (st == ST_OK)
        st = create_packer(b, k, row->coder, largest.counts, largest.topology_bytes);
    if (st == ST_OK && b->in.g->normals.count > 0) {
        st = mesh_pages_init(&k->gradients, &b->in.g->normals, b->in.plan->gradients_window);
        k->of_cells->normals = &k->gradients;
    }
    k->cells = mem_array(b->m, most, sizeof *k->cells);
    return st == ST_OK && !k->cells ? ST_NOMEM : st;
}

static status create_bench(const mesh_build *b, bench *k, const uint32_t counts[4]) {
    const mesh_plan *plan = b->in.plan;
    const leaf_grow *grow = b->in.o->grow;
    status st = b->in.o->cells ? create_cells(b, k) : create_tets(b, k, counts);
    if (st == ST_OK && grow)
        st = mesh_earlier_init(&k->earlier, b->m, leaf_grow_before(grow));
    if (st == ST_OK)
        st = mesh_pages_init(&k->points, &b->in.g->points, plan->points_window);
    if (st == ST_OK)
        st = mesh_pages_init(&k->values, &b->in.g->values, plan->values_window);
    return st;
}

static status create_benches(mesh_build *b) {
    uint32_t counts[4];
    mesh_treelet_counts_max(b->in.o->treelet_tets, b->in.o->leaf_tets, counts);
    b->benches = mem_array(b->m, (size_t)b->threads, sizeof *b->benches);
    status st = b->benches ? ST_OK : ST_NOMEM;
    for (int i = 0; i < b->threads && st == ST_OK; i++)
        st = create_bench(b, &b->benches[i], counts);
    return st;
}

status mesh_build_create(mem *m, pool *workers, const mesh_build_input *in, leaf_writer *w,
                         mesh_build **out) {
    mesh_build *b = mem_zalloc(m, sizeof *b);
    if (!b)
        return ST_NOMEM;
    b->m = m;
    b->workers = workers;
    b->in = *in;
    b->writer = w;
    b->threads = pool_threads(workers);
    status st = create_benches(b);
    if (st == ST_OK && leaf_writer_histograms(w))
        st = mesh_histogram_begin(&b->histogram, m, in->tets, in->g->fields * in->g->steps);
    if (st != ST_OK) {
        mesh_build_destroy(b);
        return st;
    }
    *out = b;
    return ST_OK;
}

void mesh_build_destroy(mesh_build *b) {
    if (!b)
        return;
    for (int i = 0; b->benches && i < b->threads; i++) {
        bench *k = &b->benches[i];
        mesh_treelet_destroy(k->builder);
        cell_builder_destroy(k->of_cells);
        mesh_pages_release(&k->input);
        mem_free(b->m, k->cells);
        mesh_sah_destroy(k->sah);
        mesh_earlier_release(&k->earlier);
        mesh_pages_release(&k->points);
        mesh_pages_release(&k->values);
        mesh_pages_release(&k->gradients);
        if (k->packer)
            leaf_packer_destroy(b->m, k->packer);
        mem_free(b->m, k->pack);
    }
    mem_free(b->m, b->benches);
    mesh_histogram_release(&b->histogram);
    mem_free(b->m, b);
}

/* ---- one treelet ---- */

/* The input of one treelet. */
typedef struct piece {
    uint32_t treelet;
    uint64_t first_tet;
    const mesh_record *records;
    size_t count;
} piece;

/* k->values must be those of the set. */
static status take_histogram(const mesh_build *b, bench *k, const piece *p, uint32_t step,
                             uint32_t set) {
    k->points.first = mesh_gather_points(b->in.g, step);
    return mesh_histogram_take(&b->histogram, set, p->first_tet, p->records, p->count, &k->points,
                               &k->values);
}

/* Put the topology, or see that it is the one of the file that is added to. */
static status put_topology(const mesh_build *b, bench *k, uint32_t treelet, const float bounds[6],
                           const mesh_earlier_built *t) {
    if (!b->in.o->grow)
        return leaf_writer_put_topology(b->writer, k->packer, treelet, bounds, t->counts,
                                        t->topology, k->pack);
    const status st = mesh_earlier_compare(&k->earlier, b->in.g->first_name, treelet, t);
    if (st == ST_OK)
        leaf_writer_keep_topology(b->writer, treelet);
    return st;
}

/* Build the topology, and the first field at the first step. */
static status build_first(const mesh_build *b, bench *k, const piece *p, mesh_treelet *t) {
    const uint32_t treelet = p->treelet;
    k->points.first = k->values.first = 0;
    status st = mesh_treelet_build(k->builder, p->records, p->count, &k->points, &k->values, t);
    if (st != ST_OK)
        return st;
    k->seen.flat += t->flat;
    k->seen.positive += t->positive;
    k->seen.negative += t->negative;
    st = put_topology(b, k, treelet, t->bounds,
                      &(mesh_earlier_built){t->counts, t->topology, k->builder});
    if (st == ST_OK)
        st =
            leaf_writer_put_values(b->writer, k->packer, 0, treelet, &t->entry, t->values, k->pack);
    return st == ST_OK ? take_histogram(b, k, p, 0, 0) : st;
}

static status build_values(const mesh_build *b, bench *k, const piece *p, uint32_t step,
                           uint32_t field, mesh_treelet *t) {
    k->values.first = mesh_gather_values(b->in.g, step, field);
    status st = mesh_treelet_revalue(k->builder, &k->values, t);
    if (st != ST_OK)
        return st;
    const uint32_t set = leaf_layout_set(leaf_writer_layout(b->writer), field, step);
    st = leaf_writer_put_values(b->writer, k->packer, set, p->treelet, &t->entry, t->values,
                                k->pack);
    return st == ST_OK ? take_histogram(b, k, p, step, set) : st;
}

static status build_positions(const mesh_build *b, bench *k, uint32_t treelet, uint32_t step,
                              mesh_treelet *t) {
    k->points.first = mesh_gather_points(b->in.g, step);
    status st = mesh_treelet_move(k->builder, &k->points, t);
    return st == ST_OK ? leaf_writer_put_positions(b->writer, k->packer, step, treelet,
                                                   t->moved_bounds, t->positions, k->pack)
                       : st;
}

/* Store the gradients of all sets. Do this last: it overwrites the topology. */
static status put_gradients(const mesh_build *b, bench *k, uint32_t treelet,
                            const mesh_treelet *t) {
    status st = ST_OK;
    for (uint32_t step = b->first_step; step < b->end_step; step++) {
        for (uint32_t field = 0; st == ST_OK && field < b->in.g->fields; field++) {
            const uint32_t set = leaf_layout_set(leaf_writer_layout(b->writer), field, step);
            const void *payload = NULL;
            k->gradients.first = mesh_gather_values(b->in.g, step, field);
            st = mesh_treelet_gradients(k->builder, t, &k->gradients, &payload);
            if (st == ST_OK)
                st =
                    leaf_writer_put_gradients(b->writer, k->packer, set, treelet, payload, k->pack);
        }
    }
    return st;
}

/* ---- one treelet of cells as they are ---- */

static void take_triangles(bench *k, const mesh_record *records, size_t count) {
    for (size_t i = 0; i < count; i++)
        for (int c = 0; c < CELL_ROW; c++)
            k->cells[i][c] = records[i].id[c < 3 ? c : 2];
}

/* Ids are looked at again: an earlier run may have left the file that they are in. */
static status fetch_cells(const mesh_build *b, bench *k, const mesh_record *records, size_t count) {
    if (!mesh_gather_keeps(b->in.g)) {
        take_triangles(k, records, count);
        return ST_OK;
    }
    for (size_t i = 0; i < count; i++) {
        const void *ids = mesh_pages_at(&k->input, mesh_record_cell(&records[i]));
        if (!ids)
            return k->input.st;
        memcpy(k->cells[i], ids, sizeof k->cells[i]);
        for (int c = 0; c < CELL_ROW; c++)
            if (k->cells[i][c] >= b->in.g->vertices)
                return mesh_batches_fault();
    }
    return ST_OK;
}

static status place_cells(const mesh_build *b, bench *k, uint32_t treelet, uint32_t step,
                          cell_treelet *t) {
    k->points.first = mesh_gather_points(b->in.g, step);
    k->gradients.first = mesh_gather_normals(b->in.g, step);
    const status st = b->in.o->cells->place(k->of_cells, &k->points, step, t);
    if (st != ST_OK)
        return st;
    if (step > 0)
        return leaf_writer_put_positions(b->writer, k->packer, step, treelet, t->bounds,
                                         t->positions, k->pack);
    k->seen.flat += t->folded;
    return put_topology(b, k, treelet, t->bounds,
                        &(mesh_earlier_built){t->counts, t->topology, NULL});
}

static status value_cells(const mesh_build *b, bench *k, const piece *p, uint32_t step,
                          uint32_t field, cell_treelet *t) {
    const cell_treelets *row = b->in.o->cells;
    const uint32_t set = leaf_layout_set(leaf_writer_layout(b->writer), field, step);
    k->points.first = mesh_gather_points(b->in.g, step);
    k->values.first = mesh_gather_values(b->in.g, step, field);
    status st = row->value(k->of_cells, &k->values, t);
    if (st == ST_OK)
        st = leaf_writer_put_values(b->writer, k->packer, set, p->treelet, &t->entry, t->values,
                                    k->pack);
    return st == ST_OK && row->histograms
               ? mesh_histogram_take_cells(&b->histogram, set, p->first_tet,
                                           (const uint32_t(*)[CELL_ROW])k->cells, p->count,
                                           &k->points, &k->values)
               : st;
}

static status build_cells(const mesh_build *b, bench *k, const piece *p) {
    const cell_treelets *row = b->in.o->cells;
    cell_treelet t;
    status st = fetch_cells(b, k, p->records, p->count);
    if (st != ST_OK)
        return st;
    row->begin(k->of_cells, (const uint32_t(*)[CELL_ROW])k->cells, p->count, &t);
    if (t.counts[1] < row->nodes_least)
        return mesh_batches_fault();
    for (uint32_t step = b->first_step; step < b->end_step && st == ST_OK; step++) {
        if (step == 0 || b->in.g->moving)
            st = place_cells(b, k, p->treelet, step, &t);
        for (uint32_t field = 0; st == ST_OK && field < b->in.g->fields; field++)
            st = value_cells(b, k, p, step, field, &t);
    }
    return st;
}

static status build_one(void *ctx, size_t index, int worker) {
    const mesh_build *b = ctx;
    bench *k = &b->benches[worker];
    const size_t first = b->batch->first[index], count = b->batch->first[index + 1] - first;
    const mesh_record *records = b->batch->records + first;
    const uint32_t treelet = b->batch->treelet + (uint32_t)index;
    piece p = {.treelet = treelet, .first_tet = b->batch->tet + first, .count = count};
    mesh_treelet t;
    status st = ST_OK;
    k->points.first = 0;
    if (k->sah)
        st = mesh_sah_order(k->sah, records, count, &k->points, &records);
    if (st != ST_OK)
        return st;
    p.records = records;
    if (k->of_cells)
        return build_cells(b, k, &p);
    if (b->first_step == 0)
        st = build_first(b, k, &p, &t);
    else
        mesh_treelet_begin(k->builder, records, count, &t);
    for (uint32_t step = b->first_step; step < b->end_step; step++) {
        for (uint32_t field = step ? 0 : 1; st == ST_OK && field < b->in.g->fields; field++)
            st = build_values(b, k, &p, step, field, &t);
        if (st == ST_OK && step > 0 && b->in.g->moving)
            st = build_positions(b, k, treelet, step, &t);
    }
    return st == ST_OK && b->in.o->gradients ? put_gradients(b, k, treelet, &t) : st;
}

/* ---- all of them ---- */

status mesh_build_take(mesh_build *b, const mesh_batches *batch, uint32_t first_step,
                       uint32_t end_step) {
    b->batch = batch;
    b->first_step = first_step;
    b->end_step = end_step;
    return pool_run(b->workers, batch->count, build_one, b);
}

static signs sum_up(const mesh_build *b) {
    signs all = b->before;
    for (int i = 0; i < b->threads; i++) {
        all.flat += b->benches[i].seen.flat;
        all.positive += b->benches[i].seen.positive;
        all.negative += b->benches[i].seen.negative;
    }
    return all;
}

void mesh_build_end(const mesh_build *b, leaf_facts *facts) {
    const signs all = sum_up(b);
    facts->flat = all.flat;
    /* Formats disagree about orientation. The majority of the tets decides. */
    facts->inverted = all.positive < all.negative ? all.positive : all.negative;
    mesh_histogram_end(&b->histogram, b->writer);
}

status mesh_build_keep(mesh_build *b, state_io *io) {
    signs all = sum_up(b);
    status st = STATE_IO(io, all);
    if (st == ST_OK && state_io_loads(io))
        b->before = all;
    return st == ST_OK ? mesh_histogram_keep(&b->histogram, io) : st;
}
