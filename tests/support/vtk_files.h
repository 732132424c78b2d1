/* vtk_files.h - VTK files of unstructured grids, legacy and XML, in every coding; written for the
 * tests, from one small mesh of all kinds of cells, by code that shares none with the readers.
 *
 * The mesh: a hex and a voxel side by side, a pyramid on the one, a wedge on the other, a tet
 * below; between them a triangle, a vertex, a line and a polygon. Volume 2.75. Fields of the
 * points: "alpha" (reals), "v" (3 components), "n" (whole numbers); of the cells: "q" and "w" (2
 * components).
 */
#ifndef TESTS_SUPPORT_VTK_FILES_H
#define TESTS_SUPPORT_VTK_FILES_H

#include <stdbool.h>
#include <stddef.h>

#include "tests/support/mesh_files.h"
#include "tests/support/vtk_writer.h"

enum { VTK_FILES_POINTS = 16, VTK_FILES_CELLS = 9, VTK_FILES_TETS = 6 + 6 + 2 + 3 + 1 };

/* vtk_files_xml(), vtk_files_legacy() - the mesh in a file of the scratch folder; its path. */
const char *vtk_files_xml(const char *name, const vtk_xml_style *style);
const char *vtk_files_legacy(const char *name, int major, int minor, bool text);

/* vtk_files_append() - the same file with text behind it; the path is a new one. */
const char *vtk_files_append(const char *path, const char *text);

/* vtk_files_patch() - the same file, its first `from` replaced by `to`; the path is a new one.
 * Fails the test when there is no `from`. */
const char *vtk_files_patch(const char *path, const char *from, const char *to);

/* vtk_files_check() - a mesh is this one, `pieces` times, with that field ("" for zeros) of that
 * component; cells' fields averaged. */
void vtk_files_check(const mesh_copy *a, int pieces, const char *field, int component);

#endif
