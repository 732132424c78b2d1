/* grid_extreme.h - the greatest or the least value on a ray through a grid (extremes.h).
 *
 * Treelets are bounded by the directory's ranges, nodes by the codes of their ranges, cells by
 * their samples. Bounds are exact, so no cell that could matter is left out: the code of a node's
 * greatest sample is compared with the code of the score found, both by the same monotone function.
 */
#ifndef RENDER_GRID_GRID_EXTREME_H
#define RENDER_GRID_GRID_EXTREME_H

#include "render/grid/walk.h"
#include "render/ray/extremes.h"

/* grid_extreme_ways(), grid_extreme(), grid_extreme_near() - the kind's `extreme_ways`, `extreme`
 * and `extreme_near` (kind.h). tr->own: a walk_scene. */
void grid_extreme_ways(const tracer *tr, const ray *r, extreme_ways *ways, ray_counters *counters);
void grid_extreme(const tracer *tr, const treelet *at, const ray *r, const extreme_way *way,
                  extreme_state *s, ray_counters *counters);
void grid_extreme_near(const tracer *tr, const treelet *at, const ray *r, double t,
                       extreme_state *s, ray_counters *counters);

/* grid_extreme_cell() - offers one cell's extreme value to *s: the truth of all kernels. Returns
 * whether *s changed. */
bool grid_extreme_cell(const walk_scene *scene, const resident_grid *at, const ray *r,
                       const uint32_t cell[3], const float samples[8], extreme_state *s);

#endif
