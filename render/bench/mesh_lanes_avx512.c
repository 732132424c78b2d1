#define LANE_COUNTS
#define mesh_tile_avx512 mesh_lanes_avx512
#include "render/mesh/mesh_tile_template.h"
