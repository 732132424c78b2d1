/* cell_batch_wide.c - cell_batch_template.h with vectors as wide as those of AVX-512, in plain C.
 */
#include "tests/support/cell_batch_wide.h"

#include "tests/support/simd_wide.h"

#include "render/grid/cell_batch_template.h"
