/* vtk_faces.h - the faces of one piece's polyhedra in VTK's XML, in the order of the cells. There
 * are two forms:
 *
 *   faces, faceoffsets        a polyhedron's number of faces, then each face's number of points and
 *                             ids; where that ends, -1 for another cell
 *   face_connectivity, face_offsets, polyhedron_to_faces, polyhedron_offsets (from version 2.3 on)
 *                             ids of faces; of each polyhedron the faces' numbers. These must rise
 *                             by one: faces are read once, in their order
 */
#ifndef FORMATS_MESH_VTK_FACES_H
#define FORMATS_MESH_VTK_FACES_H

#include "formats/base/mem.h"
#include "formats/mesh/mesh_polyhedron.h"
#include "formats/vtk/vtk_array.h"

typedef struct vtk_faces_source {
    vtk_array faces, faceoffsets;
    vtk_array ids, ends, cell_faces, cell_ends; /* of version 2.3, in the order above */
} vtk_faces_source;

/* vtk_faces_there() - whether there are any. */
bool vtk_faces_there(const vtk_faces_source *s);

typedef struct vtk_faces vtk_faces;

/* vtk_faces_open() - of so many cells; the source must outlive it. */
CHECKED status vtk_faces_open(mem *m, const vtk_faces_source *source, uint64_t cells,
                              vtk_faces **out);
void vtk_faces_close(vtk_faces *f); /* NULL is fine */

/* vtk_faces_next() - go to the next cell. polyhedron: it is one; then its faces, valid up to the
 * next call, else *p is of none. */
CHECKED status vtk_faces_next(vtk_faces *f, bool polyhedron, mesh_polyhedron *p);

/* vtk_faces_finish() - check, behind the last cell, that the arrays end there. */
CHECKED status vtk_faces_finish(vtk_faces *f);

#endif
