#include "render/mesh/mesh_tile_template.h"
