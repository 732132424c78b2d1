/* tiff_head.h - what stands before the samples in a TIFF: all its pages, one a slice, without
 * compression, a strip each; BigTIFF where 4 GiB would not hold them.
 *
 * So the samples follow as one block, slice by slice. The first page has a description in OME-XML:
 * the spacing, and as an annotation of leafcast's own the map to the world, which import-images
 * reads. The tags of resolution have the spacing, too, as close as they can.
 */
#ifndef PREP_EXPORT_TIFF_HEAD_H
#define PREP_EXPORT_TIFF_HEAD_H

#include "formats/base/out_stream.h"
#include "formats/grid/grid.h"

/* tiff_head_check() - ST_UNSUPPORTED for rectilinear grids. */
CHECKED status tiff_head_check(const grid *g);

/* tiff_head_loses() - what is told where the grid is turned or lies elsewhere than at 0; or NULL.
 */
const char *tiff_head_loses(const grid *g);

/* tiff_head() - all before the first sample; dims[2] pages, 1 is possible. */
CHECKED status tiff_head(mem *m, out_stream *out, const grid *g);

#endif
