/* bench_hex_grid.h - a curvilinear grid's treelet file as a lattice in memory (hex_lattice.h), for
 * the suite `hexes`. */
#ifndef RENDER_BENCH_BENCH_HEX_GRID_H
#define RENDER_BENCH_BENCH_HEX_GRID_H

#include "render/experiments/hex_lattice.h"

/* bench_hex_grid_load() - the first field at the first step. On failure, too, free the lattice.
 * ST_USAGE: the file has no curvilinear grid. */
CHECKED status bench_hex_grid_load(hex_lattice *l, mem *m, const char *path);

#endif
