/* walk_choices.h - other walks through grids, for experiments: the same pictures, slower.
 *
 * E1: other walks of single rays below blocks. E4: smaller packets of primary rays, without
 * grouping the ray-cells of several cells, by the best ISA.
 */
#ifndef RENDER_EXPERIMENTS_WALK_CHOICES_H
#define RENDER_EXPERIMENTS_WALK_CHOICES_H

#include "render/grid/walk_choice.h"

/* walk_choice_named() - the choice of that name; NULL for no such name, for NULL, or if this CPU
 * has no tiles. */
const walk_choice *walk_choice_named(const char *name);

#endif
