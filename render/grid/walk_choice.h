/* walk_choice.h - how rays walk a grid, where an experiment chooses (render/experiments). */
#ifndef RENDER_GRID_WALK_CHOICE_H
#define RENDER_GRID_WALK_CHOICE_H

#include "render/grid/walk.h"

typedef struct walk_choice {
    const char *name;
    walk_fn walk;   /* all rays walk one by one, by this; NULL: by the kind's kernels */
    uint8_t packet; /* side, in pixels, of the squares of a tile that walk together; 0: GRID_TILE */
    bool by_cell;   /* a batch never holds ray-cells of more than one cell */
} walk_choice;

#endif
