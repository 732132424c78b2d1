/* mesh_resident.h - a mesh's treelet in memory: its topology, and on it the values and positions of
 * one set.
 *
 * Two ways to another time step, which give the same bits (W07 6):
 *
 *   trees   each step's codes and boxes are read with its vertices; what was read stays, beside
 *           that of other steps
 *   refit   vertices alone are read, over those of the step before; codes and boxes are made anew
 *           (mesh_refit.h), and the payload that comes out must have the checksum that the file has
 *           for it. Of a compressed payload all is read, which is little.
 */
#ifndef STREAM_MESH_RESIDENT_H
#define STREAM_MESH_RESIDENT_H

#include "formats/mesh/mesh_leaf.h"
#include "stream/mesh_active.h"
#include "stream/resident.h"

typedef struct resident_mesh {
    treelet head;  /* its payload: the topology */
    void *derived; /* room for what is, see mesh_derived.h; which then is one of these: */
    struct isopolygon_cache *polygons;
    struct mesh_faces *faces;
    const void *values;
    const float (*gradients)[3]; /* at its vertices; NULL: not asked for */
    const void *moved;           /* payload of positions, where they are not the topology's */
    mesh_shape mesh;
    const mesh_node *nodes;      /* with the boxes of its step */
    const float (*positions)[3]; /* of its step */
    uint64_t first_tet;          /* index of its first tet in the whole mesh */
    const float *bounds;         /* lo x y z, hi x y z */
    mesh_frame planes;           /* what its nodes' codes mean */
    mesh_active *active;
    bool refit; /* values and moved are memory of its own */
} resident_mesh;

/* resident_mesh_of() - the whole of a treelet of a mesh; NULL of NULL. */
static inline const resident_mesh *resident_mesh_of(const treelet *tr) {
    return (const resident_mesh *)tr;
}

extern const resident_kind mesh_resident;

#endif
