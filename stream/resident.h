/* resident.h - how a kind's treelets are loaded and freed: a table of functions for each kind.
 *
 * Callers hold the loader's lock when a treelet changes its owner, and no lock during a read.
 * Treelets of several sets may share data that is the same in all sets (a mesh's topology). The
 * shared data is their payload, and the loader counts its users.
 */
#ifndef STREAM_RESIDENT_H
#define STREAM_RESIDENT_H

#include "formats/base/block_runs.h"
#include "stream/active.h"
#include "stream/mesh_derived.h"
#include "stream/source.h"
#include "stream/treelet.h"
#include "stream/treelet_tree.h"

/* How another time step of a mesh is loaded: see mesh_resident.h. */
typedef enum mesh_schema { MESH_TREES = 1, MESH_REFIT = 2 } mesh_schema;

/* Where treelets come from. */
typedef struct resident_store {
    mem *m;
    leaf_file *file;
    source *source;
    block_runs *heads;    /* for kinds with head() */
    active_fn *compute;   /* makes the masks of a grid's treelet */
    mesh_schema schema;   /* meshes: */
    bool gradients;       /* gradients are read, too */
    mesh_derived derived; /* made with the masks */
} resident_store;

/* Memory that one thread uses while it loads. */
typedef struct resident_scratch {
    leaf_unpacker *unpacker; /* NULL: the file is raw */
    void *room;              /* resident_kind.scratch bytes; or NULL */
} resident_scratch;

/* The most payloads that a treelet takes to load. */
enum { RESIDENT_PAYLOADS = 4 * LEAF_CHAIN_MAX };

typedef struct resident_kind {
    /* Whether treelets of several sets share their payload; NULL: never. */
    bool (*shares)(const leaf_file *f);
    /* Returns the boxes of a set's treelets, for a tree over treelets that overlap. NULL: the
     * directory is the tree. */
    const treelet_bounds *(*boxes)(const leaf_file *f, uint32_t set);
    /* Returns the scratch bytes to load any treelet, beside the unpacker. */
    size_t (*scratch)(const resident_store *s);
    /* Returns the bytes that load() takes from the store's heads for treelet t. NULL: none. */
    size_t (*head)(const resident_store *s, uint32_t t);
    /* bytes: the most memory of treelet t in any set. shared_bytes: the memory of its shared
     * payload. stored: its bytes in the file for one set; with those of what its family shares,
     * unless *family, in and out, says that these are counted (its parent; at first
     * LEAF_NO_TREELET).
     */
    size_t (*bytes)(const resident_store *s, uint32_t t);
    size_t (*shared_bytes)(const resident_store *s, uint32_t t);
    uint64_t (*stored)(const resident_store *s, uint32_t set, uint32_t t, uint32_t *family);
    /* List the payloads that load() will read for treelet t. Returns how many there are. */
    uint32_t (*ahead)(const resident_store *s, uint32_t set, uint32_t t,
                      uint32_t payloads[RESIDENT_PAYLOADS]);
    /* Whether a treelet of another set spares reading some of what that treelet of this set needs.
     * NULL: none ever does. */
    bool (*helps)(const resident_store *s, const treelet *tr, uint32_t set);
    /* Read treelet t of a set. *tr: NULL, or a treelet t without a set, which is filled. shared:
     * its shared payload; NULL: read the payload, too. earlier: one that helps; or NULL. On failure
     * *tr is the treelet as far as it was made, or NULL. Adds the bytes read to *read. */
    status (*load)(const resident_store *s, uint32_t t, uint32_t set, const void *shared,
                   const treelet *earlier, resident_scratch *scratch, treelet **tr, uint64_t *read);
    /* same: whether a treelet of another set has the same in this set, masks too. NULL: none ever
     * has. adopt: make one that has a treelet of this set. */
    bool (*same)(const resident_store *s, const treelet *tr, uint32_t set);
    void (*adopt)(const resident_store *s, treelet *tr, uint32_t set);
    /* After its file has grown (leaf_file_exchange()): the treelet's set has this number now, and
     * its payload lies here. NULL: files of this kind
     * do not grow while they are open. */
    void (*renumber)(const resident_store *s, treelet *tr, uint32_t set, const void *payload);
    /* Returns whether a treelet can stay whose set may have changed since it was read; it has no
     * masks any more if it must be brought up to date with them. Called only where sets change
     * (leaf_file.versions), while nothing is traced. */
    bool (*keep)(const resident_store *s, treelet *tr);
    /* Free what belongs to the treelet's set. If sets share a payload, it has no set then. */
    void (*strip)(const resident_store *s, treelet *tr);
    /* Free all but the shared payload. */
    void (*destroy)(const resident_store *s, treelet *tr);
    /* Make the masks of active cells or tets. */
    void (*mask)(const resident_store *s, treelet *tr, const interest *in);
    const struct hex_blocks *hexes; /* of kinds whose cells are hexahedra (hex_resident.h) */
} resident_kind;

/* resident_kind_of() - returns the table for a file's kind. */
const resident_kind *resident_kind_of(const leaf_file *f);

#endif
