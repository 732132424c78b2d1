/* plc_off.h - Geomview's OFF, in text: vertices, then polygons.
 *
 * The colours of COFF, the normals of NOFF and the colours of faces are skipped. Binary OFF and
 * other dimensions are ST_UNSUPPORTED.
 */
#ifndef FORMATS_SURFACE_PLC_OFF_H
#define FORMATS_SURFACE_PLC_OFF_H

#include "formats/surface/plc.h"

CHECKED status plc_off_read(plc_source *s);

#endif
