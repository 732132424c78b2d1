/* mixed_tile_wide.c - mixed_tile_template.h with vectors as wide as those of AVX-512, in plain C.
 */
#include "tests/support/mixed_tile_wide.h"

#include "tests/support/simd_wide.h"

#include "render/mixed/mixed_tile_template.h"
