/* triangle_batch_wide.c - triangle_batch_template.h with vectors as wide as those of AVX-512, in
 * plain C.
 */
#include "tests/support/triangle_batch_wide.h"

#include "tests/support/simd_wide.h"

#include "render/triangle/triangle_batch_template.h"
