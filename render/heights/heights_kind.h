/* heights_kind.h - the row of height fields: terrain (render/ray/kind.h). */
#ifndef RENDER_HEIGHTS_HEIGHTS_KIND_H
#define RENDER_HEIGHTS_HEIGHTS_KIND_H

#include "render/ray/kind.h"

extern const kind heights_kind;

#endif
