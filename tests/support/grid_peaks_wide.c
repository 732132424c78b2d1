/* grid_peaks_wide.c - grid_peaks_template.h with vectors as wide as those of AVX-512, in plain C.
 */
#include "tests/support/grid_peaks_wide.h"

#include "tests/support/simd_wide.h"

#include "render/grid/grid_peaks_template.h"
