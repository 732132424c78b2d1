/* spheres_kind.h - the row of spheres for rays: single rays alone, without tiles and projection. */
#ifndef TESTS_SPHERES_SPHERES_KIND_H
#define TESTS_SPHERES_SPHERES_KIND_H

#include "render/ray/kind.h"

extern const kind spheres_kind;

#endif
