/* curvilinear_imported.h - curvilinear grids whose format needs a heavy library: an importer
 * (formats/input/importing.h) writes a curvilinear stream, which goes into a file without a name.
 *
 * These are netCDF with places on a map or a globe, which are asked for (curvilinear_hints.to), and
 * CGNS whose zones are all structured.
 */
#ifndef FORMATS_CURVILINEAR_CURVILINEAR_IMPORTED_H
#define FORMATS_CURVILINEAR_CURVILINEAR_IMPORTED_H

#include "formats/curvilinear/curvilinear_reader.h"

/* Recognises CGNS. Which of its files are grids, and not meshes, the mesh kind has looked at before
 * (curvilinear_imported_is()). A step is imported where its first plane is read, with the fields
 * that are taken. */
extern const curvilinear_reader curvilinear_imported_reader;

/* curvilinear_imported_is() - returns whether a file's cells are all implied by zones. What its
 * importer fails over is no grid. trust: NULL: none. */
bool curvilinear_imported_is(mem *m, const char *path, const uint8_t *start, size_t size,
                             const input_trust *trust);

#endif
