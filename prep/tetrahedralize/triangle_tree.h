/* triangle_tree.h - finds the nearest triangle to a point: distances to a surface.
 *
 * It is a tree of boxes, halved at the median triangle along the longest side of their centres'
 * box. Corners are not copied: they and the ids must live as long as the tree. After building, any
 * number of threads may query it.
 */
#ifndef PREP_TETRAHEDRALIZE_TRIANGLE_TREE_H
#define PREP_TETRAHEDRALIZE_TRIANGLE_TREE_H

#include <stddef.h>
#include <stdint.h>

#include "formats/base/mem.h"
#include "formats/base/status.h"

typedef struct triangle_tree triangle_tree;

/* triangle_tree_build() - count: at least one; corners may coincide. */
CHECKED status triangle_tree_build(mem *m, const float (*xyz)[3], const uint32_t (*corners)[3],
                                   size_t count, triangle_tree **out);
void triangle_tree_free(triangle_tree *t); /* NULL is fine */

typedef struct triangle_near {
    double distance; /* in doubles; 0 at a corner */
    uint32_t triangle;
    double weight[3]; /* of its corners, at the nearest point; their sum is 1 */
} triangle_near;

/* triangle_tree_nearest() - the triangle nearest to a finite point. */
triangle_near triangle_tree_nearest(const triangle_tree *t, const float point[3]);

#endif
