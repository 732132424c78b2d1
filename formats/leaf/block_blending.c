#include "formats/leaf/block_blending.h"

#include "formats/leaf/leaf_geometry.h"

uint32_t block_blending_first_set(const leaf_layout *l) {
    return leaf_layout_moves(l) ? 1 : 0;
}

static float (*boxes_of(const leaf_file *f, uint32_t set))[6] {
    float(*all)[6] = f->geometry->section(f, LEAF_SECTION_BOUNDS);
    return all + leaf_layout_bounds(&f->layout, leaf_layout_step(&f->layout, set), 0);
}

/* A treelet's box is the blend of its boxes at both steps. It holds all blends of vertices, as they
 * are rounded: no blend turns the order of two coordinates round (blend_rows.h), so one that is not
 * below the lower planes at both steps is not below their blend. */
void block_blending_fill(leaf_file *f, uint32_t set, const uint32_t sets[2], double share) {
    if (!leaf_layout_moves(&f->layout))
        return;
    float(*const to)[6] = boxes_of(f, set);
    float(*const a)[6] = boxes_of(f->below, sets[0]), (*const b)[6] = boxes_of(f->below, sets[1]);
    for (uint32_t t = 0; t < f->layout.treelets; t++)
        for (int i = 0; i < 6; i++)
            to[t][i] = blend_sample(a[t][i], b[t][i], share) + 0.0F; /* no -0 */
}

uint32_t block_blending_set_of(const leaf_layout *l, uint32_t p) {
    uint32_t index;
    return leaf_layout_block_of(l, p, &index) == LEAF_BLOCK_TOPOLOGY ? LEAF_NO_SET : index;
}

uint32_t block_blending_alike(const leaf_layout *l, uint32_t p, const leaf_layout *of,
                              uint32_t set) {
    const uint32_t t = p % l->treelets, step = leaf_layout_step(of, set);
    uint32_t index;
    switch (leaf_layout_block_of(l, p, &index)) {
    case LEAF_BLOCK_VALUES: return leaf_layout_values(of, set, t);
    case LEAF_BLOCK_GRADIENTS: return leaf_layout_gradients(of, set, t);
    case LEAF_BLOCK_POSITIONS:
        return step > 0 ? leaf_layout_positions(of, step, t) : LEAF_NO_TREELET;
    default: return t;
    }
}

void block_blending_mix(const leaf_mix *m, const void *first, uint32_t at, size_t count) {
    m->blend(first, m->part[1] ? m->part[1] + at : NULL, m->share, (float *)(m->payload + at),
             count);
}
