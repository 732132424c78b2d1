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

#include "stream/derived.h"
#include "stream/source.h"
#include "stream/treelet.h"

typedef enum mesh_schema { MESH_TREES = 1, MESH_REFIT = 2 } mesh_schema;

/* Where treelets come from. */
typedef struct mesh_store {
    mem *m;
    leaf_file *file;
    source *source;
    mesh_schema schema;
    bool gradients; /* are read, too */
    derived_kind derived;
} mesh_store;

/* What a thread owns while it loads. */
typedef struct mesh_scratch {
    source_scratch source;
    void *refit;
} mesh_scratch;
CHECKED status mesh_scratch_init(const mesh_store *s, mesh_scratch *scratch);
void mesh_scratch_release(const mesh_store *s, mesh_scratch *scratch);

/* mesh_resident_bytes() - memory that treelet t of any set takes at most, topology included.
 * mesh_resident_topology_bytes() - of its topology alone. mesh_resident_stored() - bytes in the
 * file of a set of it and its topology. */
size_t mesh_resident_bytes(const mesh_store *s, uint32_t t);
size_t mesh_resident_topology_bytes(const mesh_store *s, uint32_t t);
uint64_t mesh_resident_stored(const mesh_store *s, uint32_t set, uint32_t t);

/* mesh_resident_create() - treelet t without anything. mesh_resident_destroy() - its values and
 * positions, too, but not its topology; NULL is fine. */
CHECKED status mesh_resident_create(const mesh_store *s, uint32_t t, treelet **out);
void mesh_resident_destroy(const mesh_store *s, treelet *tr);

/* mesh_resident_topology() - read what it has not yet; it is the caller's to give back with
 * source_evict(). mesh_resident_load() - then its values and positions of a set. *read grows by the
 * bytes read. */
CHECKED status mesh_resident_topology(const mesh_store *s, treelet *tr, mesh_scratch *scratch,
                                      uint64_t *read);
CHECKED status mesh_resident_load(const mesh_store *s, treelet *tr, uint32_t set,
                                  mesh_scratch *scratch, uint64_t *read);

/* mesh_resident_strip() - give values and positions back: it has no set then. */
void mesh_resident_strip(const mesh_store *s, treelet *tr);

#endif
