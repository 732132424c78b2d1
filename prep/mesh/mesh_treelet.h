/* mesh_treelet.h - makes the payloads of one treelet from tets of a mesh (mesh_leaf.h).
 *
 * A treelet has its vertices, each once, in order of their ids. It has its tets, with their
 * vertices in that order. Over them is a tree of up to 8 children per node, made from the binary
 * Morton tree of the tets' keys (mesh_tree.h). The payloads depend on the records and the vertices
 * alone.
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
    leaf_entry entry;              /* of the values built last */
    const void *topology, *values; /* owned by the builder, until its next treelet */
    const void *positions;         /* of a further step; NULL: none has been built */
    float moved_bounds[6];         /* bounds of these positions */
    /* Number of tets by the sign of their volume (exact_orientation()). */
    uint64_t flat, positive, negative;
} mesh_treelet;

/* One thread's buffers to build treelets. */
typedef struct mesh_treelet_builder mesh_treelet_builder;

/* mesh_treelet_create() - for treelets of at most treelet_tets tets with leaves of at most
 * leaf_tets. mesh_treelet_memory() - bytes it takes. */
CHECKED status mesh_treelet_create(mem *m, uint32_t treelet_tets, uint32_t leaf_tets,
                                   mesh_treelet_builder **out);
void mesh_treelet_destroy(mesh_treelet_builder *b); /* NULL is fine */
uint64_t mesh_treelet_memory(uint32_t treelet_tets, uint32_t leaf_tets);

/* mesh_treelet_counts_max() - the most tets, vertices, nodes and leaves of a treelet. */
void mesh_treelet_counts_max(uint32_t treelet_tets, uint32_t leaf_tets, uint32_t counts[4]);

/* mesh_treelet_payload_max() - bytes of the largest possible payload. */
size_t mesh_treelet_payload_max(uint32_t treelet_tets, uint32_t leaf_tets);

/* mesh_treelet_moved_memory() - additional bytes that mesh_treelet_move() takes, once. */
uint64_t mesh_treelet_moved_memory(uint32_t treelet_tets, uint32_t leaf_tets);

/* mesh_treelet_build() - records: 1 to treelet_tets of them, sorted by key, each of four different
 * vertices. points, values: float[3] and float of every vertex. Fails only if reading them does.
 */
CHECKED status mesh_treelet_build(mesh_treelet_builder *b, const mesh_record *records, size_t count,
                                  mesh_pages *points, mesh_pages *values, mesh_treelet *out);

/* mesh_treelet_point() - the number in the input of a vertex of the treelet built last. */
uint32_t mesh_treelet_point(const mesh_treelet_builder *b, uint32_t vertex);

/* For a series, after mesh_treelet_build() or mesh_treelet_begin(). mesh_treelet_revalue() - other
 * values of the same vertices: sets out->values, out->entry. mesh_treelet_move() - other positions:
 * sets out->positions, out->moved_bounds. mesh_treelet_begin() - take only the tets: it makes no
 * payload. */
CHECKED status mesh_treelet_revalue(mesh_treelet_builder *b, mesh_pages *values, mesh_treelet *out);
CHECKED status mesh_treelet_move(mesh_treelet_builder *b, mesh_pages *points, mesh_treelet *out);
void mesh_treelet_begin(mesh_treelet_builder *b, const mesh_record *records, size_t count,
                        mesh_treelet *out);

/* mesh_treelet_gradients() - gradients of the treelet built last, for leaf_writer_put_gradients().
 * gradients: float[3] of every vertex. Overwrites the topology: nothing else can be built of the
 * treelet afterwards. */
CHECKED status mesh_treelet_gradients(mesh_treelet_builder *b, const mesh_treelet *t,
                                      mesh_pages *gradients, const void **payload);

#endif
