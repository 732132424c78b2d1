/* leaf_stats.h - what an isovalue needs of a treelet file, counted. */
#ifndef FORMATS_LEAF_STATS_H
#define FORMATS_LEAF_STATS_H

#include <stdint.h>

#include "formats/base/mem.h"
#include "formats/base/progress.h"
#include "formats/base/status.h"
#include "formats/leaf_file.h"

typedef struct leaf_activity {
    uint64_t treelets; /* whose own range holds the isovalue: lo < iso && iso <= hi */
    uint64_t bytes;    /* of their stored payloads */
    uint64_t cells;    /* min < iso && iso <= max over the cell's 8 samples, all of them finite */
} leaf_activity;

/* leaf_stats_activity() - per level; reads the payloads of active treelets. p may be NULL. */
CHECKED status leaf_stats_activity(mem *m, leaf_file *f, double iso, int threads, const progress *p,
                                   leaf_activity levels[LEAF_LEVELS_MAX]);

/* leaf_stats_cells() - active cells of one treelet's payload. */
uint64_t leaf_stats_cells(const leaf_layout *l, uint32_t t, const void *payload, double iso);

#endif
