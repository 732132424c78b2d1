/* mesh_derived.h - what the layer above makes of a mesh's treelet for the selected interest, and
 * keeps in its block, beside the masks. */
#ifndef STREAM_MESH_DERIVED_H
#define STREAM_MESH_DERIVED_H

#include "formats/mesh/mesh_leaf.h"
#include "stream/interest.h"

struct resident_mesh;

typedef struct mesh_derived {
    /* Room in the block of a treelet of this shape; NULL: nothing is derived. */
    size_t (*bytes)(const mesh_shape *shape);
    /* Masks have been made for this interest: make what belongs to them, in tr->derived, zero to
     * begin with, and say where it is. The interest stays until the masks are made anew. Nobody
     * else looks at it meanwhile. */
    void (*make)(struct resident_mesh *tr, const interest *in);
} mesh_derived;

#endif
