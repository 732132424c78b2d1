/* curvilinear_vtk.h - structured grids of VTK, XML (.vts) and legacy: their pieces are zones.
 *
 * Arrays as text, in base64, or appended, plain or in blocks of a compressor (formats/vtk). Fields
 * are the points' arrays; points that vtkGhostType hides are no nodes. Cells that it hides are
 * none, nor are those of a zone that another zone has. Arrays are read front to back: quick where
 * each field's planes are asked for in rising order. Of each array that is read a cursor's buffers
 * are held, and a chunk of numbers.
 */
#ifndef FORMATS_CURVILINEAR_CURVILINEAR_VTK_H
#define FORMATS_CURVILINEAR_CURVILINEAR_VTK_H

#include "formats/curvilinear/curvilinear_reader.h"

extern const curvilinear_reader curvilinear_vtk_xml_reader, curvilinear_vtk_legacy_reader;

#endif
