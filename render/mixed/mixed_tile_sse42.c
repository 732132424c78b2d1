#include "render/mixed/mixed_tile_template.h"
