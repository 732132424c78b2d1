/* patch.h - where a ray crosses a bilinear patch, the face of a curved cell.
 *
 * How often, and in which sense, follows from the turns of the patch's four edges about the ray:
 * signs that depend on two vertices each, exact for the doubles of sheared_ray.h. So all cells that
 * share the face agree, and what crosses into a closed cell crosses out of it. A ray through an
 * edge or a vertex counts as a generic one beside it: as if it were moved by (-e, -e^2), e without
 * size. (M08 6.4.2.2 combines Pluecker tests and bilinear patches for the same purpose; it takes
 * convex faces.)
 *
 * A bilinear map of the square to the plane takes a value twice at most. Where the edges turn once
 * about the ray, it is crossed once. Where they do not turn, it is crossed not at all, or twice, in
 * either sense: there the patch is folded as the ray sees it.
 */
#ifndef FORMATS_CURVED_PATCH_H
#define FORMATS_CURVED_PATCH_H

#include <stdbool.h>

/* The corners of a patch are in the order (0,0), (1,0), (0,1), (1,1) of its parameters. */
enum { PATCH_CORNERS = 4, PATCH_CROSSINGS = 2 };

typedef struct patch_crossing {
    double at[2]; /* parameters, in [0, 1] */
    int sense;    /* 1: the ray goes the way of (d/d first) x (d/d second), in its space; -1 */
} patch_crossing;

/* patch_beside() - whether all corners are on one side of the ray, along one of two axes: then it
 * is not crossed. Usual, and quick. */
static inline bool patch_beside(const double q[PATCH_CORNERS][3]) {
    int above = 0, left = 0, right = 0;
    for (int i = 0; i < PATCH_CORNERS; i++) {
        above += q[i][1] >= 0.0;
        right += q[i][0] > 0.0;
        left += q[i][0] < 0.0;
    }
    return above == 0 || above == PATCH_CORNERS || right == PATCH_CORNERS || left == PATCH_CORNERS;
}

/* patch_turn() - of a straight edge, directed: 1 if it crosses the first axis upward on its
 * positive side, -1 if downward, else 0; exact, and moved as above. Over a face's edges they add up
 * to how often these turn about the ray. */
int patch_turn(const double from[3], const double to[3]);

/* patch_cross() - returns the number of crossings.
 *
 * q    the corners in the ray's space; the third coordinate is not looked at. Finite, and 0 or with
 *      products of 2^-960 to 2^960. Everyone who shares the patch must give the corners
 *      in the same order: patch_order(). */
int patch_cross(const double q[PATCH_CORNERS][3], patch_crossing out[PATCH_CROSSINGS]);

/* patch_at() - the bilinear form of four corners' values. */
static inline double patch_at(const double v[PATCH_CORNERS], const double at[2]) {
    const double low = v[0] + at[0] * (v[1] - v[0]), high = v[2] + at[0] * (v[3] - v[2]);
    return low + at[1] * (high - low);
}

/* Which order of a patch's corners is everybody's: corner k of that order is corner corner[k] of
 * one's own. Of a triangle, a patch with one side that is a corner twice, the twin comes last, and
 * whoever shares it may have another of its corners twice: then the map of a triangle is linear, so
 * they are the same. */
typedef struct patch_order {
    int corner[PATCH_CORNERS];
    int sense;         /* of that order in one's own: 1 or -1 */
    int flip[2], swap; /* of a quadrilateral: how parameters go over */
    bool triangle;
    int twin,
        along; /* one's own corner that is there twice, and which parameter tells them apart */
} patch_order;

/* patch_order_of() - the order whose corners come first by position, in dictionary order; then by
 * value. So it depends on the patch alone. */
patch_order patch_order_of(const double p[PATCH_CORNERS][3], const double value[PATCH_CORNERS]);

/* patch_own() - parameters in everybody's order as one's own. */
void patch_own(const patch_order *o, const double at[2], double own[2]);

#endif
