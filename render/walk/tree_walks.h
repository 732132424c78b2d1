/* tree_walks.h - rays and points through a volume whose treelets have boxes that may overlap: what
 * every kind with a tree over its treelets (treelet_tree.h) shares.
 *
 * The walks take treelets in the order of tree_passage.h, suspend at absent ones, and merge what is
 * found in several. Inside of a treelet a kind's treelet_walks go on: its own, or those that need
 * no more than its cells (cell_walks.h).
 */
#ifndef RENDER_WALK_TREE_WALKS_H
#define RENDER_WALK_TREE_WALKS_H

#include "render/ray/kind.h"

/* What is asked of a treelet. */
typedef struct treelet_walks {
    /* Lower state->best to the first hit in the treelet that counts, and set state->point to it. If
     * any hit will do: to some hit, without the point. Returns whether state->best changed. */
    bool (*hits)(const tracer *tr, const treelet *at, const ray *r, trace_state *state,
                 ray_counters *counters);
    /* Give tree_pieces_hold() the pieces in the treelet. Those that end before `after` or begin
     * behind state->limit.t0 may be left out. */
    void (*pieces)(const tracer *tr, const treelet *at, const ray *r, const hit *after,
                   segments_state *state, ray_counters *counters);
    /* Offer the scores of the cells that `part` of the ray meets, along the whole ray, to
     * extreme_offer(). */
    void (*extremes)(const tracer *tr, const treelet *at, const ray *r, const ray *part,
                     extreme_state *s, ray_counters *counters);
} treelet_walks;

/* The walks of a kind whose row names its treelet_walks. */
extern const kind_walks tree_walks;

#endif
