#include "prep/mesh/mesh_keys.h"

#include <math.h>
#include <stdatomic.h>
#include <string.h>

#include "formats/mesh/mesh_morton.h"
#include "prep/mesh/mesh_pages.h"

enum { BLOCK = 1 << 12, BLOCKS_MAX = 256 };

/* Buffers and counts of one thread. */
typedef struct bench {
    mesh_pages points;
    uint32_t *ids; /* of a block's tets, or cells */
    uint64_t repeated, bad;
} bench;

struct mesh_keys {
    mem *m;
    pool *workers;
    mesh_gather *g;
    mesh_lattice lattice;
    int threads;
    bench *benches;
    atomic_uint *used; /* a bit per point: some tet has it */
    size_t used_words;
    uint64_t repeated, bad; /* those of an earlier run */
    /* The current blocks. */
    uint64_t first;
    size_t count;
    mesh_record *to;
    size_t kept[BLOCKS_MAX];
};

static size_t words_of(uint64_t points) {
    return (size_t)(points / 32 + 1);
}

uint64_t mesh_keys_memory(uint64_t points, uint32_t corners, int threads) {
    return words_of(points) * sizeof(atomic_uint) + sizeof(mesh_keys) +
           (uint64_t)threads * (sizeof(bench) + corners * sizeof(uint32_t) * BLOCK + 128) + 1024;
}

static void mark(mesh_keys *k, const uint32_t *id) {
    for (uint32_t c = 0; c < k->g->corners; c++) {
        atomic_uint *word = &k->used[id[c] >> 5];
        const uint32_t bit = 1U << (id[c] & 31);
        if (!(atomic_load_explicit(word, memory_order_relaxed) & bit))
            atomic_fetch_or_explicit(word, bit, memory_order_relaxed);
    }
}

/* Whether an id comes twice. Of cells, the reader has left out those with less than four. */
static bool is_repeated(const uint32_t *id, uint32_t corners) {
    if (corners == 3)
        return id[0] == id[1] || id[0] == id[2] || id[1] == id[2];
    return corners == 4 && (id[0] == id[1] || id[0] == id[2] || id[0] == id[3] || id[1] == id[2] ||
                            id[1] == id[3] || id[2] == id[3]);
}

static bool is_bad(const uint32_t *id, uint32_t corners, uint64_t points) {
    bool bad = false;
    for (uint32_t c = 0; c < corners; c++)
        bad = bad || id[c] >= points;
    return bad;
}

static status key_of(const mesh_keys *k, bench *b, const uint32_t *id, uint64_t *key) {
    float corners[CELL_ROW][3];
    for (uint32_t c = 0; c < k->g->corners; c++) {
        const void *p = mesh_pages_at(&b->points, id[c]);
        if (!p)
            return b->points.st;
        memcpy(corners[c], p, sizeof corners[c]);
    }
    *key = k->g->corners == 3   ? mesh_morton_triangle(&k->lattice, (const float(*)[3])corners)
           : k->g->corners == 4 ? mesh_morton_key(&k->lattice, (const float(*)[3])corners)
                                : mesh_morton_cell(&k->lattice, (const float(*)[3])corners);
    return ST_OK;
}

/* A tet or a triangle is moved into its record; of another cell that has its number. */
static void put_ids(const mesh_keys *k, const uint32_t *id, uint64_t number, mesh_record *to) {
    if (mesh_gather_keeps(k->g))
        mesh_record_number(to, number);
    else
        for (uint32_t c = 0; c < 4; c++)
            to->id[c] = id[c < k->g->corners ? c : k->g->corners - 1];
}

static status make_block(void *ctx, size_t index, int worker) {
    mesh_keys *k = ctx;
    bench *b = &k->benches[worker];
    size_t at = index * BLOCK, count = k->count - at < BLOCK ? k->count - at : BLOCK;
    status st = mesh_spool_read(&k->g->tets, k->first + at, count, b->ids);
    mesh_record *to = k->to + at;
    for (size_t i = 0; st == ST_OK && i < count; i++) {
        const uint32_t corners = k->g->corners, *id = b->ids + corners * i;
        if (is_bad(id, corners, k->g->vertices)) {
            b->bad++;
        } else if (is_repeated(id, corners)) {
            b->repeated++;
        } else {
            put_ids(k, id, k->first + at + i, to);
            st = key_of(k, b, id, &to->key);
            mark(k, id);
            to++;
        }
    }
    k->kept[index] = (size_t)(to - (k->to + at));
    return st;
}

/* Move the blocks' records together. Returns how many there are. */
static size_t close_gaps(const mesh_keys *k, size_t blocks) {
    size_t end = 0;
    for (size_t i = 0; i < blocks; i++) {
        if (end != i * BLOCK)
            memmove(k->to + end, k->to + i * BLOCK, k->kept[i] * sizeof *k->to);
        end += k->kept[i];
    }
    return end;
}

static status allocate(mesh_keys *k, uint64_t window) {
    k->used_words = words_of(k->g->vertices);
    k->used = mem_array(k->m, k->used_words, sizeof *k->used);
    k->benches = mem_array(k->m, (size_t)k->threads, sizeof *k->benches);
    if (!k->used || !k->benches)
        return ST_NOMEM;
    for (int i = 0; i < k->threads; i++) {
        bench *b = &k->benches[i];
        b->ids = mem_array(k->m, (size_t)BLOCK * k->g->corners, sizeof *b->ids);
        status st = b->ids ? mesh_pages_init(&b->points, &k->g->points, window) : ST_NOMEM;
        if (st != ST_OK)
            return st;
    }
    return ST_OK;
}

status mesh_keys_create(mem *m, pool *workers, mesh_gather *g, uint64_t window, mesh_keys **out) {
    mesh_keys *k = mem_zalloc(m, sizeof *k);
    if (!k)
        return ST_NOMEM;
    k->m = m;
    k->workers = workers;
    k->g = g;
    k->lattice = mesh_lattice_of(g->bounds);
    k->threads = pool_threads(workers);
    status st = allocate(k, window);
    if (st != ST_OK) {
        mesh_keys_destroy(k);
        return st;
    }
    *out = k;
    return ST_OK;
}

void mesh_keys_destroy(mesh_keys *k) {
    if (!k)
        return;
    for (int i = 0; k->benches && i < k->threads; i++) {
        mesh_pages_release(&k->benches[i].points);
        mem_free(k->m, k->benches[i].ids);
    }
    mem_free(k->m, k->benches);
    mem_free(k->m, k->used);
    mem_free(k->m, k);
}

double mesh_keys_done(const mesh_keys *k) {
    const uint64_t all = k->g->tets.count;
    return k->first < all ? (double)k->first / (double)all : 1;
}

status mesh_keys_next(mesh_keys *k, mesh_runs *r) {
    const uint64_t left = k->g->tets.count - k->first;
    size_t room;
    k->to = mesh_runs_room(r, &room);
    k->count = room < (size_t)BLOCK * BLOCKS_MAX ? room : (size_t)BLOCK * BLOCKS_MAX;
    if (k->count > left)
        k->count = (size_t)left;
    const size_t blocks = (k->count + BLOCK - 1) / BLOCK;
    status st = pool_run(k->workers, blocks, make_block, k);
    if (st != ST_OK)
        return st;
    k->first += k->count;
    if (!mesh_gather_keeps(k->g))
        mesh_spool_forget(&k->g->tets, k->first);
    return mesh_runs_put(r, close_gaps(k, blocks));
}

/* Count values that are not finite, at points of tets only: other points may have any value, and
 * are not written. */
static status count_non_finite(const mesh_keys *k, mesh_spool *values, uint64_t *count) {
    enum { SOME = 3 * BLOCK };
    float *value = (float *)k->benches[0].ids;
    _Static_assert(SOME * sizeof(float) == BLOCK * sizeof(uint32_t[3]), "the cells' room is lent");
    for (uint64_t first = 0; first < values->count; first += SOME) {
        const uint64_t left = values->count - first;
        const size_t some = left < SOME ? (size_t)left : SOME;
        status st = progress_ask(k->g->p, "sorting");
        if (st == ST_OK)
            st = mesh_spool_read(values, first, some, value);
        if (st != ST_OK)
            return st;
        for (size_t i = 0; i < some; i++) {
            if (isfinite(value[i]))
                continue;
            const uint64_t id = (first + i) % k->g->vertices;
            *count += k->used[id >> 5] >> (id & 31) & 1;
        }
    }
    return ST_OK;
}

/* Sum up the tets that were left out. */
static void sum_up(const mesh_keys *k, uint64_t *repeated, uint64_t *bad) {
    *repeated = k->repeated;
    *bad = k->bad;
    for (int i = 0; i < k->threads; i++) {
        *repeated += k->benches[i].repeated;
        *bad += k->benches[i].bad;
    }
}

status mesh_keys_end(mesh_keys *k, mesh_keys_report *report) {
    *report = (mesh_keys_report){.tets = k->g->tets.count};
    sum_up(k, &report->repeated, &report->bad);
    report->tets -= report->repeated + report->bad;
    for (size_t i = 0; i < k->used_words; i++)
        report->vertices += (uint64_t)__builtin_popcount(k->used[i]);
    return k->g->non_finite > 0 ? count_non_finite(k, &k->g->values, &report->non_finite) : ST_OK;
}

status mesh_keys_keep(mesh_keys *k, state_io *io) {
    uint64_t repeated, bad;
    sum_up(k, &repeated, &bad);
    status st = STATE_IO(io, k->first);
    if (st == ST_OK)
        st = STATE_IO(io, repeated);
    if (st == ST_OK)
        st = STATE_IO(io, bad);
    if (st == ST_OK)
        st = state_io_bytes(io, k->used, k->used_words * sizeof *k->used);
    if (st != ST_OK || !state_io_loads(io))
        return st;
    k->repeated = repeated;
    k->bad = bad;
    return k->first > k->g->tets.count || repeated > k->first || bad > k->first - repeated
               ? state_io_fault(io)
               : ST_OK;
}

uint64_t mesh_keys_put(const mesh_keys *k) {
    uint64_t repeated, bad;
    sum_up(k, &repeated, &bad);
    return k->first - repeated - bad;
}
