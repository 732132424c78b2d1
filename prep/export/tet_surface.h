/* tet_surface.h - isosurfaces of a mesh of tets, treelet by treelet: marching tetrahedra.
 *
 * Inside is f >= isovalue. A tet with a value that is not finite has no surface. Vertices lie on
 * edges, computed from the lower to the higher vertex of the mesh, so all tets around get the same
 * bits. Normals come from the file's gradients. Without these they are the mean of the gradients of
 * the treelet's tets around, weighted by volume. Flat tets are treated as positively oriented.
 */
#ifndef PREP_EXPORT_TET_SURFACE_H
#define PREP_EXPORT_TET_SURFACE_H

#include "prep/export/piece.h"
#include "prep/export/tet_bench.h"

/* tet_surface_create() - release *out. surfaces of the choice's first field. isovalues: count of
 * them. Pieces are ordered by isovalue, then by treelet. choice and isovalues must outlive it. */
CHECKED status tet_surface_create(mem *m, const cell_choice *choice, const double *isovalues,
                                  uint32_t count, int threads, piece_source *out);

/* tet_surface_worker() - bytes that each thread needs besides its piece. */
uint64_t tet_surface_worker(const cell_choice *choice);

#endif
