/* tree_extremes.h - the greatest or the least value on a ray through a volume with a tree over its
 * treelets (extremes.h): bounds of treelets come from the directory's ranges.
 */
#ifndef RENDER_WALK_TREE_EXTREMES_H
#define RENDER_WALK_TREE_EXTREMES_H

#include "render/ray/extremes.h"

/* tree_extreme_ways(), tree_extreme(), tree_extreme_near() - kind_walks.extreme_ways, extreme and
 * extreme_near. */
void tree_extreme_ways(const tracer *tr, const ray *r, extreme_ways *ways, ray_counters *counters);
void tree_extreme(const tracer *tr, const treelet *at, const ray *r, const extreme_way *way,
                  extreme_state *s, ray_counters *counters);
void tree_extreme_near(const tracer *tr, const treelet *at, const ray *r, double t,
                       extreme_state *s, ray_counters *counters);

#endif
