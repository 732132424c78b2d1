/* active.h - which nodes and cells of a treelet an interest needs: bit masks derived from codes and
 * samples.
 *
 * The treelet's tree becomes an octree of 8-bit child masks over its blocks of 4^3 cells, and every
 * active block gets a mask of its 64 cells, all in Morton order (bit 0 x, bit 1 y, bit 2 z per
 * level). So byte i of a block's mask are the cells of its i-th 2^3 group, and traversal is the
 * same step from root to cell: test a bit of a byte.
 *
 * A cell is active iff the range of its eight samples meets the interest (interest.h) and none of
 * them is NaN or inf: exact, so traversal need not look at samples. Derived data, never
 * stored: 4.1 KiB a treelet of 32^3 cells, made in 2 to 5 us with AVX2 or SSE4.2, in 14 to 41 us by
 * the scalar version (tests/measurements/loading.md).
 */
#ifndef STREAM_ACTIVE_H
#define STREAM_ACTIVE_H

#include <stddef.h>
#include <stdint.h>

#include "formats/base/cpu.h"
#include "formats/leaf/leaf_file.h"
#include "stream/interest.h"

/* Masks of one treelet; lies in front of its arrays in one block of active_bytes(). */
typedef struct active_masks {
    uint8_t root; /* children of the root (their cells: B / 2 on a side) that hold an active cell */
    uint8_t first[3], end[3]; /* the blocks with one lie between these; nothing is set for none */
    bool some_whole;          /* then nodes with active cells may be taken whole (homogeneous.h): */
    uint8_t *whole;  /* one a block: 0, or of how many levels the whole node is that it is in */
    uint8_t *nodes;  /* child masks of tree levels 1 .. K-1: 8, 64, ... bytes, level after level */
    uint64_t *cells; /* 8^K: one a block of 4^3 cells, Morton order */
} active_masks;

/* active_bytes() - of one treelet's masks, K = node levels. */
size_t active_bytes(uint32_t node_levels);

/* active_init() - lay the masks out in a block of active_bytes(); everything inactive. */
active_masks *active_init(void *block, uint32_t node_levels);

/* active_bound() - set first[] and end[] by the nodes. */
void active_bound(active_masks *masks, uint32_t node_levels);

/* active_whole() - then, which nodes of two levels or more are taken whole; first[] and end[] leave
 * nothing out there. */
void active_whole(active_masks *masks, const leaf_file *f, uint32_t p, const void *payload,
                  const homogeneous *in);

/* active_range() - at least the range of the samples of node i of tree level k (1 .. K), which has
 * cells and no NaN or inf. */
void active_range(const leaf_file *f, uint32_t p, const void *payload, uint32_t k, uint32_t i,
                  double range[2]);

/* active_wide() - of a payload of a coarse level in a file with deviations (deviation.h): all cells
 * of the blocks where there may be something of the interest in level 0; where a deviation is
 * unknown, those of `exact`. */
void active_wide(active_masks *masks, const active_masks *exact, const leaf_file *f, uint32_t p,
                 const void *payload, const interest *in);

/* active_compute() - masks of a grid's payload p (leaf_layout_samples()) for an interest. Of the
 * samples only those of blocks whose codes meet it decide. */
typedef void active_fn(active_masks *masks, const leaf_file *f, uint32_t p, const void *payload,
                       const interest *in);
active_fn active_compute;

/* active_for() - the same function, the same bits, for a CPU that this one is. */
active_fn *active_for(cpu_isa isa);

/* Where level k (1 .. K-1) starts in `nodes`. */
static inline uint32_t active_nodes_at(uint32_t k) {
    return ((1u << (3 * k)) - 8u) / 7u;
}

#endif
