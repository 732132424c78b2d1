/* cgns_faces.h - polygons (NGON_n) of a CGNS file as the faces of its polyhedra (NFACE_n).
 *
 * Polyhedra name their faces in any order, so those of a zone are in memory, 4 bytes a node and 8 a
 * face, while the zone's polyhedra are read.
 */
#ifndef PREP_IMPORT_CGNS_CGNS_FACES_H
#define PREP_IMPORT_CGNS_CGNS_FACES_H

#include "formats/mesh/mesh_polyhedron.h"
#include "prep/import/cgns/cgns_numbers.h"

/* A section of them. */
typedef struct cgns_polygons {
    int zone;
    cgsize_t start, end; /* the elements' numbers */
    uint64_t first;      /* of its first one, among those in memory */
    cgns_lists lists;
} cgns_polygons;

typedef struct cgns_faces {
    const cgns_file *f;
    cgns_polygons *sections; /* by zones; those in memory by their numbers */
    size_t count, room;
    int zone; /* whose faces are in memory, from 1; 0: none */
    size_t first, some;
    uint32_t *ids; /* of nodes of the mesh from 0; UINT32_MAX: no node */
    uint64_t *ends;
    uint64_t *stream; /* of the polyhedron that was asked for last */
} cgns_faces;

/* Start with {.f = file}. cgns_faces_add() - a section, by its name. cgns_faces_release() - also if
 * that failed. */
CHECKED status cgns_faces_add(cgns_faces *x, int zone, const char *name, cgsize_t start,
                              cgsize_t end);
void cgns_faces_release(cgns_faces *x);

/* cgns_faces_polyhedron() - the polyhedron of a zone's elements with these numbers, negative for
 * those that go round the other way; valid until the next call. which: that of its section, from 0.
 * ST_CORRUPT: one is no polygon, or mesh_polyhedron_fault(). ST_UNSUPPORTED: more numbers than a
 * mesh stream has. ST_NOMEM: the zone's faces do not fit. */
CHECKED status cgns_faces_polyhedron(cgns_faces *x, int zone, uint64_t which,
                                     const cgsize_t *numbers, size_t count, mesh_polyhedron *p);

#endif
