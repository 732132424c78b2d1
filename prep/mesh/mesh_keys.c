#include "prep/mesh/mesh_keys.h"

#include <math.h>
#include <stdatomic.h>
#include <string.h>

#include "prep/mesh/mesh_morton.h"
#include "prep/mesh/mesh_pages.h"

enum { BLOCK = 1 << 12, BLOCKS_MAX = 256 };

/* Buffers and counts of one thread. */
typedef struct bench {
    mesh_pages points;
    uint32_t (*tets)[4];
    uint64_t repeated, bad;
} bench;

typedef struct keying {
    mem *m;
    mesh_gather *g;
    mesh_lattice lattice;
    int threads;
    bench *benches;
    atomic_uint *used; /* a bit per point: some tet has it */
    size_t used_words;
    /* The current blocks. */
    uint64_t first;
    size_t count;
    mesh_record *to;
    size_t kept[BLOCKS_MAX];
} keying;

static size_t words_of(uint64_t points) {
    return (size_t)(points / 32 + 1);
}

uint64_t mesh_keys_memory(uint64_t points, int threads) {
    return words_of(points) * sizeof(atomic_uint) +
           (uint64_t)threads * (sizeof(bench) + sizeof(uint32_t[4]) * BLOCK + 128) + 1024;
}

static void mark(keying *k, const uint32_t id[4]) {
    for (int c = 0; c < 4; c++) {
        atomic_uint *word = &k->used[id[c] >> 5];
        const uint32_t bit = 1U << (id[c] & 31);
        if (!(atomic_load_explicit(word, memory_order_relaxed) & bit))
            atomic_fetch_or_explicit(word, bit, memory_order_relaxed);
    }
}

static bool is_repeated(const uint32_t id[4]) {
    return id[0] == id[1] || id[0] == id[2] || id[0] == id[3] || id[1] == id[2] || id[1] == id[3] ||
           id[2] == id[3];
}

static bool is_bad(const uint32_t id[4], uint64_t points) {
    return id[0] >= points || id[1] >= points || id[2] >= points || id[3] >= points;
}

static status key_of(const keying *k, bench *b, const uint32_t id[4], uint64_t *key) {
    float corners[4][3];
    for (int c = 0; c < 4; c++) {
        const void *p = mesh_pages_at(&b->points, id[c]);
        if (!p)
            return b->points.st;
        memcpy(corners[c], p, sizeof corners[c]);
    }
    *key = mesh_morton_key(&k->lattice, (const float(*)[3])corners);
    return ST_OK;
}

static status make_block(void *ctx, size_t index, int worker) {
    keying *k = ctx;
    bench *b = &k->benches[worker];
    size_t at = index * BLOCK, count = k->count - at < BLOCK ? k->count - at : BLOCK;
    status st = mesh_spool_read(&k->g->tets, k->first + at, count, b->tets);
    mesh_record *to = k->to + at;
    for (size_t i = 0; st == ST_OK && i < count; i++) {
        const uint32_t *id = b->tets[i];
        if (is_bad(id, k->g->vertices)) {
            b->bad++;
        } else if (is_repeated(id)) {
            b->repeated++;
        } else {
            memcpy(to->id, id, sizeof to->id);
            st = key_of(k, b, id, &to->key);
            mark(k, id);
            to++;
        }
    }
    k->kept[index] = (size_t)(to - (k->to + at));
    return st;
}

/* Move the blocks' records together. Returns how many there are. */
static size_t close_gaps(const keying *k, size_t blocks) {
    size_t end = 0;
    for (size_t i = 0; i < blocks; i++) {
        if (end != i * BLOCK)
            memmove(k->to + end, k->to + i * BLOCK, k->kept[i] * sizeof *k->to);
        end += k->kept[i];
    }
    return end;
}

static status create(keying *k, uint64_t window) {
    k->used_words = words_of(k->g->vertices);
    k->used = mem_array(k->m, k->used_words, sizeof *k->used);
    k->benches = mem_array(k->m, (size_t)k->threads, sizeof *k->benches);
    if (!k->used || !k->benches)
        return ST_NOMEM;
    for (int i = 0; i < k->threads; i++) {
        bench *b = &k->benches[i];
        b->tets = mem_alloc(k->m, BLOCK * sizeof *b->tets);
        status st = b->tets ? mesh_pages_init(&b->points, &k->g->points, window) : ST_NOMEM;
        if (st != ST_OK)
            return st;
    }
    return ST_OK;
}

static void release(keying *k) {
    for (int i = 0; k->benches && i < k->threads; i++) {
        mesh_pages_release(&k->benches[i].points);
        mem_free(k->m, k->benches[i].tets);
    }
    mem_free(k->m, k->benches);
    mem_free(k->m, k->used);
}

/* Count values that are not finite, at points of tets only: other points may have any value, and
 * are not written. */
static status count_non_finite(const keying *k, mesh_spool *values, uint64_t *count) {
    enum { SOME = 4 * BLOCK };
    float *value = (float *)k->benches[0].tets;
    _Static_assert(SOME * sizeof(float) == BLOCK * sizeof(uint32_t[4]), "the tets' room is lent");
    for (uint64_t first = 0; first < values->count; first += SOME) {
        const uint64_t left = values->count - first;
        const size_t some = left < SOME ? (size_t)left : SOME;
        status st = mesh_spool_read(values, first, some, value);
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

static status make_all(keying *k, pool *workers, mesh_runs *r, double from, double to) {
    const uint64_t all = k->g->tets.count;
    while (k->first < all) {
        size_t room;
        k->to = mesh_runs_room(r, &room);
        k->count = room < (size_t)BLOCK * BLOCKS_MAX ? room : (size_t)BLOCK * BLOCKS_MAX;
        if (k->count > all - k->first)
            k->count = (size_t)(all - k->first);
        size_t blocks = (k->count + BLOCK - 1) / BLOCK;
        status st = pool_run(workers, blocks, make_block, k);
        if (st == ST_OK)
            st = mesh_runs_put(r, close_gaps(k, blocks));
        k->first += k->count;
        mesh_spool_forget(&k->g->tets, k->first);
        if (st == ST_OK)
            st =
                progress_step(k->g->p, "sort", from + (to - from) * (double)k->first / (double)all);
        if (st != ST_OK)
            return st;
    }
    return ST_OK;
}

status mesh_keys_make(mem *m, pool *workers, mesh_gather *g, uint64_t window, mesh_runs *r,
                      double from, double to, mesh_keys_report *report) {
    keying k = {
        .m = m, .g = g, .lattice = mesh_lattice_of(g->bounds), .threads = pool_threads(workers)};
    *report = (mesh_keys_report){.tets = g->tets.count};
    status st = create(&k, window);
    if (st == ST_OK)
        st = make_all(&k, workers, r, from, to);
    for (int i = 0; st == ST_OK && i < k.threads; i++) {
        report->repeated += k.benches[i].repeated;
        report->bad += k.benches[i].bad;
    }
    report->tets -= report->repeated + report->bad;
    for (size_t i = 0; st == ST_OK && i < k.used_words; i++)
        report->vertices += (uint64_t)__builtin_popcount(k.used[i]);
    if (st == ST_OK && g->non_finite > 0)
        st = count_non_finite(&k, &g->values, &report->non_finite);
    release(&k);
    return st;
}
