/* grid_extreme_batch_wide.c - grid_extreme_batch_template.h with vectors as wide as those of
 * AVX-512, in plain C.
 */
#include "tests/support/grid_extreme_batch_wide.h"

#include "tests/support/simd_wide.h"

#include "render/grid/grid_extreme_batch_template.h"
