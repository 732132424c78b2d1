/* nrrd.h - the headers of NRRD files, versions 1 to 5, attached and detached.
 *
 * Format: http://teem.sourceforge.net/nrrd/format.html. Understood: raw, gzip, bzip2 and text
 * encodings; either byte order; 8 to 64 bit integers, float, double; spacings, axis mins and maxs
 * (with their centring), space origin, any invertible space directions; line skip, byte skip (also
 * -1); a data file named relative to the header, or several (volume_files.h). Refused with
 * ST_UNSUPPORTED: blocks, hex.
 *
 * There are three axes, or four. A fourth axis, first or last, may hold the numbers of a sample, by
 * its kind (without kinds: a first axis of up to 4). A last one may hold time steps; its spacing,
 * axis min and unit then give their times.
 *
 * NRRD has no rectilinear axes. They are key/value pairs of ours: "leafcast axis 0:=0 1 2.5 4 ...",
 * scaled by the spacing, or the space direction, of that axis.
 */
#ifndef FORMATS_GRID_NRRD_H
#define FORMATS_GRID_NRRD_H

#include "formats/grid/grid_reader.h"

extern const grid_reader nrrd_reader;

#endif
