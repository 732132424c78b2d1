/* First sort by the highest bits in which keys differ, with all threads, from `records` to `spare`.
 * Each thread counts, then moves, a part of its own. Then sort bucket by bucket, one thread each,
 * back to `records`: some digits of 8 bits at a time, the lowest first (LSD). A bucket that holds
 * most records is again sorted by all threads. */
#include "prep/mesh/mesh_sort.h"

#include <stdbool.h>
#include <string.h>

enum {
    TOP_BITS = 11,
    BUCKETS = 1 << TOP_BITS,
    BUCKETS_AT_ONCE = BUCKETS / 8,
    DIGIT_BITS = 8,
    DIGITS = 1 << DIGIT_BITS,
    PASSES_MAX = 3,
    PARTS_PER_THREAD = 4,
    INSERTION_MAX = 24,
    SHARED_MIN = 1 << 15 /* a bucket this large, or of 1/8 of all, is sorted by all threads */
};

typedef struct part {
    size_t count[BUCKETS]; /* later: where its next record of a bucket goes */
    uint64_t any, all;     /* bits set in some key, and in every key */
} part;

struct mesh_sort {
    mem *m;
    pool *workers;
    const progress *p;
    size_t parts;
    part *part;
    size_t *starts; /* BUCKETS + 1 for each level of recursion */
    /* The part that is being sorted. */
    mesh_record *from, *to;
    size_t count;
    int shift; /* of its top digit */
    const size_t *start;
};

/* Each level of shared sorting takes TOP_BITS of 64. */
enum { LEVELS_MAX = 64 / TOP_BITS + 2 };

uint64_t mesh_sort_memory(int threads) {
    uint64_t parts = (uint64_t)threads * PARTS_PER_THREAD;
    return sizeof(mesh_sort) + parts * sizeof(part) + LEVELS_MAX * (BUCKETS + 1) * sizeof(size_t) +
           1024;
}

status mesh_sort_create(mem *m, pool *p, mesh_sort **out) {
    mesh_sort *s = mem_zalloc(m, sizeof *s);
    if (!s)
        return ST_NOMEM;
    s->m = m;
    s->workers = p;
    s->parts = (size_t)pool_threads(p) * PARTS_PER_THREAD;
    s->part = mem_array(m, s->parts, sizeof *s->part);
    s->starts = mem_array(m, (size_t)LEVELS_MAX * (BUCKETS + 1), sizeof *s->starts);
    if (!s->part || !s->starts) {
        mesh_sort_destroy(s);
        return ST_NOMEM;
    }
    *out = s;
    return ST_OK;
}

void mesh_sort_destroy(mesh_sort *s) {
    if (!s)
        return;
    mem_free(s->m, s->part);
    mem_free(s->m, s->starts);
    mem_free(s->m, s);
}

void mesh_sort_stop_by(mesh_sort *s, const progress *p) {
    s->p = p;
}

/* ---- one bucket, one thread ---- */

/* Insertion sort from one place to another. */
static void insert(const mesh_record *from, mesh_record *to, size_t count) {
    for (size_t i = 0; i < count; i++) {
        mesh_record r = from[i];
        size_t at = i;
        for (; at > 0 && to[at - 1].key > r.key; at--)
            to[at] = to[at - 1];
        to[at] = r;
    }
}

static void move_by_digit(const mesh_record *from, mesh_record *to, size_t count, int shift,
                          const uint32_t counts[DIGITS]) {
    uint32_t next[DIGITS], sum = 0;
    for (int d = 0; d < DIGITS; d++) {
        next[d] = sum;
        sum += counts[d];
    }
    for (size_t i = 0; i < count; i++)
        to[next[from[i].key >> shift & (DIGITS - 1)]++] = from[i];
}

/* Sort by the bits [low, low + passes * DIGIT_BITS) alone, from `at` to `home`; both are
 * overwritten. */
static void sort_by_digits(mesh_record *at, mesh_record *home, size_t count, int low, int passes) {
    uint32_t counts[PASSES_MAX][DIGITS];
    memset(counts, 0, (size_t)passes * sizeof counts[0]);
    for (size_t i = 0; i < count; i++)
        for (int p = 0; p < passes; p++)
            counts[p][at[i].key >> (low + p * DIGIT_BITS) & (DIGITS - 1)]++;
    mesh_record *from = at, *to = home;
    for (int p = 0; p < passes; p++) {
        const int shift = low + p * DIGIT_BITS;
        if (counts[p][from[0].key >> shift & (DIGITS - 1)] == count)
            continue;
        move_by_digit(from, to, count, shift, counts[p]);
        mesh_record *moved = to;
        to = from;
        from = moved;
    }
    if (from != home)
        memcpy(home, from, count * sizeof *home);
}

/* Sort a bucket by its lowest `bits` bits. `at` holds the records; they end up in `home`, and both
 * are overwritten. count < 2^32. The first digits tell apart nearly all keys of a bucket. The few
 * keys that they do not are sorted by the remaining bits. */
static void sort_bucket(mesh_record *at, mesh_record *home, size_t count, int bits) {
    if (count <= INSERTION_MAX) {
        insert(at, home, count);
        return;
    }
    const int low = bits > PASSES_MAX * DIGIT_BITS ? bits - PASSES_MAX * DIGIT_BITS : 0;
    sort_by_digits(at, home, count, low, (bits - low + DIGIT_BITS - 1) / DIGIT_BITS);
    for (size_t first = 0, end; low > 0 && first < count; first = end) {
        for (end = first + 1; end < count && home[end].key >> low == home[first].key >> low;)
            end++;
        if (end - first > 1) {
            memcpy(at + first, home + first, (end - first) * sizeof *at);
            sort_bucket(at + first, home + first, end - first, low);
        }
    }
}

/* ---- all threads together ---- */

static void stretch(const mesh_sort *s, size_t index, size_t *first, size_t *end) {
    *first = s->count / s->parts * index;
    *end = index + 1 == s->parts ? s->count : *first + s->count / s->parts;
}

static status look_at_part(void *ctx, size_t index, int worker) {
    mesh_sort *s = ctx;
    (void)worker;
    part *p = &s->part[index];
    size_t first, end;
    stretch(s, index, &first, &end);
    p->any = 0;
    p->all = UINT64_MAX;
    for (size_t i = first; i < end; i++) {
        p->any |= s->from[i].key;
        p->all &= s->from[i].key;
    }
    return ST_OK;
}

static inline size_t bucket_of(const mesh_sort *s, size_t i) {
    return s->from[i].key >> s->shift & (BUCKETS - 1);
}

static status count_part(void *ctx, size_t index, int worker) {
    mesh_sort *s = ctx;
    (void)worker;
    size_t first, end;
    stretch(s, index, &first, &end);
    size_t *count = s->part[index].count;
    memset(count, 0, sizeof s->part[index].count);
    for (size_t i = first; i < end; i++)
        count[bucket_of(s, i)]++;
    return ST_OK;
}

static status move_part(void *ctx, size_t index, int worker) {
    mesh_sort *s = ctx;
    (void)worker;
    size_t first, end;
    stretch(s, index, &first, &end);
    size_t *next = s->part[index].count;
    for (size_t i = first; i < end; i++)
        s->to[next[bucket_of(s, i)]++] = s->from[i];
    return ST_OK;
}

/* Compute where buckets begin, and where the parts' shares in them do. */
static void place_buckets(mesh_sort *s, size_t *start) {
    size_t at = 0;
    for (size_t b = 0; b < BUCKETS; b++) {
        start[b] = at;
        for (size_t i = 0; i < s->parts; i++) {
            size_t count = s->part[i].count[b];
            s->part[i].count[b] = at;
            at += count;
        }
    }
    start[BUCKETS] = at;
}

static bool is_shared(const mesh_sort *s, size_t count, size_t total) {
    return s->shift > 0 && count >= SHARED_MIN && (count >= total / 8 || count > UINT32_MAX);
}

static status sort_one_bucket(void *ctx, size_t b, int worker) {
    mesh_sort *s = ctx;
    (void)worker;
    size_t first = s->start[b], count = s->start[b + 1] - first;
    if (count > 0 && !is_shared(s, count, s->count))
        sort_bucket(s->to + first, s->from + first, count, s->shift);
    return ST_OK;
}

/* Number of lowest bits that are enough to tell the keys apart. */
static status bits_that_differ(mesh_sort *s, int *bits) {
    status st = pool_run(s->workers, s->parts, look_at_part, s);
    uint64_t any = 0, all = UINT64_MAX;
    for (size_t i = 0; i < s->parts; i++) {
        any |= s->part[i].any;
        all &= s->part[i].all;
    }
    *bits = any == all ? 0 : 64 - __builtin_clzll(any ^ all);
    return st;
}

static status sort_shared(mesh_sort *s, mesh_record *records, mesh_record *spare, size_t count,
                          int level) {
    s->from = records;
    s->to = spare;
    s->count = count;
    int bits = 0;
    status st = bits_that_differ(s, &bits);
    if (st != ST_OK || bits == 0)
        return st;
    const int shift = bits > TOP_BITS ? bits - TOP_BITS : 0;
    size_t *start = s->starts + (size_t)level * (BUCKETS + 1);
    s->shift = shift;
    s->start = start;
    st = pool_run(s->workers, s->parts, count_part, s);
    if (st == ST_OK)
        st = progress_ask(s->p, "sorting");
    if (st != ST_OK)
        return st;
    place_buckets(s, start);
    st = pool_run(s->workers, s->parts, move_part, s);
    for (size_t b = 0; st == ST_OK && b < BUCKETS; b += BUCKETS_AT_ONCE) {
        st = progress_ask(s->p, "sorting");
        if (st == ST_OK)
            st = pool_run_range(s->workers, b, b + BUCKETS_AT_ONCE, sort_one_bucket, s);
    }
    for (size_t b = 0; st == ST_OK && b < BUCKETS; b++) {
        size_t first = start[b], many = start[b + 1] - first;
        s->shift = shift;
        if (!is_shared(s, many, count))
            continue;
        memcpy(records + first, spare + first, many * sizeof *records);
        st = sort_shared(s, records + first, spare + first, many, level + 1);
    }
    return st;
}

status mesh_sort_records(mesh_sort *s, mesh_record *records, mesh_record *spare, size_t count) {
    if (count < SHARED_MIN) {
        memcpy(spare, records, count * sizeof *records);
        sort_bucket(spare, records, count, 64);
        return ST_OK;
    }
    return sort_shared(s, records, spare, count, 0);
}
