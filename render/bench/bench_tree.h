/* bench_tree.h - a volume's full resolution in memory, with one min/max tree over all of it whose
 * nodes' ranges are kept in several ways; for the suite `nodes`.
 *
 * Levels by size: 0 are cells, k blocks of 2^k cells an axis, the last one is the root. Ranges
 * begin at level BENCH_TREE_FINEST. A level's nodes are stored x fastest; there are none outside
 * the volume (M08 4.3.2.3).
 */
#ifndef RENDER_BENCH_BENCH_TREE_H
#define RENDER_BENCH_BENCH_TREE_H

#include <stdbool.h>
#include <stdint.h>

#include "formats/base/mem.h"
#include "formats/base/sample.h"
#include "formats/base/status.h"
#include "formats/leaf/quantize.h"

enum { BENCH_TREE_FINEST = 1, BENCH_TREE_TREELET = 5, BENCH_TREE_LEVELS = 16 };

/* How ranges are kept. */
typedef enum bench_keeping {
    KEEP_LARGE,   /* float min and max, which children there are, where the first one is */
    KEEP_FLOAT,   /* float min and max */
    KEEP_OWN,     /* min and max in the type of the samples, where that is an integer */
    KEEP_VOLUME,  /* 8-bit codes over the volume's range (M08 4.3.2.4) */
    KEEP_TREELET, /* 8-bit codes over the range of a treelet of 32^3 cells; above, float */
    KEEPINGS,
    /* KEEP_TREELET without what parents say already (M08 4.3.2.5): two codes of a family are the
     * parent's own, for one monotone function codes them all; three bits each say whose. Counted
     * only: it visits the same nodes. */
    KEEP_REUSE = KEEPINGS
} bench_keeping;

typedef struct bench_large_node {
    float lo, hi;
    uint32_t child; /* the first; others follow in order of octants */
    uint32_t exists;
} bench_large_node;

typedef struct bench_codes16 {
    uint16_t lo, hi;
} bench_codes16;

typedef struct bench_codes8 {
    uint8_t lo, hi;
} bench_codes8;

typedef struct bench_tree {
    uint32_t nodes[3]; /* of the grid: samples */
    sample_type type;
    double lo, hi; /* of all samples */
    float *samples;
    uint32_t levels; /* the root's is the last */
    uint32_t n[BENCH_TREE_LEVELS][3];
    size_t count[BENCH_TREE_LEVELS];
    float (*range[BENCH_TREE_LEVELS])[2];
    bench_codes16 *own16[BENCH_TREE_LEVELS]; /* types of 16 bits; those of 8: */
    bench_codes8 *own8[BENCH_TREE_LEVELS];
    bench_codes8 *of_volume[BENCH_TREE_LEVELS], *of_treelet[BENCH_TREE_LEVELS];
    bench_large_node *large[BENCH_TREE_LEVELS];
    quantizer *treelet; /* of every node of level BENCH_TREE_TREELET */
    mem *m;
} bench_tree;

/* bench_tree_load() - of a treelet file's level 0; release it in any case. ST_UNSUPPORTED with
 * samples that are not finite. */
CHECKED status bench_tree_load(bench_tree *t, mem *m, const char *path);
void bench_tree_release(bench_tree *t);

static inline size_t bench_tree_index(const bench_tree *t, uint32_t k, const uint32_t at[3]) {
    return at[0] + t->n[k][0] * (at[1] + (size_t)t->n[k][1] * at[2]);
}

/* bench_tree_child() - the child in an octant of a node of level k; false where there is none. */
static inline bool bench_tree_child(const bench_tree *t, uint32_t k, const uint32_t at[3],
                                    unsigned octant, uint32_t child[3]) {
    for (int a = 0; a < 3; a++) {
        child[a] = 2 * at[a] + (octant >> a & 1u);
        if (child[a] >= t->n[k - 1][a])
            return false;
    }
    return true;
}

/* bench_tree_bytes() - of all nodes down to level `finest`, and of one below the treelets. */
double bench_tree_bytes(const bench_tree *t, bench_keeping keeping, uint32_t finest, double *node);

#endif
