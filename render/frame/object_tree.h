/* object_tree.h - which objects of a scene a ray may meet: a binary tree of boxes in the scene's
 * world, over the boxes of all objects.
 *
 * Nothing is remembered between questions, so a ray that is suspended keeps only the object that it
 * is at. Boxes, and the t at which rays meet them, are widened by much more than rounding, and by
 * what places may do to it: an object is never missed, but may be asked in vain.
 */
#ifndef RENDER_FRAME_OBJECT_TREE_H
#define RENDER_FRAME_OBJECT_TREE_H

#include <stdbool.h>
#include <stdint.h>

#include "formats/base/mem.h"

typedef struct object_node {
    double box[2][3];
    uint32_t least, most; /* the least and the greatest number of its objects */
    uint32_t second;      /* its second child; the first one follows it. 0: a leaf of one object */
} object_node;

typedef struct object_tree {
    object_node *nodes; /* 2 objects - 1; the root first */
    uint32_t *leaf;     /* the node of each object */
    uint32_t objects;
} object_tree;

/* object_tree_make() - boxes: of 1 or more objects, in order. object_tree_release() - an empty one,
 * too. */
CHECKED status object_tree_make(object_tree *t, mem *m, const double (*boxes)[2][3],
                                uint32_t objects);
void object_tree_release(object_tree *t, mem *m);

/* A part of a ray in the scene's world. */
typedef struct object_ray {
    const double *origin, *direction;
    double t0, t1;
} object_ray;

/* An object, and the t at which a ray enters its box, at least the ray's t0. Ordered by t, then by
 * number. */
typedef struct object_entry {
    double t;
    uint32_t object;
} object_entry;

/* object_tree_after() - set *at to the next object after it in that order. Returns false, and
 * leaves it, if the ray meets no more. To begin, at->t = -INFINITY. */
bool object_tree_after(const object_tree *t, const object_ray *r, object_entry *at);

/* object_tree_entry() - returns the entry of an object that object_tree_after() has returned for
 * this ray; its t1 may have been another one. */
object_entry object_tree_entry(const object_tree *t, const object_ray *r, uint32_t object);

/* object_tree_from() - returns the first object by number, from `from` on, whose box the ray meets;
 * t->objects: it meets no more. */
uint32_t object_tree_from(const object_tree *t, const object_ray *r, uint32_t from);

#endif
