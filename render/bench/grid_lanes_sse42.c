#define LANE_COUNTS
#define grid_tile_trace_sse42 grid_lanes_sse42
#include "render/grid/grid_tile_template.h"
