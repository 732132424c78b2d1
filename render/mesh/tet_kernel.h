/* tet_kernel.h - does this ray cross this isosurface in this tetrahedron, and where: the scalar
 * truth.
 *
 * The answer is a pure function of (ray, four vertices, four values, isovalue): a fixed sequence of
 * double additions, products and quotients without contraction, and exact signs (exact.h). It does
 * not depend on how traversal got here.
 *
 * Conventions (those of the reference renderer):
 *   - The vertices come in ascending order of their global ids, so all tets around a face or an
 *     edge see it in one order. Either orientation is allowed, and none (flat tets).
 *   - A vertex is inside where f >= iso. The isopolygon cuts the tet's edges between inside and
 *     outside. Tets whose vertices are all on one side, or have a value that is not finite, have
 *     none.
 *   - A cut edge's point is a pure function of its ends and their values, see isopolygon_of(): all
 *     tets around the edge have the very same one. A vertex at the isovalue is that point.
 *   - A quadrilateral is two triangles, along the diagonal from point 0 to point 2.
 *   - A hit enters where the ray goes along the polygon's normal. A tet without volume has no side
 *     to enter: made a little thicker one way or the other, it would have opposite sides. It is hit
 *     all the same, so that no gap opens; `entering` then follows from the order of the ids. Only
 *     this is sure: `entering` flips with the ray, and agrees with tet_surface()'s gradient. So no
 *     caller may rely on sides that alternate along a ray, and none does. Shading sees both sides;
 *     a shadow asks whether the light and the ray's origin are on one side of the polygon.
 *   - A ray hits a triangle if its three edge functions do not differ in sign, where 0 has either
 *     sign. If all three are 0, the ray lies in its plane, or it has no area: no hit.
 *
 * Why no ray slips through. Seen along the ray, triangles are triangles of the plane, the ray is a
 * point, and signs are exact: a point of a closed triangle hits it. Tets that share a face share
 * the segment across it, the same two points to the bit. So all triangles together are a closed
 * complex, except at the ends of the mesh. Triangles that have no area as this ray sees them cover
 * no area either. So if rays arbitrarily near meet the complex, they meet other triangles. Of these
 * there are finitely many, each closed, so the ray meets one of them itself. A ray through an edge
 * or a corner hits all triangles there that have area.
 *
 * Doubles. Such hits have the same t bits: where the ray meets an edge, t comes from its two points
 * alone, by a formula symmetric in them; where it meets a corner, from that point alone. So of hits
 * sorted by (t, cell, iso) only the first of each (t, iso, entering) counts: flat_polygon_double().
 * A ray that touches a silhouette has there one hit that enters and one that leaves. A ray that
 * lies in a polygon's plane may hit its neighbours at both ends, at two t: no double.
 *
 * Sources: W07 4.1 (isopolygons by marching tetrahedra, 16 cases). Deviation: edges are tested in
 * space and exactly, not in a plane of projection that changes from tet to tet.
 */
#ifndef RENDER_MESH_TET_KERNEL_H
#define RENDER_MESH_TET_KERNEL_H

#include <stdbool.h>
#include <stdint.h>

#include "render/flat/flat_point.h"
#include "render/flat/flat_polygon.h"
#include "render/ray/ray.h"
#include "render/ray/surface_point.h"

/* Edges of a tet by number: 01 02 03 12 13 23, in the order of their ends, and so of the ends'
 * global ids. */
enum { TET_EDGES = 6 };

typedef struct tet {
    float p[4][3]; /* finite; in ascending order of global vertex ids */
    float f[4];
} tet;

/* Its points lie on cut edges, whose numbers are their ranks. By the right-hand rule the normal
 * points to the inside (f >= iso) unless the tet is flat. */
typedef flat_polygon isopolygon;

/* isopolygon_of() - makes the isopolygon. Returns false, and leaves *out untouched, if the tet is
 * not active: min < iso && iso <= max, all values finite. iso is finite.
 *
 * The point between a and b, where a has the lower id, is a + s (b - a) with s = (iso - fa) / (fb -
 * fa); it is b itself where s = 1. A vertex at the isovalue is itself the point. The point never
 * leaves the box of a and b.
 */
bool isopolygon_of(const tet *x, double iso, isopolygon *out);

/* tet_cuts[] - the cut edges of a tet by which of its vertices are inside (bit k: vertex k), in
 * order around. By the right-hand rule the normal points to the inside where (v1 - v0) . ((v2 - v0)
 * x (v3 - v0)) > 0. tet_turn_over() - reverses the order; the diagonal stays. tet_edge_ends: the
 * vertices of an edge. */
typedef struct tet_cut {
    uint8_t count, edge[4]; /* as of an isopolygon */
} tet_cut;
extern const tet_cut tet_cuts[16];
extern const uint8_t tet_edge_ends[TET_EDGES][2];
void tet_turn_over(uint8_t edge[4], int count);

/* tet_gradient() - gives the gradient of f in the tet, world space, right to 1e-4 of its terms
 * (mostly to 1e-15). Returns false, and leaves gradient untouched, if the tet is too flat for that,
 * or a value is not finite. */
bool tet_gradient(const tet *x, double gradient[3]);

/* The least |determinant| for which there is a gradient, relative to the sum of its terms' moduli.
 * The determinant errs by about 2^-50 of that sum, so the gradient by 2^-14. */
#define TET_GRADIENT_SURE 0x1p-36

/* tet_surface() - describes the point of a hit that flat_polygon_hit() found on this ray, tet and
 * isovalue.
 *
 * gradient  from tet_gradient(). If there is none: the polygon's unit normal, and `error` is a
 *           distance; zero if the polygon has no normal either
 * error     bound of |f - iso| at the computed point o + t d, and at the start of a ray that begins
 *           there: the computed |f - iso|, and the rounding of all points involved
 * span      the shortest edge of the tet
 * normal    unit, against gradient; zero if gradient is */
surface_point tet_surface(const tet *x, const ray *r, double iso, const hit *h);

/* tet_facts_of() - what all rays that hit a tet's isopolygon have in common. With flat_point_at()
 * for each ray it gives the same as tet_surface(). */
flat_facts tet_facts_of(const tet *x, double iso);

/* tet_normal() - gives the normal alone, which is the same for all rays that hit the tet's
 * isopolygon. */
void tet_normal(const tet *x, double iso, float normal[3]);

#endif
