#include "render/grid/grid_batch_template.h"
