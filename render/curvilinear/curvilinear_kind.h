/* curvilinear_kind.h - the row of curvilinear grids in the table of kinds (kind.h). */
#ifndef RENDER_CURVILINEAR_CURVILINEAR_KIND_H
#define RENDER_CURVILINEAR_CURVILINEAR_KIND_H

#include "render/ray/kind.h"

extern const kind curvilinear_kind;

#endif
