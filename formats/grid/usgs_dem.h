/* usgs_dem.h - digital elevation models of the U.S. Geological Survey (.dem, of text).
 *
 * Source: USGS, Standards for Digital Elevation Models, part 2 (1998). Records of 1024 bytes, maybe
 * with line ends behind them: one of type A with the place, then profiles (type B), columns of
 * elevations from south to north, each with a first node of its own. Nodes that no profile has, and
 * elevations of -32767, have no data. Becomes one slice of f32, rows from north to south, of
 * elevations in their unit. Arc-seconds become degrees, metres and feet stay.
 */
#ifndef FORMATS_GRID_USGS_DEM_H
#define FORMATS_GRID_USGS_DEM_H

#include "formats/grid/grid_reader.h"

extern const grid_reader usgs_dem_reader;

#endif
