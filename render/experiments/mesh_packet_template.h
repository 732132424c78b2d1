/* mesh_packet_template.h - mesh_packet_X() of mesh_packet.h; included by the units of an ISA (see
 * formats/base/simd.h). */
#ifndef RENDER_MESH_MESH_PACKET_TEMPLATE_H
#define RENDER_MESH_MESH_PACKET_TEMPLATE_H

#include "formats/base/simd.h"

#ifdef SIMD_NAME

#include "render/experiments/isopolygon_cache.h"
#include "render/experiments/mesh_packet.h"
#include "render/experiments/packet_frustum.h"
#include "render/mesh/mesh_shade_template.h"
#include "render/mesh/mesh_tracer.h"
#include "render/mesh/tet_batch.h"
#include "render/tile/tile_rects_template.h"
#include "render/walk/box_interval_template.h"

void SIMD_NAME(mesh_packet)(const frame *f, uint32_t x0, uint32_t y0, const tile_row asked[],
                            tile_outcome *out, ray_counters *counters);
void SIMD_NAME(tet_batch)(const isopolygon *g, uint64_t cell, int32_t iso_index, tet_known known,
                          flat_rays *rays, int first, int end);

/* A node or treelet still to be visited, its box relative to the eye. */
typedef struct packet_pending {
    packet_box box;
    float near2; /* its distance from the eye, squared */
    int first;   /* the rays before it miss the box */
    bool only;   /* an only child: entered without a test of its box */
    uint32_t level, i;
} packet_pending;

enum {
    PACKET_TREELET_STACK = MESH_DEPTH_MAX * (MESH_CHILDREN - 1) + 1,
    PACKET_TREE_STACK = TREELET_TREE_LEVELS_MAX * TREELET_TREE_ARITY
};

typedef struct packet {
    tile_state s; /* the state of the packet's tile */
    ray_counters *counters;
    unsigned side, x, y; /* position of its first pixel in the tile */
    int count;           /* number of its rays, stored row by row */
    double eye[3];
    packet_frustum frustum;
    bool lowered; /* rays have found something since `frustum.far` was set */
    flat_rays rays;
    packet_pending in_treelet[PACKET_TREELET_STACK], in_tree[PACKET_TREE_STACK]; /* stacks */
} packet;

/* What is kept in the outcome's scratch. */
typedef struct packet_work {
    packet packet;
    mesh_shading shading;
} packet_work;
_Static_assert(sizeof(packet_work) <= MESH_TILE_SCRATCH, "a tile has room in its scratch");

/* Side of W07's smallest packets, in rays. All their 2 x 2 rays are tested against each box; they
 * use no interval arithmetic. */
enum { PACKET_SMALLEST = 2 };

/* Surfaces that a walk finds per ray. */
enum { PACKET_LAYERS = 1 };

/* ---- Rays and boxes ---- */

/* Returns which of VD_N rays from `at` on meet the box before their nearest hit so far. */
SIMD unsigned rays_meet(const packet *w, const packet_box *b, int at) {
    const flat_rays *r = &w->rays;
    const vd d[3] = {d_load(r->d[0] + at), d_load(r->d[1] + at), d_load(r->d[2] + at)};
    return box_interval_meets(d, b->lo, b->hi, d_load(r->from + at), d_load(r->to + at));
}

/* Set frustum.far to the greatest t up to which any ray still looks. */
SIMD void look_again(packet *w) {
    vd far = d_set(-INFINITY);
    double lanes[VD_N];
    for (int at = 0; at < w->count; at += VD_N)
        far = d_max(far, d_load(w->rays.to + at));
    d_store(lanes, far);
    w->frustum.far = lanes[0];
    for (int k = 1; k < VD_N; k++)
        w->frustum.far = lanes[k] > w->frustum.far ? lanes[k] : w->frustum.far;
    w->lowered = false;
}

/* Test all rays against the box at once, by interval arithmetic. Returns whether any may meet it
 * before its nearest hit so far; *reach: which ones. */
SIMD bool packet_may_meet(packet *w, const packet_box *b, packet_reach *reach) {
    if (w->lowered)
        look_again(w);
    w->counters->interval_tests++;
    return packet_frustum_box(&w->frustum, b, reach);
}

/* Test rays of [from, end), VD_N at most, side by side. Returns the first that meets the box; end:
 * none. Tests only rays that still look as far as `near`. */
SIMD int first_of_few(packet *w, const packet_box *b, double near, int from, int end) {
    const int at = from & -VD_N;
    const unsigned there = (1u << (end - at)) - (1u << (from - at));
    const unsigned looking = md_bits(d_ge(d_load(w->rays.to + at), d_set(near))) & there;
    const unsigned met = looking ? rays_meet(w, b, at) & looking : 0;
    const unsigned tested = met ? looking & ((met & -met) * 2 - 1) : looking;
    w->counters->box_tests += (unsigned)__builtin_popcount(tested);
    return met ? at + __builtin_ctz(met) : end;
}

/* Returns the first ray from `first` on that meets the box; count: none. */
SIMD int first_to_meet(packet *w, const packet_box *b, const packet_reach *reach, int first) {
    const packet_rect *r = &reach->pixels;
    const int side = (int)w->side;
    for (int y = r->y0; y <= r->y1; y++) {
        const int end = side * y + r->x1 + 1;
        int at = side * y + r->x0 > first ? side * y + r->x0 : first;
        while (at < end) {
            const int stop = (at & -VD_N) + VD_N < end ? (at & -VD_N) + VD_N : end;
            const int found = first_of_few(w, b, reach->near, at, stop);
            if (found < stop)
                return found;
            at = stop;
        }
    }
    return w->count;
}

/* Test all rays of a packet of 2 x 2. Returns the first that meets the box; count: none. */
SIMD int first_of_four(packet *w, const packet_box *b) {
    w->counters->box_tests += (unsigned)w->count;
    for (int at = 0; at < w->count; at += VD_N) {
        const unsigned met = rays_meet(w, b, at);
        if (met)
            return at + __builtin_ctz(met);
    }
    return w->count;
}

/* Returns whether the packet enters the box; p->first: its first ray there. */
SIMD bool packet_enters(packet *w, packet_pending *p) {
    packet_reach reach;
    if (p->only)
        return true;
    if (w->side == PACKET_SMALLEST) {
        p->first = first_of_four(w, &p->box);
        return p->first < w->count;
    }
    w->counters->box_tests++;
    if (rays_meet(w, &p->box, p->first & -VD_N) >> p->first % VD_N & 1u)
        return true;
    if (!packet_may_meet(w, &p->box, &reach))
        return false;
    p->first = first_to_meet(w, &p->box, &reach, p->first + 1);
    return p->first < w->count;
}

/* Narrow [*first, *end) to the rays of the rectangle that still look as far as `near`, from the
 * first to the last of them. Returns false if there are none. */
SIMD bool still_looking(const packet *w, const packet_reach *reach, int *first, int *end) {
    const packet_rect *r = &reach->pixels;
    const int side = (int)w->side;
    int one = w->count, last = -1;
    for (int y = r->y0; y <= r->y1; y++) {
        const int stop = side * y + r->x1 + 1;
        for (int i = side * y + r->x0; i < stop; i = (i & -VD_N) + VD_N) {
            const int at = i & -VD_N;
            unsigned lanes = md_bits(d_ge(d_load(w->rays.to + at), d_set(reach->near)));
            lanes &= ~0u << (i - at);
            if (stop - at < VD_N)
                lanes &= (1u << (stop - at)) - 1;
            if (!lanes)
                continue;
            const int lowest = at + __builtin_ctz(lanes);
            one = lowest < one ? lowest : one; /* a vector may hold several rows */
            last = at + 31 - __builtin_clz(lanes);
        }
    }
    *first = one > *first ? one : *first;
    *end = last + 1;
    return *first < *end;
}

/* Returns whether the packet has to look into a leaf; *first to *end: with which rays. */
SIMD bool packet_visits(packet *w, const packet_pending *p, int *first, int *end) {
    packet_reach reach;
    *first = p->first;
    *end = w->count;
    if (w->side == PACKET_SMALLEST) {
        *first = first_of_four(w, &p->box);
        return *first < w->count;
    }
    return packet_may_meet(w, &p->box, &reach) && still_looking(w, &reach, first, end);
}

/* ---- Isopolygons ---- */

SIMD tet_known known_by(packet_view view) {
    return view == PACKET_HITS_FIRST    ? TET_FIRST_IS_HIT
           : view == PACKET_HITS_SECOND ? TET_SECOND_IS_HIT
                                        : TET_UNKNOWN;
}

static void packet_tet(packet *w, const resident_mesh *at, uint32_t local, int first, int end) {
    const frame *f = w->s.f;
    const isovalue_list *isos = &f->tracer->isos;
    for (int i = 0; i < isos->count; i++) {
        isopolygon own;
        const isopolygon *g = isopolygon_cache_find(at, local, isos->isovalues[i], &own);
        if (!g)
            continue;
        w->counters->isopolygons++;
        packet_view view = PACKET_DIFFERS;
        if (w->side > PACKET_SMALLEST)
            view = packet_frustum_polygon(&w->frustum, g);
        if (view == PACKET_MISSES)
            continue;
        if (view == PACKET_DIFFERS)
            w->counters->polygon_tests += (uint64_t)(end - first);
        SIMD_NAME(tet_batch)(g, at->first_tet + local, i, known_by(view), &w->rays, first, end);
        w->lowered = true;
    }
}

static void packet_leaf(packet *w, const resident_mesh *at, const packet_pending *p) {
    const uint32_t leaf = p->i & ~(uint32_t)MESH_LEAF;
    const uint16_t *leaves = mesh_leaf_first(&at->mesh, at->head.payload);
    const uint32_t first = leaves[leaf], end = leaves[leaf + 1];
    int first_ray, end_ray;
    if (!packet_visits(w, p, &first_ray, &end_ray))
        return;
    w->counters->isorange_tests += end - first;
    for (uint32_t word = first / 64; word * 64 < end; word++) {
        uint64_t bits = mesh_active_word(at->active, word, first, end);
        w->s.counters->cells += (uint64_t)__builtin_popcountll(bits);
        for (; bits; bits &= bits - 1)
            packet_tet(w, at, word * 64 + (uint32_t)__builtin_ctzll(bits), first_ray, end_ray);
    }
}

/* ---- Nodes ---- */

/* Insert a child among its siblings from `bottom` on, the nearest last. */
SIMD int push_child(packet_pending *stack, int bottom, int top, const packet_pending *child) {
    int at = top;
    for (; at > bottom && stack[at - 1].near2 < child->near2; at--)
        stack[at] = stack[at - 1];
    stack[at] = *child;
    return top + 1;
}

static float packet_near2(const packet_box *b) {
    double sum = 0.0;
    for (int a = 0; a < 3; a++) {
        const double beside = b->lo[a] > 0.0 ? b->lo[a] : b->hi[a] < 0.0 ? b->hi[a] : 0.0;
        sum += beside * beside;
    }
    return (float)sum;
}

/* Push a node's active children. Count all children: each is one isorange test. */
SIMD int open_node(packet *w, const resident_mesh *at, const packet_pending *p,
                   packet_pending *stack, int top) {
    const mesh_node *n = &at->nodes[p->i];
    const unsigned active = at->active->children[p->i];
    const int bottom = top;
    w->s.counters->nodes++;
    for (int c = 0; c < MESH_CHILDREN && n->child[c] != MESH_NO_CHILD; c++)
        w->counters->isorange_tests++;
    for (unsigned left = active; left; left &= left - 1) {
        const unsigned c = (unsigned)__builtin_ctz(left);
        packet_pending child = {
            .first = p->first, .only = !(active & (active - 1)), .i = n->child[c]};
        for (int a = 0; a < 3; a++) {
            child.box.lo[a] = (double)mesh_leaf_plane(&at->planes, a, n->lo[a][c]) - w->eye[a];
            child.box.hi[a] = (double)mesh_leaf_plane(&at->planes, a, n->hi[a][c]) - w->eye[a];
        }
        child.near2 = packet_near2(&child.box);
        top = push_child(stack, bottom, top, &child);
    }
    return top;
}

static void packet_treelet(packet *w, const resident_mesh *at, int first_ray) {
    packet_pending *stack = w->in_treelet;
    int top = 0;
    stack[top++] = (packet_pending){.first = first_ray, .only = true};
    while (top > 0) {
        packet_pending p = stack[--top];
        if (p.i & MESH_LEAF)
            packet_leaf(w, at, &p);
        else if (packet_enters(w, &p))
            top = open_node(w, at, &p, stack, top);
    }
}

/* ---- Treelets ---- */

/* Suspend rays that pass an absent treelet. */
static void packet_waits(packet *w, const packet_pending *p) {
    tile_outcome *out = w->s.out;
    bool any = false;
    for (int i = p->first; i < w->count; i++) {
        const unsigned y = w->y + (unsigned)i / w->side, x = w->x + (unsigned)i % w->side;
        if (!(rays_meet(w, &p->box, i & -VD_N) >> i % VD_N & 1u))
            continue;
        out->waits[y] |= 1u << x;
        flat_rays_clear(&w->rays, i);
        any = true;
    }
    if (any)
        tile_absent(out, p->i, 0);
}

static void packet_resident(packet *w, const packet_pending *p) {
    const tracer *tr = w->s.f->tracer;
    const resident_mesh *at = resident_mesh_of(loader_lookup(tr->treelets, p->i));
    if (!at) {
        packet_waits(w, p);
        return;
    }
    tracer_touch(tr, p->i);
    packet_treelet(w, at, p->first);
}

SIMD void box_of_bounds(const packet *w, const float bounds[6], packet_box *box) {
    for (int a = 0; a < 3; a++) {
        box->lo[a] = (double)bounds[a] - w->eye[a];
        box->hi[a] = (double)bounds[a + 3] - w->eye[a];
    }
}

SIMD int open_family(packet *w, const packet_pending *p, packet_pending *stack, int top) {
    const treelet_tree *tree = w->s.f->tracer->treelets->tree;
    uint32_t count, first = treelet_tree_children(tree, p->level, p->i, &count);
    unsigned active = 0;
    const int bottom = top;
    w->s.counters->nodes++;
    w->counters->isorange_tests += count;
    for (uint32_t c = 0; c < count; c++)
        active |= (unsigned)tree->active[p->level - 1][first + c] << c;
    for (unsigned left = active; left; left &= left - 1) {
        const uint32_t i = first + (uint32_t)__builtin_ctz(left);
        packet_pending child = {.first = p->first,
                                .only = !(active & (active - 1)) && p->level > 1,
                                .level = p->level - 1,
                                .i = i};
        box_of_bounds(w, tree->bounds[p->level - 1][i], &child.box);
        child.near2 = packet_near2(&child.box);
        top = push_child(stack, bottom, top, &child);
    }
    return top;
}

static void packet_mesh(packet *w, int first_ray) {
    const treelet_tree *tree = w->s.f->tracer->treelets->tree;
    const uint32_t last = tree->levels - 1;
    packet_pending *stack = w->in_tree;
    int top = 0;
    w->counters->isorange_tests++;
    if (tree->active[last][0]) {
        stack[top] = (packet_pending){.first = first_ray, .level = last};
        box_of_bounds(w, tree->bounds[last][0], &stack[top++].box);
    }
    while (top > 0) {
        packet_pending p = stack[--top];
        if (!packet_enters(w, &p))
            continue;
        if (p.level == 0)
            packet_resident(w, &p);
        else
            top = open_family(w, &p, stack, top);
    }
}

/* ---- Packets ---- */

/* Gather the packet's rays. Returns the first one that looks for hits; w->count: none does. */
static int packet_begin(packet *w) {
    const tile_rays *rays = &w->s.rays;
    const hit before = hit_before_all();
    const int padded = (w->count + 15) / 16 * 16;
    int first = w->count;
    const tile_view view = tile_view_of(w->s.f, w->s.x0 + w->x, w->s.y0 + w->y);
    packet_frustum_begin(&w->frustum, view.p, view.x, view.y, (int)w->side);
    for (int i = padded; i-- > 0;) {
        const unsigned y = w->y + (unsigned)i / w->side, x = w->x + (unsigned)i % w->side;
        const unsigned from = TILE * y + x;
        flat_rays_clear(&w->rays, i);
        if (i >= w->count || !(w->s.open[y] >> x & 1u))
            continue;
        ray r = {.t0 = rays->t0[from], .t1 = rays->t1[from]};
        for (int a = 0; a < 3; a++) {
            r.o[a] = w->eye[a];
            r.d[a] = rays->d[a][from];
        }
        const hit after = w->s.before > 0 ? tile_hit(&w->s, &w->s.after[from]) : before;
        flat_rays_put(&w->rays, i, &r, &after);
        packet_frustum_add(&w->frustum, r.d);
        first = i;
    }
    for (int k = 0; k < 4; k++) {
        const unsigned y = w->y + (k / 2 ? w->side - 1 : 0), x = w->x + (k % 2 ? w->side - 1 : 0);
        for (int a = 0; a < 3; a++)
            w->frustum.corner[a][k] = rays->d[a][TILE * y + x];
    }
    w->lowered = true;
    return first;
}

/* Returns the resident treelet that holds a tet, by the tet's number in the whole mesh. */
static const resident_mesh *treelet_of_tet(const loader *l, uint64_t number) {
    const uint64_t *first = l->file->mesh->first_tet;
    uint32_t lo = 0, hi = l->file->layout.treelets;
    while (hi - lo > 1) {
        const uint32_t middle = lo + (hi - lo) / 2;
        *(first[middle] <= number ? &lo : &hi) = middle;
    }
    return resident_mesh_of(loader_lookup(l, lo));
}

/* Hand the hits of the packet's rays to the tile. */
static void packet_end(packet *w) {
    const loader *treelets = w->s.f->tracer->treelets;
    const resident_mesh *at = NULL;
    for (int i = 0; i < w->count; i++) {
        const hit *h = &w->rays.best[i];
        const unsigned y = w->y + (unsigned)i / w->side, x = w->x + (unsigned)i % w->side;
        const unsigned to = TILE * y + x;
        if (!hit_exists(h))
            continue;
        if (!at || h->cell < at->first_tet || h->cell - at->first_tet >= at->mesh.tets)
            at = treelet_of_tet(treelets, h->cell);
        const tile_surface found = {h->t, &at->head, (uint32_t)(h->cell - at->first_tet), h->iso,
                                    h->entering};
        (void)tile_state_take(&w->s, to, found);
        w->s.counters->roots++;
    }
}

/* Trace all packets of a tile. */
static void trace_packets(packet *w) {
    for (w->y = 0; w->y < TILE; w->y += w->side)
        for (w->x = 0; w->x < TILE; w->x += w->side) {
            const int first = packet_begin(w);
            if (first == w->count)
                continue;
            packet_mesh(w, first);
            packet_end(w);
        }
}

void SIMD_NAME(mesh_packet)(const frame *f, uint32_t x0, uint32_t y0, const tile_row asked[],
                            tile_outcome *out, ray_counters *counters) {
    packet_work *work = out->scratch;
    packet *w = &work->packet;
    tile_state_begin(&w->s, f, &mesh_order, PACKET_LAYERS, x0, y0, asked, out, counters);
    tile_state_rays(&w->s);
    w->counters = counters;
    w->side = mesh_rays_of(f->tracer)->packet;
    w->count = (int)(w->side * w->side);
    w->rays.front_first = false;
    w->rays.one_origin = true;
    for (int a = 0; a < 3; a++)
        w->eye[a] = f->projection->eye[a];
    mesh_shade_begin(&work->shading, &w->s);
    do {
        trace_packets(w);
        mesh_shade(&work->shading);
    } while (tile_state_again(&w->s, PACKET_LAYERS, work->shading.pixels.rgba[3]));
    mesh_shade_end(&work->shading);
}

#endif
#endif
