/* exact.h - exact signs of determinants: a ray against an edge, a tet's orientation, a point in a
 * tet. All code that asks whether a tet is flat, how it is oriented or whether it holds a point
 * uses these functions, so that all parts agree.
 *
 * The edge function of a ray (o, d) and a directed edge P -> Q is
 *
 *     E = d . ((P - o) x (Q - o)) = d . ((P - o) x (Q - P)),
 *
 * positive where the edge turns about the ray as a right-handed screw. Seen along d it is twice the
 * area of the triangle (ray, P, Q). So a triangle's three edge functions are also the weights of
 * its corners. With an edge in place of d it is six times the volume of a tet.
 *
 * exact_near() computes E in doubles with a proven bound of its error. Where that leaves the sign
 * in doubt, E is computed as an integer, without any rounding: 6 to 24 products of three
 * significands, added in a number as wide as needed. Unlike expansions of doubles, this cannot
 * overflow or underflow, however large or small the arguments. Signs are therefore exact for any
 * finite arguments, and antisymmetric: E(Q, P) = -E(P, Q).
 *
 * Pure functions; the same bits with any compiler and CPU.
 */
#ifndef FORMATS_BASE_EXACT_H
#define FORMATS_BASE_EXACT_H

#include <math.h>
#include <stdbool.h>

/* EXACT_BOUND: error relative to the sum of the moduli of E's terms, see exact_near().
 * EXACT_SMALLEST: the most that underflow of products can add, as long as |d| is at most 2^300. */
#define EXACT_BOUND    0x1p-50
#define EXACT_SMALLEST 0x1p-700

/* A value of more than this many error bounds has a relative error of at most 2^-26. */
#define EXACT_ENOUGH 0x1p26

typedef struct exact_estimate {
    double value;
    double bound; /* |value - E| is at most this */
} exact_estimate;

/* exact_near() - E in doubles, and a bound of its error. The sign is right where |value| > bound.
 * (That is false for NaN, and after overflow, where the bound is not finite either.)
 *
 * a   P - o, each component rounded once
 * e   Q - P, each component rounded once
 *
 * Proof. With u = 2^-53 every difference, product and sum is the true one times 1 + delta, |delta|
 * <= u; a product that underflows is off by at most 2^-1075 instead. On its way from the arguments
 * into the result a term collects at most 7 such factors: of a, of e, of their product, of the
 * difference of two, of the product with d, of two sums. So the result is the true sum of six
 * terms, each times 1 + theta, |theta| <= 7u / (1 - 7u). Its error is at most that times M, the sum
 * of the true terms' moduli. M as computed is at least M (1 - u)^7, so 8u times that suffices, with
 * nearly u to spare. Products that underflow add at most 6 (|d| + 1) 2^-1074: less than
 * EXACT_SMALLEST for |d| <= 2^300.
 *
 * With d rounded once, too, a term collects 8 factors: twice the bound is more than enough. */
static inline exact_estimate exact_near(const double d[3], const double a[3], const double e[3]) {
    const double yz = a[1] * e[2], zy = a[2] * e[1];
    const double zx = a[2] * e[0], xz = a[0] * e[2];
    const double xy = a[0] * e[1], yx = a[1] * e[0];
    const double terms = fabs(d[0]) * (fabs(yz) + fabs(zy)) + fabs(d[1]) * (fabs(zx) + fabs(xz)) +
                         fabs(d[2]) * (fabs(xy) + fabs(yx));
    return (exact_estimate){d[0] * (yz - zy) + d[1] * (zx - xz) + d[2] * (xy - yx),
                            EXACT_BOUND * terms + EXACT_SMALLEST};
}

/* exact_edge() - E, rounded to about a double's last place; its sign is exact. It is 0 only where E
 * is 0: results outside the range of doubles become the smallest or the largest double. Returns 0
 * for arguments that are not finite. Costs some 20 times exact_near(). */
exact_estimate exact_edge(const double o[3], const double d[3], const double p[3],
                          const double q[3]);

/* exact_volume() - (b - a) . ((c - a) x (d - a)) of the four points a, b, c, d, rounded like
 * exact_edge(). */
double exact_volume(const double (*p)[3]);

/* exact_orientation() - the sign of exact_volume(): 1, 0 (flat), -1. Uses exact_near() where that
 * suffices. Coordinates up to 2^299. */
static inline int exact_orientation(const double p[4][3]) {
    double e[3][3];
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++)
            e[i][k] = p[i + 1][k] - p[0][k];
    const exact_estimate near = exact_near(e[0], e[1], e[2]);
    if (fabs(near.value) > 2.0 * near.bound)
        return near.value > 0.0 ? 1 : -1;
    const double value = exact_volume(p);
    return (value > 0.0) - (value < 0.0);
}

/* exact_weights() - whether a tet, boundary included, holds a point; if so, also the weight of each
 * vertex at the point.
 *
 * p        the vertices; coordinates up to 2^299
 * sign     exact_orientation(p); not 0: a flat tet holds nothing
 * point    finite, up to 2^299
 * weight   out: per vertex six times the volume of the tet of the point and the other three
 *          vertices, with a relative error of at most 2^-25; 0 exactly where the point lies in
 *          their plane. The four add up to six times the tet's volume. Clobbered where the point
 *          is not held. */
bool exact_weights(const double p[4][3], int sign, const double point[3], double weight[4]);

#endif
