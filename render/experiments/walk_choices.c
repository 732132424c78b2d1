#include "render/experiments/walk_choices.h"

#include <string.h>

#include "render/grid/grid_tile.h"
#include "render/ray/open_volume.h"

static const walk_choice choices[] = {{"scalar-groups", walk_treelet_groups, 0, false},
                                      {"scalar-corners", walk_treelet_corners, 0, false},
                                      {"packets-4x4", NULL, 4, false},
                                      {"packets-8x8", NULL, 8, false},
                                      {"packets-16x16", NULL, 16, false},
                                      {"packets-4x4-by-cell", NULL, 4, true},
                                      {"tiles-by-cell", NULL, GRID_TILE, true}};

const walk_choice *walk_choice_named(const char *name) {
    for (size_t i = 0; name && i < sizeof choices / sizeof *choices; i++)
        if (strcmp(name, choices[i].name) == 0)
            return choices[i].walk || grid_tile_kernels[cpu_best()] ? &choices[i] : NULL;
    return NULL;
}

const walk_choice *walk_choice_use(leafcast *v, const walk_choice *choice) {
    const walk_choice *before = v->choice;
    v->choice = choice;
    return before;
}
