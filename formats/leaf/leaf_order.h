/* leaf_order.h - the order in which payloads lie in a file.
 *
 * Of a grid it is the order in which a conversion has them, as slices of level 0 come in from the
 * first to the last: so each is written once, at its place, and what is written stays. A slab is
 * the families of one level that lie at one z. It is complete when all slices are there that its
 * samples reach; a slice of a coarse level is, when the finer slices around it are. Slabs lie in
 * the order in which they are completed, the finer ones first where several are completed by one
 * slice; in a slab, families by y, then x; in a family, the treelets by octant, then their shell.
 * One set comes after the other. Payloads of other kinds lie as they are numbered.
 */
#ifndef FORMATS_LEAF_LEAF_ORDER_H
#define FORMATS_LEAF_LEAF_ORDER_H

#include "formats/leaf/leaf_layout.h"

typedef struct leaf_slab {
    uint32_t level, z; /* place of its families on their level, in families; the root is one */
    uint32_t slices;   /* of level 0 that complete it: 1 up to all */
} leaf_slab;

/* A walk through the slabs of a grid. */
typedef struct leaf_slabs {
    leaf_slab at;
    uint32_t next[LEAF_LEVELS_MAX]; /* per level: z of the first slab that has not been met */
} leaf_slabs;

/* leaf_slabs_begin() - at the first slab. leaf_slabs_next() - go on; false behind the last, which
 * is the root's. */
leaf_slabs leaf_slabs_begin(const leaf_layout *l);
bool leaf_slabs_next(leaf_slabs *s, const leaf_layout *l);

/* leaf_slab_families() - how many families a slab has. leaf_slab_parent() - the treelet above
 * family `index`, in order; LEAF_NO_TREELET: it is the root alone. */
uint32_t leaf_slab_families(const leaf_layout *l, const leaf_slab *s);
uint32_t leaf_slab_parent(const leaf_layout *l, const leaf_slab *s, uint32_t index);

/* A walk through the payloads of any kind. */
typedef struct leaf_order {
    uint32_t p; /* the payload; behind the last: the layout's `payloads` */
    /* Grids: */
    uint32_t set, family; /* family: index in its slab */
    uint32_t parent;      /* above the family, or LEAF_NO_TREELET */
    uint32_t child, left; /* the treelet, and how many of its family are behind it */
    leaf_slabs slabs;
} leaf_order;

/* leaf_order_begin() - at the first payload. leaf_order_next() - go on. */
leaf_order leaf_order_begin(const leaf_layout *l);
void leaf_order_next(leaf_order *o, const leaf_layout *l);

/* leaf_order_last() - the last payload. */
uint32_t leaf_order_last(const leaf_layout *l);

/* leaf_order_same_family() - whether two places of a walk are in one family. */
static inline bool leaf_order_same_family(const leaf_order *a, const leaf_order *b) {
    return a->set == b->set && a->family == b->family && a->slabs.at.level == b->slabs.at.level &&
           a->slabs.at.z == b->slabs.at.z;
}

/* Payloads get their places one after the other. */
typedef struct leaf_placing {
    uint64_t end; /* where the payload before, or the last section, ends */
    bool run;     /* a run has begun that has no bytes yet */
} leaf_placing;

/* leaf_placing_next() - the offset of payload p of so many stored bytes. It lies behind the one
 * before it, at the next multiple of LEAF_ALIGN, or right behind it where the grid is compressed;
 * or at one of 2^run_align_log2 if it is the first of its run that has bytes. In a grid, a run
 * begins with the child in octant 0, which every parent has. In a mesh, it begins with the first
 * treelet's payload in each block. A payload of no bytes lies where the one before it ends. */
static inline uint64_t leaf_placing_next(leaf_placing *x, const leaf_layout *l, uint32_t p,
                                         uint64_t bytes, uint32_t run_align_log2) {
    x->run |= leaf_layout_begins_run(l, p);
    if (!bytes)
        return x->end;
    const uint32_t inner = l->coded ? 0 : LEAF_ALIGN_LOG2;
    const uint64_t at = leaf_layout_aligned(x->end, x->run ? run_align_log2 : inner);
    *x = (leaf_placing){.end = at + bytes};
    return at;
}

#endif
