#define LANE_COUNTS
#define mesh_tile_sse42 mesh_lanes_sse42
#include "render/mesh/mesh_tile_template.h"
