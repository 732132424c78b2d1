/* slab.h - holds the part of a level that is being cut into treelets: a slab two treelets high.
 *
 * Slices go in front to back. When all slices of the next slab are there (with halo), its boxes
 * come out. Each holds the samples of whole families of siblings. In memory a slab is a ring of
 * slices, and one box is the whole slab. A spilled slab is made of columns (x/y tiles) in a scratch
 * file beside the output. Each column is written once and read once, and one is in memory at a
 * time. The file has room for two slabs, used in turn, because they overlap.
 */
#ifndef PREP_GRID_SLAB_H
#define PREP_GRID_SLAB_H

#include <stdbool.h>
#include <stdint.h>

#include "formats/base/mem.h"
#include "formats/base/pool.h"
#include "formats/base/state_io.h"
#include "formats/base/status.h"
#include "formats/leaf/leaf_layout.h"
#include "prep/grid/slice_ring.h"
#include "prep/grid/treelet_build.h"

typedef struct slab slab;

/* How to hold a level's slabs. */
typedef struct slab_plan {
    bool spilled;
    uint32_t column_families; /* if spilled: families across a column; it is one family high */
    int threads;              /* of the pools that will store slices */
    uint32_t ahead;           /* slices that are read ahead, to the slab's ring; 0: it has none */
} slab_plan;

/* slab_memory() - bytes that slab_create() takes. slab_spill_bytes() - size of the scratch file; 0
 * unless spilled. */
uint64_t slab_memory(const leaf_layout *l, uint32_t level, const slab_plan *plan);
uint64_t slab_spill_bytes(const leaf_layout *l, uint32_t level, const slab_plan *plan);

/* slab_slots() - slots of slab_ring(). */
uint32_t slab_slots(const leaf_layout *l, uint32_t level, const slab_plan *plan);

/* slab_families() - families along an axis of a level. A root alone is one, too. */
uint32_t slab_families(const leaf_layout *l, uint32_t level, int axis);

/* slab_create() - l must outlive the slab. beside: path beside which a scratch file may lie. */
CHECKED status slab_create(mem *m, const leaf_layout *l, uint32_t level, const slab_plan *plan,
                           const char *beside, slab **out);
void slab_destroy(slab *s); /* NULL is fine */

/* slab_room() - slices that fit before the next slab is complete and must be taken. 0 if a slab is
 * complete, or at the level's end. */
uint32_t slab_room(const slab *s);
bool slab_complete(const slab *s);

/* slab_quiet() - set the value of tiles that are not busy, a sample. Call it before the first
 * slice.
 */
void slab_quiet(slab *s, const void *sample);

/* slab_ring() - where slices may be read to, before they are stored. In memory it is the slab's own
 * ring, and they stay where they are. slab_needed() - the first slice that must stay there. */
slice_ring slab_ring(const slab *s);
uint32_t slab_needed(const slab *s);

/* slab_store() - store the next `count` slices, at most slab_room(), consecutive in memory. busy:
 * their maps (slice_tiles.h); NULL: all tiles are. */
CHECKED status slab_store(slab *s, pool *workers, const void *slices, const uint8_t *busy,
                          uint32_t count);

/* A box and the families whose samples it holds. Families form a grid in the level, each two
 * treelets wide on each axis. */
typedef struct slab_box {
    sample_box samples;
    uint32_t first[3], count[3]; /* range of families; count[2] is 1 */
} slab_box;

/* slab_boxes() - boxes of the complete slab. slab_take() - one of them, valid until the next call.
 * slab_next() - finish the complete slab. */
uint32_t slab_boxes(const slab *s);
CHECKED status slab_take(slab *s, uint32_t index, slab_box *out);
void slab_next(slab *s);

/* slab_keep() - save or load which slices there are, and those that the slabs to come need. No slab
 * is complete; one that loads is new. The slab that loads may be held otherwise. If it is
 * spilled, loading takes a slice's memory for a while. */
CHECKED status slab_keep(slab *s, state_io *io);

#endif
