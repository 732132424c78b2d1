#include "formats/leaf/mesh_layout.h"

#include <assert.h>

#include "formats/leaf/mesh_geometry.h"
#include "formats/mesh/mesh_leaf.h"

uint64_t mesh_layout_payloads(const mesh_layout_blocks *b) {
    const uint64_t sets = (uint64_t)b->fields * b->steps;
    return b->treelets * (1 + sets + (b->gradients ? sets : 0) + (b->moving ? b->steps - 1 : 0));
}

void mesh_layout_of(leaf_layout *l, const mesh_layout_blocks *b) {
    assert(b->treelets > 0 && b->fields > 0 && b->steps > (b->moving ? 1U : 0U));
    assert(mesh_layout_payloads(b) < LEAF_NO_TREELET);
    leaf_layout_flat(l, &mesh_geometry, b->treelets, (uint32_t)mesh_layout_payloads(b));
    l->sets = b->fields * b->steps;
    l->steps = b->steps;
    l->gradient_sets = b->gradients ? l->sets : 0;
    l->places = b->moving ? b->steps : 1;
}

bool mesh_layout_repeat(leaf_layout *l, uint32_t steps) {
    const mesh_layout_blocks b = {.treelets = l->treelets,
                                  .fields = l->sets / l->steps,
                                  .steps = steps,
                                  .gradients = l->gradient_sets > 0};
    const uint64_t payloads = mesh_layout_payloads(&b);
    l->sets = b.fields * steps;
    l->steps = steps;
    l->gradient_sets = b.gradients ? l->sets : 0;
    l->payloads = (uint32_t)payloads;
    return payloads < LEAF_NO_TREELET;
}

status mesh_layout_init(leaf_layout *l, mem *m, const mesh_layout_blocks *b) {
    mesh_layout_of(l, b);
    return leaf_layout_init_flat(l, m);
}

void mesh_layout_set_counts(leaf_layout *l, const uint32_t (*counts)[4]) {
    l->counts = counts;
    l->payload_max = 0;
    for (uint32_t t = 0; t < l->treelets; t++) {
        const mesh_shape s = mesh_leaf_shape(counts[t]);
        l->payload_max = s.topology_bytes > l->payload_max ? s.topology_bytes : l->payload_max;
        assert(s.values_bytes <= s.topology_bytes && s.gradients_bytes <= s.topology_bytes &&
               s.positions_bytes <= s.topology_bytes);
    }
}
