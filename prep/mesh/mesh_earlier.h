/* mesh_earlier.h - further steps of a treelet file: what is built of them must be what the file has
 * already, all but the values.
 *
 * A further step is sorted and cut by itself. Where points and tets are those of the first step,
 * the same treelets come out, to the bit: treelets depend on them and the parameters alone. So each
 * topology is built again, compared, and not stored.
 */
#ifndef PREP_MESH_MESH_EARLIER_H
#define PREP_MESH_MESH_EARLIER_H

#include "formats/leaf/leaf_unpacker.h"
#include "prep/mesh/mesh_treelet.h"

/* One thread's buffers to compare treelets. */
typedef struct mesh_earlier {
    mem *m;
    leaf_file *f; /* the file that is added to */
    leaf_unpacker *unpacker;
    char *topology;
} mesh_earlier;

/* mesh_earlier_init() - f must outlive it. mesh_earlier_memory() - bytes it takes.
 * mesh_earlier_release() - a zeroed struct is fine. */
CHECKED status mesh_earlier_init(mesh_earlier *e, mem *m, leaf_file *f);
void mesh_earlier_release(mesh_earlier *e);
uint64_t mesh_earlier_memory(const leaf_file *f);

/* What is known of a mesh before it is built. */
typedef struct mesh_counts {
    uint64_t tets, vertices, treelets;
} mesh_counts;

/* A treelet as it was built. */
typedef struct mesh_earlier_built {
    const uint32_t *counts; /* element of COUNTS */
    const void *topology;
    const mesh_treelet_builder *by; /* NULL: of a mixed mesh */
} mesh_earlier_built;

/* mesh_earlier_check() - ST_USAGE, naming what differs, if a mesh with these counts is no further
 * step of f. input: its name.
 * mesh_earlier_compare() - the same of treelet t as it was built. ST_CORRUPT: the file is damaged.
 */
CHECKED status mesh_earlier_check(const leaf_file *f, const char *input, const mesh_counts *own);
CHECKED status mesh_earlier_compare(mesh_earlier *e, const char *input, uint32_t t,
                                    const mesh_earlier_built *built);

#endif
