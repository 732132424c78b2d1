/* mesh_packet_wide.c - mesh_packet_template.h with vectors as wide as those of AVX-512, in plain C.
 */
#include "tests/support/mesh_packet_wide.h"

#include "tests/support/simd_wide.h"

#include "render/experiments/mesh_packet_template.h"
