/* box_tree.h - which boxes a ray meets: a tree four wide, whose nodes have their children's boxes
 * as floats.
 *
 * Boxes are kept relative to the tree's middle. A ray begins where it enters the box of them all,
 * so what is rounded is of the tree's own size, however far away the ray comes from. The rounding
 * of the boxes, of the ray, and of all that is computed of both is less than the ray's margin: no
 * box is missed, but some may be met in vain. A box inside another one is entered at the same s, or
 * later, and left at the same, or earlier.
 */
#ifndef RENDER_FRAME_BOX_TREE_H
#define RENDER_FRAME_BOX_TREE_H

#include <stdbool.h>
#include <stdint.h>
#include <string.h>

#include "formats/base/mem.h"

enum {
    BOX_WIDTH = 4,
    BOX_ENTRIES_MOST = 1 << 30, /* of a tree */
    BOX_STACK = 64              /* room for the children on the way to any entry */
};

typedef float box_floats __attribute__((vector_size(16)));
typedef int32_t box_masks __attribute__((vector_size(16)));

typedef struct box_node {
    float box[2][3][BOX_WIDTH]; /* those of its children, see box_tree.scale; of none: empty */
    uint32_t child[BOX_WIDTH];  /* an entry, */
    uint32_t least, most;       /* the least and the greatest entry below */
    uint32_t inner;             /* or, where this has the child's bit, a node */
} box_node;

typedef struct box_tree {
    double box[2][3]; /* around all, widened by more than rounding */
    double middle[3];
    double scale;    /* a power of two: nodes have scale * (x - middle), of 2 at most */
    double half[3];  /* how far the box of all goes from its middle, likewise */
    box_node *nodes; /* the root first; NULL: there is one entry, whose box is that of all */
    uint32_t *leaf;  /* of each entry: BOX_WIDTH times its node's number, and which child it is */
    uint32_t entries;
} box_tree;

/* box_tree_make() - boxes: of 1 to BOX_ENTRIES_MOST entries. ST_NOMEM; then, too, *t may be
 * released, as an empty one may. */
CHECKED status box_tree_make(box_tree *t, mem *m, const double (*boxes)[2][3], uint32_t entries);
void box_tree_release(box_tree *t, mem *m);

/* A ray, or its way in the world of a tree. */
typedef struct box_way {
    double origin[3], direction[3];
    double inverse[3]; /* of the direction; 0: it does not move along the axis, or hardly */
    double off[3];     /* so far it may pass from where the tracers have it */
} box_way;

/* The part of it that is of interest. */
typedef struct box_span {
    double t0, t1;
} box_span;

/* box_way_of() - a ray of the scene's world. */
box_way box_way_of(const double origin[3], const double direction[3]);

/* Such a way in a tree, from where it enters the box of all: t = from + s * unit. It moves by 1 at
 * most while s grows by 1. */
typedef struct box_ray {
    float near[3], far[3]; /* the origin for planes where it enters, and leaves, boxes */
    float inverse[3];
    bool down[3];
    double from, unit;
    double t0, t1; /* cut to these */
} box_ray;

/* box_tree_enter() - begin in a tree: sets *at to where the way, in `within`, meets the box of all,
 * and, where the tree has nodes, *r. Returns false, and sets neither, if it does not. at->t0
 * depends on within->t0, but not on within->t1. */
bool box_tree_enter(const box_tree *t, const box_way *w, const box_span *within, box_span *at,
                    box_ray *r);

/* box_ray_span() - the t between two s. */
box_span box_ray_span(const box_ray *r, float s0, float s1);

/* box_ray_least(), box_ray_most() - an s below all those of boxes that are left, by
 * box_ray_span(), at t or later; and one above those of boxes that are entered at t or earlier. */
float box_ray_least(const box_ray *r, double t);
float box_ray_most(const box_ray *r, double t);

static inline box_floats box_lesser(box_floats a, box_floats b) {
    const box_masks m = a < b;
    return (box_floats)((m & (box_masks)a) | (~m & (box_masks)b));
}
static inline box_floats box_greater(box_floats a, box_floats b) {
    const box_masks m = a > b;
    return (box_floats)((m & (box_masks)a) | (~m & (box_masks)b));
}

/* box_ray_meets() - returns which children of a node the ray meets, as bits, between two s: s0[]
 * and s1[] are set to where it enters and leaves each. */
static inline unsigned box_ray_meets(const box_ray *r, const box_node *n, float least, float most,
                                     float s0[BOX_WIDTH], float s1[BOX_WIDTH]) {
    box_floats in = {0.0f, 0.0f, 0.0f, 0.0f}, out = {1e38f, 1e38f, 1e38f, 1e38f};
    for (int a = 0; a < 3; a++) {
        box_floats near, far;
        memcpy(&near, n->box[r->down[a]][a], sizeof near);
        memcpy(&far, n->box[!r->down[a]][a], sizeof far);
        in = box_greater((near - r->near[a]) * r->inverse[a], in);
        out = box_lesser((far - r->far[a]) * r->inverse[a], out);
    }
    const box_masks met = (in <= out) & (in <= most) & (out >= least);
    unsigned bits = 0;
    for (int k = 0; k < BOX_WIDTH; k++)
        bits |= (unsigned)(met[k] & 1) << k;
    memcpy(s0, &in, sizeof in);
    memcpy(s1, &out, sizeof out);
    return bits;
}

#endif
