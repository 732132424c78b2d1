/* curvilinear_tile_wide.c - curvilinear_tile_template.h with vectors as wide as those of AVX-512,
 * in plain C. */
#include "tests/support/curvilinear_tile_wide.h"

#include "tests/support/simd_wide.h"

#include "render/curvilinear/curvilinear_tile_template.h"
