#include "render/grid/grid_extreme_batch_template.h"
