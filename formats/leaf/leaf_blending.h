/* leaf_blending.h - what a kind of geometry decides about a file that lies between the steps of
 * another one of its kind (leaf_between.h): one table of functions each. A kind adds a file with
 * its table, which its leaf_geometry points to.
 */
#ifndef FORMATS_LEAF_LEAF_BLENDING_H
#define FORMATS_LEAF_LEAF_BLENDING_H

#include "formats/leaf/blend_rows.h"
#include "formats/leaf/leaf_file.h"

enum { LEAF_BETWEEN_SETS = 4, LEAF_BETWEEN_PARTS = 2 };

/* A payload that is to be made of those of two steps. */
typedef struct leaf_mix {
    uint32_t set, treelet;
    double share; /* 0: of the first alone */
    blend_fn *blend;
    const char *part[LEAF_BETWEEN_PARTS]; /* their payloads; NULL: not needed, or in `shared` */
    const void *shared;                   /* what treelets of all sets share; NULL: nothing */
    void *scratch;
    char *payload;
} leaf_mix;

typedef struct leaf_blending {
    /* At most so many payloads has a treelet in a file between. */
    uint32_t blocks;
    /* The first of LEAF_BETWEEN_SETS sets that stand for moments. */
    uint32_t (*first_set)(const leaf_layout *l);
    /* Make f->layout, given f->below. allocate(): once the arrays of all kinds are there, make what
     * the directory has in addition. The caller closes f on failure. */
    status (*lay_out)(leaf_file *f);
    status (*allocate)(leaf_file *f);
    /* Fill what the directory has in addition for a set, of sets of the file below; ranges and
     * flags are there. */
    void (*fill)(leaf_file *f, uint32_t set, const uint32_t sets[2], double share);
    /* The set that payload p is of; LEAF_NO_SET: none, it is the same one of the file below. */
    uint32_t (*set_of)(const leaf_layout *l, uint32_t p);
    /* The payload of another layout, in that one's set, which holds what p does in its own.
     * LEAF_NO_TREELET: what treelets share holds it. */
    uint32_t (*alike)(const leaf_layout *l, uint32_t p, const leaf_layout *of, uint32_t set);
    /* Where payload p, of a set, has those that it is made of. */
    leaf_beside (*beside)(const leaf_layout *l, uint32_t p);
    /* Make payload p. */
    void (*make)(const leaf_file *f, uint32_t p, const leaf_mix *m);
} leaf_blending;

enum { LEAF_NO_SET = UINT32_MAX };

#endif
