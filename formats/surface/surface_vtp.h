/* surface_vtp.h - the reader of VTK's polygonal data in XML (.vtp): its pieces, in any coding of
 * vtk_xml.h. */
#ifndef FORMATS_SURFACE_SURFACE_VTP_H
#define FORMATS_SURFACE_SURFACE_VTP_H

#include "formats/mesh/mesh_reader.h"

extern const mesh_reader surface_vtp_reader;

#endif
