/* flat_tile_template.h - polygons that a tile's rays may hit: which pixels they can cover, in
 * single precision, and the rays there, in doubles; included by the units of an ISA (see
 * formats/base/simd.h).
 *
 * Small polygons meet their rays together, with a polygon and one of its rays per lane. Large ones
 * meet theirs alone, a ray per lane. The kind's unit may define FLAT_QUEUE_OWN and FLAT_TILE_OWN,
 * members that it keeps beside, and defines
 *
 *   static void flat_make_polygons(flat_tile *w, unsigned lanes);   of the queue: polygons
 */
#ifndef RENDER_FLAT_FLAT_TILE_TEMPLATE_H
#define RENDER_FLAT_FLAT_TILE_TEMPLATE_H

#include "formats/base/simd.h"

#ifdef SIMD_NAME

#include "render/flat/flat_polygon_template.h"
#include "render/ray/lane_counts.h"
#include "render/tile/tile_boxes_template.h"

/* The most pixels that waiting polygons may cover together. While they wait, they hide nothing. */
enum { QUEUE_PIXELS = 64 };

/* Polygons that rays may hit, a lane each. */
typedef struct flat_queue {
    const treelet *at[VD_N];
    uint32_t local[VD_N]; /* the cell's number in the treelet */
    int32_t iso[VD_N];
    tile_rect rect[VD_N];   /* pixels where the polygon can be */
    uint32_t centres[VD_N]; /* which of these pixels look at it, as in flat_covers */
    unsigned count, pixels; /* sum of the rectangles' pixels */
    polygon_lanes polygons; /* while rays meet them */
#ifdef FLAT_QUEUE_OWN
    FLAT_QUEUE_OWN
#endif
} flat_queue;

typedef struct flat_tile {
    tile_boxes b;
    flat_queue queue;
#ifdef FLAT_TILE_OWN
    FLAT_TILE_OWN
#endif
} flat_tile;

static void flat_make_polygons(flat_tile *w, unsigned lanes);

/* Side of a window of pixels that starts at a rectangle's corner. */
enum { CENTRES = 4 };

SIMD unsigned centre_ray(tile_rect r, unsigned bit) {
    return TILE * (r.y0 + bit / CENTRES) + r.x0 + bit % CENTRES;
}

/* Of the pixels `centres`, a bit each in a window of 4 x 4, row by row, returns the ones whose rays
 * have no surface nearer than the squared distance near2. */
SIMD uint32_t centres_in_sight(const flat_tile *w, tile_rect r, uint32_t centres, float near2) {
    const float at = near2 * SURELY;
    uint32_t visible = 0;
    for (uint32_t left = centres; left; left &= left - 1)
        if (!(w->b.far2[centre_ray(r, (unsigned)__builtin_ctz(left))] < at))
            visible |= left & -left;
    return visible;
}

/* ---- Pixels' centres ---- */

/* Isopolygons in the picture, relative to a tile's first pixel: their corners in order around, then
 * the first one again. A triangle has its third corner twice. */
typedef struct flat_polygons {
    vf x[5], y[5];
} flat_polygons;

/* Lines around polygons. The edge function of line i falls by y[i] from each pixel of a row to the
 * next. */
typedef struct flat_lines {
    flat_polygons from;
    vf x[4], y[4], error;
} flat_lines;

/* Polygons up to this size, in pixels, are tested against pixel centres. */
static const float CENTRES_REACH = 8.0f;

/* Make the lines around the polygons, and the error bound of their edge functions. deep: far / w.
 *
 * Proof. If a pixel's centre c is within the exact polygon, it is on the same side of all edges.
 * The computed corners are off by at most m per coordinate, twice the margin at `deep`. Errors a
 * and b of the corners P and Q move the edge function at c by (b - a) x (c - P) - (Q - P) x a - (b
 * - a) x a, with |a|, |b| <= m. Let S be the sum of the moduli of all edges' coordinates, so that c
 * - P has S / 2 at most. Then this is less than m S + m S / 2 + 2 m^2. The S of the computed
 * corners is itself off by 16 m. Together this makes 1.5 m S + 26 m^2. Edge functions are rounded
 * by less than 2^-22 (S / 2)^2 < m S / 4, as m > 2e-4 and S < 128. */
SIMD flat_lines lines_around(const tile_view *tile, flat_polygons from, vf deep) {
    const float least = tile->p->margin_least;
    const float slope = (tile->p->margin - least) * projection_depth_share;
    const vf m = f_set(2.0f * least) + f_set(2.0f * slope) * deep;
    flat_lines l = {.from = from};
    vf sum = f_set(0.0f);
    for (int i = 0; i < 4; i++) {
        l.x[i] = l.from.x[i + 1] - l.from.x[i];
        l.y[i] = l.from.y[i + 1] - l.from.y[i];
        sum = sum + (f_abs(l.x[i]) + f_abs(l.y[i]));
    }
    l.error = (f_set(2.0f) * m) * sum + (f_set(32.0f) * m) * m;
    return l;
}

/* Returns the lanes in which a pixel's centre is certainly outside the polygon. side: the edge
 * functions at the centre. */
SIMD mf is_beside(const vf side[4], vf error) {
    const vf least = f_min(f_min(side[0], side[1]), f_min(side[2], side[3]));
    const vf most = f_max(f_max(side[0], side[1]), f_max(side[2], side[3]));
    return mf_and(f_gt(most, error), f_lt(least, f_set(0.0f) - error));
}

typedef struct flat_covers {
    tile_rect rect[VF_N];
    _Alignas(64) float depth[VF_N]; /* no point of the polygon is nearer than this */
    /* If the rectangle is small: the pixels whose centres may be covered, a bit each of a window of
     * 4 x 4 from its corner on, row by row. 0: it is not small. */
    uint32_t centres[VF_N];
} flat_covers;

/* Test pixel centres in small rectangles of small polygons, which flatten() makes of points.
 * Returns the lanes that cover none. */
SIMD mf cover_no_centre(const tile_view *tile,
                        flat_polygons (*flatten)(const tile_view *, const void *),
                        const void *points, const children_extent *e, vf far, mf alive,
                        flat_covers *out) {
    const rect_lanes r = rect_lanes_load(out->rect);
    const vf wide = r.x1 - r.x0, high = r.y1 - r.y0, last = f_set(CENTRES - 1);
    const vf reach = f_max(e->x1 - e->x0, e->y1 - e->y0), zero = f_set(0.0f);
    const mf small =
        mf_and(alive, mf_and(f_le(reach, f_set(CENTRES_REACH)), f_le(f_max(wide, high), last)));
    vf centres = zero;
    if (mf_bits(small)) {
        const flat_lines l = lines_around(tile, flatten(tile, points), far / e->w0);
        for (int y = 0; y < CENTRES; y++) {
            const mf row = mf_and(small, f_ge(high, f_set((float)y)));
            vf side[4];
            if (!mf_bits(row))
                break;
            for (int i = 0; i < 4; i++)
                side[i] =
                    l.x[i] * (r.y0 + f_set((float)y) - l.from.y[i]) - l.y[i] * (r.x0 - l.from.x[i]);
            for (int x = 0; x < CENTRES; x++) {
                const mf there = mf_and(row, f_ge(wide, f_set((float)x)));
                const float bit = (float)(1 << (CENTRES * y + x));
                if (!mf_bits(there))
                    break;
                centres = centres +
                          f_select(mf_and_not(there, is_beside(side, l.error)), f_set(bit), zero);
                for (int i = 0; i < 4; i++)
                    side[i] = side[i] - l.y[i];
            }
        }
    }
    const vi bits = f_to_int(centres);
    memcpy(out->centres, &bits, sizeof bits);
    return mf_and(small, f_le(centres, zero));
}

/* ---- Hits ---- */

/* Polygons of the queue and rays, tested together lane by lane. */
typedef struct met_rays {
    vd d[3];
    uint16_t ray[VD_N];
    uint8_t of[VD_N]; /* the polygon's lane in the queue */
} met_rays;

/* Take a hit of ray i if it is before the one that the ray has. */
static void take_surface(flat_tile *w, unsigned of, unsigned i, double t, bool entering) {
    const flat_queue *q = &w->queue;
    const tile_surface found = {t, q->at[of], q->local[of], q->iso[of], entering};
    if (!tile_state_take(&w->b.s, i, found))
        return;
    if (w->b.s.reach[i] < (double)INFINITY)
        look_as_far(&w->b, i);
    w->b.s.counters->roots++;
}

/* Decide by the scalar kernel what the vectors leave in doubt. A bent quadrilateral may have two
 * hits. */
static void take_scalar(flat_tile *w, unsigned of, unsigned i) {
    const flat_queue *q = &w->queue;
    const flat_polygon g = polygon_lanes_get(&q->polygons, of);
    const tile_surface asked = {.at = q->at[of], .local = q->local[of]};
    const uint64_t cell = w->b.s.order->cell_of(w->b.s.f, &asked);
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
SIMD void take_sure(flat_tile *w, const met_rays *r, unsigned hits, unsigned enters, vd t) {
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
SIMD unsigned meet_lanes(flat_tile *w, const seen_lanes *s, const met_rays *r, unsigned lanes,
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
SIMD void meet_few(flat_tile *w, const seen_lanes *s, unsigned lanes, unsigned quads) {
    const flat_queue *q = &w->queue;
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
SIMD void spread_lane(const seen_lanes *s, unsigned lane, bool quad, seen_lanes *out) {
    for (int i = 0; i < (quad ? 4 : 3); i++)
        for (int a = 0; a < 3; a++)
            out->a[i][a] = d_set(s->a[i][a][lane]);
    for (int k = 0; k < (quad ? EDGES : EDGE_23); k++) {
        for (int a = 0; a < 3; a++)
            out->normal[k][a] = d_set(s->normal[k][a][lane]);
        out->error[k] = d_set(s->error[k][lane]);
    }
}

/* Windows of pixels, as wide as rows of doubles are loaded. */
enum { SPAN = D_ROW, SPANS = VD_N / D_ROW };

/* Returns the rays of row y that look at a lane's polygon. */
SIMD unsigned looking(const flat_tile *w, unsigned lane, unsigned y) {
    const flat_queue *q = &w->queue;
    const tile_rect r = q->rect[lane];
    if (y < r.y0 || y > r.y1)
        return 0;
    if (q->centres[lane])
        return (q->centres[lane] >> CENTRES * (y - r.y0) & ((1u << CENTRES) - 1u)) << r.x0;
    return w->b.s.open[y] & row_mask(r);
}

/* Test one polygon against the rays that look at it, window by window. */
static void meet_many(flat_tile *w, const seen_lanes *all, unsigned lane, bool quad) {
    const tile_rays *rays = &w->b.s.rays;
    const tile_rect rect = w->queue.rect[lane];
    const unsigned span = (1u << SPAN) - 1u;
    unsigned met = 0;
    seen_lanes s;
    met_rays r;
    spread_lane(all, lane, quad, &s);
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

/* A polygon with at most this many rays is tested together with other polygons. */
enum { FEW = 4 };

/* Make the polygons of the queue, if they are not there, and test them against their rays. */
static void walk_queue(flat_tile *w) {
    flat_queue *q = &w->queue;
    const unsigned lanes = (1u << q->count) - 1u;
    unsigned few = 0, many = 0, quads = 0;
    seen_lanes s;
    flat_make_polygons(w, lanes);
    for (unsigned k = 0; k < VD_N && k < q->count; k++) {
        const unsigned rays = (unsigned)__builtin_popcount(q->centres[k]);
        const unsigned there = q->polygons.count[k] > 0, is_few = rays > 0 && rays <= FEW;
        few |= (there & is_few) << k;
        many |= (there & !is_few) << k;
        quads |= (unsigned)(q->polygons.count[k] == 4) << k;
    }
    LANE_COUNT(polygons, few | many);
    see_lanes(&q->polygons, w->b.eye, quads != 0, &s);
    meet_few(w, &s, few, quads);
    for (; many; many &= many - 1) {
        const unsigned k = (unsigned)__builtin_ctz(many);
        meet_many(w, &s, k, quads >> k & 1u);
    }
    q->count = q->pixels = 0;
}

#endif
#endif
