/* time_tree.h - one tree over the treelets and the time steps of a field (M08 5.1.3).
 *
 * Its leaves are the treelets of level 0, one for each step, with the ranges that the directory
 * has. A node above is a group of treelets in a span of 1, 2, 4, .. steps: its range holds those of
 * all leaves below. A question about many steps so passes over whole spans, and whole parts of
 * space, that have nothing to say to it. Groups are what coarser treelets cover, or where there are
 * none, 8 neighbours in the file's order, 64, ..
 *
 * Nodes are split in space or in time, all of one group size and one span alike. Which, follows
 * from the mean overlap of the ranges of their children: first where it is greatest, as M08 does.
 * What changes little from step to step is so split in time at the root, and below is a tree for
 * each step: a question about one step costs no more than in that tree alone, but for the way to
 * it, and the ranges of a step lie side by side. Other orders are there to compare with (leafcast
 * bench time4d, tests/measurements/loading.md).
 *
 * Nothing of it is in the file. Making it reads each range a few times, and takes, until it is
 * made, 1.3 times the memory of the field's ranges of level 0.
 */
#ifndef FORMATS_LEAF_TIME_TREE_H
#define FORMATS_LEAF_TIME_TREE_H

#include "formats/leaf/leaf_file.h"
#include "formats/leaf/value_limits.h"

typedef enum time_order {
    TIME_ORDER_MOST,  /* first where the ranges of children overlap most (M08 5.1.3.2) */
    TIME_ORDER_LEAST, /* first where they overlap least */
    TIME_ORDER_LONG,  /* the longest side, as spans of steps and of treelets go (M08 5.1.3.1) */
    TIME_ORDER_STEPS, /* a tree for each step, and nothing over them */
    TIME_ORDERS
} time_order;

typedef struct time_tree time_tree;

/* time_tree_create() - make the tree of a field. f must stay open, with the ranges that it has.
 * time_tree_destroy() - NULL is fine. Immutable in between: any thread may ask. */
CHECKED status time_tree_create(mem *m, const leaf_file *f, uint32_t field, time_order order,
                                time_tree **out);
void time_tree_destroy(time_tree *t);

/* time_tree_bytes() - the memory of its ranges. The file's own are not among them. */
size_t time_tree_bytes(const time_tree *t);

/* A question: which treelets of level 0 meet any of some intervals, in which of the steps from
 * `first` to before `end`. */
typedef struct time_query {
    const value_limits *limits;
    int count;
    uint32_t first, end; /* 0 <= first <= end <= steps */
    /* Called for each treelet and step that meets, once, in an order that the tree decides. May
     * lower `end`, and set elements of `settled`: these steps are passed over from then on. */
    void (*met)(struct time_query *q, uint32_t treelet, uint32_t step);
    void *ctx;
    uint8_t *settled; /* per step of the file, or NULL: not 0 where nothing more is asked */
    uint64_t visited; /* out, added to: nodes whose range was looked at */
} time_query;

void time_tree_ask(const time_tree *t, time_query *q);

/* time_tree_steps() - set has[step - first] for each step from `first` to before `end` to whether a
 * treelet of level 0 meets an interval: 0 or 1. A grid without missing data has its surface there.
 * time_tree_first() - the first of these steps; `end` if there is none. *visited: as of a
 * question. */
void time_tree_steps(const time_tree *t, value_limits at, uint32_t first, uint32_t end,
                     uint8_t *has, uint64_t *visited);
uint32_t time_tree_first(const time_tree *t, value_limits at, uint32_t first, uint32_t end,
                         uint64_t *visited);

#endif
