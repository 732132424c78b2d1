/* mesh_faces.h - finds which tets of a treelet share a face, for ways from tet to tet (M08 6.3.2).
 *
 * Derived data of a resident treelet, in its own block and within the budget: 16 bytes a tet, as in
 * the paper, 4 a vertex, and masks of the tets with an outer face.
 *
 * A tet's vertices are in ascending order of their global ids, so both tets at a face have its
 * vertices in the same order. Two tets are neighbours if they share three vertices, lie on opposite
 * sides of them, and neither is flat. If more than two tets share a face, only two become
 * neighbours. All other faces are outer ones: of the mesh, of its holes, of the treelet, of flat
 * tets, and where tets overlap. So a line that crosses a tet has crossed its neighbour before, or
 * comes in by an outer face.
 */
#ifndef RENDER_MESH_MESH_FACES_H
#define RENDER_MESH_MESH_FACES_H

#include "stream/mesh_resident.h"

#define MESH_OUTER UINT32_MAX

typedef struct mesh_faces {
    uint32_t (*beyond)[4]; /* tet, face (tet_sight.h): neighbour << 2 | its face; or MESH_OUTER */
    uint32_t *first;       /* per vertex: scratch for making the entries */
    uint32_t set;          /* the set that they were made for, + 1 */
    mesh_active outer;     /* masks of the tets with outer faces, and of the nodes above them; no
                              sides */
} mesh_faces;

/* mesh_faces_kind() - returns what a loader has to derive: tr->faces. */
mesh_derived mesh_faces_kind(void);

#endif
