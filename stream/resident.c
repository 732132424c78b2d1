#include "stream/resident.h"

#include "stream/curvilinear_resident.h"
#include "stream/grid_resident.h"
#include "stream/mesh_resident.h"
#include "stream/mixed_resident.h"
#include "stream/moving_resident.h"
#include "stream/triangle_resident.h"

const resident_kind *resident_kind_of(const leaf_file *f) {
    static const resident_kind *const kinds[] = {
        [LEAF_KIND_GRID] = &grid_resident,
        [LEAF_KIND_MESH] = &mesh_resident,
        [LEAF_KIND_CURVILINEAR] = &curvilinear_resident,
        [LEAF_KIND_MIXED] = &mixed_resident,
        [LEAF_KIND_TRIANGLES] = &triangle_resident,
        [LEAF_KIND_HEIGHTS] = &grid_resident,
    };
    return f->moving ? &moving_resident : kinds[f->header.kind];
}
