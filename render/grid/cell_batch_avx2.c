#include "render/grid/cell_batch_template.h"
