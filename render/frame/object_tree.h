/* object_tree.h - which objects of a scene a ray may meet: a tree of boxes in the scene's world,
 * over the boxes of all objects.
 *
 * Objects that are placed together many times are a group (M08 5.2: multi-level instancing): a tree
 * of its own in a world of its own, which is an entry of the tree above, under a tree over the
 * boxes of its places. All objects are numbered through: those of the tree, then for each group and
 * each of its places those of the group. So a number says where an object is, and no list is as
 * long as there are objects.
 *
 * A ray that is suspended keeps only the object that it is at: the search begins anew from there. A
 * ray that goes on has a list of the objects that come next. Boxes, and the t at which rays meet
 * them, are widened by much more than rounding, and by what places may do to it: an object is never
 * missed, but may be asked in vain.
 */
#ifndef RENDER_FRAME_OBJECT_TREE_H
#define RENDER_FRAME_OBJECT_TREE_H

#include <stdbool.h>
#include <stdint.h>

#include "formats/base/mem.h"
#include "render/frame/box_tree.h"
#include "render/ray/placement.h"

typedef struct object_tree {
    box_tree of;                       /* its entries */
    uint32_t singles;                  /* the first ones are objects, */
    const struct object_group *groups; /* and the others these */
    uint32_t volume;        /* number of the first object's volume; those of the next ones follow */
    const placement *place; /* of each such object; NULL: its tracer has it */
    uint32_t objects;       /* in all */
} object_tree;

typedef struct object_group {
    const box_tree *places; /* an entry each, in the world of the tree above */
    const placement *place; /* where each is */
    const uint16_t *which;  /* of these members each has; NULL: the first ones */
    const uint32_t *starts; /* with that: how many objects come before it; and the number of all */
    const object_tree *members;
    uint32_t first; /* its first object's number, in the tree above */
} object_group;

enum {
    OBJECT_DEPTH = 8,             /* groups within groups, the tree at the top counted */
    OBJECTS_MOST = UINT32_MAX - 1 /* of a tree */
};

/* object_tree_make() - boxes: of 1 to BOX_ENTRIES_MOST entries, in order, which are all objects;
 * for a tree with groups, set `singles` and what follows it, and object_tree_count(), then.
 * ST_NOMEM.
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

enum { OBJECT_LIST = 8 };

/* The next objects on a ray behind one that was asked for. */
typedef struct object_list {
    double origin[3], direction[3], t0, t1; /* of the ray */
    object_entry of[OBJECT_LIST];
    unsigned count; /* 0: of no ray yet; OBJECT_LIST: there may be others behind them */
} object_list;

static const uint32_t object_none = UINT32_MAX;

/* object_tree_next() - returns the next object behind `before` in that order; before: an object
 * that was returned for this ray, with the same t0 but maybe a greater t1, or object_none to begin.
 * object_none: the ray meets no more. list: zeroed at first, and then of any ray: a list that fits
 * spares the search. */
uint32_t object_tree_next(const object_tree *t, const object_ray *r, uint32_t before,
                          object_list *list);

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
