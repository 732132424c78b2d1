/* mesh_topology_coder.h - the topology of a mesh's treelet as streams, for mesh_coder.c.
 *
 * s: of the treelet. Streams begin behind the byte that says the way.
 */
#ifndef FORMATS_MESH_MESH_TOPOLOGY_CODER_H
#define FORMATS_MESH_MESH_TOPOLOGY_CODER_H

#include <stdbool.h>

#include "formats/leaf/coded_streams.h"
#include "formats/mesh/mesh_leaf.h"

/* Written to files: never renumber. */
typedef enum mesh_topology_way {
    MESH_BOXES_IMPLIED = 1, /* the boxes of nodes are those that the positions imply */
    MESH_BOXES_STORED = 2   /* they are stored */
} mesh_topology_way;

/* mesh_topology_room() - returns the most bytes of all streams.
 * mesh_topology_scratch() - returns the bytes of scratch that mesh_topology_encode() needs. */
size_t mesh_topology_room(const mesh_shape *s);
size_t mesh_topology_scratch(const mesh_shape *s);

/* mesh_topology_encode() - encode a payload; with MESH_BOXES_IMPLIED its boxes are ignored. Returns
 * false if its tets cannot be coded. A payload out of order may decode to other bytes: decode and
 * compare. mesh_topology_decode() - decode all that is left of `in`. Returns false if it is
 * malformed, or if boxes are implied and a position lies outside the bounds. */
bool mesh_topology_encode(mesh_topology_way way, const mesh_shape *s, const void *payload,
                          uint8_t *scratch, coded_streams *out);
bool mesh_topology_decode(mesh_topology_way way, const mesh_shape *s, const float bounds[6],
                          coded_input *in, void *payload);

#endif
