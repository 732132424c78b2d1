/* surface_input_kind.h - surfaces of triangles as a kind of inputs: a row of input_open.c; its
 * `own' is a mesh_input. */
#ifndef FORMATS_SURFACE_SURFACE_INPUT_KIND_H
#define FORMATS_SURFACE_SURFACE_INPUT_KIND_H

#include "formats/input_kind.h"

extern const input_kind surface_input_kind;

#endif
