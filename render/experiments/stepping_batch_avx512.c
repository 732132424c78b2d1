#include "render/experiments/stepping_batch_template.h"
