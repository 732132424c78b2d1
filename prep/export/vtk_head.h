/* vtk_head.h - what stands around the samples in VTK's XML files of grids: .vti and .vtr, raw
 * appended data, 64-bit sizes.
 */
#ifndef PREP_EXPORT_VTK_HEAD_H
#define PREP_EXPORT_VTK_HEAD_H

#include "formats/base/out_stream.h"
#include "formats/grid/grid.h"

/* vtk_head_image_check() - ST_UNSUPPORTED for rectilinear grids: those are vtk_head_axes_check()'s,
 * which refuses grids that are turned against the axes. */
CHECKED status vtk_head_image_check(const grid *g);
CHECKED status vtk_head_axes_check(const grid *g);

/* vtk_head_image(), vtk_head_axes() - all before the first sample. A nameless grid's array is
 * called "value". vtk_head_tail() - all behind the last one. */
CHECKED status vtk_head_image(mem *m, out_stream *out, const grid *g);
CHECKED status vtk_head_axes(mem *m, out_stream *out, const grid *g);
CHECKED status vtk_head_tail(out_stream *out);

#endif
