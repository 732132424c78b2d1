/* layout_slices.h - the slices of a volume_layout: samples that lie in order in one stream. */
#ifndef FORMATS_GRID_LAYOUT_SLICES_H
#define FORMATS_GRID_LAYOUT_SLICES_H

#include "formats/base/status.h"
#include "formats/grid/slice_source.h"
#include "formats/grid/volume_layout.h"

/* layout_slices_open() - l passes volume_layout_check(); its grid and its stream are taken over.
 * out->format is the caller's to set. ST_CORRUPT, ST_IO, ST_NOMEM: l is as before, to be released.
 */
CHECKED status layout_slices_open(volume_layout *l, slice_source *out);

#endif
