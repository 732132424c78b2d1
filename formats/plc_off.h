/* plc_off.h - Geomview's OFF, in text: vertices, then polygons.
 *
 * The colours of COFF and the normals of NOFF are passed over, as are those of faces. Binary OFF
 * and other dimensions are ST_UNSUPPORTED.
 */
#ifndef FORMATS_PLC_OFF_H
#define FORMATS_PLC_OFF_H

#include "formats/plc.h"

CHECKED status plc_off_read(plc_source *s);

#endif
