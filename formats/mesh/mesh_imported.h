/* mesh_imported.h - meshes that a verb import-X reads: its mesh stream, through a pipe.
 */
#ifndef FORMATS_MESH_MESH_IMPORTED_H
#define FORMATS_MESH_MESH_IMPORTED_H

#include "formats/mesh/mesh_reader.h"

extern const mesh_reader mesh_imported_reader;

#endif
