/* pyramid.h - one level of detail from the one below, slice by slice in a rolling window.
 *
 * Coarse node (i, j, k) is the 1-4-6-4-1 mean, per axis, around fine node (2i, 2j, 2k), indices
 * clamped to the fine level; so also the node that sits one beyond the fine level's end. Samples
 * keep their type:
 *
 *   integers  exact integer sums over 4096, rounded half to even
 *   f32       sums in double, x then y then z, each from the lowest index up, divided by the sum of
 *             weights, rounded to float; NaN and inf have weight 0; a coarse node whose (clamped)
 *             centre is one of them is the quiet NaN 0x7FC00000
 *
 * Bit-exact whatever the threads: a band of rows is one thread's, and no sum crosses bands.
 */
#ifndef PREP_GRID_PYRAMID_H
#define PREP_GRID_PYRAMID_H

#include <stdint.h>

#include "formats/base/mem.h"
#include "formats/base/pool.h"
#include "formats/base/sample.h"
#include "formats/base/status.h"

typedef struct pyramid pyramid;

/* pyramid_create() - type: one that sample_stored() yields; fine: nodes per axis of the level
 * below, each >= 2; threads: those of the pools it will be fed with. */
CHECKED status pyramid_create(mem *m, sample_type type, const uint32_t fine[3], int threads,
                              pyramid **out);
void pyramid_destroy(pyramid *p); /* NULL is fine */

/* pyramid_memory() - bytes that pyramid_create() takes. */
uint64_t pyramid_memory(sample_type type, const uint32_t fine[3], int threads);

/* pyramid_coarse() - nodes on an axis of the coarser level. */
uint32_t pyramid_coarse(uint32_t fine);

/* pyramid_ready() - how many more coarse slices there will be once `count` more fine ones have been
 * fed; at most count / 2 + 2. */
uint32_t pyramid_ready(const pyramid *p, uint32_t count);

/* pyramid_feed() - the next `count` fine slices, one after the other in memory; the pyramid_ready()
 * coarse slices that become complete are written to coarse, likewise. busy, coarse_busy: maps of
 * the slices (slice_tiles.h), those of coarse before: of what it holds; or both NULL. Coarse
 * samples are the same with maps and without. */
CHECKED status pyramid_feed(pyramid *p, pool *workers, const void *fine, const uint8_t *busy,
                            uint32_t count, void *coarse, uint8_t *coarse_busy);

/* pyramid_quiet() - before the first slice, where slices come with maps: the value of what is not
 * busy, a finite sample. */
CHECKED status pyramid_quiet(pyramid *p, const void *sample);

#endif
