#include "render/curvilinear/curvilinear_kind.h"
#include "render/grid/grid_kind.h"
#include "render/heights/heights_kind.h"
#include "render/mesh/mesh_kind.h"
#include "render/mixed/mixed_kind.h"
#include "render/triangle/triangle_kind.h"

const kind *kind_of(const leaf_file *f) {
    static const kind *const kinds[] = {
        [LEAF_KIND_GRID] = &grid_kind,
        [LEAF_KIND_MESH] = &mesh_kind,
        [LEAF_KIND_CURVILINEAR] = &curvilinear_kind,
        [LEAF_KIND_MIXED] = &mixed_kind,
        [LEAF_KIND_TRIANGLES] = &triangle_kind,
        [LEAF_KIND_HEIGHTS] = &heights_kind,
    };
    return kinds[f->header.kind];
}
