/* tree_walks.h - walks of rays and points through a volume whose treelets have boxes that may
 * overlap. All kinds with a tree over their treelets (treelet_tree.h) share them.
 *
 * The walks take treelets in the order of tree_passage.h, suspend at absent ones, and merge what is
 * found in several treelets. Inside a treelet they call the kind's treelet_walks: the kind's own,
 * or the ones of cell_walks.h, which only need functions of a cell.
 */
#ifndef RENDER_WALK_TREE_WALKS_H
#define RENDER_WALK_TREE_WALKS_H

#include "render/ray/kind.h"

/* A kind's walks inside one treelet. */
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
