#include "formats/leaf/curvilinear_geometry.h"
#include "formats/leaf/grid_geometry.h"
#include "formats/leaf/leaf_geometry.h"
#include "formats/leaf/mesh_geometry.h"
#include "formats/leaf/mixed_geometry.h"
#include "formats/leaf/triangle_geometry.h"

const leaf_geometry *leaf_geometry_of(uint32_t kind) {
    static const leaf_geometry *const geometries[] = {
        [LEAF_KIND_GRID] = &grid_geometry,
        [LEAF_KIND_MESH] = &mesh_geometry,
        [LEAF_KIND_CURVILINEAR] = &curvilinear_geometry,
        [LEAF_KIND_MIXED] = &mixed_geometry,
        [LEAF_KIND_TRIANGLES] = &triangle_geometry,
        [LEAF_KIND_HEIGHTS] = &grid_geometry,
    };
    return kind < sizeof geometries / sizeof *geometries ? geometries[kind] : NULL;
}
