/* mesh_kind.h - the row of tetrahedral meshes in the table of kinds. */
#ifndef RENDER_MESH_MESH_KIND_H
#define RENDER_MESH_MESH_KIND_H

#include "render/ray/kind.h"

extern const kind mesh_kind;

#endif
