/* walk_choice.h - how rays walk a grid, where an experiment chooses (render/experiments). */
#ifndef RENDER_GRID_WALK_CHOICE_H
#define RENDER_GRID_WALK_CHOICE_H

#include "render/grid/walk.h"

typedef struct walk_choice {
    const char *name;
    walk_fn walk;   /* of single rays; NULL: tiles, */
    uint8_t packet; /* of so many pixels on a side that walk together, */
    bool by_cell;   /* which never hold ray-cells of more than one cell at a time */
} walk_choice;

#endif
