/* object_tree.h - which objects of a scene a ray may meet: a binary tree of boxes in the scene's
 * world, over the boxes of all objects.
 *
 * Objects that are placed together many times are a group (M08 5.2: multi-level instancing): a tree
 * of its own in a world of its own, which is an entry of the tree above, under a tree over the
 * boxes of its places. All objects are numbered through: those of the tree, then for each group and
 * each of its places those of the group. So a number says where an object is, and no list is as
 * long as there are objects.
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
#include "render/ray/placement.h"

typedef struct object_node {
    double box[2][3];
    uint32_t least, most; /* the least and the greatest number of its entries */
    uint32_t second;      /* its second child; the first one follows it. 0: a leaf of one entry */
} object_node;

typedef struct object_tree {
    object_node *nodes; /* 2 entries - 1; the root first */
    uint32_t *leaf;     /* the node of each entry */
    uint32_t entries;
    uint32_t singles;                  /* the first entries are objects, */
    const struct object_group *groups; /* and the others these */
    uint32_t volume;        /* number of the first object's volume; those of the next ones follow */
    const placement *place; /* of each such object; NULL: its tracer has it */
    uint32_t objects;       /* in all */
} object_tree;

typedef struct object_group {
    const object_tree *places; /* an entry each, as if an object; in the world of the tree above */
    const placement *place;    /* where each is */
    const uint16_t *which;     /* of these members each has; NULL: the first ones */
    const uint32_t *starts; /* with that: how many objects come before it; and the number of all */
    const object_tree *members;
    uint32_t first; /* its first object's number, in the tree above */
} object_group;

enum {
    OBJECT_DEPTH = 8,             /* groups within groups, the tree at the top counted */
    OBJECTS_MOST = UINT32_MAX - 1 /* of a tree */
};

/* object_tree_make() - boxes: of 1 or more entries, in order, which are all objects; for a tree
 * with groups, set `singles` and what follows it, and object_tree_count(), then. ST_NOMEM.
 * object_tree_release() - an empty one, too. object_tree_count() - count the objects, and set each
 * group's `first`. Returns false if there are more than OBJECTS_MOST. */
CHECKED status object_tree_make(object_tree *t, mem *m, const double (*boxes)[2][3],
                                uint32_t entries);
bool object_tree_count(object_tree *t, object_group *groups);
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

/* object_tree_grouped() - whether an object is of a group. object_tree_place() - returns the number
 * of the volume of an object of a group, and sets *place to where it is: its own place in the
 * group, followed by the group's, and so on. */
static inline bool object_tree_grouped(const object_tree *t, uint32_t object) {
    return object >= t->singles;
}
uint32_t object_tree_place(const object_tree *t, uint32_t object, placement *place);

#endif
