/* medium_batch_wide.c - medium_batch_template.h with vectors as wide as those of AVX-512, in plain
 * C.
 */
#include "tests/support/medium_batch_wide.h"

#include "tests/support/simd_wide.h"

#include "render/medium/medium_batch_template.h"
