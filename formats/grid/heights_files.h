/* heights_files.h - files of elevations: Arc ASCII grids (.asc) and SRTM tiles (.hgt). Each is a
 * grid of one slice, rows from north to south, and says what stands for no data.
 *
 * .asc: "ncols", "nrows", "xllcorner" or "xllcenter", likewise y, "cellsize", and maybe
 * "NODATA_value", a word and a number a line, then the numbers, kept as f32. .hgt: square, i16,
 * most significant byte first, -32768 for no data; its name says the degrees of its south-west
 * corner (N47E006.hgt). Degrees are left as they are, beside metres of elevation.
 */
#ifndef FORMATS_GRID_HEIGHTS_FILES_H
#define FORMATS_GRID_HEIGHTS_FILES_H

#include "formats/grid/grid_reader.h"

extern const grid_reader heights_asc_reader, heights_hgt_reader;

#endif
