#include "render/tet_batch_template.h"
