/* mesh_build.h - builds the payloads of treelets from sorted tets, by many threads, and puts them
 * into the file.
 *
 * Topology and values of the first step come first. Further steps follow, in the same pass over the
 * tets or in another one.
 */
#ifndef PREP_MESH_MESH_BUILD_H
#define PREP_MESH_MESH_BUILD_H

#include <stdint.h>

#include "formats/base/pool.h"
#include "formats/leaf/leaf_writer.h"
#include "prep/mesh/mesh_batches.h"
#include "prep/mesh/mesh_gather.h"
#include "prep/mesh/mesh_plan.h"

/* What treelets are built from. All must outlive the building. */
typedef struct mesh_build_input {
    const mesh_options *o;
    const mesh_plan *plan;
    mesh_gather *g;
    mesh_spool
        *gradients; /* of all sets, in the order of the values; unused without o->gradients */
    uint64_t tets;
} mesh_build_input;

typedef struct mesh_build mesh_build;

/* mesh_build_create() - w: where payloads go; it must outlive the building. */
CHECKED status mesh_build_create(mem *m, pool *workers, const mesh_build_input *in, leaf_writer *w,
                                 mesh_build **out);
void mesh_build_destroy(mesh_build *b); /* NULL is fine */

/* mesh_build_take() - build the steps from first_step to before end_step of a batch's treelets.
 * Each batch and step once; step 0 of a batch before its others.
 * mesh_build_end() - when all is built: sets facts->flat and facts->inverted, and fills the
 * writer's histograms. */
CHECKED status mesh_build_take(mesh_build *b, const mesh_batches *batch, uint32_t first_step,
                               uint32_t end_step);
void mesh_build_end(const mesh_build *b, leaf_facts *facts);

/* mesh_build_keep() - save what was seen in the treelets so far, or load it. */
CHECKED status mesh_build_keep(mesh_build *b, state_io *io);

#endif
