/* triangle_walk.h - a ray through a treelet of triangles. */
#ifndef RENDER_TRIANGLE_TRIANGLE_WALK_H
#define RENDER_TRIANGLE_TRIANGLE_WALK_H

#include "render/ray/tracer.h"
#include "render/triangle/triangle_kernel.h"
#include "stream/triangle_blocks.h"

/* triangle_walk_place() - returns the treelet that a triangle of this number is in; *local: which
 * one it is there. */
uint32_t triangle_walk_place(const leaf_file *f, uint64_t number, uint32_t *local);

/* triangle_walk_one() - a triangle of a treelet, with its values. */
triangle triangle_walk_one(const triangle_blocks *b, uint32_t local);

/* triangle_walk_hits() - treelet_walks.hits: lower state->best to the first hit that counts, and
 * set state->point to it; if any will do, to some hit, without the point. Returns whether
 * state->best changed. coloured: values are packed colours. */
bool triangle_walk_hits(const triangle_blocks *b, bool coloured, const ray *r, trace_state *state,
                        ray_counters *counters);

#endif
