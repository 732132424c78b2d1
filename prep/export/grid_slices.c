#include "prep/export/grid_slices.h"

#include "formats/base/pool.h"
#include "formats/leaf/leaf_unpacker.h"
#include "prep/export/grid_box.h"

/* Bytes for bookkeeping that the plan does not count: heads of blocks, the pool. */
enum { SPARE_BYTES = 64 << 10 };

typedef struct job {
    mem *m;
    leaf_file *f;
    const grid_part *part;
    pool *workers;
    int threads;
    size_t width;   /* bytes of a sample */
    size_t payload; /* bytes for one payload */
    size_t slice;   /* bytes of a slice of the part */
    char *payloads; /* one per thread */
    leaf_unpacker **unpackers;
    grid_box box;               /* the slab, with the slices that it holds now */
    uint32_t slices;            /* most slices in the slab */
    uint32_t from[3], count[3]; /* treelets of the layer that holds those slices */
} job;

/* ---- memory ---- */

/* Choose as many threads and slices as fit the budget. */
static status plan(job *j) {
    const uint32_t *lo = j->part->lo, *end = j->part->end;
    const uint64_t all = end[2] - lo[2], layer = 1u << j->f->layout.cells_log2;
    const uint64_t most = all < layer + 1 ? all : layer + 1;
    const uint64_t each = j->payload + leaf_unpacker_memory(j->f);
    j->slices = (uint32_t)most;
    if (!j->m->limit)
        return ST_OK;
    const uint64_t fixed = mem_used(j->m) + SPARE_BYTES, least = fixed + each + j->slice;
    if (least > j->m->limit)
        return status_describe(
            ST_NOMEM,
            "a memory budget of %llu KiB is too small: a slice of this grid needs %llu KiB",
            (unsigned long long)(j->m->limit >> 10), (unsigned long long)((least >> 10) + 1));
    const uint64_t left = j->m->limit - fixed;
    while (j->threads > 1 && ((uint64_t)j->threads * each > left / 2 ||
                              (uint64_t)j->threads * each + j->slice > left))
        j->threads--;
    const uint64_t fitting = (left - (uint64_t)j->threads * each) / j->slice;
    j->slices = (uint32_t)(fitting < most ? fitting : most);
    return ST_OK;
}

static status allocate(job *j) {
    j->width = sample_size(j->f->layout.type);
    j->payload = leaf_layout_aligned(leaf_layout_payload_max(&j->f->layout), LEAF_ALIGN_LOG2);
    j->slice = j->width * (j->part->end[0] - j->part->lo[0]) * (j->part->end[1] - j->part->lo[1]);
    status st = plan(j);
    if (st == ST_OK)
        st = pool_create(j->m, j->threads, &j->workers);
    if (st != ST_OK)
        return st;
    j->payloads = mem_alloc(j->m, (size_t)j->threads * j->payload);
    j->box.samples = mem_alloc(j->m, j->slices * j->slice);
    return j->payloads && j->box.samples
               ? leaf_unpackers_create(j->m, j->f, j->threads, &j->unpackers)
               : ST_NOMEM;
}

static void release(job *j) {
    mem_free(j->m, j->payloads);
    leaf_unpackers_destroy(j->m, j->unpackers, j->threads);
    mem_free(j->m, j->box.samples);
    pool_destroy(j->workers);
}

/* ---- a treelet ---- */

static status load_one(void *ctx, size_t index, int worker) {
    const job *j = ctx;
    const uint32_t place[3] = {j->from[0] + (uint32_t)(index % j->count[0]),
                               j->from[1] + (uint32_t)(index / j->count[0]), j->from[2]};
    const uint32_t t = leaf_layout_find(&j->f->layout, j->part->level, place);
    char *payload = j->payloads + (size_t)worker * j->payload;
    const uint32_t element = leaf_layout_samples(&j->f->layout, j->part->set, t);
    status st = leaf_file_load(j->f, element, j->unpackers[worker], payload);
    if (st != ST_OK)
        return st;
    grid_box_copy(&j->box, &j->f->layout, place, payload);
    return ST_OK;
}

/* ---- slab by slab ---- */

static status load_slab(job *j, uint32_t first) {
    const leaf_layout *l = &j->f->layout;
    const uint32_t layer = grid_box_treelet(l, j->part->level, 2, first);
    const uint32_t end = grid_box_end(l, j->part->level, 2, layer);
    grid_box *b = &j->box;
    b->lo[2] = first;
    b->end[2] = end < j->part->end[2] ? end : j->part->end[2];
    if (b->end[2] - first > j->slices)
        b->end[2] = first + j->slices;
    grid_box_treelets(b, l, j->from, j->count);
    return pool_run(j->workers, (size_t)j->count[0] * j->count[1], load_one, j);
}

status grid_slices_run(mem *m, leaf_file *f, const grid_part *part, int threads, const progress *p,
                       grid_slices_take take, void *ctx) {
    const uint32_t lo = part->lo[2], end = part->end[2];
    job j = {.m = m, .f = f, .part = part, .threads = threads, .box = grid_box_of(part)};
    status st = allocate(&j);
    for (uint32_t z = lo; st == ST_OK && z < end; z = j.box.end[2]) {
        st = load_slab(&j, z);
        if (st == ST_OK)
            st = take(ctx, j.box.samples, (j.box.end[2] - z) * (j.slice / j.width));
        if (st == ST_OK)
            st = progress_step(p, "export", (double)(j.box.end[2] - lo) / (end - lo));
    }
    release(&j);
    return st;
}
