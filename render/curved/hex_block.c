#include "render/curved/hex_block.h"

#include "render/curved/hex_block_sides.h"

static hex_block_sides sides_of(const hex_block *b, uint32_t k, const sheared_ray *r) {
    hex_block_sides s = {0, 0, 0};
    for (uint32_t j = 0; j <= b->cells[1]; j++)
        for (uint32_t i = 0; i <= b->cells[0]; i++) {
            const uint32_t at = i + b->row * j + b->slab * k, bit = i + 8 * j;
            const double p[3] = {(double)b->p[0][at], (double)b->p[1][at], (double)b->p[2][at]};
            double q[3];
            sheared_ray_place(r, p, q);
            s.above |= (uint64_t)(q[1] >= 0.0) << bit;
            s.right |= (uint64_t)(q[0] > 0.0) << bit;
            s.left |= (uint64_t)(q[0] < 0.0) << bit;
        }
    return s;
}

static uint64_t hex_block_scalar(const hex_block *b, const sheared_ray *r) {
    hex_block_sides below = sides_of(b, 0, r);
    uint64_t out = 0;
    for (uint32_t k = 0; k < b->cells[2]; k++) {
        const hex_block_sides above = sides_of(b, k + 1, r);
        out |= hex_block_between(&below, &above, b->cells) << HEX_BLOCK * HEX_BLOCK * k;
        below = above;
    }
    return out;
}

CPU_KERNELS(hex_block_fn, hex_block_cells, hex_block_scalar, hex_block);
