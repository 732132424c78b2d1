#define LANE_COUNTS
#define mesh_tile_avx2 mesh_lanes_avx2
#include "render/mesh/mesh_tile_template.h"
