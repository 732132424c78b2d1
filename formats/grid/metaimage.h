/* metaimage.h - the headers of MetaImage files: .mhd with a data file, .mha with the samples behind
 * the header.
 *
 * Format: https://itk.org/Wiki/MetaIO/Documentation. Understood: one channel; three axes, or four
 * of which the last has one sample; 8 to 32 bit integers, float, double; either byte order; raw,
 * zlib (or gzip) and text; ElementSpacing (or ElementSize), Offset (or Position, Origin),
 * TransformMatrix (or Orientation, Rotation); HeaderSize, also -1. Refused with ST_UNSUPPORTED:
 * 64-bit integers, several channels, several data files.
 */
#ifndef FORMATS_GRID_METAIMAGE_H
#define FORMATS_GRID_METAIMAGE_H

#include "formats/grid/grid_reader.h"

extern const grid_reader metaimage_reader;

#endif
