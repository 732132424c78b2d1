/* flat_polygon.h - does this ray cross this triangle or quadrilateral, and where: the scalar truth.
 *
 * The answer is a pure function of (ray, points): a fixed sequence of double additions, products
 * and quotients without contraction, and exact signs (exact.h). Edges are tested from the point of
 * the lower rank to that of the higher one: polygons that share an edge and agree about the order
 * of its ends get the same number, but for its sign. What follows from that is proven in
 * mesh/tet_kernel.h.
 *
 *   - A quadrilateral is two triangles, along the diagonal from point 0 to point 2.
 *   - A ray hits a triangle if its three edge functions do not differ in sign, where 0 has either
 *     sign. If all three are 0, the ray lies in its plane, or it has no area: no hit.
 *   - A hit enters where the ray goes along the polygon's normal.
 */
#ifndef RENDER_FLAT_FLAT_POLYGON_H
#define RENDER_FLAT_FLAT_POLYGON_H

#include <stdbool.h>
#include <stdint.h>

#include "render/ray/ray.h"

/* 3 or 4 points, in order around: the right-hand rule gives the normal. Points may coincide. */
typedef struct flat_polygon {
    double p[4][3];  /* [count..] are copies of [count - 1] */
    uint8_t edge[4]; /* rank of each point; copies as for p */
    uint8_t count;
} flat_polygon;

/* flat_polygon_hit() - finds the first hit of the ray that comes strictly after `after` in (t,
 * cell, iso) order, with t in [r->t0, r->t1]. *found is set only when true is returned; it gets
 * cell (the cell's global index) and iso_index as given.
 *
 * t lies within the t of the polygon's points. A polygon has two hits, at different t, only where
 * rounding has bent a quadrilateral.
 *
 * r->o finite; r->d finite, between 1e-60 and 1e60 long for the sake of t (signs are exact in any
 * case). r->held is not looked at. */
bool flat_polygon_hit(const flat_polygon *g, const ray *r, uint64_t cell, int32_t iso_index,
                      const hit *after, hit *found);

/* flat_polygon_double() - whether two hits of one ray are the same crossing, seen from two polygons
 * with an edge or a corner in common. */
static inline bool flat_polygon_double(const hit *a, const hit *b) {
    return a->t == b->t && a->iso == b->iso && a->entering == b->entering;
}

/* flat_polygon_less() - the order (t, iso, entering, cell), in which doubles lie side by side. */
static inline bool flat_polygon_less(const hit *a, const hit *b) {
    if (a->t != b->t)
        return a->t < b->t;
    if (a->iso != b->iso)
        return a->iso < b->iso;
    return a->entering != b->entering ? b->entering : a->cell < b->cell;
}

/* flat_polygon_next() - finds the first hit behind `after` in that order, which is not the same
 * crossing. */
bool flat_polygon_next(const flat_polygon *g, const ray *r, uint64_t cell, int32_t iso_index,
                       const hit *after, hit *found);

#endif
