#include "render/grid/grid_pieces_template.h"
