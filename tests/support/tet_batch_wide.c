/* tet_batch_wide.c - tet_batch_template.h with vectors as wide as those of AVX-512, in plain C. */
#include "tests/support/tet_batch_wide.h"

#include "tests/support/simd_wide.h"

#include "render/mesh/tet_batch_template.h"
