/* cell_kernel.h - does this ray cross this isosurface in this cell, and where: the scalar truth.
 *
 * The answer is a pure function of (ray, cell, 8 samples, isovalue): a fixed sequence of double
 * additions, products, quotients and square roots without contraction. It does not depend on how
 * traversal got here, so results are the same bits whatever the ISA, threads, treelet size or
 * budget.
 *
 * Conventions (those of the reference renderer):
 *   - Inside is f >= iso; a surface is a change of side along the ray.
 *   - The ray crosses planes in the order of (t, axis); a cell is visited between its last entry
 *     and its first exit in that order, zero-length visits included. t of a plane: its
 *     distance over d, (plane - o) / d.
 *   - f at entry and exit is the bilinear form of that face's four samples, computed alike from
 *     both sides, so that one cell's exit side is the next one's entry side.
 *
 * Sources: M08 4.3.3.2 (exact intersection by isolating extrema); deviation: the cubic is kept in
 * Bernstein form between entry and exit, whose control values are mixed corners of the trilinear
 * form, instead of the power form about the eye that loses all digits.
 */
#ifndef RENDER_GRID_CELL_KERNEL_H
#define RENDER_GRID_CELL_KERNEL_H

#include <stdbool.h>

#include "render/ray/ray.h"

typedef struct cell_box {
    double lo[3], hi[3]; /* its planes in grid space, lo < hi */
    double inv[3];       /* 1 / (hi - lo) */
    bool last[3];        /* the last cell of its axis owns its upper end, too */
} cell_box;

/* The part of a ray inside a cell. */
typedef struct cell_visit {
    double t_in, t_out;
    double in[3], out[3]; /* cell coordinates in [0, 1] at t_in and t_out; exactly 0 or 1 on the
                             face that is crossed */
} cell_visit;

/* Constants of the root search. They are here since the SIMD versions repeat the search. */
#define CELL_STEPS_MAX   200
#define CELL_LAST_BIT    0x1p-53 /* of [0, 1] */
#define CELL_SERIES_USED 0x1p-3  /* see refine() */
#define CELL_SERIES_SURE 0x1p-10
#define CELL_NEAR_END    1e-6 /* see cell_roots(); of control values scaled to [1, 2) */
/* If the largest control value lies between these two, no product vanishes or overflows without
 * scaling. */
#define CELL_ORDINARY_MIN  0x1p-300
#define CELL_ORDINARY_MAX  0x1p300
#define CELL_EXPONENT_BITS UINT64_C(0x7ff0000000000000)

/* cell_visit_of() - whether the ray visits the cell within [t0, t1]; *visit is set only then. */
bool cell_visit_of(const ray *r, const cell_box *box, cell_visit *visit);

/* cell_cubic() - f - iso along the visit as a cubic in Bernstein form: b[0] at entry, b[3] at exit.
 * samples: corner x + 2y + 4z, finite. Returns false, with b untouched or not, when the cell is not
 * active for iso (not min < iso && iso <= max). */
bool cell_cubic(const cell_visit *visit, const float samples[8], double iso, double b[4]);

/* cell_values() - f - above along the visit, in the same form, whether the cell is active or not.
 * b[0] and b[3] equal the values of the cells beyond the faces. */
void cell_values(const cell_visit *visit, const float samples[8], double above, double b[4]);

/* cell_blossom() - the same form of any trilinear function, given by its corner values. */
void cell_blossom(const cell_visit *visit, const double corners[8], double b[4]);

/* cell_roots() - finds the changes of side of the cubic in [0, 1]: 0 to 3 parameters, ascending.
 * Returns their number. Scale-invariant; b must be finite. */
int cell_roots(const double b[4], double roots[3]);

/* cell_root_t() - returns the ray's t at parameter s of the visit; t_out exactly at s = 1. */
static inline double cell_root_t(const cell_visit *visit, double s) {
    double t = visit->t_in + s * (visit->t_out - visit->t_in);
    return s < 1.0 && t < visit->t_out ? t : visit->t_out;
}

/* cell_next_hit() - finds the first hit in this cell that comes strictly after `after` in (t, cell,
 * iso) order: the `marmitt` intersector, iterated to the last bits. iso_index and cell go into
 * *found, which is set only when true is returned. */
bool cell_next_hit(const ray *r, const cell_visit *visit, const float samples[8], double iso,
                   int32_t iso_index, uint64_t cell, const hit *after, hit *found);

#endif
