/* slc.h - SLC volumes of VolVis, which VTK's vtkSLCReader reads, too.
 *
 * A head of text, numbers between blanks: 11111; width, height, depth; bits a voxel; three sizes of
 * a voxel; a unit, where the data comes from, what was done to it; 0 or 1 for how it is packed;
 * width and height of an icon. Behind an X the icon follows, three planes of bytes, then the
 * slices, a byte a voxel. A packed slice begins with its number of bytes, as text, and an X. Runs
 * follow: a control byte c whose low 7 bits are a number n, 0 for the slice's end. With c's high
 * bit set n bytes follow; else one byte, which is repeated n times. The meaning of the unit's
 * number is not documented anywhere, so lengths have no unit here.
 */
#ifndef FORMATS_GRID_SLC_H
#define FORMATS_GRID_SLC_H

#include "formats/grid/grid_reader.h"

extern const grid_reader slc_reader;

#endif
