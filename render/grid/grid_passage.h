/* grid_passage.h - the treelets on a ray's way through a grid's directory, front to back.
 *
 * The directory is an octree of treelets. The caller keeps a stack of subtrees still to be visited,
 * the nearest on top, and replaces a treelet that is not drawn itself by its children.
 */
#ifndef RENDER_GRID_GRID_PASSAGE_H
#define RENDER_GRID_GRID_PASSAGE_H

#include "render/grid/octree_step.h"
#include "render/grid/walk.h"
#include "render/ray/tracer.h"

enum { GRID_PASSAGES_MAX = 4 * LEAF_LEVELS_MAX };

/* A subtree of the directory still to be visited; octants != 0: instead, these eighths of the
 * treelet itself. */
typedef struct grid_passage {
    double t_in, t_out;
    uint32_t t;
    uint32_t octants;
} grid_passage;

static inline void grid_passage_middle(const tracer *tr, uint32_t t, double middle[3]) {
    const walk_scene *scene = tr->own;
    const leaf_layout *layout = tr->layout;
    const uint32_t level = layout->level_of[t], half = 1u << (layout->cells_log2 - 1);
    for (int a = 0; a < 3; a++)
        middle[a] = scene->levels[level].at[a][(layout->place[t][a] << layout->cells_log2) + half];
}

/* Push the active children of treelet node->t that the ray passes, the nearest last. Returns the
 * new top. In a preview an absent child sets *provisional, and the node's own eighth stands in for
 * the child if the node is resident or taken whole. provisional NULL: nothing stands in. */
static inline int grid_passage_push(const tracer *tr, const ray *r, const grid_passage *node,
                                    grid_passage *stack, int top, bool *provisional) {
    const leaf_layout *layout = tr->layout;
    const unsigned active = tr->treelets->children[node->t];
    const unsigned existing = leaf_layout_children(layout, node->t);
    double middle[3];
    octree_child children[4];
    grid_passage_middle(tr, node->t, middle);
    for (int i = octree_step(r, middle, node->t_in, node->t_out, children); i-- > 0;) {
        const unsigned o = children[i].octant;
        if (!(active >> o & 1u))
            continue;
        const uint32_t rank = (uint32_t)__builtin_popcount(existing & ((1u << o) - 1u));
        grid_passage p = {children[i].t_in, children[i].t_out, layout->first_child[node->t] + rank,
                          0};
        if (tr->preview && provisional && tr->treelets->own[p.t] &&
            !loader_lookup(tr->treelets, p.t)) {
            *provisional = true;
            if (!tr->treelets->whole[node->t] && !loader_lookup(tr->treelets, node->t))
                continue;
            p.t = node->t;
            p.octants = 1u << o;
        }
        stack[top++] = p;
    }
    return top;
}

/* grid_passage_drawn() - returns whether rays look at the treelet itself, not at its children. */
static inline bool grid_passage_drawn(const tracer *tr, const grid_passage *node) {
    return node->octants || tr->layout->level_of[node->t] == tr->target_level ||
           (tr->stop && tr->stop[node->t]);
}

#endif
