/* heights_walk.h - one ray over a height field: treelets front to back, by the directory's
 * quadtree; in a treelet nodes by the codes of its elevations, down to cells (M08 5.2.2).
 *
 * A node is left out where the ray stays above or below all elevations in it. The children of a
 * node that a ray passes follow from its crossings of the node's two middle planes, which are the
 * kernel's own (heights_patch.h).
 */
#ifndef RENDER_HEIGHTS_HEIGHTS_WALK_H
#define RENDER_HEIGHTS_HEIGHTS_WALK_H

#include "render/heights/heights_field.h"

/* heights_walk_next() - implements tracer_next(). */
trace_result heights_walk_next(const tracer *tr, const ray *r, trace_state *state,
                               ray_counters *counters);

/* heights_walk_block() - lower state->best to the first hit in a treelet; [t_in, t_out] holds the
 * ray's interval in it. octants: which eighths of it (x + 4z) to look at, one or all. Returns
 * whether state->best changed; its point is not set. */
bool heights_walk_block(const heights_block *b, const ray *r, double t_in, double t_out,
                        unsigned octants, trace_state *state, ray_counters *counters);

#endif
