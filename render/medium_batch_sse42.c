#include "render/medium_batch_template.h"
