/* rawfile.h - bare samples, described by hints, by a JSON file or by the file's name.
 *
 * A name like bonsai_256x256x256_uint8.raw gives sizes and type. A JSON file in the style of the
 * Open SciVis data sets,
 *
 *   {"name": "bonsai", "type": "uint8", "size": [256, 256, 256], "spacing": [1, 1, 1]}
 *
 * lies beside the samples (bonsai.json or bonsai_256x256x256_uint8.json), or is opened itself; it
 * then names them by "file", by the last part of "url", or by its own name (bonsai.json:
 * bonsai.raw). Hints override the JSON, which overrides the name. Understood beyond that: "origin"
 * [x,y,z], "endian" "big" or "little". Files may be packed by
 * gzip; bytes to skip then count in the unpacked data.
 */
#ifndef FORMATS_GRID_RAWFILE_H
#define FORMATS_GRID_RAWFILE_H

#include "formats/grid/grid_reader.h"

/* Recognises any file, so it is the last row. Ignores the hints' spacing and origin. ST_UNSUPPORTED
 * when sizes or type stay unknown, naming the file's format if it is recognised. */
extern const grid_reader raw_reader;

#endif
