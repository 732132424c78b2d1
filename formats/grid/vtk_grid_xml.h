/* vtk_grid_xml.h - VTK XML files of grids: image data (.vti), rectilinear grids (.vtr), structured
 * grids whose points make one of these (.vts), and all of them in pieces, a file each (.pvti,
 * .pvtr, .pvts).
 *
 * Arrays as text, in base64, or appended (raw or in base64), plain or in blocks of zlib, LZ4 or
 * LZMA; either byte order; points and cells; pieces in one file or in several, which may overlap.
 * Only regular files: they are read at several places at once.
 */
#ifndef FORMATS_GRID_VTK_GRID_XML_H
#define FORMATS_GRID_VTK_GRID_XML_H

#include "formats/grid/grid_reader.h"
#include "formats/vtk/vtk_parts.h"

extern const grid_reader vtk_grid_xml_reader;

/* vtk_grid_xml_open() - open the file of a collection, as the reader would. parts: moved to the
 * grid in any case; the hints' step has been applied. */
CHECKED status vtk_grid_xml_open(volume_layout *l, const volume_hints *hints, vtk_parts *parts,
                                 slice_source *out);

#endif
