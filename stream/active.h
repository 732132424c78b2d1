/* active.h - which nodes and cells of a treelet an interest needs: bit masks derived from codes and
 * samples.
 *
 * The treelet's tree becomes an octree of 8-bit child masks over its blocks of 4^3 cells. Every
 * active block gets a mask of its 64 cells. All are in Morton order (bit 0 x, bit 1 y, bit 2 z per
 * level). So byte i of a block's mask holds the cells of its i-th 2^3 group, and traversal takes
 * the same step from root to cell: test a bit of a byte.
 *
 * A cell is active iff the range of its eight samples meets the interest (interest.h) and none of
 * them is NaN or inf. This is exact, so traversal need not look at samples. Masks are never stored.
 * They take 4.1 KiB per treelet of 32^3 cells, made in 2 to 5 us with AVX2 or SSE4.2, in 14 to 41
 * us by the scalar version (tests/measurements/loading.md).
 */
#ifndef STREAM_ACTIVE_H
#define STREAM_ACTIVE_H

#include <stddef.h>
#include <stdint.h>

#include "formats/base/cpu.h"
#include "formats/leaf/leaf_file.h"
#include "stream/interest.h"

/* Masks of one treelet. The struct and then its arrays lie in one block of active_bytes(). */
typedef struct active_masks {
    uint8_t root;             /* children of the root (B / 2 cells on a side) with an active cell */
    uint8_t first[3], end[3]; /* per axis: range of active blocks; unset without any */
    bool some_whole;          /* nodes with active cells are taken whole (homogeneous.h): */
    uint8_t *whole;  /* per block: 0, or the number of levels of the whole node that holds it */
    uint8_t *nodes;  /* child masks of tree levels 1 .. K-1: 8, 64, ... bytes, level after level */
    uint64_t *cells; /* 8^K: one per block of 4^3 cells, Morton order */
} active_masks;

/* active_bytes() - returns the bytes of one treelet's masks; K = node_levels. */
size_t active_bytes(uint32_t node_levels);

/* active_init() - lay the masks out in a block of active_bytes(); everything inactive. */
active_masks *active_init(void *block, uint32_t node_levels);

/* active_bound() - set first[] and end[] from the nodes. */
void active_bound(active_masks *masks, uint32_t node_levels);

/* active_whole() - find which nodes of two levels or more are taken whole. Call it after
 * active_compute(). If there are any, sets first[] and end[] to span the whole treelet. */
void active_whole(active_masks *masks, const leaf_file *f, uint32_t p, const void *payload,
                  const homogeneous *in);

/* active_range() - give a range that contains the samples of node i of tree level k (1 .. K). The
 * node must have cells, and no NaN or inf. */
void active_range(const leaf_file *f, uint32_t p, const void *payload, uint32_t k, uint32_t i,
                  double range[2]);

/* active_wide() - make masks of a coarse level's payload in a file with deviations (deviation.h):
 * all cells of the blocks where level 0 may meet the interest. Where a deviation is unknown, the
 * block gets the cells of `exact`. */
void active_wide(active_masks *masks, const active_masks *exact, const leaf_file *f, uint32_t p,
                 const void *payload, const interest *in);

/* active_compute() - make the masks of a grid's payload p (leaf_layout_samples()) for an interest.
 * Blocks whose codes do not meet the interest are inactive; in the others the samples decide. */
typedef void active_fn(active_masks *masks, const leaf_file *f, uint32_t p, const void *payload,
                       const interest *in);
active_fn active_compute;

/* active_for() - returns the version of active_compute() for an ISA of this CPU; same bits. */
active_fn *active_for(cpu_isa isa);

/* Returns where level k (1 .. K-1) starts in `nodes`. */
static inline uint32_t active_nodes_at(uint32_t k) {
    return ((1u << (3 * k)) - 8u) / 7u;
}

#endif
