/* leaf_stats.h - counts what an isovalue needs of a treelet file. */
#ifndef FORMATS_LEAF_LEAF_STATS_H
#define FORMATS_LEAF_LEAF_STATS_H

#include <stdbool.h>
#include <stdint.h>

#include "formats/base/mem.h"
#include "formats/base/progress.h"
#include "formats/base/status.h"
#include "formats/leaf/leaf_file.h"
#include "formats/leaf/time_tree.h"

typedef struct leaf_activity {
    uint64_t treelets; /* treelets whose own range holds the isovalue: lo < iso && iso <= hi */
    uint64_t bytes;    /* that the samples and cells of these take in the file; what several of them
                          need counts once */
    uint64_t cells;    /* that are active (leaf_active.h) */
} leaf_activity;

/* leaf_stats_activity() - the activity of a set, per level (a mesh: as level 0). Reads the payloads
 * of active treelets. p may be NULL. */
CHECKED status leaf_stats_activity(mem *m, leaf_file *f, uint32_t set, double iso, int threads,
                                   const progress *p, leaf_activity levels[LEAF_LEVELS_MAX]);

/* Where an isovalue is in some of a field's steps, by the ranges of treelets of level 0 alone. A
 * grid without missing data has its surface there. */
typedef struct leaf_presence {
    uint32_t steps;    /* that have it */
    uint64_t treelets; /* that have it at any of these */
    uint64_t most;     /* treelets in the step that has the most; */
    uint32_t step_of_most;
    uint64_t bytes; /* as of an activity, of all steps together: to play them reads so much, once */
} leaf_presence;

/* leaf_stats_presence() - by the tree of the field. asked, has: per step of the file, 0 or not. has
 * is set, within what is asked, to 0 or 1. */
CHECKED status leaf_stats_presence(mem *m, const leaf_file *f, const time_tree *tree,
                                   uint32_t field, double iso, const uint8_t *asked, uint8_t *has,
                                   leaf_presence *out);

/* leaf_stats_meets() - whether a treelet of level 0 of a set meets an interval. Looks from the
 * coarsest treelets down, below those alone that meet it: a treelet's merged range holds those of
 * its children. Where there are no coarse ones, at each treelet in turn. Needs no memory. */
bool leaf_stats_meets(const leaf_file *f, uint32_t set, value_limits at);

/* A summary of the deviations of a level of a grid (deviation.h), over all bricks and sets. */
typedef struct leaf_deviation {
    uint64_t bricks;   /* with a known deviation */
    uint64_t unknown;  /* with an unknown one */
    double mean, most; /* over the known ones; 0 without any */
} leaf_deviation;

/* leaf_stats_deviation() - the summary of a level above 0, for a file that has deviations. */
leaf_deviation leaf_stats_deviation(const leaf_file *f, uint32_t level);

/* What the payloads of a mesh are made of: bytes before compression. */
typedef struct leaf_mesh_parts {
    uint64_t nodes;       /* boxes and children of the trees, and where leaves begin */
    uint64_t tets;        /* their vertex indices */
    uint64_t positions;   /* of vertices, one array per treelet */
    uint64_t codes;       /* value ranges of the trees, all sets */
    uint64_t values;      /* of vertices, all sets */
    uint64_t gradients;   /* of vertices, all sets */
    uint64_t moved_boxes; /* boxes of the trees at the steps behind the first */
    uint64_t moved;       /* positions of vertices at these steps */
    uint64_t padding;
    uint64_t vertices, node_count, leaves; /* sums of COUNTS */
    uint64_t stored_topology, stored_values, stored_gradients, stored_positions; /* in the file */
} leaf_mesh_parts;

leaf_mesh_parts leaf_stats_mesh(const leaf_file *f);

#endif
