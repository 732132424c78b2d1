#include "render/kernels.h"

#include <string.h>

/* Experiment E1: the same pictures, slower. */
static const struct {
    const char *name;
    walk_fn walk;
} alternatives[] = {{"scalar-groups", walk_treelet_groups},
                    {"scalar-corners", walk_treelet_corners}};

bool kernels_for(const char *name, kernels *out) {
    cpu_isa isa;
    for (size_t i = 0; name && i < sizeof alternatives / sizeof *alternatives; i++) {
        if (!strcmp(name, alternatives[i].name)) {
            *out = (kernels){alternatives[i].name, CPU_SCALAR, alternatives[i].walk,
                             cell_batch_for(CPU_SCALAR), NULL};
            return true;
        }
    }
    if (!cpu_isa_find(name, &isa))
        return false;
    *out = (kernels){cpu_isa_name(isa), isa, walk_treelet, cell_batch_for(isa), tile_for(isa)};
    return true;
}
