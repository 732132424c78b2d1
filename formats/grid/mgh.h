/* mgh.h - FreeSurfer's volumes: .mgh, and .mgz, which is the same packed by gzip.
 *
 * Format: https://surfer.nmr.mgh.harvard.edu/fswiki/FsTutorial/MghFormat. Understood: version 1,
 * big endian; 8, 16 and 32 bit integers, float; frames as steps; the place of the centre and the
 * directions, or FreeSurfer's defaults if the file has none. Times stand behind the samples, and
 * are not read. Refused with ST_UNSUPPORTED: tensors and bitmaps.
 */
#ifndef FORMATS_GRID_MGH_H
#define FORMATS_GRID_MGH_H

#include "formats/grid/grid_reader.h"

extern const grid_reader mgh_reader;

#endif
