/* grid_pieces_wide.c - grid_pieces_template.h with vectors as wide as those of AVX-512, in plain C.
 */
#include "tests/support/grid_pieces_wide.h"

#include "tests/support/simd_wide.h"

#include "render/grid/grid_pieces_template.h"
