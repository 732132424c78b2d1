#include "render/grid/grid_tile_template.h"
