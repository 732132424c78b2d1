/* pyramid.h - makes a level of detail from the finer one, slice by slice in a rolling window.
 *
 * Coarse node (i, j, k) is the 1-4-6-4-1 mean, per axis, around fine node (2i, 2j, 2k), with
 * indices clamped to the fine level. This holds also for the node one beyond the fine level's end.
 * Samples keep their type:
 *
 *   integers  exact integer sums over 4096, rounded half to even
 *   f32       sums in double, x then y then z, each from the lowest index up, divided by the sum of
 *             weights, rounded to float, then to PYRAMID_BITS bits of mantissa (not if the sums of
 *             all five planes are the same: a constant stays as it is). NaN and infinity have
 *             weight 0; a coarse node whose (clamped) centre is one of them is the quiet NaN
 *             0x7FC00000
 *   colours   (colour_field.h; f32) each byte as integers are: the mean of what is stored, in sRGB
 *
 * Bit-exact whatever the threads: one thread does a band of rows, and no sum crosses bands.
 */
#ifndef PREP_GRID_PYRAMID_H
#define PREP_GRID_PYRAMID_H

#include <stdbool.h>
#include <stdint.h>

#include "formats/base/mem.h"
#include "formats/base/pool.h"
#include "formats/base/sample.h"
#include "formats/base/state_io.h"
#include "formats/base/status.h"

typedef struct pyramid pyramid;

/* Bits behind the leading one: errors of rounding are at most 2^-13 of a value. */
enum { PYRAMID_BITS = 12 };

/* pyramid_create() - type: a result of sample_stored(). colours: samples are. fine: nodes per axis
 * of the finer level, each >= 2. threads: of the pools that it will be fed with. */
CHECKED status pyramid_create(mem *m, sample_type type, bool colours, const uint32_t fine[3],
                              int threads, pyramid **out);
void pyramid_destroy(pyramid *p); /* NULL is fine */

/* pyramid_memory() - bytes that pyramid_create() takes. */
uint64_t pyramid_memory(sample_type type, const uint32_t fine[3], int threads);

/* pyramid_coarse() - nodes of the coarser level on an axis with `fine` nodes. */
uint32_t pyramid_coarse(uint32_t fine);

/* pyramid_ready() - coarse slices that the next `count` fine slices will complete; at most count /
 * 2 + 2. */
uint32_t pyramid_ready(const pyramid *p, uint32_t count);

/* pyramid_feed() - feed the next `count` fine slices, consecutive in memory. The pyramid_ready()
 * coarse slices that become complete are written to `coarse`. busy, coarse_busy: maps of the slices
 * (slice_tiles.h), or both NULL. On entry coarse_busy must describe what `coarse` holds. Coarse
 * samples are the same with and without maps. */
CHECKED status pyramid_feed(pyramid *p, pool *workers, const void *fine, const uint8_t *busy,
                            uint32_t count, void *coarse, uint8_t *coarse_busy);

/* pyramid_quiet() - if slices have maps: set the value of tiles that are not busy, a finite sample.
 * Call it before the first slice. */
CHECKED status pyramid_quiet(pyramid *p, const void *sample);

/* pyramid_keep() - save or load how far it is, and the window. One that loads is new, but for
 * pyramid_quiet(). */
CHECKED status pyramid_keep(pyramid *p, state_io *io);

#endif
