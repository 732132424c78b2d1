/* plot3d.h - curvilinear grids of PLOT3D: a grid, and a solution or functions in files of their
 * own.
 *
 * One or several zones, with or without IBLANK; C binary or Fortran's unformatted records, either
 * byte order, f32 or f64, or text, whole or by planes (plot3d_layout.h). IBLANK of 0: no node;
 * negative ones touch another zone, and are nodes. Numbers are read where they lie: buffers of
 * fixed size, and marks of text (plot3d_text.h). Records above 2^31 - 9 bytes are not read. A value
 * beyond floats becomes inf; a field that is computed (plot3d_flow.h) is NaN where it is not
 * finite.
 */
#ifndef FORMATS_CURVILINEAR_PLOT3D_H
#define FORMATS_CURVILINEAR_PLOT3D_H

#include "formats/curvilinear/curvilinear_reader.h"

extern const curvilinear_reader plot3d_reader;

#endif
