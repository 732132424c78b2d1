/* ref_pieces.h - what the value does along a ray, cell by cell, as the references in long double
 * see it: brute force over all cells of a grid that the ray visits, or over all tets.
 */
#ifndef TESTS_SUPPORT_REF_PIECES_H
#define TESTS_SUPPORT_REF_PIECES_H

#include "tests/support/tet_reference.h"

/* A ray's way through one cell, of length t1 - t0 > 0. */
typedef struct ref_piece {
    long double t0, t1;
    long double k[4]; /* the value at t0 + x: k[0] + k[1] x + k[2] x^2 + k[3] x^3 */
    uint64_t cell;
} ref_piece;

/* ref_piece_at() - the value there. */
long double ref_piece_at(const long double k[4], long double x);

/* ref_cubic_turns() - where the cubic's slope is 0, strictly inside (0, length), in order. */
int ref_cubic_turns(const long double k[4], long double length, long double x[2]);

/* ref_grid_pieces() - of a ray in world space, as far as the clip (NULL: all t >= 0) keeps it; in
 * order of t. Cells that touch NaN or inf give none. Returns how many there are, `room` at most. */
size_t ref_grid_pieces(const ref_volume *v, const ref_ray *ray, const ref_clip *clip,
                       ref_piece *out, size_t room);

/* ref_mesh_pieces() - the same; pieces overlap only where tets do. */
size_t ref_mesh_pieces(const tet_ref_mesh *m, const ref_ray *ray, const ref_clip *clip,
                       ref_piece *out, size_t room);

#endif
