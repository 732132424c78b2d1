#include "render/kernels.h"

#include <string.h>

/* The last two are experiment E1's alternatives: the same pictures, slower. */
static const kernels table[] = {{"scalar", walk_treelet},
                                {"scalar-groups", walk_treelet_groups},
                                {"scalar-corners", walk_treelet_corners}};

const kernels *kernels_for(const char *isa) {
    if (!isa || !strcmp(isa, "auto"))
        return &table[0];
    for (size_t i = 0; i < sizeof table / sizeof *table; i++)
        if (!strcmp(isa, table[i].isa))
            return &table[i];
    return NULL;
}
