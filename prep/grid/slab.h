/* slab.h - the part of a level that is being cut into treelets: a slab of two treelets' height.
 *
 * Slices go in front to back; whenever those of the next slab are all there (with halo), its boxes
 * come out, each with the samples of whole families of siblings. Held in memory as a ring of
 * slices, and then one box is the whole slab; or spilled: as columns (x/y tiles) of a scratch file
 * beside the output, written once and read once, of which one is in memory at a time. The file has
 * room for two slabs, used in turn, for they overlap.
 */
#ifndef PREP_GRID_SLAB_H
#define PREP_GRID_SLAB_H

#include <stdbool.h>
#include <stdint.h>

#include "formats/base/mem.h"
#include "formats/base/pool.h"
#include "formats/base/status.h"
#include "formats/leaf/leaf_layout.h"
#include "prep/grid/treelet_build.h"

typedef struct slab slab;

/* How to hold a level's slabs. */
typedef struct slab_plan {
    bool spilled;
    uint32_t column_families; /* spilled: width of a column, in families; its height is one */
    int threads;              /* of the pools that will store slices */
} slab_plan;

/* slab_memory(), slab_spill_bytes() - what slab_create() takes; size of the scratch file (0 unless
 * spilled). */
uint64_t slab_memory(const leaf_layout *l, uint32_t level, const slab_plan *plan);
uint64_t slab_spill_bytes(const leaf_layout *l, uint32_t level, const slab_plan *plan);

/* slab_families() - families along an axis of a level; a lone root is one, too. */
uint32_t slab_families(const leaf_layout *l, uint32_t level, int axis);

/* slab_create() - l must outlive the slab; beside: the path beside which a scratch file may be. */
CHECKED status slab_create(mem *m, const leaf_layout *l, uint32_t level, const slab_plan *plan,
                           const char *beside, slab **out);
void slab_destroy(slab *s); /* NULL is fine */

/* slab_room() - slices that may be stored before the next slab is complete and must be taken; 0
 * when it is, and at the level's end. */
uint32_t slab_room(const slab *s);
bool slab_complete(const slab *s);

/* slab_store() - the next `count` slices, at most slab_room(), one after the other in memory. busy:
 * maps of them (slice_tiles.h), or NULL, always or never. */
CHECKED status slab_store(slab *s, pool *workers, const void *slices, const uint8_t *busy,
                          uint32_t count);

/* A box and the families whose samples it holds, in the level's grid of families (two treelets wide
 * on each axis). */
typedef struct slab_box {
    sample_box samples;
    uint32_t first[3], count[3]; /* families; count[2] is 1 */
} slab_box;

/* slab_boxes(), slab_take() - of the complete slab: how many boxes, and one of them, valid until
 * the next call. slab_next() - the complete slab is done with. */
uint32_t slab_boxes(const slab *s);
CHECKED status slab_take(slab *s, uint32_t index, slab_box *out);
void slab_next(slab *s);

#endif
