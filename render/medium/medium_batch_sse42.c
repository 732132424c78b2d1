#include "render/medium/medium_batch_template.h"
