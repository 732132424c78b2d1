/* mixed_kind.h - the row of ray/kind.h for mixed meshes. */
#ifndef RENDER_MIXED_MIXED_KIND_H
#define RENDER_MIXED_MIXED_KIND_H

#include "render/ray/kind.h"

extern const kind mixed_kind;

#endif
