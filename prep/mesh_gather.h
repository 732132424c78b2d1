/* mesh_gather.h - a mesh on its way in: everything a reader hands over, kept for what comes next.
 *
 * In memory up to a ceiling; then tets go to a scratch file first, and points and values when that
 * is not enough.
 */
#ifndef PREP_MESH_GATHER_H
#define PREP_MESH_GATHER_H

#include <stdbool.h>
#include <stdint.h>

#include "formats/base/progress.h"
#include "formats/mesh.h"
#include "prep/mesh_spool.h"

typedef struct mesh_gather {
    mesh_spool points, values, tets; /* float[3], float, uint32_t[4] */
    float bounds[6];                 /* of all points: lo x y z, hi x y z */
    uint64_t non_finite;             /* values that are NaN or inf */
    bool counted;                    /* nothing is kept, but how much there would be */
    const progress *p;
} mesh_gather;

/* mesh_gather_init() - ceiling: of what m has in use; 0: none. beside: the path beside which
 * scratch files may be, kept by reference; p may be NULL. */
void mesh_gather_init(mesh_gather *g, mem *m, const char *beside, size_t ceiling,
                      const progress *p);
void mesh_gather_release(mesh_gather *g); /* zeroed is fine */

/* mesh_gather_least() - bytes that it takes at least. */
size_t mesh_gather_least(void);

/* mesh_gather_sink() - what to give to mesh_read(). */
mesh_sink mesh_gather_sink(mesh_gather *g);

/* mesh_gather_counter() - the same, to count what would come: for a plan alone. Of the spools,
 * `count` and the number of chunks are as if all were held. No mesh_gather_end(). */
mesh_sink mesh_gather_counter(mesh_gather *g);

/* mesh_gather_end() - everything has come. */
CHECKED status mesh_gather_end(mesh_gather *g);

#endif
