#include "render/walk/tree_points.h"

#include <math.h>
#include <string.h>

#include "formats/base/box3.h"
#include "formats/base/vec3.h"
#include "render/ray/kind.h"
#include "render/ray/open_volume.h"

/* ---- Boxes ---- */

void tree_active_box(const leafcast *v, uint32_t set, const double *isovalues, int count,
                     double corners[8][3]) {
    const leaf_layout *l = &v->file->layout;
    const float(*own)[2] = (const float(*)[2])v->file->own + (size_t)set * l->treelets;
    const interest in = interest_of_isovalues(isovalues, count);
    const treelet_bounds *bounds = resident_kind_of(v->file)->boxes(v->file, set);
    double box[2][3], some[2][3];
    box3_begin(box);
    for (uint32_t t = 0; t < l->treelets; t++) {
        box3_of_floats(bounds[t], some);
        if (interest_meets(&in, own[t][0], own[t][1]))
            box3_widen(box, some[0], some[1]);
    }
    if (!box3_any(box))
        box3_of_floats(leaf_file_bounds(v->file, leaf_layout_step(l, set)), box);
    for (int i = 0; i < 8; i++)
        box3_corner(box, i, corners[i]);
}

void tree_span(const leafcast *v, uint32_t t, double span[2][3]) {
    const uint32_t set = leaf_layout_set(&v->file->layout, v->field, v->step);
    const treelet_bounds *bounds = resident_kind_of(v->file)->boxes(v->file, set);
    box3_share_of(bounds[t], leaf_file_bounds(v->file, v->step), span);
}

void tree_describe(const leafcast *v, uint32_t step, double share, leafcast_info *info) {
    const float *bounds = leaf_file_bounds(v->file, step);
    for (int a = 0; a < 3; a++) {
        info->bounds[0][a] = (double)bounds[a];
        info->bounds[1][a] = (double)bounds[a + 3];
        info->cell_size *= cbrt(info->bounds[1][a] - info->bounds[0][a]);
    }
    info->cell_size *= cbrt(share);
}

double tree_cells_along(const leafcast *v, const double vector[3]) {
    leafcast_info info = {.cell_size = 1.0};
    v->kind->describe(v, leaf_layout_step(&v->file->layout, v->set), &info);
    return sqrt(vec3_dot(vector, vector)) / info.cell_size;
}

/* ---- The order of treelets ---- */

/* Map floats to integers in the same order. */
static uint32_t ordered(double x) {
    const float f = (float)x;
    uint32_t bits;
    memcpy(&bits, &f, sizeof bits);
    return bits >> 31 ? ~bits : bits | 1u << 31;
}

/* Returns the square of the distance from a point to a box. */
static double distance_to(const float bounds[6], const double from[3]) {
    double sum = 0.0;
    for (int a = 0; a < 3; a++) {
        const double below = (double)bounds[a] - from[a], above = from[a] - (double)bounds[a + 3];
        const double outside = below > 0.0 ? below : above > 0.0 ? above : 0.0;
        sum += outside * outside;
    }
    return sum;
}

/* Returns where a box begins in a direction. */
static double along(const float bounds[6], const double direction[3]) {
    double sum = 0.0;
    for (int a = 0; a < 3; a++)
        sum += direction[a] * (double)bounds[direction[a] > 0.0 ? a : a + 3];
    return sum;
}

uint32_t tree_rank(const tracer *tr, uint32_t t, const ray_bundle *rays) {
    const float *bounds = tr->treelets->tree->bounds[0][t];
    switch (rays->way) {
    case RAYS_FROM: return ordered(distance_to(bounds, rays->vector));
    case RAYS_TOWARDS: return ~ordered(distance_to(bounds, rays->vector));
    default: return ordered(along(bounds, rays->vector));
    }
}

/* ---- Points ---- */

static bool holds(const float bounds[6], const double point[3]) {
    bool within = true;
    for (int a = 0; a < 3; a++)
        within &= (double)bounds[a] <= point[a] && point[a] <= (double)bounds[a + 3];
    return within;
}

typedef struct tree_node {
    uint32_t level, i;
} tree_node;

/* Returns the last treelet below a node. */
static uint64_t last_below(tree_node n) {
    return ((uint64_t)n.i + 1) * (UINT64_C(1) << (TREELET_TREE_ARITY_LOG2 * n.level)) - 1;
}

/* Of a node's children the first is pushed last. */
uint32_t tree_box_at(const treelet_tree *tree, const double point[3], uint32_t after) {
    tree_node stack[TREELET_TREE_LEVELS_MAX * TREELET_TREE_ARITY];
    int top = 0;
    stack[top++] = (tree_node){tree->levels - 1, 0};
    while (top > 0) {
        const tree_node n = stack[--top];
        if ((after != LEAF_NO_TREELET && last_below(n) <= after) ||
            !holds(tree->bounds[n.level][n.i], point))
            continue;
        if (n.level == 0)
            return n.i;
        uint32_t count, first = treelet_tree_children(tree, n.level, n.i, &count);
        while (count-- > 0)
            stack[top++] = (tree_node){n.level - 1, first + count};
    }
    return LEAF_NO_TREELET;
}

uint32_t tree_treelet_at(const leafcast *v, uint32_t level, const double point[3], uint32_t after) {
    (void)level;
    return tree_box_at(v->treelets->tree, point, after);
}
