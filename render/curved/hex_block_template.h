/* hex_block_template.h - hex_block_cells with vectors: a row of nodes in one, two or three. The
 * same bits.
 */
#ifndef RENDER_CURVED_HEX_BLOCK_TEMPLATE_H
#define RENDER_CURVED_HEX_BLOCK_TEMPLATE_H

#include "formats/base/simd.h"
#include "render/curved/hex_block_sides.h"

__typeof__(*(hex_block_fn)NULL) hex_block_sse42, hex_block_avx2, hex_block_avx512;

#ifdef SIMD_NAME

/* The ray, in vectors; axes in its own order. */
typedef struct wide_ray {
    vd o[3], slope[2];
    int axis[3];
} wide_ray;

SIMD wide_ray widen(const sheared_ray *r) {
    return (wide_ray){{d_set(r->o[r->axis[0]]), d_set(r->o[r->axis[1]]), d_set(r->o[r->axis[2]])},
                      {d_set(r->slope[0]), d_set(r->slope[1])},
                      {r->axis[0], r->axis[1], r->axis[2]}};
}

/* The sides of VD_N nodes. */
SIMD void add_sides(const hex_block *b, uint32_t at, unsigned bit, const wide_ray *r,
                    hex_block_sides *s) {
    const vd along = d_of_floats(b->p[r->axis[2]] + at) - r->o[2], zero = d_set(0.0);
    const vd x = (d_of_floats(b->p[r->axis[0]] + at) - r->o[0]) - r->slope[0] * along;
    const vd y = (d_of_floats(b->p[r->axis[1]] + at) - r->o[1]) - r->slope[1] * along;
    s->above |= (uint64_t)md_bits(d_ge(y, zero)) << bit;
    s->right |= (uint64_t)md_bits(d_gt(x, zero)) << bit;
    s->left |= (uint64_t)md_bits(d_lt(x, zero)) << bit;
}

/* Bits of what is read behind a row's nodes are looked at by no cell. */
SIMD hex_block_sides sides_of(const hex_block *b, uint32_t k, const wide_ray *r) {
    hex_block_sides s = {0, 0, 0};
    for (uint32_t j = 0; j <= b->cells[1]; j++)
        for (unsigned i = 0; i <= b->cells[0]; i += VD_N)
            add_sides(b, i + b->row * j + b->slab * k, i + 8 * j, r, &s);
    return s;
}

uint64_t SIMD_NAME(hex_block)(const hex_block *b, const sheared_ray *r) {
    const wide_ray wide = widen(r);
    hex_block_sides below = sides_of(b, 0, &wide);
    uint64_t out = 0;
    for (uint32_t k = 0; k < b->cells[2]; k++) {
        const hex_block_sides above = sides_of(b, k + 1, &wide);
        out |= hex_block_between(&below, &above, b->cells) << HEX_BLOCK * HEX_BLOCK * k;
        below = above;
    }
    return out;
}

#endif
#endif
