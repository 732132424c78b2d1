/* attractor.h - the Lorenz attractor as a density: how often its orbits pass each node.
 *
 * A fixed set of orbits is integrated by Runge and Kutta's method with + - * alone. Each point is
 * shared out to the eight nodes around it in whole numbers, so the sums depend on no order. The
 * orbits are integrated again for every block: memory is bounded by one block's counters.
 */
#ifndef PREP_GENERATE_ATTRACTOR_H
#define PREP_GENERATE_ATTRACTOR_H

#include <stdint.h>

#include "formats/base/mem.h"
#include "formats/base/pool.h"
#include "formats/base/status.h"
#include "prep/generate/field.h"

typedef struct attractor attractor;

extern const field_info attractor_info;

/* attractor_create() - samples: most nodes of a block. */
CHECKED status attractor_create(mem *m, const uint32_t dims[3], uint64_t seed, size_t samples,
                                attractor **out);
void attractor_destroy(attractor *a); /* NULL is fine */

/* attractor_count() - integrate all orbits, and count their points at the nodes of a block. */
CHECKED status attractor_count(attractor *a, pool *p, const field_block *block);

/* attractor_values() - densities at `count` nodes of the counted block, from its node `first`
 * on. */
void attractor_values(const attractor *a, size_t first, size_t count, double *out);

#endif
