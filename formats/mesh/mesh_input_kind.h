/* mesh_input_kind.h - meshes as inputs: the row of input_open.c for all that mesh_input.h reads. */
#ifndef FORMATS_MESH_MESH_INPUT_KIND_H
#define FORMATS_MESH_MESH_INPUT_KIND_H

#include "formats/input_kind.h"

extern const input_kind mesh_input_kind; /* its own: a mesh_input */

#endif
