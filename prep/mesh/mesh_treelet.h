/* mesh_treelet.h - tets of a mesh to the payloads of one treelet (mesh_leaf.h).
 *
 * Its vertices, each once, in order of their ids; its tets with their vertices in that order; over
 * them a tree of up to 8 children a node: the binary Morton tree of the tets' keys, of which the
 * child with the most tets is opened until a node has 8 or all are leaves. The payloads depend on
 * the records and the vertices alone.
 */
#ifndef PREP_MESH_MESH_TREELET_H
#define PREP_MESH_MESH_TREELET_H

#include <stddef.h>
#include <stdint.h>

#include "formats/base/mem.h"
#include "formats/base/status.h"
#include "formats/leaf/leaf_writer.h"
#include "prep/mesh/mesh_pages.h"
#include "prep/mesh/mesh_sort.h"

typedef struct mesh_treelet {
    float bounds[6]; /* lo x y z, hi x y z of its vertices */
    uint32_t counts[4];
    leaf_entry entry;              /* of the values that were built last */
    const void *topology, *values; /* the builder's, until its next treelet */
    const void *positions;         /* of a further step; NULL: none built yet */
    float moved_bounds[6];         /* of these */
    /* Tets by the sign of their volume (exact_orientation()). */
    uint64_t flat, positive, negative;
} mesh_treelet;

/* What one thread builds treelets with. */
typedef struct mesh_treelet_builder mesh_treelet_builder;

/* mesh_treelet_create() - for treelets of up to treelet_tets tets with leaves of up to leaf_tets.
 * mesh_treelet_memory() - bytes that it takes. */
CHECKED status mesh_treelet_create(mem *m, uint32_t treelet_tets, uint32_t leaf_tets,
                                   mesh_treelet_builder **out);
void mesh_treelet_destroy(mesh_treelet_builder *b); /* NULL is fine */
uint64_t mesh_treelet_memory(uint32_t treelet_tets, uint32_t leaf_tets);

/* mesh_treelet_payload_max() - bytes of the largest payload that may come out. */
size_t mesh_treelet_payload_max(uint32_t treelet_tets, uint32_t leaf_tets);

/* mesh_treelet_moved_memory() - what mesh_treelet_move() takes besides, once. */
uint64_t mesh_treelet_moved_memory(uint32_t treelet_tets, uint32_t leaf_tets);

/* mesh_treelet_build() - records: 1 to treelet_tets of them, sorted by key, each of four different
 * vertices. points, values: float[3] and float of every vertex. Fails only where reading them does.
 */
CHECKED status mesh_treelet_build(mesh_treelet_builder *b, const mesh_record *records, size_t count,
                                  mesh_pages *points, mesh_pages *values, mesh_treelet *out);

/* Of a series, behind mesh_treelet_build() or mesh_treelet_begin(): mesh_treelet_revalue() - other
 * values of the same vertices: out->values, out->entry. mesh_treelet_move() - other positions:
 * out->positions, out->moved_bounds. mesh_treelet_begin() - the tets alone: no payload is there
 * before one of these. */
CHECKED status mesh_treelet_revalue(mesh_treelet_builder *b, mesh_pages *values, mesh_treelet *out);
CHECKED status mesh_treelet_move(mesh_treelet_builder *b, mesh_pages *points, mesh_treelet *out);
void mesh_treelet_begin(mesh_treelet_builder *b, const mesh_record *records, size_t count,
                        mesh_treelet *out);

/* mesh_treelet_gradients() - of the treelet built last, for leaf_writer_put_gradients(); gradients:
 * float[3] of every vertex. Takes the place of its topology: nothing else can be
 * built of the treelet then. */
CHECKED status mesh_treelet_gradients(mesh_treelet_builder *b, const mesh_treelet *t,
                                      mesh_pages *gradients, const void **payload);

#endif
