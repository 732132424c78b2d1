#include "render/triangle/triangle_tile_template.h"
