/* tet_kernel.h - does this ray cross this isosurface in this tetrahedron, and where: the scalar
 * truth.
 *
 * The answer is a pure function of (ray, four vertices, four values, isovalue): a fixed sequence of
 * double additions, products and quotients without contraction, and exact signs (exact.h). It
 * does not depend on how traversal got here.
 *
 * Conventions (those of the reference renderer):
 *   - The vertices come in ascending order of their global ids, so that all tets around a face or
 *     an edge see it in one order. Geometric orientation is free, also none (flat tets).
 *   - A vertex is inside where f >= iso. The isopolygon cuts the tet's edges between inside and
 *     outside. Tets whose vertices are all on one side, or have a value that is not finite, have
 *     none.
 *   - A cut edge's point is a pure function of its ends and their values, see isopolygon_of(): the
 *     tets around the edge have the very same one. A vertex at the isovalue is that point.
 *   - A quadrilateral is two triangles, along the diagonal from point 0 to point 2.
 *   - A hit enters where the ray goes along the polygon's normal. A tet without volume has no side
 *     to enter (made a little thicker one way or the other, it would have opposite ones). It is hit
 *     all the same, so that nothing opens, and `entering` goes there by the order of the ids. Sure
 *     is only that it turns round with the ray, and that tet_surface()'s gradient agrees with it.
 *     So nobody may count on sides that alternate along a ray, and nobody does: shading sees both
 *     sides, and a shadow asks whether the light and the ray's origin are on one side of the
 *     polygon.
 *   - A ray hits a triangle where its three edge functions do not differ in sign, 0 being of either
 *     sign, but for three zeros (the ray lies in its plane, or it has no area): no hit then.
 *
 * Why no ray slips through. Seen along the ray, triangles are triangles of the plane, the ray is a
 * point, and signs are exact: a point of a closed triangle hits it. Tets that share a face share
 * the segment across it, the same two points to the bit, so all triangles together are a closed
 * complex but for the ends of the mesh. What triangles without area (as this ray sees them) cover
 * has no area either: if rays as near as one likes meet the complex, they meet others, of which
 * there are finitely many, each closed, so that the ray meets one of these itself. A ray through
 * an edge or a corner hits all triangles there that have area.
 *
 * Doubles. These hits have the same t bits: where the ray meets an edge, t comes from its two
 * points alone by a formula symmetric in them, where it meets a corner, from that alone. So of hits
 * sorted by (t, cell, iso) only the first of each (t, iso, entering) counts: tet_double(). A ray
 * that touches a silhouette has there one hit that enters and one that leaves. A ray that lies in
 * a polygon's plane may hit what adjoins it at both ends, at two t: no double.
 *
 * Sources: W07 4.1 (isopolygons by marching tetrahedra, 16 cases). Deviation: edges are tested in
 * space and exactly, not in a plane of projection that changes from tet to tet.
 */
#ifndef RENDER_MESH_TET_KERNEL_H
#define RENDER_MESH_TET_KERNEL_H

#include <stdbool.h>
#include <stdint.h>

#include "render/ray/ray.h"
#include "render/ray/surface_point.h"

/* Edges of a tet by number: 01 02 03 12 13 23, in the order of their ends, so of these' global
 * ids. */
enum { TET_EDGES = 6 };

typedef struct tet {
    float p[4][3]; /* finite; in ascending order of global vertex ids */
    float f[4];
} tet;

/* 3 or 4 points on cut edges, in order around: by the right-hand rule the normal points to the
 * inside (f >= iso) unless the tet is flat. Points may coincide. */
typedef struct isopolygon {
    double p[4][3];  /* [count..] are copies of [count - 1] */
    uint8_t edge[4]; /* the edge that each lies on, by number; likewise */
    uint8_t count;
} isopolygon;

/* isopolygon_of() - false, and *out untouched, when the tet is not active: min < iso && iso <= max,
 * all values finite. iso is finite.
 *
 * The point between a and b, a of the lower id: a + s (b - a) with s = (iso - fa) / (fb - fa); b
 * itself where s = 1. It is a vertex that lies at the isovalue; it never leaves the box of a and b.
 */
bool isopolygon_of(const tet *x, double iso, isopolygon *out);

/* tet_cuts[] - the cut edges of a tet by which of its vertices are inside (bit k: vertex k), in
 * order around: by the right-hand rule the normal points to the inside where (v1 - v0) . ((v2 - v0)
 * x (v3 - v0)) > 0. tet_turn_over() - the other way around: the diagonal stays. tet_edge_ends: the
 * vertices of an edge. */
typedef struct tet_cut {
    uint8_t count, edge[4]; /* as of an isopolygon */
} tet_cut;
extern const tet_cut tet_cuts[16];
extern const uint8_t tet_edge_ends[TET_EDGES][2];
void tet_turn_over(uint8_t edge[4], int count);

/* isopolygon_hit() - the first hit of the ray that comes strictly after `after` in (t, cell, iso)
 * order, with t in [r->t0, r->t1]. *found is set only when true is returned; it gets cell (the
 * tet's global index) and iso_index as they are.
 *
 * t lies within the t of the polygon's points. A polygon has two hits (they differ in t) only where
 * rounding has bent a quadrilateral.
 *
 * r->o finite; r->d finite, between 1e-60 and 1e60 long for the sake of t (signs are exact in any
 * case). r->held is not looked at. */
bool isopolygon_hit(const isopolygon *g, const ray *r, uint64_t cell, int32_t iso_index,
                    const hit *after, hit *found);

/* tet_double() - whether two hits of one ray are the same crossing, seen from two tets. */
static inline bool tet_double(const hit *a, const hit *b) {
    return a->t == b->t && a->iso == b->iso && a->entering == b->entering;
}

/* tet_less() - the order (t, iso, entering, cell), in which doubles lie side by side. */
static inline bool tet_less(const hit *a, const hit *b) {
    if (a->t != b->t)
        return a->t < b->t;
    if (a->iso != b->iso)
        return a->iso < b->iso;
    return a->entering != b->entering ? b->entering : a->cell < b->cell;
}

/* tet_gradient() - the gradient of f in the tet, world space, right to 1e-4 of its terms (mostly to
 * 1e-15). False, and gradient untouched, where the tet is too flat for that, or a value not finite.
 */
bool tet_gradient(const tet *x, double gradient[3]);

/* Least |determinant| that has one, relative to the sum of its terms' moduli: these err by about
 * 2^-50 of it, so the gradient by 2^-14. */
#define TET_GRADIENT_SURE 0x1p-36

/* tet_surface() - the point of a hit that isopolygon_hit() found on this ray, tet and isovalue.
 *
 * gradient  that of tet_gradient(). Where there is none: the polygon's unit normal, and `error` is
 *           a distance; zero where the polygon has none, either
 * error     bound of |f - iso| at the computed point o + t d, and where a ray begins that starts
 *           there: what it comes to, and the rounding of all points involved
 * span      the shortest edge of the tet
 * normal    unit, against gradient; zero where that is */
surface_point tet_surface(const tet *x, const ray *r, double iso, const hit *h);

/* What all rays have in common that hit a tet's isopolygon: tet_facts_of(), then tet_surface_at()
 * for each ray is tet_surface(). */
typedef struct tet_facts {
    double at[3];        /* a point of the polygon */
    double slack;        /* what its value may err by; INFINITY: there is none */
    double error[3];     /* of the gradient */
    surface_point point; /* without its error */
} tet_facts;
tet_facts tet_facts_of(const tet *x, double iso);
surface_point tet_surface_at(const tet_facts *f, const ray *r, const hit *h);

/* tet_normal() - the normal alone, which is the same for all rays that hit the tet's isopolygon. */
void tet_normal(const tet *x, double iso, float normal[3]);

#endif
