/* plc_stl.h - STL, in text or binary: triangles, each with corners of its own, which plc_clean.h
 * welds.
 *
 * Normals and attributes are skipped. A binary file is recognised by its length, or by bytes that
 * are no text.
 */
#ifndef FORMATS_SURFACE_PLC_STL_H
#define FORMATS_SURFACE_PLC_STL_H

#include "formats/surface/plc.h"

CHECKED status plc_stl_read(plc_source *s);

#endif
