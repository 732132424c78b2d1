/* rawfile.h - bare samples, described by hints, by a JSON or by the file's name.
 *
 * A name like bonsai_256x256x256_uint8.raw tells sizes and type. A JSON in the style of the Open
 * SciVis data sets,
 *
 *   {"name": "bonsai", "type": "uint8", "size": [256, 256, 256], "spacing": [1, 1, 1]}
 *
 * lies beside the samples (bonsai.json or bonsai_256x256x256_uint8.json), or is opened itself; it
 * then names them by "file", by the last part of "url", or by its own name (bonsai.json:
 * bonsai.raw). What a hint says goes before the JSON, which goes before the name. Understood beyond
 * that: "origin" [x,y,z], "endian" "big" or "little". Files may be packed by
 * gzip; bytes to skip are then unpacked ones.
 */
#ifndef FORMATS_GRID_RAWFILE_H
#define FORMATS_GRID_RAWFILE_H

#include <stdbool.h>

#include "formats/base/status.h"
#include "formats/grid/volume.h"
#include "formats/grid/volume_layout.h"

/* rawfile_open() - describe the samples of path, the file l->data (exchanged for the samples when
 * path is the JSON). Spacing and origin hints are not looked at. l->m and l->data are set; release
 * l in any case. ST_UNSUPPORTED when sizes or type stay unknown. */
CHECKED status rawfile_open(volume_layout *l, const char *path, const volume_hints *hints);

#endif
