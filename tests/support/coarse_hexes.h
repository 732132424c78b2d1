/* coarse_hexes.h - the lattice of mesh_cases_kuhn(), its cells kept as hexahedra, as a treelet file
 * with coarse grids.
 */
#ifndef TESTS_SUPPORT_COARSE_HEXES_H
#define TESTS_SUPPORT_COARSE_HEXES_H

#include <stdbool.h>

#include "formats/base/mem.h"
#include "formats/base/progress.h"
#include "formats/leaf/leaf_writer.h"

typedef struct coarse_hexes {
    bool whole;     /* a mesh of whole cells; else a curvilinear grid of four zones */
    uint32_t cells; /* along each axis, a multiple of 4 */
    uint32_t steps; /* values are higher by 0.3 each */
    bool coarse;    /* with grids, */
    uint32_t dims;  /* of so many nodes along an edge; 0: as many as suit it */
    leaf_codec codec;
    int threads;
    uint64_t memory;
    const progress *progress; /* or NULL */
} coarse_hexes;

/* coarse_hexes_of() - one step, with grids, nothing compressed, 2 threads, 1 GiB. */
coarse_hexes coarse_hexes_of(bool whole, uint32_t cells, uint32_t dims);

/* coarse_hexes_convert() - to the scratch file of this name. */
status coarse_hexes_convert(mem *m, const coarse_hexes *c, const char *name);

#endif
