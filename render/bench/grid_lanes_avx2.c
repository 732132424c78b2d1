#define LANE_COUNTS
#define grid_tile_trace_avx2 grid_lanes_avx2
#include "render/grid/grid_tile_template.h"
