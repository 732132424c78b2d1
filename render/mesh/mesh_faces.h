/* mesh_faces.h - which tets of a treelet share a face: what a way from tet to tet goes by (M08
 * 6.3.2).
 *
 * Derived data of a resident treelet, in its own block and within the budget: 16 bytes a tet, as
 * the paper's, 4 a vertex, and masks of the tets with a face that is no neighbour's.
 *
 * Vertices of a tet are in ascending order of their global ids, so that a face has one order in
 * both. Two tets are neighbours where they have three vertices in common, lie on both sides of
 * these, and neither is flat; of more than two at a face, two are. All other faces are outer ones:
 * those of the mesh, of its holes, of the treelet, of flat tets, and where tets overlap. So a line
 * that crosses a tet has crossed its neighbour before, or comes in by an outer face.
 */
#ifndef RENDER_MESH_MESH_FACES_H
#define RENDER_MESH_MESH_FACES_H

#include "stream/mesh_resident.h"

#define MESH_OUTER UINT32_MAX

typedef struct mesh_faces {
    uint32_t (*beyond)[4]; /* tet, face (tet_sight.h): neighbour << 2 | its face; or MESH_OUTER */
    uint32_t *first;       /* room for an entry a vertex while they are made */
    uint32_t set;          /* that they were made for, + 1 */
    mesh_active outer;     /* the tets with outer faces, and the nodes above; no sides */
} mesh_faces;

/* mesh_faces_kind() - what a loader is to derive: tr->faces. */
mesh_derived mesh_faces_kind(void);

#endif
