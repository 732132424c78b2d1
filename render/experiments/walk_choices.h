/* walk_choices.h - other walks through grids, for experiments: the same pictures, slower.
 *
 * E1: other walks of single rays below blocks. E4: smaller packets of primary rays, without
 * grouping the ray-cells of several cells, by the best ISA.
 */
#ifndef RENDER_EXPERIMENTS_WALK_CHOICES_H
#define RENDER_EXPERIMENTS_WALK_CHOICES_H

#include "render/grid/walk_choice.h"
#include "render/leafcast.h"

/* walk_choice_named() - the choice of that name; NULL for no such name, for NULL, or if this CPU
 * has no tiles. */
const walk_choice *walk_choice_named(const char *name);

/* walk_choice_use() - let the rays of an open grid walk by this choice from now on; NULL: by the
 * product's own. Returns the choice before. */
const walk_choice *walk_choice_use(leafcast *v, const walk_choice *choice);

#endif
