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

#include "formats/grid/grid_reader.h"

/* Knows any file: the last row. Of hints, spacing and origin are not looked at. ST_UNSUPPORTED when
 * sizes or type stay unknown: what the file is, where that can be told. */
extern const grid_reader raw_reader;

#endif
