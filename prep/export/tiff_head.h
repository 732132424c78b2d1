/* tiff_head.h - everything before the samples of a TIFF: its pages, one per slice, each one strip
 * without compression. BigTIFF is used if 4 GiB would not do.
 *
 * So the samples follow as one block, slice by slice. The first page has a description in OME-XML.
 * That holds the spacing and, as an annotation of leafcast's own, the map to the world, which
 * import-images reads. The resolution tags hold the spacing, too, as close as they can.
 */
#ifndef PREP_EXPORT_TIFF_HEAD_H
#define PREP_EXPORT_TIFF_HEAD_H

#include "formats/base/out_stream.h"
#include "formats/grid/grid.h"

/* tiff_head_check() - ST_UNSUPPORTED for rectilinear grids. */
CHECKED status tiff_head_check(const grid *g);

/* tiff_head_loses() - a note if the grid is turned or does not begin at 0; else NULL.
 */
const char *tiff_head_loses(const grid *g);

/* tiff_head() - write all bytes before the first sample: dims[2] pages, 1 is possible. */
CHECKED status tiff_head(mem *m, out_stream *out, const grid *g);

#endif
