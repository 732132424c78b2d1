/* mesh_tile_polygons_template.h - tests tets that a tile's rays may hit, in doubles; included by
 * the units of an ISA (see formats/base/simd.h).
 *
 * Isopolygons are made a vector of tets at a time. Small ones then meet their rays together, with a
 * polygon and one of its rays per lane. Large ones meet theirs alone, a ray per lane.
 */
#ifndef RENDER_MESH_MESH_TILE_POLYGONS_TEMPLATE_H
#define RENDER_MESH_MESH_TILE_POLYGONS_TEMPLATE_H

#include "formats/base/simd.h"

#ifdef SIMD_NAME

#include "render/mesh/kept_polygons.h"
#include "render/mesh/mesh_tile_state_template.h"

/* ---- Hits ---- */

/* Polygons of the queue and rays, tested together lane by lane. */
typedef struct met_rays {
    vd d[3];
    uint16_t ray[VD_N];
    uint8_t of[VD_N]; /* the polygon's lane in the queue */
} met_rays;

/* Take a hit of ray i if it is before the one that the ray has. */
static void take_surface(mesh_tile *w, unsigned of, unsigned i, double t, bool entering) {
    const tet_queue *q = &w->queue;
    const tile_surface found = {t, &q->at[of]->head, q->local[of], q->iso[of], entering};
    if (!tile_state_take(&w->b.s, i, found))
        return;
    if (w->b.s.reach[i] < (double)INFINITY)
        look_as_far(&w->b, i);
    w->b.s.counters->roots++;
}

/* Decide by the scalar kernel what the vectors leave in doubt. A bent quadrilateral may have two
 * hits. */
static void take_scalar(mesh_tile *w, unsigned of, unsigned i) {
    const tet_queue *q = &w->queue;
    const isopolygon g = polygon_lanes_get(&q->polygons, of);
    const uint64_t cell = q->at[of]->first_tet + q->local[of];
    hit before = hit_before_all(), found;
    ray r = {.t0 = w->b.s.rays.t0[i], .t1 = w->b.s.rays.t1[i]};
    for (int a = 0; a < 3; a++) {
        r.o[a] = r.held[a] = w->b.eye[a];
        r.d[a] = w->b.s.rays.d[a][i];
    }
    for (; flat_polygon_hit(&g, &r, cell, q->iso[of], &before, &found); before = found)
        take_surface(w, of, i, found.t, found.entering);
}

/* Take the certain hits that are nearer than the rays' hits so far. enters: a bit per lane whose
 * ray goes along the normal. */
SIMD void take_sure(mesh_tile *w, const met_rays *r, unsigned hits, unsigned enters, vd t) {
    const tile_rays *rays = &w->b.s.rays;
    double ts[VD_N];
    d_store(ts, t);
    for (; hits; hits &= hits - 1) {
        const unsigned k = (unsigned)__builtin_ctz(hits), i = r->ray[k];
        if (ts[k] >= rays->t0[i] && ts[k] <= rays->t1[i] && ts[k] <= w->b.s.reach[i])
            take_surface(w, r->of[k], i, ts[k], enters >> k & 1u);
    }
}

/* ---- Rays and polygons ---- */

/* Test a ray and a polygon per lane. lanes: which to test; quads: which polygons have four points.
 * Returns the lanes with a hit. */
SIMD unsigned meet_lanes(mesh_tile *w, const seen_lanes *s, const met_rays *r, unsigned lanes,
                         unsigned quads) {
    const weights w12 = weigh(r->d, s->normal[EDGE_12], s->error[EDGE_12]);
    const weights w20 = weigh(r->d, s->normal[EDGE_20], s->error[EDGE_20]);
    const weights w01 = weigh(r->d, s->normal[EDGE_01], s->error[EDGE_01]);
    const verdict v = judge(w12, w20, w01);
    const unsigned hits = md_bits(md_or(v.enters, v.leaves)) & lanes;
    unsigned doubtful = md_bits(v.doubtful), hits2 = 0;
    LANE_COUNT(rays, lanes);
    LANE_COUNT(centres, hits);
    if (quads & lanes) {
        const weights w23 = weigh(r->d, s->normal[EDGE_23], s->error[EDGE_23]);
        const weights w30 = weigh(r->d, s->normal[EDGE_30], s->error[EDGE_30]), w02 = against(w20);
        const verdict v2 = judge(w23, w30, w02);
        hits2 = md_bits(md_or(v2.enters, v2.leaves)) & quads & lanes;
        LANE_COUNT(centres, hits2);
        /* A quadrilateral that is hit twice is bent: leave it to the scalar truth. */
        doubtful |= (md_bits(v2.doubtful) & quads) | (hits & hits2);
        if (hits2 & ~doubtful)
            take_sure(w, r, hits2 & ~doubtful, md_bits(v2.enters),
                      cross_at(r->d, s->a[0], s->a[2], s->a[3], w23, w30, w02));
    }
    if (hits & ~doubtful)
        take_sure(w, r, hits & ~doubtful, md_bits(v.enters),
                  cross_at(r->d, s->a[0], s->a[1], s->a[2], w12, w20, w01));
    for (unsigned left = doubtful & lanes; left; left &= left - 1) {
        const unsigned k = (unsigned)__builtin_ctz(left);
        take_scalar(w, r->of[k], r->ray[k]);
    }
    return hits | hits2;
}

/* Polygons with few rays each: test one ray of each at a time. */
SIMD void meet_few(mesh_tile *w, const seen_lanes *s, unsigned lanes, unsigned quads) {
    const tet_queue *q = &w->queue;
    uint32_t left[VD_N];
    unsigned met = 0;
    met_rays r;
    memset(r.ray, 0, sizeof r.ray);
    for (unsigned k = 0; k < VD_N; k++) {
        left[k] = lanes >> k & 1u ? q->centres[k] : 0;
        r.of[k] = (uint8_t)k;
    }
    while (lanes) {
        unsigned more = 0;
        for (unsigned k = 0; k < VD_N; k++) {
            if (!left[k])
                continue;
            r.ray[k] = (uint16_t)centre_ray(q->rect[k], (unsigned)__builtin_ctz(left[k]));
            left[k] &= left[k] - 1;
            more |= (unsigned)(left[k] != 0) << k;
        }
        for (int a = 0; a < 3; a++)
            r.d[a] = d_load_at(w->b.s.rays.d[a], r.ray);
        met |= meet_lanes(w, s, &r, lanes, quads);
        lanes = more;
    }
    LANE_COUNT(polygons_hit, met);
}

/* Copy a lane's polygon to all lanes. */
SIMD void spread_lane(const seen_lanes *s, unsigned lane, seen_lanes *out) {
    for (int i = 0; i < 4; i++)
        for (int a = 0; a < 3; a++)
            out->a[i][a] = d_set(s->a[i][a][lane]);
    for (int k = 0; k < EDGES; k++) {
        for (int a = 0; a < 3; a++)
            out->normal[k][a] = d_set(s->normal[k][a][lane]);
        out->error[k] = d_set(s->error[k][lane]);
    }
}

/* Windows of pixels, as wide as rows of doubles are loaded. */
enum { SPAN = D_ROW, SPANS = VD_N / D_ROW };

/* Returns the rays of row y that look at a lane's polygon. */
SIMD unsigned looking(const mesh_tile *w, unsigned lane, unsigned y) {
    const tet_queue *q = &w->queue;
    const tile_rect r = q->rect[lane];
    if (y < r.y0 || y > r.y1)
        return 0;
    if (q->centres[lane])
        return (q->centres[lane] >> CENTRES * (y - r.y0) & ((1u << CENTRES) - 1u)) << r.x0;
    return w->b.s.open[y] & row_mask(r);
}

/* Test one polygon against the rays that look at it, window by window. */
static void meet_many(mesh_tile *w, const seen_lanes *all, unsigned lane, bool quad) {
    const tile_rays *rays = &w->b.s.rays;
    const tile_rect rect = w->queue.rect[lane];
    const unsigned span = (1u << SPAN) - 1u;
    unsigned met = 0;
    seen_lanes s;
    met_rays r;
    spread_lane(all, lane, &s);
    memset(r.of, (int)lane, sizeof r.of);
    for (unsigned y = rect.y0; y <= rect.y1; y += SPANS) {
        const unsigned top = y < TILE - SPANS ? y : TILE - SPANS;
        unsigned row[SPANS], any = 0;
        for (unsigned j = 0; j < SPANS; j++)
            any |= row[j] = top + j < y ? 0 : looking(w, lane, top + j);
        while (any) {
            const unsigned first = (unsigned)__builtin_ctz(any);
            const unsigned x = first < TILE - SPAN ? first : TILE - SPAN, at = TILE * top + x;
            unsigned lanes = 0;
            any &= ~(span << x);
            for (unsigned j = 0; j < SPANS; j++) {
                lanes |= (row[j] >> x & span) << SPAN * j;
                row[j] &= ~(span << x);
            }
            for (unsigned k = 0; k < VD_N; k++)
                r.ray[k] = (uint16_t)(at + TILE * (k / SPAN) + k % SPAN);
            for (int a = 0; a < 3; a++)
                r.d[a] = d_load_rows(rays->d[a] + at, TILE);
            met |= meet_lanes(w, &s, &r, lanes, quad ? ~0u : 0);
        }
    }
    LANE_COUNT(polygons_hit, met != 0);
}

/* ---- Tets ---- */

/* Fill a lane by itself: its polygon is kept with the treelet, or isopolygons_near() was not sure
 * of it. */
static void polygon_alone(mesh_tile *w, unsigned lane) {
    tet_queue *q = &w->queue;
    const resident_mesh *at = q->at[lane];
    isopolygon made;
    const isopolygon *g = NULL;
    if (at->polygons) {
        g = at->polygons->find(at, q->local[lane], q->isovalue[lane], &made);
    } else {
        const tet exact = mesh_walk_tet(at, q->local[lane]);
        g = isopolygon_of(&exact, q->isovalue[lane], &made) ? &made : NULL;
    }
    q->polygons.count[lane] = 0;
    if (g)
        polygon_lanes_put(&q->polygons, lane, g);
}

/* A polygon with at most this many rays is tested together with other polygons. */
enum { FEW = 2 };

/* Make the polygons of the queue, and test them against their rays. */
static void walk_queue(mesh_tile *w) {
    tet_queue *q = &w->queue;
    const unsigned lanes = (1u << q->count) - 1u;
    unsigned alone = ~isopolygons_near(&q->tets, q->isovalue, &q->polygons) & lanes;
    unsigned few = 0, many = 0, quads = 0;
    seen_lanes s;
    for (unsigned k = 0; k < VD_N && k < q->count; k++)
        alone |= (unsigned)(q->at[k]->polygons != NULL) << k;
    for (unsigned k = 0; k < VD_N; k++)
        if (alone >> k & 1u)
            polygon_alone(w, k);
    see_lanes(&q->polygons, w->b.eye, &s);
    for (unsigned k = 0; k < VD_N && k < q->count; k++) {
        const unsigned rays = (unsigned)__builtin_popcount(q->centres[k]);
        const unsigned there = q->polygons.count[k] > 0, is_few = rays > 0 && rays <= FEW;
        few |= (there & is_few) << k;
        many |= (there & !is_few) << k;
        quads |= (unsigned)(q->polygons.count[k] == 4) << k;
    }
    LANE_COUNT(polygons, few | many);
    meet_few(w, &s, few, quads);
    for (; many; many &= many - 1) {
        const unsigned k = (unsigned)__builtin_ctz(many);
        meet_many(w, &s, k, quads >> k & 1u);
    }
    q->count = q->pixels = 0;
}

/* Queue a lane's tet. Flush when the queue is full. */
SIMD void put_tet(mesh_tile *w, const resident_mesh *at, const tet_lanes *l, unsigned lane,
                  int32_t iso, tile_rect rect, uint32_t centres) {
    const float *values = mesh_leaf_values(&at->mesh, at->values);
    tet_queue *q = &w->queue;
    const unsigned to = q->count++;
    for (int k = 0; k < 4; k++) {
        const uint32_t v = l->vertex[k][lane];
        for (int a = 0; a < 3; a++)
            q->tets.p[k][a][to] = (double)at->positions[v][a];
        q->tets.f[k][to] = (double)values[v];
    }
    q->isovalue[to] = w->b.s.f->tracer->isos.isovalues[iso];
    q->at[to] = at;
    q->local[to] = l->local[lane];
    q->iso[to] = iso;
    q->rect[to] = rect;
    q->centres[to] = centres;
    q->pixels += (rect.x1 - rect.x0 + 1u) * (rect.y1 - rect.y0 + 1u);
    LANE_COUNT(looked_at, 1u);
    if (q->count == VD_N || q->pixels >= QUEUE_PIXELS)
        walk_queue(w);
}

#endif
#endif
