/* heights_slices.h - a field of elevations as slices: a grid of one slice, turned over.
 *
 * A height field is kept as a grid with one layer of cells across its second axis, whose nodes have
 * the same samples on both sides: node (i, 0, j) and node (i, 1, j) are elevation (i, j). So a row
 * of elevations is a slice, and all that reads, cuts, codes and checks grids row by row serves
 * terrain of any size (formats/HEIGHTS.md). In grid space the second axis is the elevation.
 */
#ifndef FORMATS_GRID_HEIGHTS_SLICES_H
#define FORMATS_GRID_HEIGHTS_SLICES_H

#include "formats/grid/slice_source.h"
#include "formats/grid/volume_layout.h"

/* heights_layout() - let the rows of a layout's one slice be its slices, so that they are read one
 * by one. Nothing happens if it has several. */
void heights_layout(volume_layout *l);

/* heights_slices() - put a source of one slice, or of rows by heights_layout(), behind one of a
 * height field's slices. A source of one slice is held in memory. ST_USAGE: it has several slices;
 * ST_UNSUPPORTED: uneven spacings. On failure *s is as before. */
CHECKED status heights_slices(slice_source *s);

#endif
