#include "prep/export/grid_slices.h"

#include <string.h>

#include "formats/base/pool.h"

/* Book-keeping beside what is planned: blocks' heads, the pool. */
enum { SPARE_BYTES = 64 << 10 };

typedef struct job {
    mem *m;
    leaf_file *f;
    const grid_part *part;
    pool *workers;
    int threads;
    size_t width;            /* of a sample */
    size_t payload;          /* room for one */
    size_t slice;            /* bytes of one of the part */
    char *payloads, *stored; /* one a thread; stored: NULL where nothing is packed */
    char *slab;
    uint32_t slices;            /* most in the slab */
    uint32_t first, end;        /* those that are in it now */
    uint32_t layer;             /* of treelets, that they are in */
    uint32_t from[2], count[2]; /* treelets of the layer along x and y */
} job;

static bool is_packed(const leaf_file *f) {
    return f->header.codec != LEAF_CODEC_RAW;
}

/* ---- memory ---- */

/* As many threads and slices as fit. */
static status plan(job *j) {
    const uint32_t *lo = j->part->lo, *end = j->part->end;
    const uint64_t all = end[2] - lo[2], layer = 1u << j->f->layout.cells_log2;
    const uint64_t most = all < layer + 1 ? all : layer + 1;
    const uint64_t each = (is_packed(j->f) ? 2 : 1) * j->payload;
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
    if (is_packed(j->f))
        j->stored = mem_alloc(j->m, (size_t)j->threads * j->payload);
    j->slab = mem_alloc(j->m, j->slices * j->slice);
    return j->payloads && j->slab && (j->stored || !is_packed(j->f)) ? ST_OK : ST_NOMEM;
}

static void release(job *j) {
    mem_free(j->m, j->payloads);
    mem_free(j->m, j->stored);
    mem_free(j->m, j->slab);
    pool_destroy(j->workers);
}

/* ---- a treelet ---- */

/* The nodes of a treelet along an axis that go into the slab: its own but for the last, which is
 * the next one's, within the part. */
static void nodes_of(const job *j, const uint32_t place[3], int a, uint32_t *first, uint32_t *end) {
    const leaf_level *l = &j->f->layout.level[j->part->level];
    const uint32_t log2 = j->f->layout.cells_log2;
    const uint32_t lo = a == 2 ? j->first : j->part->lo[a], hi = a == 2 ? j->end : j->part->end[a];
    *first = place[a] << log2;
    *end = place[a] + 1 == l->treelets[a] ? l->dims[a] : (place[a] + 1) << log2;
    *first = *first > lo ? *first : lo;
    *end = *end < hi ? *end : hi;
}

static void copy(const job *j, const leaf_payload *p, const uint32_t place[3],
                 const char *payload) {
    const leaf_layout *l = &j->f->layout;
    uint32_t first[3], end[3], within[3];
    for (int a = 0; a < 3; a++) {
        nodes_of(j, place, a, &first[a], &end[a]);
        within[a] = first[a] + l->halo - (place[a] << l->cells_log2);
    }
    const size_t row = j->width * (j->part->end[0] - j->part->lo[0]);
    for (uint32_t z = first[2]; z < end[2]; z++)
        for (uint32_t y = first[1]; y < end[1]; y++) {
            const size_t at =
                ((size_t)(within[2] + z - first[2]) * p->samples[1] + within[1] + y - first[1]) *
                    p->samples[0] +
                within[0];
            memcpy(j->slab + (z - j->first) * j->slice + (y - j->part->lo[1]) * row +
                       (first[0] - j->part->lo[0]) * j->width,
                   payload + p->samples_at + at * j->width, (end[0] - first[0]) * j->width);
        }
}

static status load_one(void *ctx, size_t index, int worker) {
    const job *j = ctx;
    const uint32_t place[3] = {j->from[0] + (uint32_t)(index % j->count[0]),
                               j->from[1] + (uint32_t)(index / j->count[0]), j->layer};
    const uint32_t t = leaf_layout_find(&j->f->layout, j->part->level, place);
    char *payload = j->payloads + (size_t)worker * j->payload;
    char *stored = j->stored ? j->stored + (size_t)worker * j->payload : NULL;
    const uint32_t element = leaf_layout_samples(&j->f->layout, j->part->set, t);
    status st = leaf_file_load(j->f, element, stored, payload);
    if (st != ST_OK)
        return st;
    const leaf_payload p = leaf_layout_payload(&j->f->layout, t);
    copy(j, &p, place, payload);
    return ST_OK;
}

/* ---- slab by slab ---- */

/* The treelet that has a node as its own. */
static uint32_t treelet_of(const job *j, int a, uint32_t node) {
    const uint32_t t = node >> j->f->layout.cells_log2;
    const uint32_t last = j->f->layout.level[j->part->level].treelets[a] - 1;
    return t < last ? t : last;
}

static status load_slab(job *j, uint32_t first) {
    const leaf_level *l = &j->f->layout.level[j->part->level];
    j->layer = treelet_of(j, 2, first);
    const uint32_t end =
        j->layer + 1 == l->treelets[2] ? l->dims[2] : (j->layer + 1) << j->f->layout.cells_log2;
    j->first = first;
    j->end = end < j->part->end[2] ? end : j->part->end[2];
    if (j->end - first > j->slices)
        j->end = first + j->slices;
    for (int a = 0; a < 2; a++) {
        j->from[a] = treelet_of(j, a, j->part->lo[a]);
        j->count[a] = treelet_of(j, a, j->part->end[a] - 1) - j->from[a] + 1;
    }
    return pool_run(j->workers, (size_t)j->count[0] * j->count[1], load_one, j);
}

status grid_slices_run(mem *m, leaf_file *f, const grid_part *part, int threads, const progress *p,
                       grid_slices_take take, void *ctx) {
    job j = {.m = m, .f = f, .part = part, .threads = threads};
    const uint32_t lo = part->lo[2], end = part->end[2];
    status st = allocate(&j);
    for (uint32_t z = lo; st == ST_OK && z < end; z = j.end) {
        st = load_slab(&j, z);
        if (st == ST_OK)
            st = take(ctx, j.slab, (j.end - z) * (j.slice / j.width));
        if (st == ST_OK)
            st = progress_step(p, "export", (double)(j.end - lo) / (end - lo));
    }
    release(&j);
    return st;
}
