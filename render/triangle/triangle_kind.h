/* triangle_kind.h - surfaces of triangles as a kind of geometry (ray/kind.h). */
#ifndef RENDER_TRIANGLE_TRIANGLE_KIND_H
#define RENDER_TRIANGLE_TRIANGLE_KIND_H

#include "render/ray/kind.h"

extern const kind triangle_kind;

#endif
