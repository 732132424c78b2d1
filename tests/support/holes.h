/* holes.h - ray-cells among missing data: volumes with NaN and inf voxels, and which of their cells
 * the masks of active cells give to the intersectors. */
#ifndef TESTS_SUPPORT_HOLES_H
#define TESTS_SUPPORT_HOLES_H

#include <stdbool.h>

#include "tests/support/ray_cells.h"

typedef struct holes holes;

/* holes_make() - converts small volumes in the scratch folder and computes their masks, with the
 * newest kernels; trouble ends the program. */
holes *holes_make(uint64_t seed);
void holes_free(holes *h); /* NULL is fine */

/* holes_cell() - the index-th ray-cell; returns whether the masks say that it is active. */
bool holes_cell(const holes *h, uint64_t index, ray_cell *out);

#endif
