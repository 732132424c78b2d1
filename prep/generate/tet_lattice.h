/* tet_lattice.h - points and tets of a regular mesh: a grid whose cells are cut into six tets each,
 * copied side by side and deformed on request.
 *
 * Kuhn's cut has a tet for each order of the axes. Along that order its corners go from the cell's
 * lowest node to its highest. Every cell is cut alike, so the diagonals of two cells agree on the
 * face between them. All tets have a positive volume: det(b - a, c - a, d - a) > 0.
 *
 * Node (i, j, k) of copy (r, s, t) lies at spacing times (i + r (dims - 1), ...). Copies touch
 * (their faces have the same positions) but share no points: each has its own points and tets.
 * Points are ordered node by node, x fastest, within a copy; copies likewise, x fastest. Tets are
 * ordered by cell in the same way.
 *
 * The deformation moves inner nodes by a swirl, with N = dims - 1 cells along an axis, in cells:
 *     A (sin(pi i/N) sin(2 pi j/N) sin(pi k/N), sin(pi i/N) sin(pi j/N) sin(2 pi k/N),
 *        sin(2 pi i/N) sin(pi j/N) sin(pi k/N)),    A = deform min(N) / (4 pi)
 * It is 0 on the faces of each copy. Along an edge of a cell it changes by at most |deform|, all
 * three components together: a sine of p half waves changes by at most p pi / N, and each axis has
 * 1 + 1 + 2 of them. The edges of a tet along the axes are then I + D, where the sums of D's
 * columns are below 1. That is diagonally dominant, so its determinant stays positive. The gap
 * between |deform| and 1 covers the rounding of positions to floats. The bits are the same on any
 * machine.
 */
#ifndef PREP_GENERATE_TET_LATTICE_H
#define PREP_GENERATE_TET_LATTICE_H

#include <stdint.h>

#include "formats/base/mem.h"
#include "formats/base/status.h"

#define TET_LATTICE_DEFORM_MAX 0.9

/* Cells along an axis, over all copies. Up to here a float tells nodes apart, however deformed. */
enum { TET_LATTICE_CELLS_MAX = 1 << 18 };

typedef struct tet_lattice_shape {
    uint32_t dims[3];   /* nodes per axis of one copy, each at least 2 */
    uint32_t copies[3]; /* per axis, each at least 1 */
    double spacing[3];  /* distance between nodes; negative: mirrored */
    double deform;      /* -TET_LATTICE_DEFORM_MAX .. TET_LATTICE_DEFORM_MAX */
} tet_lattice_shape;

typedef struct tet_lattice {
    tet_lattice_shape shape;
    uint64_t points, tets;         /* of all copies */
    uint64_t point_rows, tet_rows; /* rows along x, of all copies */
    uint32_t row_points, row_tets; /* points or tets in each row */
    uint32_t copy_points, copies;  /* points per copy; number of copies */
    double amplitude;              /* A of the deformation */
    double *sine[3];               /* per axis: sin(pi i/N), then sin(2 pi i/N) */
    uint32_t corner[6][4];         /* nodes of a cell's tets, relative to the cell's lowest node */
} tet_lattice;

/* tet_lattice_check() - ST_USAGE: the shape exceeds the limits above, has more points than a mesh
 * may have (MESH_POINTS_MAX), or a spacing that floats cannot hold. */
CHECKED status tet_lattice_check(const tet_lattice_shape *shape);

/* tet_lattice_count_points(), tet_lattice_count_tets() - of all copies. */
uint64_t tet_lattice_count_points(const tet_lattice_shape *shape);
uint64_t tet_lattice_count_tets(const tet_lattice_shape *shape);

/* tet_lattice_init() - shape must have been checked. Release l in any case. */
CHECKED status tet_lattice_init(tet_lattice *l, mem *m, const tet_lattice_shape *shape);
void tet_lattice_release(tet_lattice *l, mem *m);

/* tet_lattice_points(), tet_lattice_tets() - write one row: row_points positions, or row_tets times
 * four ids. Thread-safe. */
void tet_lattice_points(const tet_lattice *l, uint64_t row, float (*xyz)[3]);
void tet_lattice_tets(const tet_lattice *l, uint64_t row, uint32_t (*ids)[4]);

#endif
