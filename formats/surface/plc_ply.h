/* plc_ply.h - PLY, in text or binary of either byte order: vertices with properties, and faces.
 *
 * A field is any scalar property of the vertices but x, y, z. Unknown elements and properties are
 * skipped. Triangle strips are ST_UNSUPPORTED.
 */
#ifndef FORMATS_SURFACE_PLC_PLY_H
#define FORMATS_SURFACE_PLC_PLY_H

#include "formats/surface/plc.h"

CHECKED status plc_ply_read(plc_source *s);

#endif
