/* surface_edges.h - the edges of a treelet's cells that an isosurface crosses, each with its
 * vertex: a hash table. Edges whose ends have the same places and values are one.
 */
#ifndef PREP_EXPORT_SURFACE_EDGES_H
#define PREP_EXPORT_SURFACE_EDGES_H

#include <stdbool.h>

#include "prep/export/piece.h"

typedef struct surface_crossing {
    hash_id key;
    uint32_t vertex;
} surface_crossing;

/* Start with {.m = budget}; free .crossing. */
typedef struct surface_edges {
    mem *m;
    surface_crossing *crossing;
    uint32_t slots, count; /* slots: a power of two, or 0 */
} surface_edges;

/* surface_edges_clear() - forget all edges. */
void surface_edges_clear(surface_edges *e);

/* surface_edge_key() - the same for this edge in all treelets: of both ends in an order that they
 * have in all, and the isovalue. */
hash_id surface_edge_key(const float from[3], float from_value, const float to[3], float to_value,
                         double isovalue);

/* surface_edges_find() - where the vertex of the edge of this key is kept, up to the next call.
 * *known: it is there; else it is to be put there. NULL: no memory. */
uint32_t *surface_edges_find(surface_edges *e, hash_id key, bool *known);

#endif
