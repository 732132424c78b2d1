/* grid_block_planes_template.h - the planes between a block's cells, 4^3 of them: where rays of a
 * batch come into the cells, and leave them; included by the units of an ISA (see
 * formats/base/simd.h).
 */
#ifndef RENDER_GRID_GRID_BLOCK_PLANES_TEMPLATE_H
#define RENDER_GRID_GRID_BLOCK_PLANES_TEMPLATE_H

#include "formats/base/simd.h"

#ifdef SIMD_NAME

#include "render/grid/grid_rays_template.h"
#include "render/grid/walk.h"

/* By place along each axis: a cell's planes, counted from the rays' middle, and 1 / their distance.
 * Rays enter by the plane `near` and leave by `far`. */
typedef struct block_planes {
    float lo[3][BLOCK_SIDE], hi[3][BLOCK_SIDE], inverse[3][BLOCK_SIDE];
    float near[3][BLOCK_SIDE], far[3][BLOCK_SIDE];
} block_planes;

SIMD block_planes block_planes_of(const grid_rays *g, const level_planes *planes,
                                  const uint32_t first[3]) {
    block_planes b;
    for (int a = 0; a < 3; a++) {
        const double *at = planes->at[a] + first[a], *inverse = planes->inverse[a] + first[a];
        const bool back = g->back >> a & 1u;
        for (int i = 0; i < BLOCK_SIDE; i++) {
            b.lo[a][i] = (float)(at[i] - g->middle[a]);
            b.hi[a][i] = (float)(at[i + 1] - g->middle[a]);
            b.inverse[a][i] = (float)inverse[i];
            b.near[a][i] = back ? b.hi[a][i] : b.lo[a][i];
            b.far[a][i] = back ? b.lo[a][i] : b.hi[a][i];
        }
    }
    return b;
}

/* t where VF_N rays enter and leave the cells, along each axis. */
typedef struct block_met {
    vf near[3][BLOCK_SIDE], far[3][BLOCK_SIDE];
} block_met;

SIMD block_met block_met_of(const ray_slabs *rays, unsigned at, const block_planes *planes) {
    block_met m;
    slabs_meet(rays, at, BLOCK_SIDE, planes->near[0], planes->far[0], m.near[0], m.far[0]);
    return m;
}

/* block_comes() - returns t where the rays enter a cell. block_leaves() - returns t where they
 * leave a cell. */
SIMD vf block_comes(const block_met *m, const unsigned cell[3]) {
    return f_max(f_max(m->near[2][cell[2]], m->near[1][cell[1]]), m->near[0][cell[0]]);
}
SIMD vf block_leaves(const block_met *m, const unsigned cell[3]) {
    return f_min(f_min(m->far[2][cell[2]], m->far[1][cell[1]]), m->far[0][cell[0]]);
}

#endif
#endif
