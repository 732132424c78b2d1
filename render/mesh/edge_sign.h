/* edge_sign.h - on which side of an edge does a ray pass: exact for doubles.
 *
 * The edge function of a ray (o, d) and a directed edge P -> Q is
 *
 *     E = d . ((P - o) x (Q - o)) = d . ((P - o) x (Q - P)),
 *
 * positive where the edge turns about the ray as a right-handed screw. Seen along d it is twice the
 * area of the triangle (ray, P, Q), so the three of a triangle are also the weights of its corners.
 *
 * edge_near() computes E in doubles with a proven bound of its error. Where that leaves the sign in
 * doubt, edge_sign() computes E as an integer, without any rounding: 18 products of three
 * significands, summed at their place in a number as wide as it takes. Unlike with expansions of
 * doubles, nothing can overflow or vanish there, however large or small the arguments. Signs are
 * therefore exact for any finite arguments, and antisymmetric: E(Q, P) = -E(P, Q).
 *
 * Pure functions; the same bits with any compiler and CPU.
 */
#ifndef RENDER_MESH_EDGE_SIGN_H
#define RENDER_MESH_EDGE_SIGN_H

#include <math.h>

/* Relative to the sum of the moduli of E's terms, see edge_near(); and what vanishing products may
 * cost, as long as |d| is at most 2^300. */
#define EDGE_BOUND    0x1p-50
#define EDGE_SMALLEST 0x1p-700

typedef struct edge_weight {
    double value; /* E: its sign is exact; 0 only where E is */
    double bound; /* |value - E| is at most this */
} edge_weight;

/* edge_near() - E in doubles, and a bound of its error: the sign is right where |value| > bound (so
 * not with NaN, nor with overflow, where the bound is not finite either).
 *
 * a   P - o, each component rounded once
 * e   Q - P, each component rounded once
 *
 * Proof. With u = 2^-53 every difference, product and sum is the true one times 1 + delta,
 * |delta| <= u, or, a product that vanishes, off by at most 2^-1075. On its way from the arguments
 * into the result a term collects at most 7 such factors: of a, of e, of their product, of the
 * difference of two, of the product with d, of two sums. So the result is the true sum of six
 * terms, each times 1 + theta, |theta| <= 7u / (1 - 7u): it errs by at most that times M, the sum
 * of the true terms' moduli. M as computed is at least M (1 - u)^7, so 8u times that suffices, with
 * nearly u to spare. Products that vanish add at most 6 (|d| + 1) 2^-1074: less than EDGE_SMALLEST
 * for |d| <= 2^300. */
static inline edge_weight edge_near(const double d[3], const double a[3], const double e[3]) {
    const double yz = a[1] * e[2], zy = a[2] * e[1];
    const double zx = a[2] * e[0], xz = a[0] * e[2];
    const double xy = a[0] * e[1], yx = a[1] * e[0];
    const double terms = fabs(d[0]) * (fabs(yz) + fabs(zy)) + fabs(d[1]) * (fabs(zx) + fabs(xz)) +
                         fabs(d[2]) * (fabs(xy) + fabs(yx));
    return (edge_weight){d[0] * (yz - zy) + d[1] * (zx - xz) + d[2] * (xy - yx),
                         EDGE_BOUND * terms + EDGE_SMALLEST};
}

/* edge_exact() - E, rounded to about a double's last place. 0 only where E is: what is too small or
 * too large becomes the smallest or the largest double. Arguments that are not finite: 0. Costs
 * some 20 times edge_near(). */
edge_weight edge_exact(const double o[3], const double d[3], const double p[3], const double q[3]);

/* edge_sign() - E with its exact sign, from edge_near() where that is sure. |d| <= 2^300. */
static inline edge_weight edge_sign(const double o[3], const double d[3], const double p[3],
                                    const double q[3]) {
    const double a[3] = {p[0] - o[0], p[1] - o[1], p[2] - o[2]};
    const double e[3] = {q[0] - p[0], q[1] - p[1], q[2] - p[2]};
    const edge_weight near = edge_near(d, a, e);
    return fabs(near.value) > near.bound ? near : edge_exact(o, d, p, q);
}

/* edge_sign_of_tet() - the exact sign of (b - a) . ((c - a) x (d - a)) for points a, b, c, d whose
 * coordinates are floats: 1, 0 (flat), -1.
 *
 * edge_near() with its first argument rounded, too: 8 factors where the proof there has 7. Twice
 * the bound is more than enough. */
int edge_exact_of_tet(const double p[4][3]);
static inline int edge_sign_of_tet(const double p[4][3]) {
    double e[3][3];
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++)
            e[i][k] = p[i + 1][k] - p[0][k];
    const edge_weight near = edge_near(e[0], e[1], e[2]);
    if (fabs(near.value) > 2.0 * near.bound)
        return near.value > 0.0 ? 1 : -1;
    return edge_exact_of_tet(p);
}

#endif
