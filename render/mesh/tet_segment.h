/* tet_segment.h - a ray's piece in one tetrahedron, and the value at its ends: the scalar truth.
 *
 * A pure function of (ray, four vertices, four values), as tet_kernel.h is:
 *   - The vertices come in ascending order of their global ids.
 *   - Signs are exact. A ray that meets an edge is taken to pass infinitely little beside it: it is
 *     moved by (e, e^2, e^3). So it crosses exactly two faces of a tet or none, and one of the two
 *     tets at each side of a face, whatever it runs through or along. Flat tets give nothing.
 *   - t and the value at a face come from that face's three vertices alone, in their order; where
 *     the ray meets a face's edge, from its two ends; at a vertex, from that. So both tets at a
 *     face have the same bits, and so have all tets around an edge that the ray meets.
 *
 * Errors, with u = 2^-53, W the difference of the t (of the values) of the face's three vertices: t
 * errs by at most
 *
 *     TET_MEAN_ERROR W + TET_T_ROUNDING (largest sum of |d_a (p_a - o_a)|) / d^2,
 *
 * a value by TET_MEAN_ERROR W + TET_VALUE_ROUNDING (largest |value|).
 *
 * Proof. The result is a mean m of three x, by weights w > 0. A computed weight is right to e =
 * 2^-32 of itself (and 2^-64), or it is computed exactly and rounded: it is w (1 + r) with |r| <=
 * e. The sum of w (x - m) is 0. So the mean moves by the sum of w r (x - m) over the sum of w (1 +
 * r): by e / (1 - e) times the mean of |x - m| at most. In that mean, the x above m balance those
 * below. The x are no more than W apart, so it is W / 2 at most. This makes 2^-33 W. A 256th of it
 * is far more than e^2 and the six roundings of the mean's differences, products, sums and
 * quotient, u W each at most. The last sum rounds by u |m|. Each t, too, has been rounded eight
 * times: p - o, a product, two sums; in d^2 a product, two sums; the quotient. The mean of these
 * errors is no more than the largest of them. That is 9u, and another u is for u^2.
 */
#ifndef RENDER_MESH_TET_SEGMENT_H
#define RENDER_MESH_TET_SEGMENT_H

#include "render/mesh/tet_kernel.h"

#define TET_MEAN_ERROR     0x1.01p-33
#define TET_T_ROUNDING     (10.0 * 0x1p-53)
#define TET_VALUE_ROUNDING (2.0 * 0x1p-53)

typedef struct tet_piece {
    double t[2], f[2];
} tet_piece;

/* tet_segment() - finds where the line enters and leaves the tet; false if it misses the tet. t[0]
 * >= t[1] where rounding hides the length. The ray's [t0, t1] is ignored. Values finite; the ray as
 * for flat_polygon_hit(). */
bool tet_segment(const tet *x, const ray *r, tet_piece *out);

#endif
