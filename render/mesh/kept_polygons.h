/* kept_polygons.h - isopolygons that stay in memory with their treelet, where an experiment keeps
 * them (experiments/isopolygon_cache.h): resident_mesh.polygons, else NULL.
 */
#ifndef RENDER_MESH_KEPT_POLYGONS_H
#define RENDER_MESH_KEPT_POLYGONS_H

#include "render/mesh/tet_kernel.h"
#include "stream/mesh_resident.h"

typedef struct kept_polygons {
    /* Returns the isopolygon of an active tet of the treelet, or NULL if it has none. The result is
     * the kept one, or made in *own. */
    const isopolygon *(*find)(const resident_mesh *tr, uint32_t local, double isovalue,
                              isopolygon *own);
} kept_polygons;

#endif
