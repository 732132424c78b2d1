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

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "formats/base/status.h"
#include "formats/grid/volume_layout.h"

/* metaimage_known() - whether a file of this name that starts with these bytes is a MetaImage. */
bool metaimage_known(const char *path, const uint8_t *start, size_t size);

/* metaimage_open() - read the header in l->data, which is exchanged for a data file of its own.
 * l->m and l->data are set; release l in any case. */
CHECKED status metaimage_open(volume_layout *l);

#endif
