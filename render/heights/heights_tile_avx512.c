#include "render/heights/heights_tile_template.h"
