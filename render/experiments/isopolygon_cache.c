#include "render/experiments/isopolygon_cache.h"

#include <stdatomic.h>
#include <string.h>

#include "render/mesh/mesh_walk.h"

enum { EMPTY, MAKING, THERE };

typedef struct isopolygon_cache {
    kept_polygons head; /* must be first */
    const interest *in; /* an interval's isovalue is its lower end */
    uint32_t room;
    bool precomputed;
    uint32_t *before;     /* per 64 tets: number of active ones before them */
    atomic_uchar *state;  /* per polygon */
    isopolygon *polygons; /* of active tets in order, for each one per interval; count 0: none */
} isopolygon_cache;

static uint32_t room_of(const mesh_shape *shape) {
    return (shape->tets + KEPT_SHARE - 1) / KEPT_SHARE;
}

static size_t words_of(const mesh_shape *shape) {
    return (shape->tets + 63) / 64;
}

static size_t kept_bytes(const mesh_shape *shape) {
    const size_t room = room_of(shape);
    return sizeof(isopolygon_cache) + room * sizeof(isopolygon) +
           words_of(shape) * sizeof(uint32_t) + room;
}

static void lay_out(isopolygon_cache *k, const mesh_shape *shape) {
    k->room = room_of(shape);
    k->polygons = (isopolygon *)(k + 1);
    k->before = (uint32_t *)(k->polygons + k->room);
    k->state = (atomic_uchar *)(k->before + words_of(shape));
}

static void count_active(isopolygon_cache *k, const resident_mesh *tr) {
    uint32_t sum = 0;
    for (size_t w = 0; w < words_of(&tr->mesh); w++) {
        k->before[w] = sum;
        sum += (uint32_t)__builtin_popcountll(tr->active->tets[w]);
    }
}

static void make_polygon(const resident_mesh *tr, uint32_t local, double isovalue, isopolygon *g) {
    const tet x = mesh_walk_tet(tr, local);
    if (!isopolygon_of(&x, isovalue, g))
        g->count = 0;
}

/* Make all polygons that there is room for. */
static void precompute(isopolygon_cache *k, const resident_mesh *tr) {
    uint32_t n = 0;
    for (uint32_t w = 0; w < words_of(&tr->mesh); w++)
        for (uint64_t left = tr->active->tets[w]; left; left &= left - 1)
            for (int i = 0; i < k->in->count && n < k->room; i++)
                make_polygon(tr, 64 * w + (uint32_t)__builtin_ctzll(left), k->in->of[i].lo,
                             &k->polygons[n++]);
}

/* Returns the polygon's number among the kept ones; `room` if it is not kept. */
static uint32_t number_of(const isopolygon_cache *k, const resident_mesh *tr, uint32_t local,
                          double isovalue) {
    int i = 0;
    while (i < k->in->count && k->in->of[i].lo != isovalue)
        i++;
    if (i == k->in->count)
        return k->room;
    const uint64_t below = tr->active->tets[local / 64] & ((UINT64_C(1) << local % 64) - 1);
    const uint64_t n =
        (k->before[local / 64] + (uint64_t)__builtin_popcountll(below)) * (uint64_t)k->in->count +
        (uint64_t)i;
    return n < k->room ? (uint32_t)n : k->room;
}

/* Keep a polygon that has been made, unless another thread does. */
static void offer_polygon(isopolygon_cache *k, uint32_t n, const isopolygon *own) {
    unsigned char empty = EMPTY;
    if (!atomic_compare_exchange_strong_explicit(&k->state[n], &empty, MAKING, memory_order_relaxed,
                                                 memory_order_relaxed))
        return;
    k->polygons[n] = *own;
    atomic_store_explicit(&k->state[n], THERE, memory_order_release);
}

const isopolygon *isopolygon_cache_find(const resident_mesh *tr, uint32_t local, double isovalue,
                                        isopolygon *own) {
    isopolygon_cache *k = tr->polygons ? tr->derived : NULL;
    const uint32_t n = k ? number_of(k, tr, local, isovalue) : 0;
    const isopolygon *g = own;
    if (k && n < k->room &&
        (k->precomputed || atomic_load_explicit(&k->state[n], memory_order_acquire) == THERE)) {
        g = &k->polygons[n];
    } else {
        make_polygon(tr, local, isovalue, own);
        if (k && n < k->room)
            offer_polygon(k, n, own);
    }
    return g->count > 0 ? g : NULL;
}

static void keep(resident_mesh *tr, const interest *in, bool precomputed) {
    isopolygon_cache *k = tr->derived;
    tr->polygons = &k->head;
    k->head.find = isopolygon_cache_find;
    lay_out(k, &tr->mesh);
    k->in = in;
    k->precomputed = precomputed;
    count_active(k, tr);
    if (precomputed)
        precompute(k, tr);
    else
        for (uint32_t n = 0; n < k->room; n++)
            atomic_store_explicit(&k->state[n], EMPTY, memory_order_relaxed);
}

static void keep_all(resident_mesh *tr, const interest *in) {
    keep(tr, in, true);
}

static void keep_seen(resident_mesh *tr, const interest *in) {
    keep(tr, in, false);
}

mesh_derived isopolygon_cache_kind(bool precomputed) {
    return (mesh_derived){kept_bytes, precomputed ? keep_all : keep_seen};
}
