/* vtk_grid.h - what stands around the samples in VTK's XML files of grids: .vti and .vtr, raw
 * appended data, 64-bit sizes.
 */
#ifndef PREP_EXPORT_VTK_GRID_H
#define PREP_EXPORT_VTK_GRID_H

#include "formats/base/out_stream.h"
#include "formats/grid/grid.h"

/* vtk_image_check() - ST_UNSUPPORTED for rectilinear grids: those are vtk_axes_check()'s, which
 * refuses grids that are turned against the axes. */
CHECKED status vtk_image_check(const grid *g);
CHECKED status vtk_axes_check(const grid *g);

/* vtk_image_head(), vtk_axes_head() - all before the first sample. A nameless grid's array is
 * called "value". vtk_grid_tail() - all behind the last one. */
CHECKED status vtk_image_head(mem *m, out_stream *out, const grid *g);
CHECKED status vtk_axes_head(mem *m, out_stream *out, const grid *g);
CHECKED status vtk_grid_tail(out_stream *out);

#endif
