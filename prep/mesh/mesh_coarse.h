/* mesh_coarse.h - makes the coarse grids in a mesh's treelet file (leaf.h, COARSE): its values
 * resampled, with their pyramid. They are drawn before the mesh has been read.
 */
#ifndef PREP_MESH_MESH_COARSE_H
#define PREP_MESH_MESH_COARSE_H

#include <stdint.h>

#include "formats/base/mem.h"
#include "formats/base/progress.h"
#include "formats/base/status.h"
#include "formats/leaf/leaf_writer.h"

typedef struct mesh_coarse {
    uint32_t dims; /* nodes along the longest edge; 0: half as many nodes as there are tets */
    leaf_parameters file; /* of the mesh */
    uint64_t memory;
    int threads;
} mesh_coarse;

/* mesh_coarse_embed() - put a grid for each set into w, which must be settled. output: path beside
 * which scratch files may lie. The grids depend on the mesh, dims and file alone. */
CHECKED status mesh_coarse_embed(mem *m, leaf_writer *w, const char *output, const mesh_coarse *o,
                                 const progress *p);

#endif
