/* tree_hits.h - one ray's next hit in a volume with a tree over its treelets, resumable.
 *
 * A hit is final when the next active treelet begins behind it.
 */
#ifndef RENDER_WALK_TREE_HITS_H
#define RENDER_WALK_TREE_HITS_H

#include "render/ray/tracer.h"

/* tree_hits_next() - kind_walks.next. */
trace_result tree_hits_next(const tracer *tr, const ray *r, trace_state *state,
                            ray_counters *counters);

#endif
