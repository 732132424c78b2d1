/* isopolygon_cache.h - isopolygons that stay in memory with their treelet: W07 4.4.
 *
 *   on the fly    nothing is kept: made whenever rays come to a tet
 *   precomputed   all of them are made with the treelet's masks
 *   cached        made by whichever ray first comes to a tet, and kept
 *
 * Derived data of a resident treelet, in its own block and within the budget. There is room for 1 /
 * KEPT_SHARE of its tets; all others are made on the fly. The pictures have the same bits in any
 * case.
 *
 * A cache takes no locks. A polygon's state goes EMPTY -> MAKING -> THERE. Whoever finds it EMPTY
 * stores the polygon that it has made for itself anyway. The others make their own until the state
 * is THERE.
 */
#ifndef RENDER_MESH_ISOPOLYGON_CACHE_H
#define RENDER_MESH_ISOPOLYGON_CACHE_H

#include "render/mesh/kept_polygons.h"
#include "stream/mesh_resident.h"

enum { KEPT_SHARE = 3 };

/* Returns what a loader has to derive: isopolygons, precomputed or else cached. */
mesh_derived isopolygon_cache_kind(bool precomputed);

/* isopolygon_cache_find() - kept_polygons.find; without kept polygons it is made in *own. */
const isopolygon *isopolygon_cache_find(const resident_mesh *tr, uint32_t local, double isovalue,
                                        isopolygon *own);

#endif
