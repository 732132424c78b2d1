#include "render/kernels.h"

#include <string.h>

static const kernels scalar = {"scalar", walk_treelet};

const kernels *kernels_for(const char *isa)
{
    return !strcmp(isa, "auto") || !strcmp(isa, "scalar") ? &scalar : NULL;
}
