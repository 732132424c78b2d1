/* level_planes.h - the planes between cells, level by level, in grid space.
 *
 * Node i of level l lies on node i << l of level 0; past the volume's end the last spacing goes on,
 * so that every treelet has all its planes.
 */
#ifndef RENDER_GRID_LEVEL_PLANES_H
#define RENDER_GRID_LEVEL_PLANES_H

#include "formats/leaf/leaf_file.h"

/* Where a level's nodes and cells lie, in grid space. Coarse levels reach past the volume's end. */
typedef struct level_planes {
    const double *at[3];      /* coordinate of the level's plane i; enough for whole treelets */
    const double *inverse[3]; /* 1 / (at[i + 1] - at[i]) */
    const double *central[3]; /* 1 / (at[i + 1] - at[i - 1]), one-sided at the level's ends */
    uint32_t cells[3];
} level_planes;

typedef struct level_planes_table {
    level_planes levels[LEAF_LEVELS_MAX];
    double *block; /* all coordinates and inverse widths */
    mem *m;
} level_planes_table;

/* level_planes_init() - makes the planes of every level of a file, allocated from m. */
CHECKED status level_planes_init(level_planes_table *table, mem *m, const leaf_file *f);
void level_planes_release(level_planes_table *table);

#endif
