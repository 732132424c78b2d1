/* vtk_grid_xml.h - VTK XML files of grids: image data (.vti), rectilinear grids (.vtr), and both in
 * pieces, a file each (.pvti, .pvtr).
 *
 * Arrays as text, in base64, or appended (raw or in base64), plain or in blocks of zlib, LZ4 or
 * LZMA; either byte order; points and cells; pieces in one file or in several, which may overlap.
 * Only regular files: they are read at several places at once.
 */
#ifndef FORMATS_GRID_VTK_GRID_XML_H
#define FORMATS_GRID_VTK_GRID_XML_H

#include "formats/grid/grid_reader.h"

extern const grid_reader vtk_grid_xml_reader;

#endif
