/* mesh_sah.h - orders a treelet's tets for a tree by the surface area heuristic, the yardstick for
 * the tree by Morton keys.
 *
 * Binned, as by Wald 2007: a node is cut along the axis and at the one of 15 planes between the
 * tets' centres for which the sum of box area times tets is least. The tets' new keys are their
 * paths from the root. So mesh_tree.h builds this tree instead of the other one. It still decides
 * on leaves and on nodes of 8 children.
 */
#ifndef PREP_MESH_MESH_SAH_H
#define PREP_MESH_MESH_SAH_H

#include <stddef.h>
#include <stdint.h>

#include "formats/base/mem.h"
#include "formats/base/status.h"
#include "prep/mesh/mesh_pages.h"
#include "prep/mesh/mesh_sort.h"

typedef struct mesh_sah mesh_sah;

/* mesh_sah_create() - for treelets of at most treelet_tets tets. mesh_sah_memory() - bytes it
 * takes.
 */
CHECKED status mesh_sah_create(mem *m, uint32_t treelet_tets, uint32_t leaf_tets, mesh_sah **out);
void mesh_sah_destroy(mesh_sah *s); /* NULL is fine */
uint64_t mesh_sah_memory(uint32_t treelet_tets);

/* mesh_sah_order() - *out: the records in their new order, with new keys, valid until the next
 * call. They depend on the records and points alone. Fails only if reading points does. */
CHECKED status mesh_sah_order(mesh_sah *s, const mesh_record *records, size_t count,
                              mesh_pages *points, const mesh_record **out);

#endif
