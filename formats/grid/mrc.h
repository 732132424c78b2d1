/* mrc.h - MRC and CCP4 maps: .mrc, .map, .rec, .st.
 *
 * Format: https://www.ccpem.ac.uk/mrc_format/mrc2014.php. Understood: modes 0 (also of IMOD,
 * unsigned), 1, 2, 6 and 12; either byte order; an extended header, which is skipped; cells with
 * any angles; axes in any order (samples stay in the file's order, and the world's axes follow it);
 * the origin, or the start where there is none; stacks of volumes as steps. Refused with
 * ST_UNSUPPORTED: complex and 4-bit numbers, files without "MAP".
 */
#ifndef FORMATS_GRID_MRC_H
#define FORMATS_GRID_MRC_H

#include "formats/grid/grid_reader.h"

extern const grid_reader mrc_reader;

#endif
