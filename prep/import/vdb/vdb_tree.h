/* vdb_tree.h - one grid of an OpenVDB file as z slices of a box. Wraps OpenVDB for C.
 *
 * The file is read in two passes. The first visits the grid without its values, by a stream that
 * fails at the first missing byte. It must end where the file says that the grid ends. So cut
 * files, and most altered ones, are refused before anything is written. The second loads the tree.
 * A leaf's values are read when its slice comes, if the file allows that. Leaves behind the last
 * slice asked for are freed. OpenVDB's allocations are counted in the budget of vdb_memory.h. No
 * exception leaves these functions. One thread.
 */
#ifndef PREP_IMPORT_VDB_VDB_TREE_H
#define PREP_IMPORT_VDB_VDB_TREE_H

#include <stdbool.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#include "formats/base/sample.h"
#include "formats/base/status.h"

typedef struct vdb_request {
    const char *path;
    const char *field;  /* NULL: the first grid that can be read */
    const char *list;   /* the command that lists the grids, for messages */
    uint32_t component; /* of vectors: 1 .. 3; 0: their magnitude */
    bool boxed;         /* use `box`, not the box of active voxels */
    int32_t box[2][3];  /* index coordinates, the upper corner included */
    uint32_t pad;       /* additional voxels on all six sides */
} vdb_request;

/* Node (0, 0, 0) is the voxel at the lower corner of the box. */
typedef struct vdb_facts {
    const char *name; /* lives as long as the tree */
    uint64_t dims[3];
    sample_type type;
    double to_world[3][4]; /* of nodes, counted from the lower corner */
} vdb_facts;

typedef struct vdb_tree vdb_tree;

/* vdb_tree_open() - ST_IO, ST_CORRUPT, ST_UNSUPPORTED (no such grid, points, a map that is not
 * affine, nothing active and no box), ST_USAGE (no such component), ST_NOMEM. */
CHECKED status vdb_tree_open(const vdb_request *q, vdb_facts *facts, vdb_tree **out);

/* vdb_tree_read() - read slices first .. first + count - 1 of the box, x fastest. Slices before
 * these cannot be read any more. busy: their maps (slice_tiles.h), or NULL. Tiles that no node
 * covers are quiet: they have the background, the sample of vdb_tree_background(). */
CHECKED status vdb_tree_read(vdb_tree *t, uint32_t first, uint32_t count, void *slices,
                             uint8_t *busy);
void vdb_tree_background(const vdb_tree *t, void *sample);
void vdb_tree_close(vdb_tree *t); /* NULL is fine */

/* A grid of a file. */
typedef struct vdb_entry {
    const char *name;
    const char *type;    /* "float, half, level set" */
    uint64_t dims[3];    /* of the active voxels; 0: none, or it cannot be read */
    const char *refuse;  /* why it cannot be read; NULL: it can */
    uint32_t components; /* 3: a vector; 0: a scalar */
} vdb_entry;

/* vdb_tree_list() - report each grid of a file, in the file's order of names. */
CHECKED status vdb_tree_list(const char *path, status (*take)(void *ctx, const vdb_entry *e),
                             void *ctx);

#ifdef __cplusplus
}
#endif
#endif
