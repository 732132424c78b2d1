/* surface_off.h - Geomview's OFF in text as a stream of triangles: vertices, then polygons.
 *
 * The first word may be OFF with ST, C and N before it, in that order. Colours of COFF are the
 * field "rgb": whole numbers of 0 .. 255, or with a point in one of them of 0 .. 1. Normals,
 * texture coordinates and the colours of faces are skipped. Binary OFF and other dimensions are
 * ST_UNSUPPORTED.
 */
#ifndef FORMATS_SURFACE_SURFACE_OFF_H
#define FORMATS_SURFACE_SURFACE_OFF_H

#include "formats/mesh/mesh_reader.h"

extern const mesh_reader surface_off_reader;

#endif
