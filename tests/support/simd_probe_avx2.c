#include "tests/support/simd_probe_template.h"
