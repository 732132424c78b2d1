/* grid_projection.h - the projection of all planes between a grid's cells. */
#ifndef RENDER_GRID_GRID_PROJECTION_H
#define RENDER_GRID_GRID_PROJECTION_H

#include "render/grid/level_planes.h"
#include "render/look/projection.h"

/* grid_projection_init() - projects the planes of all levels of a file, allocated from m.
 * grid_projection_bytes() - returns how many bytes that takes. */
CHECKED status grid_projection_init(projection *p, mem *m, const leaf_layout *layout,
                                    const level_planes levels[], const affine *space,
                                    const camera *c);
size_t grid_projection_bytes(const leaf_layout *layout);

#endif
