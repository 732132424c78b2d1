/* tree_points.h - boxes, distances and points in a volume with a tree over its treelets. */
#ifndef RENDER_WALK_TREE_POINTS_H
#define RENDER_WALK_TREE_POINTS_H

#include "render/leafcast.h"
#include "render/ray/ray_bundle.h"
#include "render/ray/tracer.h"

/* What kind_walks (ray/kind.h) names so: */
void tree_active_box(const leafcast *v, uint32_t set, const double *isovalues, int count,
                     double corners[8][3]);
void tree_span(const leafcast *v, uint32_t t, double span[2][3]);
double tree_cells_along(const leafcast *v, const double vector[3]);
uint32_t tree_rank(const tracer *tr, uint32_t t, const ray_bundle *rays);
uint32_t tree_treelet_at(const leafcast *v, uint32_t level, const double point[3], uint32_t after);

/* tree_box_at() - returns the number of the first box that holds a point, boundary included, among
 * boxes with numbers above `after`; LEAF_NO_TREELET as `after`: among all. LEAF_NO_TREELET: none.
 * So of the cells that share a point the first one is found. */
uint32_t tree_box_at(const treelet_tree *tree, const double point[3], uint32_t after);

/* tree_describe() - set bounds, and cell_size to the edge of a cube with this share of the bounds'
 * volume: the share of one cell. */
void tree_describe(const leafcast *v, uint32_t step, double share, leafcast_info *info);

#endif
