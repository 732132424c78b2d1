#include "render/mesh/mesh_batch_template.h"
