#include "render/mesh_tile_template.h"
