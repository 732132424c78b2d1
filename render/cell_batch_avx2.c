#include "render/cell_batch_template.h"
