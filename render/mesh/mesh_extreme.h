/* mesh_extreme.h - finds the greatest or the least value of a ray in a treelet of tets
 * (extremes.h): bounds of nodes come from their codes, of tets from their vertices.
 */
#ifndef RENDER_MESH_MESH_EXTREME_H
#define RENDER_MESH_MESH_EXTREME_H

#include "render/ray/extremes.h"

/* mesh_extremes() - treelet_walks.extremes (walk/tree_walks.h). */
void mesh_extremes(const tracer *tr, const treelet *at, const ray *r, const ray *part,
                   extreme_state *s, ray_counters *counters);

#endif
