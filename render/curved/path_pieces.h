/* path_pieces.h - the value along a ray in a curved cell as cubics in t, each with a proven bound
 * of its error: for integrals, extremes, and whatever else asks for a ray's pieces
 * (render/ray/segments.h).
 *
 * On a proven stretch (path_stretch.h) the parameters are guessed by cubics in t. Put into the
 * trilinear map, these give a polynomial of degree 9; what it differs from the ray by bounds the
 * guess's error, by the same contraction that proved the stretch. Put into the trilinear value,
 * they give another one, and what that differs from the piece's cubic by bounds the rest.
 * Polynomials are bounded by their Bernstein coefficients. Pieces are halved until the sum is small
 * enough.
 */
#ifndef RENDER_CURVED_PATH_PIECES_H
#define RENDER_CURVED_PATH_PIECES_H

#include "render/curved/path_roots.h"

enum { PATH_PIECES = 64 };

typedef struct path_piece {
    double t[2];
    double b[4];  /* Bernstein coefficients from t[0] to t[1]; the ends are the faces' own values */
    double error; /* the value differs from the cubic by so much at most */
} path_piece;

/* path_pieces() - returns the number of pieces, in order of t within each part, part by part. Two
 * in a row share an end's t and value.
 *
 * folded       pieces are linear, by the rule of path_roots.h, without error
 * range        of the cell's values
 * tolerance    the error that is allowed, above 0. Where a piece is as short as it gets, or all
 *              PATH_PIECES are used, the error may be more, up to the whole range
 * counts       added to; may be NULL */
int path_pieces(const curved_map *m, const path_part *parts, int part_count, bool folded,
                const double range[2], double tolerance, path_piece out[PATH_PIECES],
                path_counts *counts);

#endif
