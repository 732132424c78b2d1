/* slc.h - SLC volumes of VolVis, as VTK's vtkSLCReader reads them, too.
 *
 * A head of text, numbers between blanks: 11111; width, height, depth; bits a voxel; three sizes of
 * a voxel; a unit, where the data comes from, what was done to it; 0 or 1 for how it is packed;
 * width and height of an icon. Behind an X the icon follows, three planes of bytes, then the
 * slices, a byte a voxel. Packed ones have each its number of bytes, as text, and an X in front,
 * then runs: a control byte c, of which the low 7 bits are a number n, 0 for the slice's end; with
 * the high bit n bytes follow, without it one, which comes n times. What the unit's number means is
 * not written down anywhere; lengths have no unit here.
 */
#ifndef FORMATS_GRID_SLC_H
#define FORMATS_GRID_SLC_H

#include "formats/grid/grid_reader.h"

extern const grid_reader slc_reader;

#endif
