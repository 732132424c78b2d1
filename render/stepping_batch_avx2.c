#include "render/stepping_batch_template.h"
