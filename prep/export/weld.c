#include "prep/export/weld.h"

#include <assert.h>
#include <string.h>

#include "formats/base/file.h"
#include "prep/mesh/mesh_runs.h"

enum { BLOCK = 1 << 12, ALIKE_MAX = 8 };

/* One entry per piece, and one more for the end of all. */
typedef struct piece_range {
    uint64_t vertex; /* number of the first vertex that it owns; until weld_end(): how many vertices
                        it has */
    uint64_t share;  /* number of its first share, counted over all pieces */
    uint64_t guest;  /* shares before it that other pieces own */
} piece_range;

struct weld {
    mem *m;
    pool *workers;
    const char *beside;
    uint32_t pieces, added;
    piece_range *ranges; /* pieces + 1 */
    uint64_t *owned;     /* a bit per share: its piece owns it */
    out_file *keys;      /* a mesh_record per share, in order; NULL: none */
    out_file *hosts; /* for each share that its piece does not own: the equal share that is owned */
    mesh_runs *runs;
    uint64_t room; /* memory for runs */
};

status weld_create(mem *m, pool *workers, const char *beside, uint32_t pieces, weld **out) {
    weld *w = mem_zalloc(m, sizeof *w);
    if (!w)
        return ST_NOMEM;
    *w = (weld){.m = m, .workers = workers, .beside = beside, .pieces = pieces};
    w->ranges = mem_array(m, (size_t)pieces + 1, sizeof *w->ranges);
    if (!w->ranges) {
        weld_destroy(w);
        return ST_NOMEM;
    }
    *out = w;
    return ST_OK;
}

void weld_destroy(weld *w) {
    if (!w)
        return;
    mesh_runs_destroy(w->runs);
    out_file_discard(w->keys);
    out_file_discard(w->hosts);
    mem_free(w->m, w->owned);
    mem_free(w->m, w->ranges);
    mem_free(w->m, w);
}

static uint64_t shares(const weld *w) {
    return w->ranges[w->added].share;
}

/* ---- adding shares ---- */

/* The upper 63 bits are the sort key. All other bits tell apart records with equal keys. */
static mesh_record record_of(const hash_id *key, uint64_t share) {
    return (mesh_record){.key = key->hi >> 1,
                         .id = {(uint32_t)key->lo, (uint32_t)(key->lo >> 32), (uint32_t)share,
                                (uint32_t)(share >> 32)}};
}

static uint64_t share_of(const mesh_record *r) {
    return r->id[2] | (uint64_t)r->id[3] << 32;
}

status weld_add(weld *w, uint32_t vertices, const hash_id *keys, uint32_t count) {
    mesh_record block[BLOCK / sizeof(mesh_record)];
    const uint32_t most = sizeof block / sizeof *block;
    piece_range *p = &w->ranges[w->added];
    status st = ST_OK;
    if (count > 0 && !w->keys)
        st = out_file_scratch(w->m, w->beside, &w->keys);
    for (uint32_t done = 0, part; st == ST_OK && done < count; done += part) {
        part = count - done < most ? count - done : most;
        for (uint32_t i = 0; i < part; i++)
            block[i] = record_of(&keys[done + i], p->share + done + i);
        st = out_file_append(w->keys, block, part * sizeof *block);
    }
    p->vertex = vertices;
    p[1].share = p->share + count;
    w->added++;
    return st;
}

/* ---- equal shares ---- */

static status begin_runs(weld *w) {
    const uint64_t sort = mesh_sort_memory(pool_threads(w->workers));
    const uint64_t room = w->room > 2 * sort ? w->room - sort : w->room / 2;
    const mesh_runs_plan plan = mesh_runs_plan_make(shares(w), 1, room, room);
    return mesh_runs_create(w->m, w->workers, w->beside, &plan, &w->runs);
}

static void end_runs(weld *w) {
    mesh_runs_destroy(w->runs);
    w->runs = NULL;
}

static status put(mesh_runs *runs, mesh_record r) {
    size_t room;
    *mesh_runs_room(runs, &room) = r;
    return mesh_runs_put(runs, 1);
}

static status sort_keys(weld *w) {
    const uint64_t count = shares(w);
    status st = begin_runs(w);
    for (uint64_t done = 0; st == ST_OK && done < count;) {
        size_t room;
        mesh_record *to = mesh_runs_room(w->runs, &room);
        const size_t part = count - done < room ? (size_t)(count - done) : room;
        st = out_file_read_at(w->keys, done * sizeof *to, to, part * sizeof *to);
        if (st == ST_OK)
            st = mesh_runs_put(w->runs, part);
        done += part;
    }
    out_file_discard(w->keys);
    w->keys = NULL;
    return st == ST_OK ? mesh_runs_end(w->runs) : st;
}

/* Records with equal keys follow one another in the order of shares. These are the distinct ones so
 * far, which the next record is compared with. */
typedef struct alike {
    mesh_record first[ALIKE_MAX];
    int count;
} alike;

static status find_host(alike *a, const mesh_record *r, const mesh_record **host) {
    if (a->count > 0 && a->first[0].key != r->key)
        a->count = 0;
    *host = NULL;
    for (int i = 0; i < a->count; i++)
        if (memcmp(a->first[i].id, r->id, 2 * sizeof *r->id) == 0)
            *host = &a->first[i];
    if (*host)
        return ST_OK;
    if (a->count == ALIKE_MAX)
        return status_describe(ST_FAILED, "more than %d vertices have the same hash", ALIKE_MAX);
    a->first[a->count++] = *r;
    return ST_OK;
}

/* Go through the sorted keys. Guests, shares that an earlier piece owns, go to `out`, to be sorted
 * by share. */
static status find_guests(weld *w, mesh_runs *sorted, mesh_runs *out) {
    alike seen = {.count = 0};
    const mesh_record *records;
    size_t used = 0, count;
    bool last;
    status st;
    do {
        st = mesh_runs_window(sorted, used, &records, &count, &last);
        for (used = 0; st == ST_OK && used < count; used++) {
            const mesh_record *host;
            st = find_host(&seen, &records[used], &host);
            if (st != ST_OK || !host)
                continue;
            const uint64_t share = share_of(&records[used]);
            w->owned[share / 64] &= ~((uint64_t)1 << share % 64);
            st = put(out, (mesh_record){.key = share, .id = {0, 0, host->id[2], host->id[3]}});
        }
    } while (st == ST_OK && !last);
    return st;
}

static status write_hosts(weld *w) {
    uint64_t block[BLOCK / sizeof(uint64_t)];
    const mesh_record *records;
    size_t used = 0, count, filled = 0;
    bool last;
    status st = out_file_scratch(w->m, w->beside, &w->hosts);
    do {
        if (st == ST_OK)
            st = mesh_runs_window(w->runs, used, &records, &count, &last);
        for (used = 0; st == ST_OK && used < count; used++) {
            block[filled++] = share_of(&records[used]);
            if (filled < sizeof block / sizeof *block)
                continue;
            st = out_file_append(w->hosts, block, sizeof block);
            filled = 0;
        }
    } while (st == ST_OK && !last);
    return st == ST_OK ? out_file_append(w->hosts, block, filled * sizeof *block) : st;
}

static status match(weld *w) {
    status st = sort_keys(w);
    mesh_runs *sorted = w->runs;
    w->runs = NULL;
    if (st == ST_OK)
        st = begin_runs(w);
    if (st == ST_OK)
        st = find_guests(w, sorted, w->runs);
    mesh_runs_destroy(sorted);
    if (st == ST_OK)
        st = mesh_runs_end(w->runs);
    if (st == ST_OK)
        st = write_hosts(w);
    end_runs(w);
    return st;
}

/* ---- numbers ---- */

/* Number of shares in [from, end) that their pieces own. */
static uint64_t count_owned(const weld *w, uint64_t from, uint64_t end) {
    uint64_t count = 0;
    for (uint64_t at = from; at < end;) {
        const uint64_t stop = at / 64 * 64 + 64 < end ? at / 64 * 64 + 64 : end;
        uint64_t bits = w->owned[at / 64] >> at % 64;
        if (stop - at < 64)
            bits &= ((uint64_t)1 << (stop - at)) - 1;
        count += (uint64_t)__builtin_popcountll(bits);
        at = stop;
    }
    return count;
}

static void number(weld *w) {
    uint64_t vertex = 0, guest = 0;
    for (uint32_t i = 0; i < w->pieces; i++) {
        piece_range *p = &w->ranges[i];
        const uint64_t guests = p[1].share - p->share - count_owned(w, p->share, p[1].share),
                       has = p->vertex;
        p->vertex = vertex;
        p->guest = guest;
        vertex += has - guests;
        guest += guests;
    }
    w->ranges[w->pieces].vertex = vertex;
    w->ranges[w->pieces].guest = guest;
}

status weld_end(weld *w, uint64_t spare) {
    assert(w->added == w->pieces);
    const size_t words = (size_t)(shares(w) / 64 + 1);
    w->owned = mem_alloc(w->m, words * sizeof *w->owned);
    if (!w->owned)
        return ST_NOMEM;
    memset(w->owned, 0xff, words * sizeof *w->owned);
    const uint64_t used = mem_used(w->m) + spare, limit = w->m->limit ? w->m->limit : UINT64_MAX;
    w->room = used < limit ? (limit - used) / 2 : 0;
    status st = shares(w) > 0 ? match(w) : ST_OK;
    if (st == ST_OK)
        number(w);
    return st;
}

uint64_t weld_vertices(const weld *w) {
    return w->ranges[w->pieces].vertex;
}

uint64_t weld_first(const weld *w, uint32_t index) {
    return w->ranges[index].vertex;
}

static bool is_owned(const weld *w, uint64_t share) {
    return w->owned[share / 64] >> share % 64 & 1;
}

bool weld_knows(const weld *w, uint32_t index, const piece *p) {
    const piece_range *at = &w->ranges[index];
    const uint64_t guests = at[1].guest - at->guest;
    return at[1].share - at->share == p->shares &&
           at[1].vertex - at->vertex + guests == p->vertices;
}

uint32_t weld_owned(const weld *w, uint32_t index, const piece *p, uint32_t *order) {
    const uint64_t first = w->ranges[index].share;
    uint32_t count = 0, next = 0;
    for (uint32_t k = 0; k < p->shares; k++)
        if (is_owned(w, first + k))
            order[count++] = p->share[k].vertex;
    for (uint32_t v = 0; v < p->vertices; v++) {
        if (next < p->shares && p->share[next].vertex == v)
            next++;
        else
            order[count++] = v;
    }
    return count;
}

/* The vertex number of a share that its piece owns. */
static uint64_t number_of(const weld *w, uint64_t share) {
    uint32_t lo = 0, hi = w->pieces;
    while (hi - lo > 1) {
        const uint32_t middle = lo + (hi - lo) / 2;
        if (w->ranges[middle].share <= share)
            lo = middle;
        else
            hi = middle;
    }
    return w->ranges[lo].vertex + count_owned(w, w->ranges[lo].share, share);
}

status weld_numbers(const weld *w, uint32_t index, const piece *p, uint64_t *numbers,
                    uint64_t *scratch) {
    const piece_range *at = &w->ranges[index];
    const uint64_t guests = at[1].guest - at->guest;
    uint64_t next = at->vertex, guest = 0;
    if (guests > 0) {
        status st = out_file_read_at(w->hosts, at->guest * sizeof *scratch, scratch,
                                     (size_t)guests * sizeof *scratch);
        if (st != ST_OK)
            return st;
    }
    for (uint32_t k = 0; k < p->shares; k++)
        numbers[p->share[k].vertex] =
            is_owned(w, at->share + k) ? next++ : number_of(w, scratch[guest++]);
    for (uint32_t v = 0, k = 0; v < p->vertices; v++) {
        if (k < p->shares && p->share[k].vertex == v)
            k++;
        else
            numbers[v] = next++;
    }
    return ST_OK;
}
