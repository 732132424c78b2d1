#include "render/tile_template.h"
