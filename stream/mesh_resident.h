/* mesh_resident.h - a mesh's treelet in memory: its topology, and the values and positions of one
 * set.
 *
 * Two ways lead to another time step, with the same bits (W07 6):
 *
 *   trees   each step's codes and boxes are read with its vertices; they stay in memory beside
 *           those of other steps
 *   refit   only the vertices are read, in place of the last step's; codes and boxes are made anew
 *           (mesh_refit.h). The completed payload must have the checksum in the file. A compressed
 *           payload is read completely; it is small.
 *
 * Between steps (leaf_between.h), each payload has those of both steps behind its own, which is
 * made with the masks: vertices are blended, codes and boxes refit to them.
 */
#ifndef STREAM_MESH_RESIDENT_H
#define STREAM_MESH_RESIDENT_H

#include "formats/mesh/mesh_leaf.h"
#include "stream/mesh_active.h"
#include "stream/resident.h"

typedef struct resident_mesh {
    treelet head;  /* head.payload: the topology */
    void *derived; /* memory for derived data (mesh_derived.h), one of these: */
    const struct kept_polygons *polygons;
    struct mesh_faces *faces;
    const void *values;
    const float (*gradients)[3]; /* at its vertices; NULL: not selected */
    const void *moved;           /* payload of positions; NULL: the topology has them */
    mesh_shape mesh;
    const mesh_node *nodes;      /* with the boxes of its step */
    const float (*positions)[3]; /* of its step */
    uint64_t first_tet;          /* index of its first tet in the whole mesh */
    const float *bounds;         /* lo x y z, hi x y z */
    mesh_frame planes;           /* what the codes of its nodes' boxes mean */
    mesh_active *active;
    bool refit; /* values and moved are own memory, not the source's */
} resident_mesh;

/* resident_mesh_of() - returns the whole struct of a mesh's treelet; NULL gives NULL. */
static inline const resident_mesh *resident_mesh_of(const treelet *tr) {
    return (const resident_mesh *)tr;
}

extern const resident_kind mesh_resident;

#endif
