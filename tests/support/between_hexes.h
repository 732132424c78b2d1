/* between_hexes.h - the series of between_lab.h whose cells are hexahedra between the points of
 * between_mesh.h: a curvilinear grid, of which some cells are hidden at some steps, or a mesh of
 * whole cells.
 */
#ifndef TESTS_SUPPORT_BETWEEN_HEXES_H
#define TESTS_SUPPORT_BETWEEN_HEXES_H

#include "tests/support/between_mesh.h"

/* between_hexes_hide() - per point: infinity if the grid's cell there is hidden at a step; else 0.
 * So it is hidden at one of two steps where their blend is not 0. */
void between_hexes_hide(int step, float *to);

/* between_hexes_fold() - move some of the points on, so far that hexahedra fold. */
void between_hexes_fold(int step, float (*to)[3]);

/* between_hexes_convert() - between_mesh_convert() of these. */
void between_hexes_convert(const between_kind *of, const float *const *steps, uint32_t first,
                           uint32_t count, const char *path);

#endif
