/* nrrd.h - the headers of NRRD files, versions 1 to 5, attached and detached.
 *
 * Format: http://teem.sourceforge.net/nrrd/format.html. Understood: raw, gzip, bzip2 and text
 * encodings; either byte order; 8 to 64 bit integers, float, double; three axes, or a fourth, first
 * or last, with the numbers of a sample, as its kind says (without any: a first one of up to 4), or
 * last, with steps of time, whose spacing, axis min and unit are their times; spacings, axis mins
 * and maxs (with their centring), space origin, any invertible space directions; line skip, byte
 * skip (also -1); a data file named relative to the header. Refused with ST_UNSUPPORTED: blocks,
 * hex and bzip2, lists of files. Rectilinear axes, which NRRD does not know, are key/value pairs of
 * ours: "leafcast axis 0:=0 1 2.5 4 ..."; they are scaled by the spacing, or the space direction,
 * of that axis.
 */
#ifndef FORMATS_GRID_NRRD_H
#define FORMATS_GRID_NRRD_H

#include "formats/grid/grid_reader.h"

extern const grid_reader nrrd_reader;

#endif
