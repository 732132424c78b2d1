/* tile_state_template.h - the state that kernels of tiles for grids and for meshes share: a tile's
 * rays, and the surfaces that they have met; included by the units of an ISA (see
 * formats/base/simd.h).
 *
 * A walk keeps the nearest surfaces of each ray, in order. If surfaces are opaque, it keeps one;
 * else as many as are composited, or as there is room for (layers). A ray is full when nothing
 * behind its last surface counts, or there is no room. From then on it looks only up to that
 * surface. Rays that lacked room are walked again, behind their surfaces (tile_state_again()).
 */
#ifndef RENDER_TILE_TILE_STATE_TEMPLATE_H
#define RENDER_TILE_TILE_STATE_TEMPLATE_H

#include "formats/base/simd.h"

#ifdef SIMD_NAME

#include "render/surface/surface_integrator.h"
#include "render/tile/tile_rays_template.h"

/* The most surfaces of a ray in one walk. */
enum { TILE_LAYERS = 8 };

/* A surface on a ray's way. A kind's unit may define TILE_SURFACE_OWN, members that it keeps
 * beside.
 */
typedef struct tile_surface {
    double t;
    const treelet *at;
    uint32_t local; /* cell number in the treelet, as the kind counts */
    int32_t iso;
    bool entering;
#ifdef TILE_SURFACE_OWN
    TILE_SURFACE_OWN
#endif
} tile_surface;

/* How a kind orders surfaces at the same t. */
typedef struct tile_order {
    uint64_t (*cell_of)(const frame *f, const tile_surface *s);
    bool (*less)(const hit *a, const hit *b);
    bool (*same)(const hit *a, const hit *b); /* one crossing, seen from two cells */
} tile_order;

typedef struct tile_state {
    const frame *f;
    ray_counters *counters;
    tile_outcome *out;
    const tile_order *order;
    uint32_t x0, y0; /* the tile's first pixel */
    bool has_rays;
    tile_rays rays;       /* made when first needed */
    tile_row asked[TILE]; /* a bit a pixel, as in tile.h */
    tile_row open[ROWS];  /* pixels whose rays still look for a surface */
    /* Found by this walk: */
    int layers;               /* the most surfaces it keeps of a ray */
    int deepest;              /* the most that any ray has */
    double reach[TILE_RAYS];  /* how far a ray looks */
    uint8_t count[TILE_RAYS]; /* surfaces of each ray; `layers` places a ray, in order */
    tile_surface surfaces[TILE_RAYS * TILE_LAYERS];
    /* Found by earlier walks: */
    int before;                    /* layers of each ray */
    float alpha[TILE_RAYS];        /* composited so far */
    tile_surface after[TILE_RAYS]; /* the last one, if before > 0: only what is behind it counts */
} tile_state;

/* The k-th surfaces of all rays, counted from the front; number: k. */
typedef struct tile_layer {
    const tile_state *s;
    unsigned number;
} tile_layer;

static const leafcast_surface *tile_look(const tile_state *s, int32_t iso) {
    return &surface_look_of(s->f)->surfaces[0][iso];
}

/* ---- Walks ---- */

/* Begin a walk with at most `most` layers. */
static void begin_walk(tile_state *s, int most) {
    const int wanted = surface_layers(s->f);
    s->layers = wanted == 0 || wanted - s->before > most ? most : wanted - s->before;
    s->deepest = 0;
    memset(s->count, 0, sizeof s->count);
    for (unsigned i = 0; i < TILE_RAYS; i += VD_N)
        d_store(s->reach + i, d_set(INFINITY));
}

static void tile_state_begin(tile_state *s, const frame *f, const tile_order *order, int most,
                             uint32_t x0, uint32_t y0, const tile_row asked[], tile_outcome *out,
                             ray_counters *counters) {
    s->f = f;
    s->counters = counters;
    s->out = out;
    s->order = order;
    s->x0 = x0;
    s->y0 = y0;
    s->has_rays = false;
    out->absent_count = 0;
    for (unsigned y = 0; y < ROWS; y++)
        s->open[y] = y < TILE ? asked[y] : 0;
    for (unsigned y = 0; y < TILE; y++) {
        s->asked[y] = s->open[y];
        s->rays.single[y] = out->waits[y] = 0;
    }
    s->before = 0;
    memset(s->alpha, 0, sizeof s->alpha);
    begin_walk(s, most);
}

/* Make the rays, once. Tiles that meet no active cell do not need them. */
static void tile_state_rays(tile_state *s) {
    if (s->has_rays)
        return;
    tile_rays_make(s->f, s->x0, s->y0, &s->rays);
    s->has_rays = true;
    for (unsigned y = 0; y < TILE; y++) {
        s->rays.single[y] &= s->asked[y];
        s->open[y] &= ~s->rays.single[y];
    }
}

/* ---- Surfaces ---- */

static tile_surface *surfaces_of(tile_state *s, unsigned i) {
    return &s->surfaces[i * (unsigned)s->layers];
}

/* Returns whether ray i has a surface in a layer. surface_of() then returns it. */
static bool in_layer(const tile_layer *l, unsigned i) {
    return l->number < l->s->count[i];
}

static const tile_surface *surface_of(const tile_layer *l, unsigned i) {
    return &l->s->surfaces[i * (unsigned)l->s->layers + l->number];
}

static hit tile_hit(const tile_state *s, const tile_surface *x) {
    return (hit){x->t, s->order->cell_of(s->f, x), x->iso, x->entering};
}

/* Returns -1 if a comes before b, 0 if both are the same crossing, 1 if a comes after b. */
static int compare(const tile_state *s, const tile_surface *a, const tile_surface *b) {
    if (a->t != b->t)
        return a->t < b->t ? -1 : 1;
    const hit x = tile_hit(s, a), y = tile_hit(s, b);
    if (s->order->same(&x, &y))
        return 0;
    return s->order->less(&x, &y) ? -1 : 1;
}

/* Cut off surfaces of ray i that no longer count. Returns whether the ray is full. */
static bool is_full(tile_state *s, unsigned i) {
    const tile_surface *x = surfaces_of(s, i);
    float alpha = s->alpha[i];
    for (unsigned k = 0; k < s->count[i]; k++) {
        const float opacity = tile_look(s, x[k].iso)->opacity;
        alpha += (1.0f - alpha) * opacity;
        if (!surface_shows_through(alpha, opacity)) {
            s->count[i] = (uint8_t)(k + 1);
            return true;
        }
    }
    return s->count[i] == s->layers;
}

/* Two cells found the same crossing. Keep the surface of the lesser cell. */
static void take_double(const tile_state *s, tile_surface *known, const tile_surface *found) {
    const hit x = tile_hit(s, found), y = tile_hit(s, known);
    if (s->order->less(&x, &y))
        *known = *found;
}

/* tile_state_take() for a ray that keeps several surfaces, or has one. */
static __attribute__((noinline)) bool take_among_others(tile_state *s, unsigned i,
                                                        const tile_surface *found) {
    tile_surface *x = surfaces_of(s, i);
    unsigned k = s->count[i];
    if (s->before > 0 && compare(s, found, &s->after[i]) <= 0)
        return false;
    for (; k > 0; k--) {
        const int order = compare(s, found, &x[k - 1]);
        if (order == 0)
            take_double(s, &x[k - 1], found);
        if (order == 0)
            return false;
        if (order > 0)
            break;
    }
    if ((int)k == s->layers)
        return false;
    const unsigned last = s->count[i] < s->layers ? s->count[i]++ : (unsigned)s->layers - 1;
    for (unsigned to = last; to > k; to--)
        x[to] = x[to - 1];
    x[k] = *found;
    if (is_full(s, i))
        s->reach[i] = x[s->count[i] - 1].t;
    if (s->count[i] > s->deepest)
        s->deepest = s->count[i];
    return k < s->count[i];
}

/* Insert a surface, in order, among the surfaces of ray i. Returns false if it does not count, or
 * is there already. Sets the reach of a ray that is full. The common case is a ray's first and only
 * surface. It is stored member by member: a copy of the struct would wait for members that have
 * just been stored. So only the other case may take an address. */
SIMD bool tile_state_take(tile_state *s, unsigned i, tile_surface found) {
    if (s->layers > 1 || s->before > 0 || s->count[i] > 0) {
        const tile_surface taken = found;
        return take_among_others(s, i, &taken);
    }
    tile_surface *to = surfaces_of(s, i);
#ifdef TILE_SURFACE_OWN
    *to = found;
#else
    to->t = found.t;
    to->at = found.at;
    to->local = found.local;
    to->iso = found.iso;
    to->entering = found.entering;
#endif
    s->count[i] = 1;
    s->deepest = 1;
    s->reach[i] = found.t;
    return true;
}

/* Returns which of `count` rays from i on have a surface in a layer. */
SIMD unsigned hits_from(const tile_layer *l, unsigned i, unsigned count) {
    unsigned hits = 0;
    for (unsigned k = 0; k < count; k++)
        hits |= (unsigned)in_layer(l, i + k) << k;
    return hits;
}

/* ---- Again ---- */

/* Returns the last surface of a ray that has s->layers surfaces. */
static const tile_surface *last_of(const tile_state *s, unsigned i) {
    return &s->surfaces[(i + 1) * (unsigned)s->layers - 1];
}

/* Returns whether ray i has s->layers surfaces, and looks for more behind them. alpha: the alpha
 * composited so far, per ray. */
static bool wants_more(const tile_state *s, unsigned i, const float alpha[]) {
    const bool done = (s->rays.single[i / TILE] | s->out->waits[i / TILE]) >> i % TILE & 1u;
    return !done && s->count[i] == s->layers &&
           surface_shows_through(alpha[i], tile_look(s, last_of(s, i)->iso)->opacity);
}

/* Call when the surfaces found are composited. Begins another walk, for the rays that had no room
 * for more surfaces: it looks behind their last ones. Returns false if there is no such ray. */
static bool tile_state_again(tile_state *s, int most, const float alpha[]) {
    const int wanted = surface_layers(s->f);
    tile_row any = 0;
    if (s->deepest < s->layers || s->before + s->layers == wanted)
        return false;
    memset(s->open, 0, sizeof s->open);
    for (unsigned i = 0; i < TILE_RAYS; i++) {
        if (!wants_more(s, i, alpha))
            continue;
        s->open[i / TILE] |= (tile_row)1 << i % TILE;
        any |= s->open[i / TILE];
        s->after[i] = *last_of(s, i);
    }
    memcpy(s->alpha, alpha, sizeof s->alpha);
    s->before += s->layers;
    if (any)
        begin_walk(s, most);
    return any;
}

#endif
#endif
