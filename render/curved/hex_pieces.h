/* hex_pieces.h - the value along a ray in a hexahedron as cubics in t, each with a proven bound of
 * its error: for integrals, extremes, and whatever else asks for a ray's pieces
 * (render/ray/segments.h).
 *
 * On a proven stretch (hex_stretch.h) the parameters are guessed by cubics in t. Put into the
 * trilinear map, these give a polynomial of degree 9; what it differs from the ray by bounds the
 * guess's error, by the same contraction that proved the stretch. Put into the trilinear value,
 * they give another one, and what that differs from the piece's cubic by bounds the rest.
 * Polynomials are bounded by their Bernstein coefficients. Pieces are halved until the sum is small
 * enough.
 */
#ifndef RENDER_CURVED_HEX_PIECES_H
#define RENDER_CURVED_HEX_PIECES_H

#include "render/curved/hex_roots.h"

enum { HEX_PIECES = 64 };

typedef struct hex_piece {
    double t[2];
    double b[4];  /* Bernstein coefficients from t[0] to t[1]; the ends are the faces' own values */
    double error; /* the value differs from the cubic by so much at most */
} hex_piece;

/* hex_pieces() - returns the number of pieces, in order of t within each part, part by part. Two in
 * a row share an end's t and value.
 *
 * sense        hexahedron_sense(); 0: the cell is folded, and its pieces are linear, by the rule of
 *              hex_roots.h, without error
 * tolerance    the error that is allowed, above 0. Where a piece is as short as it gets, or all
 *              HEX_PIECES are used, the error may be more, up to the whole range of the cell's
 * values counts       added to; may be NULL */
int hex_pieces(const hexahedron *h, int sense, const hex_path *path, double tolerance,
               hex_piece out[HEX_PIECES], hex_counts *counts);

#endif
