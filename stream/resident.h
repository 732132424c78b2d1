/* resident.h - how a kind's treelets come into memory and go: a row of a table for each kind.
 *
 * Whoever calls it holds the loader's lock where a treelet changes hands, and none while it is
 * read. A treelet of several sets may share what does not differ from set to set (of a mesh its
 * topology): that is its payload, which the loader counts users of.
 */
#ifndef STREAM_RESIDENT_H
#define STREAM_RESIDENT_H

#include "stream/active.h"
#include "stream/mesh_derived.h"
#include "stream/source.h"
#include "stream/treelet.h"
#include "stream/treelet_tree.h"

/* How another time step of a mesh comes in: see mesh_resident.h. */
typedef enum mesh_schema { MESH_TREES = 1, MESH_REFIT = 2 } mesh_schema;

/* Where treelets come from. */
typedef struct resident_store {
    mem *m;
    leaf_file *file;
    source *source;
    active_fn *compute;   /* masks of a grid's treelet */
    mesh_schema schema;   /* of a mesh: */
    bool gradients;       /* are read, too */
    mesh_derived derived; /* with its masks */
} resident_store;

/* What a thread owns while it loads. */
typedef struct resident_scratch {
    source_scratch source;
    void *room; /* resident_kind.scratch bytes; or NULL */
} resident_scratch;

typedef struct resident_kind {
    /* Treelets of several sets share their payload. */
    bool shares;
    /* The boxes of treelets in a set, which overlap: a tree over them orders them. NULL: the
     * directory does. */
    const treelet_bounds *(*boxes)(const leaf_file *f, uint32_t set);
    /* What a thread needs to load any treelet, beside the source's scratch; 0: nothing. */
    size_t (*scratch)(const resident_store *s);
    /* Memory that treelet t of any set takes at most; that its shared payload takes; bytes of a set
     * of it in the file. */
    size_t (*bytes)(const resident_store *s, uint32_t t);
    size_t (*shared_bytes)(const resident_store *s, uint32_t t);
    uint64_t (*stored)(const resident_store *s, uint32_t set, uint32_t t);
    /* Read treelet t of a set. *tr: NULL, or one without a set. shared: its payload, where that is
     * there; NULL: it is read. What there is when it fails stays in *tr. *read grows by the bytes
     * read. */
    status (*load)(const resident_store *s, uint32_t t, uint32_t set, const void *shared,
                   resident_scratch *scratch, treelet **tr, uint64_t *read);
    /* Give back what belongs to the set: it has none then. */
    void (*strip)(const resident_store *s, treelet *tr);
    /* Give all back but what is shared. */
    void (*destroy)(const resident_store *s, treelet *tr);
    /* Masks of what is active. */
    void (*mask)(const resident_store *s, treelet *tr, const interest *in);
} resident_kind;

/* resident_kind_of() - the row of a file's geometry. */
const resident_kind *resident_kind_of(const leaf_file *f);

#endif
