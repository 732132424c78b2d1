/* tile_wide.c - tile_template.h with vectors as wide as those of AVX-512, in plain C. */
#include "tests/support/tile_wide.h"

#include "tests/support/simd_wide.h"

#include "render/tile_template.h"
