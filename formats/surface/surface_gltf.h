/* surface_gltf.h - the readers of glTF 2.0, binary (.glb), and as JSON with files of bytes beside
 * it
 * (.gltf): see gltf_file.h.
 *
 * Positions are placed in double. COLOR_0, which is linear, becomes the field "rgb" in sRGB bytes;
 * where one part has it, others are white. Arrays are read at their places, so the file must be
 * regular.
 */
#ifndef FORMATS_SURFACE_SURFACE_GLTF_H
#define FORMATS_SURFACE_SURFACE_GLTF_H

#include "formats/mesh/mesh_reader.h"

extern const mesh_reader surface_glb_reader, surface_gltf_reader;

#endif
