#include "formats/leaf/mesh_layout.h"

#include <assert.h>

#include "formats/leaf/mesh_geometry.h"
#include "formats/mesh/mesh_refit.h"

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

static uint32_t file_bytes(const mesh_shape *s, leaf_block block) {
    switch (block) {
    case LEAF_BLOCK_TOPOLOGY: return s->topology_bytes;
    case LEAF_BLOCK_VALUES: return s->values_bytes;
    case LEAF_BLOCK_GRADIENTS: return s->gradients_bytes;
    default: return s->positions_bytes;
    }
}

static leaf_beside beside_of(const leaf_layout *l, const mesh_shape *s, leaf_block block) {
    return leaf_layout_block_beside(l, block, file_bytes(s, block), mesh_refit_scratch(s));
}

static uint32_t memory_bytes(const leaf_layout *l, const mesh_shape *s, leaf_block block) {
    const leaf_beside b = beside_of(l, s, block);
    return leaf_layout_block_bytes(&b, file_bytes(s, block));
}

uint32_t mesh_layout_payload_bytes(const leaf_layout *l, uint32_t p) {
    const mesh_shape s = mesh_leaf_shape(l->counts[p % l->treelets]);
    uint32_t index;
    return memory_bytes(l, &s, leaf_layout_block_of(l, p, &index));
}

leaf_beside mesh_layout_beside(const leaf_layout *l, uint32_t p) {
    const mesh_shape s = mesh_leaf_shape(l->counts[p % l->treelets]);
    uint32_t index;
    return beside_of(l, &s, leaf_layout_block_of(l, p, &index));
}
