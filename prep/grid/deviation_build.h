/* deviation_build.h - the deviations of one level from the one below (deviation.h), slice by slice
 * beside the pyramid that makes it.
 *
 * Compares fine slices with the coarse ones around them as soon as both are there; up to three fine
 * slices and a coarse one are kept for that. The same codes whatever the threads and the batches: a
 * coarse row of bricks is one thread's, and greatest numbers do not depend on an order.
 */
#ifndef PREP_GRID_DEVIATION_BUILD_H
#define PREP_GRID_DEVIATION_BUILD_H

#include "formats/base/mem.h"
#include "formats/base/pool.h"
#include "formats/base/status.h"
#include "formats/grid/grid.h"
#include "formats/leaf/deviation.h"

typedef struct deviation_build deviation_build;

/* deviation_build_create() - of level fine + 1 in a set; codes: of all, zero there, and complete
 * for level `fine` wherever slices are compared. l and codes must outlive it; g: for its axes.
 * threads: those of the pools it will be fed with. */
CHECKED status deviation_build_create(mem *m, const leaf_layout *l, uint32_t fine, uint32_t set,
                                      const grid *g, int threads, uint16_t *codes,
                                      deviation_build **out);
void deviation_build_destroy(deviation_build *b); /* NULL is fine */

/* deviation_build_memory() - bytes that deviation_build_create() takes. */
uint64_t deviation_build_memory(const leaf_layout *l, uint32_t fine, bool rectilinear, int threads);

/* deviation_build_feed() - the next slices of both levels, one after the other in memory: as they
 * go into pyramid_feed() and come out of it. */
CHECKED status deviation_build_feed(deviation_build *b, pool *workers, const void *fine,
                                    uint32_t fine_count, const void *coarse, uint32_t coarse_count);

/* deviation_build_end() - all levels of a set are complete: room for what was rounded; range: of
 * the set's finite values. */
void deviation_build_end(const leaf_layout *l, uint32_t set, bool rectilinear,
                         const double range[2], uint16_t *codes);

#endif
