/* grid_extreme.h - the greatest or the least value on a ray through a grid (extremes.h): treelets
 * by the directory's ranges, nodes by the codes of theirs, cells by their samples.
 *
 * Bounds are exact, and no cell is left out that could matter: a node's code of its greatest sample
 * is compared with that of the score that has been found, by the same monotone function.
 */
#ifndef RENDER_GRID_GRID_EXTREME_H
#define RENDER_GRID_GRID_EXTREME_H

#include "render/grid/walk.h"
#include "render/ray/extremes.h"

/* grid_extreme_ways(), grid_extreme(), grid_extreme_near() - the rows `extreme_ways`, `extreme` and
 * `extreme_near`. tr->own: a walk_scene. */
void grid_extreme_ways(const tracer *tr, const ray *r, extreme_ways *ways, ray_counters *counters);
void grid_extreme(const tracer *tr, const treelet *at, const ray *r, const extreme_way *way,
                  extreme_state *s, ray_counters *counters);
void grid_extreme_near(const tracer *tr, const treelet *at, const ray *r, double t,
                       extreme_state *s, ray_counters *counters);

/* grid_extreme_cell() - what is in one cell of a treelet: the truth of all kernels. Whether that
 * changes what is found. */
bool grid_extreme_cell(const walk_scene *scene, const resident_grid *at, const ray *r,
                       const uint32_t cell[3], const float samples[8], extreme_state *s);

#endif
