/* deviation_build.h - deviations of one level from the finer one (deviation.h), slice by slice
 * while the pyramid makes it.
 *
 * Fine slices are compared with the coarse ones around them as soon as both are there. Up to three
 * fine slices and a coarse one are kept for that. The codes do not depend on threads or batches:
 * one thread does a coarse row of bricks, and a maximum does not depend on an order.
 */
#ifndef PREP_GRID_DEVIATION_BUILD_H
#define PREP_GRID_DEVIATION_BUILD_H

#include "formats/base/mem.h"
#include "formats/base/pool.h"
#include "formats/base/state_io.h"
#include "formats/base/status.h"
#include "formats/grid/grid.h"
#include "formats/leaf/deviation.h"

typedef struct deviation_build deviation_build;

/* deviation_build_create() - for level fine + 1 of a set. codes: of all levels; zero for that
 * level, and complete for level `fine` wherever slices are compared. l and codes must outlive it.
 * g: for its axes. threads: of the pools that it will be fed with. */
CHECKED status deviation_build_create(mem *m, const leaf_layout *l, uint32_t fine, uint32_t set,
                                      const grid *g, int threads, uint16_t *codes,
                                      deviation_build **out);
void deviation_build_destroy(deviation_build *b); /* NULL is fine */

/* deviation_build_memory() - bytes that deviation_build_create() takes. */
uint64_t deviation_build_memory(const leaf_layout *l, uint32_t fine, bool rectilinear, int threads);

/* Slices of a level, consecutive in memory, with their maps (slice_tiles.h): all tiles that are not
 * busy have one value, the same in both levels. Where a coarse tile is not, fine ones are not, as
 * pyramid_feed() has it. busy: NULL: all tiles are. */
typedef struct deviation_slices {
    const char *samples;
    const uint8_t *busy;
    uint32_t count;
} deviation_slices;

/* deviation_build_feed() - feed the next slices of both levels: the same that pyramid_feed() takes
 * and gives. */
CHECKED status deviation_build_feed(deviation_build *b, pool *workers, const deviation_slices *fine,
                                    const deviation_slices *coarse);

/* deviation_build_keep() - save or load how far it is, and the slices that are kept; but not the
 * codes. One that loads is new. */
CHECKED status deviation_build_keep(deviation_build *b, state_io *io);

/* deviation_build_end() - call it when all levels of a set are complete. Adds the rounding errors
 * to the codes. range: of the set's finite values. */
void deviation_build_end(const leaf_layout *l, uint32_t set, bool rectilinear,
                         const double range[2], uint16_t *codes);

#endif
