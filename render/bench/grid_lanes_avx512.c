#define LANE_COUNTS
#define grid_tile_trace_avx512 grid_lanes_avx512
#include "render/grid/grid_tile_template.h"
