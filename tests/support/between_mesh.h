/* between_mesh.h - the meshes among the series of between_lab.h: nodes of a coarse grid with six
 * tets to a cell, whose points may move.
 *
 * A step, or a time between two, is an array of BETWEEN_MESH_FLOATS floats: the values of all
 * points, then their coordinates, then what between_hexes_hide() says.
 */
#ifndef TESTS_SUPPORT_BETWEEN_MESH_H
#define TESTS_SUPPORT_BETWEEN_MESH_H

#include "tests/support/between_lab.h"
#include "tests/support/mesh_movies.h"
#include "tests/support/ref_judge.h"

enum {
    BETWEEN_MESH_CELLS = 12, /* on each axis */
    BETWEEN_MESH_NODES = BETWEEN_MESH_CELLS + 1,
    BETWEEN_MESH_POINTS = BETWEEN_MESH_NODES * BETWEEN_MESH_NODES * BETWEEN_MESH_NODES,
    BETWEEN_MESH_HIDDEN = 4 * BETWEEN_MESH_POINTS,
    BETWEEN_MESH_FLOATS = 5 * BETWEEN_MESH_POINTS,
    BETWEEN_MESH_STRIDE = BETWEEN_SIDE / BETWEEN_MESH_CELLS /* of a grid's samples */
};

/* between_mesh_points() - where the points are at a step; they move or not. */
void between_mesh_points(bool moves, int step, float (*to)[3]);

/* between_mesh_convert() - a file of steps [first, first + count) at a path: a new one, or added to
 * that one. */
void between_mesh_convert(const between_kind *of, const float *const *steps, uint32_t first,
                          uint32_t count, const char *path);

/* between_mesh_movie() - the same, as tets, not yet written; the caller's to release. */
mesh_movie between_mesh_movie(const between_kind *of, const float *const *steps, uint32_t first,
                              uint32_t count);

/* between_mesh_judge() - compare every so many of the distances of a picture with brute force. */
ref_tally between_mesh_judge(const float *of, const ref_camera *look, double iso,
                             const double *depth, int every);

#endif
