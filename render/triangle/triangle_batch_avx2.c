#include "render/triangle/triangle_batch_template.h"
