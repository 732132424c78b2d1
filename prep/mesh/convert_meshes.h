/* convert_meshes.h - meshes as inputs of convert: a row of convert_main.c. */
#ifndef PREP_MESH_CONVERT_MESHES_H
#define PREP_MESH_CONVERT_MESHES_H

#include "prep/convert_kind.h"

extern const convert_kind convert_meshes;

#endif
