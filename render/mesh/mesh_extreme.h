/* mesh_extreme.h - finds the greatest or the least value on a ray through a mesh of tets
 * (extremes.h): bounds of treelets come from the directory's ranges, of nodes from their codes, of
 * tets from their vertices.
 */
#ifndef RENDER_MESH_MESH_EXTREME_H
#define RENDER_MESH_MESH_EXTREME_H

#include "render/ray/extremes.h"

/* mesh_extreme_ways(), mesh_extreme(), mesh_extreme_near() - the rows `extreme_ways`, `extreme` and
 * `extreme_near`. tr->own: a mesh_rays. */
void mesh_extreme_ways(const tracer *tr, const ray *r, extreme_ways *ways, ray_counters *counters);
void mesh_extreme(const tracer *tr, const treelet *at, const ray *r, const extreme_way *way,
                  extreme_state *s, ray_counters *counters);
void mesh_extreme_near(const tracer *tr, const treelet *at, const ray *r, double t,
                       extreme_state *s, ray_counters *counters);

#endif
