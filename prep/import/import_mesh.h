/* import_mesh.h - a mesh or a curvilinear grid that an importer has opened, and its way out as a
 * mesh stream, or a curvilinear stream.
 */
#ifndef PREP_IMPORT_IMPORT_MESH_H
#define PREP_IMPORT_IMPORT_MESH_H

#include <stdbool.h>
#include <stdint.h>

#include "formats/base/mem.h"
#include "formats/base/progress.h"
#include "formats/base/quadratic_tet.h"
#include "formats/base/status.h"
#include "formats/grid/absent.h"
#include "formats/mesh/mesh_stream.h"

/* What the shim around a format's library fills. Each call gives `count` from `first` on, of what
 * the header says. All are called in order, and each once. */
typedef struct import_mesh {
    mesh_stream_header header; /* what it points to is the shim's */
    void *ctx;
    status (*points)(void *ctx, uint64_t first, size_t count, float (*xyz)[3]);
    status (*values)(void *ctx, uint32_t field, uint64_t first, size_t count, float *to);
    /* Ids as cell_shape.h orders them, from 0; any that is no point makes the cell a bad one. */
    status (*cells)(void *ctx, cell_shape shape, uint64_t first, size_t count, uint32_t *ids);
    /* The next polyhedra, as mesh_stream.h has their numbers: as many as there is room for, which
     * is for one of any size, and how many numbers these are. NULL: there are none. */
    status (*polyhedra)(void *ctx, size_t room, uint32_t *to, size_t *count);
    /* A curvilinear grid in place of cells: its zones, whose nodes are the points, in order. 0: it
     * is a mesh. blanks(): as curvilinear_source.h has it; NULL: all are nodes. */
    const uint32_t (*zones)[3];
    uint32_t zone_count;
    status (*blanks)(void *ctx, uint64_t first, size_t count, uint8_t *to);
    bool still;                 /* nodes are the same at all steps */
    const absent_parts *absent; /* of what has been read; NULL: nothing tells */
    void (*close)(void *ctx);   /* NULL: it has not been opened */
} import_mesh;

/* import_mesh_shape() - the shape of an element of so many nodes, whose corners have the shape
 * given: a tet of ten is a quadratic one, unless it is taken by its corners. */
static inline cell_shape import_mesh_shape(cell_shape corners, size_t nodes, bool by_corners) {
    const bool quadratic = corners == CELL_TET && nodes == QUADRATIC_NODES && !by_corners;
    return quadratic ? CELL_QUADRATIC_TET : corners;
}

void import_mesh_close(import_mesh *x);

/* import_mesh_write() - write all of it to a file, or to "-". Nothing is left behind if it fails.
 * step() is told how much is done, 0 to 1, and may end it. */
CHECKED status import_mesh_write(mem *m, import_mesh *x, const char *path, bool force,
                                 status (*step)(const void *ctx, double fraction), const void *ctx);

#endif
