/* isopolygon_cache.h - isopolygons that stay with their treelet: W07 4.4.
 *
 *   on the fly    nothing is kept: made whenever rays come to a tet
 *   precomputed   made with the treelet's masks, all of them
 *   cached        made when rays first come to a tet, by whoever comes, and kept
 *
 * Derived data of a resident treelet, in its own block and within the budget: room for a
 * KEPT_SHARE-th of its tets; those beyond are made on the fly. The same bits in any case.
 *
 * A cache takes no locks: a polygon's state goes EMPTY -> MAKING -> THERE, whoever finds it EMPTY
 * puts what it has made for itself anyway, and the others do without until it is THERE.
 */
#ifndef RENDER_MESH_ISOPOLYGON_CACHE_H
#define RENDER_MESH_ISOPOLYGON_CACHE_H

#include "render/mesh/tet_kernel.h"
#include "stream/mesh_resident.h"

enum { KEPT_SHARE = 3 };

/* What a loader is to derive; how: precomputed, or else cached. */
mesh_derived isopolygon_cache_kind(bool precomputed);

/* isopolygon_cache_find() - the isopolygon of an active tet of the treelet, or NULL where it has
 * none. Kept, or made in *own. */
const isopolygon *isopolygon_cache_find(const resident_mesh *tr, uint32_t local, double isovalue,
                                        isopolygon *own);

#endif
