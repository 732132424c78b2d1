/* layout_slices.h - makes slices from a volume_layout: samples that lie in order in one stream. */
#ifndef FORMATS_GRID_LAYOUT_SLICES_H
#define FORMATS_GRID_LAYOUT_SLICES_H

#include "formats/base/status.h"
#include "formats/grid/slice_source.h"
#include "formats/grid/volume_layout.h"

/* layout_slices_open() - open a layout that passes volume_layout_check(). Takes over its grid and
 * stream. The caller sets out->format. On ST_CORRUPT, ST_IO or ST_NOMEM, l is as before, to be
 * released. */
CHECKED status layout_slices_open(volume_layout *l, slice_source *out);

#endif
