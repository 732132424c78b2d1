/* grid_tracer.h - one ray through a whole grid, treelet by treelet, resumable.
 *
 * The directory is walked as an octree of treelets by its merged ranges; each treelet of the wanted
 * level that the ray meets is walked in turn (walk.h), front to back.
 */
#ifndef RENDER_GRID_GRID_TRACER_H
#define RENDER_GRID_GRID_TRACER_H

#include "render/grid/walk.h"
#include "render/ray/tracer.h"

/* grid_tracer_next() - tracer_next() of a grid. grid_tracer_surface() - the surface point of hit h
 * on ray r, in this treelet. tr->own: a walk_scene. */
trace_result grid_tracer_next(const tracer *tr, const ray *r, trace_state *state,
                              ray_counters *counters);
surface_point grid_tracer_surface(const tracer *tr, const treelet *at, const ray *r, const hit *h);

#endif
