/* intersect_walk.h - single rays through a treelet of a grid, with any function in the place of
 * cell_next_hit().
 */
#ifndef RENDER_EXPERIMENTS_INTERSECT_WALK_H
#define RENDER_EXPERIMENTS_INTERSECT_WALK_H

#include "render/experiments/intersect.h"
#include "render/grid/walk_choice.h"

/* intersect_walk() - walk_treelet() (grid/walk.h) with next_hit, which is asked of the same cells
 * in the same order. */
bool intersect_walk(intersect_fn next_hit, const walk_scene *scene, const resident_grid *tr,
                    const ray *r, double t_in, double t_out, unsigned octants, const hit *after,
                    hit *best, ray_counters *counters);

/* intersect_walk_by() - the choice of rays that walk by an approximate intersector; NULL for the
 * exact one. */
const walk_choice *intersect_walk_by(leafcast_intersector how);

#endif
