/* mesh_batch_wide.c - mesh_batch_template.h with vectors as wide as those of AVX-512, in plain C.
 */
#include "tests/support/mesh_batch_wide.h"

#include "tests/support/simd_wide.h"

#include "render/mesh/mesh_batch_template.h"
