#include "render/experiments/intersect_walk.h"

#include "render/grid/octree_step.h"

/* The walk of one ray through one treelet: the arguments of a walk_fn. */
typedef struct treelet_walk {
    intersect_fn next_hit;
    const walk_scene *scene;
    const resident_grid *tr;
    const ray *r;
    const hit *after;
    hit *best;
    ray_counters *counters;
} treelet_walk;

/* A cube of 2^size cells. morton: its place among the nodes of its size. */
typedef struct tree_node {
    double t_in, t_out;
    uint32_t cell[3];
    uint32_t morton, size;
} tree_node;

/* Lower *w->best to the first hit in one active cell. Returns whether it changed. */
static bool visit_cell(const treelet_walk *w, const uint32_t cell[3]) {
    const walk_scene *scene = w->scene;
    const level_planes *planes = &scene->levels[w->tr->level];
    const cell_box box = walk_cell_box(planes, cell);
    cell_visit visit;
    float samples[8];
    bool changed = false;
    w->counters->cells++;
    if (!cell_visit_of(w->r, &box, &visit))
        return false;
    walk_cell_samples(scene, w->tr, cell, samples);
    for (int i = 0; i < scene->count; i++) {
        hit found;
        if (!w->next_hit(w->r, &visit, samples, scene->isovalues[i], i,
                         walk_cell_index(planes, cell), w->after, &found))
            continue;
        w->counters->roots++;
        if (hit_less(&found, w->best)) {
            *w->best = found;
            changed = true;
        }
    }
    return changed;
}

static tree_node child_of(const tree_node *n, const octree_child *c) {
    const uint32_t half = 1u << (n->size - 1);
    return (tree_node){c->t_in,
                       c->t_out,
                       {n->cell[0] + (c->octant & 1u) * half,
                        n->cell[1] + (c->octant >> 1 & 1u) * half,
                        n->cell[2] + (c->octant >> 2) * half},
                       n->morton << 3 | c->octant,
                       n->size - 1};
}

/* Visit a node's active cells front to back, those in the octants `wanted` alone. Returns whether
 * *w->best changed. */
static bool visit_node(const treelet_walk *w, const tree_node *n, unsigned wanted) {
    /* What begins behind the best hit cannot come before it. */
    if (n->t_in > w->best->t)
        return false;
    if (n->size == 0)
        return visit_cell(w, n->cell);
    w->counters->nodes++;
    const unsigned active = walk_children(w->tr, n->size, n->morton) & wanted;
    if (!active)
        return false;
    const level_planes *planes = &w->scene->levels[w->tr->level];
    octree_child children[4];
    double middle[3];
    bool changed = false;
    for (int a = 0; a < 3; a++)
        middle[a] = planes->at[a][n->cell[a] + (1u << (n->size - 1))];
    const int count = octree_step(w->r, middle, n->t_in, n->t_out, children);
    for (int i = 0; i < count; i++) {
        const tree_node child = child_of(n, &children[i]);
        if (active >> children[i].octant & 1u)
            changed |= visit_node(w, &child, 255u);
    }
    return changed;
}

bool intersect_walk(intersect_fn next_hit, const walk_scene *scene, const resident_grid *tr,
                    const ray *r, double t_in, double t_out, unsigned octants, const hit *after,
                    hit *best, ray_counters *counters) {
    const treelet_walk w = {next_hit, scene, tr, r, after, best, counters};
    const tree_node root = {t_in,
                            t_out,
                            {tr->first_cell[0], tr->first_cell[1], tr->first_cell[2]},
                            0,
                            tr->shape.node_levels + LEAF_BLOCK_LOG2};
    return visit_node(&w, &root, octants);
}

/* A walk_fn says nothing of the intersector, so each has its own. */
#define WALK_BY(NAME, HOW)                                                                         \
    static bool NAME(const walk_scene *scene, const resident_grid *tr, const ray *r, double t_in,  \
                     double t_out, unsigned octants, const hit *after, hit *best,                  \
                     ray_counters *counters) {                                                     \
        return intersect_walk(intersector_find(HOW)->next_hit, scene, tr, r, t_in, t_out, octants, \
                              after, best, counters);                                              \
    }

WALK_BY(walk_marmitt_3, LEAFCAST_MARMITT_3)
WALK_BY(walk_midpoint, LEAFCAST_MIDPOINT)
WALK_BY(walk_linear, LEAFCAST_LINEAR)
WALK_BY(walk_neubauer, LEAFCAST_NEUBAUER)
WALK_BY(walk_schwarze, LEAFCAST_SCHWARZE)

const walk_choice *intersect_walk_by(leafcast_intersector how) {
    static const walk_choice choices[] = {
        [LEAFCAST_MARMITT_3] = {"marmitt-3", walk_marmitt_3, 0, false},
        [LEAFCAST_MIDPOINT] = {"midpoint", walk_midpoint, 0, false},
        [LEAFCAST_LINEAR] = {"linear", walk_linear, 0, false},
        [LEAFCAST_NEUBAUER] = {"neubauer", walk_neubauer, 0, false},
        [LEAFCAST_SCHWARZE] = {"schwarze", walk_schwarze, 0, false}};
    return how == LEAFCAST_MARMITT ? NULL : &choices[how];
}
