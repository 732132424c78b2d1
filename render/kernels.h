/* kernels.h - the table of kernels, filled by what the CPU can do.
 *
 * Every entry has a scalar version that is the truth; SIMD versions overwrite it where the CPU
 * allows and must give the same bits.
 */
#ifndef RENDER_KERNELS_H
#define RENDER_KERNELS_H

#include "render/walk.h"

typedef struct kernels {
    const char *isa;
    walk_fn walk; /* one ray through one treelet */
} kernels;

/* kernels_for() - isa: NULL or "auto" for the best there is, or a name; NULL where this build or
 * this CPU has no such kernels. */
const kernels *kernels_for(const char *isa);

#endif
