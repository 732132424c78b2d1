/* metaimage.h - the headers of MetaImage files: .mhd with a data file, .mha with the samples behind
 * the header.
 *
 * Format: https://itk.org/Wiki/MetaIO/Documentation. Understood: three axes, or a fourth with steps
 * of time; channels (three or four of bytes are a colour); 8 to 64 bit integers, float, double;
 * either byte order; raw, zlib (or gzip) and text; ElementSpacing (or ElementSize), Offset (or
 * Position, Origin), TransformMatrix (or Orientation, Rotation); HeaderSize, also -1; several data
 * files (volume_files.h), but not of text.
 */
#ifndef FORMATS_GRID_METAIMAGE_H
#define FORMATS_GRID_METAIMAGE_H

#include "formats/grid/grid_reader.h"

extern const grid_reader metaimage_reader;

#endif
