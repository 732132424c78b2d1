#include "render/mesh/tet_batch_template.h"
