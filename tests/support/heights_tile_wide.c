/* heights_tile_wide.c - heights_tile_template.h with vectors as wide as those of AVX-512, in plain
 * C. */
#include "tests/support/heights_tile_wide.h"

#include "tests/support/simd_wide.h"

#include "render/heights/heights_tile_template.h"
