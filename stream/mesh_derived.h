/* mesh_derived.h - data that the layer above derives from a mesh's treelet for the selected
 * interest, and keeps in the treelet's block, beside the masks. */
#ifndef STREAM_MESH_DERIVED_H
#define STREAM_MESH_DERIVED_H

#include "formats/mesh/mesh_leaf.h"
#include "stream/interest.h"

struct resident_mesh;

typedef struct mesh_derived {
    /* Returns the bytes to add to a treelet's block of this shape; NULL: nothing is derived. */
    size_t (*bytes)(const mesh_shape *shape);
    /* Called when masks have been made for this interest: make the derived data in tr->derived (at
     * first all 0), and set the pointer to it. The interest stays valid until masks are made anew.
     * No other thread uses the treelet meanwhile. */
    void (*make)(struct resident_mesh *tr, const interest *in);
} mesh_derived;

#endif
