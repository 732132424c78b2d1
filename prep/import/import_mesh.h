/* import_mesh.h - a mesh that an importer has opened, and its way out as a mesh stream.
 */
#ifndef PREP_IMPORT_IMPORT_MESH_H
#define PREP_IMPORT_IMPORT_MESH_H

#include "formats/base/mem.h"
#include "formats/base/progress.h"
#include "formats/base/status.h"
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
    void (*close)(void *ctx); /* NULL: it has not been opened */
} import_mesh;

void import_mesh_close(import_mesh *x);

/* import_mesh_write() - write all of it to a file, or to "-". Nothing is left behind if it fails.
 * step() is told how much is done, 0 to 1, and may end it. */
CHECKED status import_mesh_write(mem *m, import_mesh *x, const char *path, bool force,
                                 status (*step)(const void *ctx, double fraction), const void *ctx);

#endif
