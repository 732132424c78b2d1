#include "render/curvilinear/curvilinear_tile_template.h"
