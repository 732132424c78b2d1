/* vtk_head.h - head and tail of VTK's XML files of grids: .vti and .vtr, raw appended data, 64-bit
 * sizes.
 */
#ifndef PREP_EXPORT_VTK_HEAD_H
#define PREP_EXPORT_VTK_HEAD_H

#include "formats/base/out_stream.h"
#include "formats/grid/grid.h"

/* vtk_head_image_check() - ST_UNSUPPORTED for rectilinear grids. vtk_head_axes_check() - for .vtr:
 * ST_UNSUPPORTED for grids that are turned against the axes. */
CHECKED status vtk_head_image_check(const grid *g);
CHECKED status vtk_head_axes_check(const grid *g);

/* vtk_head_image(), vtk_head_axes() - write all bytes before the first sample. The array of a grid
 * without a name is "value". vtk_head_tail() - write all bytes behind the last sample. */
CHECKED status vtk_head_image(mem *m, out_stream *out, const grid *g);
CHECKED status vtk_head_axes(mem *m, out_stream *out, const grid *g);
CHECKED status vtk_head_tail(out_stream *out);

#endif
