/* moving_arguments.h - checks of what callers of leafcast_dynamic.h pass: a part of arguments.h. */
#ifndef RENDER_DOOR_MOVING_ARGUMENTS_H
#define RENDER_DOOR_MOVING_ARGUMENTS_H

#include "formats/public_fields.h"
#include "render/leafcast_dynamic.h"

extern const public_fields moving_arguments_table;

/* moving_arguments_check() - but for the positions, which are checked where they are copied. */
CHECKED status moving_arguments_check(const leafcast_triangles *triangles);

#endif
