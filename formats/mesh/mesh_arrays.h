/* mesh_arrays.h - a mesh that lies in memory, for mesh_input_open_arrays(). */
#ifndef FORMATS_MESH_MESH_ARRAYS_H
#define FORMATS_MESH_MESH_ARRAYS_H

#include "formats/mesh/mesh_input.h"
#include "formats/mesh/mesh_reader.h"

/* mesh_arrays_state() - make the state of mesh_arrays_reader for a mesh in memory. */
CHECKED status mesh_arrays_state(mem *m, const mesh_arrays *a, void **state);

/* The reader, for mesh_input.c. It has no known(): no file is recognised as arrays. */
extern const mesh_reader mesh_arrays_reader;

#endif
