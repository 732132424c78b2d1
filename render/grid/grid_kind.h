/* grid_kind.h - the row of regular and rectilinear grids of voxels in the table of kinds. */
#ifndef RENDER_GRID_GRID_KIND_H
#define RENDER_GRID_GRID_KIND_H

#include "render/ray/kind.h"

extern const kind grid_kind;

#endif
