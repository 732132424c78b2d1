#include "formats/leaf/curvilinear_facts.h"
#include "formats/leaf/grid_facts.h"
#include "formats/leaf/leaf_tell.h"
#include "formats/leaf/mesh_facts.h"
#include "formats/leaf/mixed_facts.h"
#include "formats/leaf/triangle_facts.h"

const leaf_teller *leaf_teller_of(const leaf_file *f) {
    static const leaf_teller *const tellers[] = {
        [LEAF_KIND_GRID] = &grid_facts,
        [LEAF_KIND_MESH] = &mesh_facts,
        [LEAF_KIND_CURVILINEAR] = &curvilinear_facts,
        [LEAF_KIND_MIXED] = &mixed_facts,
        [LEAF_KIND_TRIANGLES] = &triangle_facts,
        [LEAF_KIND_HEIGHTS] = &heights_facts,
    };
    const uint32_t kind = f->header.kind;
    return kind < sizeof tellers / sizeof *tellers ? tellers[kind] : &leaf_tell_other;
}
