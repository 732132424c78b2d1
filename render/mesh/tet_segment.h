/* tet_segment.h - a ray's piece in one tetrahedron, and the value at its ends: the scalar truth.
 *
 * A pure function of (ray, four vertices, four values), as tet_kernel.h is:
 *   - The vertices come in ascending order of their global ids.
 *   - Signs are exact, and where the ray meets an edge it is taken to pass infinitely little beside
 *     it: moved by (e, e^2, e^3). So it crosses exactly two faces of a tet or none, and one of two
 *     tets at each side of a face, whatever it runs through or along. Flat tets give nothing.
 *   - t and the value at a face come from that face's three vertices alone, in their order; of a
 *     face's edge that the ray meets, from its two ends; of a vertex, from that. So both tets at a
 *     face have the same bits, and all tets around an edge that is met.
 *
 * Errors, with u = 2^-53, W the difference of the t (of the values) of the face's three vertices:
 * t errs by at most 2^-30 W + 8u (sum of |d_a (p_a - o_a)|) / d^2, a value by 2^-30 W + 8u (largest
 * |value|): each weight is right to 2^-32 of itself, or it is computed exactly and rounded.
 */
#ifndef RENDER_MESH_TET_SEGMENT_H
#define RENDER_MESH_TET_SEGMENT_H

#include "render/mesh/tet_kernel.h"

typedef struct tet_piece {
    double t[2], f[2];
} tet_piece;

/* tet_segment() - false where the line passes the tet by. Else where it enters and leaves it; t[0]
 * >= t[1] where rounding hides its length. The ray's [t0, t1] does not matter. Values finite; the
 * ray as for isopolygon_hit(). */
bool tet_segment(const tet *x, const ray *r, tet_piece *out);

#endif
