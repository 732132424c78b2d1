/* walk_choices.h - other walks through grids, for experiments: the same pictures, slower.
 *
 * E1: other walks of single rays below blocks. E4: smaller packets of primary rays, and no
 * ray-cells of several cells together, with the best ISA there is.
 */
#ifndef RENDER_EXPERIMENTS_WALK_CHOICES_H
#define RENDER_EXPERIMENTS_WALK_CHOICES_H

#include "render/grid/walk_choice.h"

/* walk_choice_named() - NULL where there is none such, or this CPU has no tiles; so is NULL. */
const walk_choice *walk_choice_named(const char *name);

#endif
