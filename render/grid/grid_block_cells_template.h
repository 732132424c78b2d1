/* grid_block_cells_template.h - ray-cells of a block of 4^3 on their way to the filter; included by
 * the units of an ISA (see formats/base/simd.h).
 */
#ifndef RENDER_GRID_GRID_BLOCK_CELLS_TEMPLATE_H
#define RENDER_GRID_GRID_BLOCK_CELLS_TEMPLATE_H

#include "formats/base/simd.h"

#ifdef SIMD_NAME

#include "render/grid/grid_block_planes_template.h"
#include "render/grid/grid_ray_cells_template.h"

/* A block's ray-cells are filtered when there are RAY_CELLS or more. By then there may be a vector
 * more, and a vector behind the last one is written. */
enum { RAY_CELLS = 256, RAY_CELLS_ROOM = RAY_CELLS + 2 * VF_N };

/* Ray-cells of a block: rays by their places, cells by their number in Morton order. */
typedef struct block_cells {
    const resident_grid *at;
    uint32_t first[3];
    block_planes planes;
    unsigned count;
    uint32_t ray[RAY_CELLS_ROOM], cell[RAY_CELLS_ROOM];
    uint64_t met;   /* cells of the ray-cells that wait */
    uint64_t known; /* cells of the block whose samples have been read */
    _Alignas(32) float samples[64][8];
} block_cells;

/* block_cells_begin() - begins with the block whose first cell in its level is `first`. */
SIMD void block_cells_begin(block_cells *b, const grid_rays *g, const level_planes *planes,
                            const resident_grid *at, const uint32_t first[3]) {
    b->at = at;
    for (int a = 0; a < 3; a++)
        b->first[a] = first[a];
    b->planes = block_planes_of(g, planes, first);
    b->count = 0;
    b->met = b->known = 0;
}

/* A cell's place in its block along an axis, by its Morton number; also for a vector of numbers. */
#define MORTON_PLACE(cell, axis) (((cell) >> (axis)&1) | ((cell) >> ((axis) + 2) & 2))

static inline void block_cell_at(const block_cells *b, uint32_t number, uint32_t cell[3]) {
    for (int a = 0; a < 3; a++)
        cell[a] = b->first[a] + MORTON_PLACE(number, a);
}

/* Returns the rays that meet a cell, a bit each. */
SIMD unsigned block_cell_met(const block_met *m, uint32_t number) {
    const unsigned cell[3] = {MORTON_PLACE(number, 0), MORTON_PLACE(number, 1),
                              MORTON_PLACE(number, 2)};
    return mf_bits(f_le(block_comes(m, cell), block_leaves(m, cell)));
}

/* Put a cell with some of the VF_N rays from place `at` on, a bit each. */
SIMD void block_cells_put(block_cells *b, uint32_t number, unsigned at, unsigned rays) {
    static const uint32_t lanes[16] = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15};
    i_pack(b->ray + b->count, i_load(lanes) + i_set(at), rays);
    i_store(b->cell + b->count, i_set(number));
    b->met |= (uint64_t)(rays != 0) << number;
    b->count += (unsigned)__builtin_popcount(rays);
}

/* Read the samples of all cells that wait. Fill the lanes behind the last ray-cell with the first
 * one. */
SIMD void block_cells_complete(block_cells *b, const walk_scene *scene) {
    for (uint64_t left = b->met & ~b->known; left; left &= left - 1) {
        const uint32_t number = (uint32_t)__builtin_ctzll(left);
        uint32_t cell[3];
        block_cell_at(b, number, cell);
        walk_cell_samples(scene, b->at, cell, b->samples[number]);
    }
    b->known |= b->met;
    i_store(b->ray + b->count, i_set(b->ray[0]));
    i_store(b->cell + b->count, i_set(b->cell[0]));
}

/* Returns which of the VF_N ray-cells from `from` on may cross any of the surfaces. */
SIMD unsigned block_may_cross(const block_cells *b, const grid_rays *g, unsigned from,
                              const walk_scene *scene) {
    const vi cell = i_load(b->cell + from);
    vf lo[3], hi[3], inverse[3], s[8];
    for (int a = 0; a < 3; a++) {
        const vi place = MORTON_PLACE(cell, a);
        lo[a] = f_look_up(b->planes.lo[a], place);
        hi[a] = f_look_up(b->planes.hi[a], place);
        inverse[a] = f_look_up(b->planes.inverse[a], place);
    }
    const ray_visits v = ray_visits_of(g, b->ray + from, lo, hi, inverse);
    f_load_fours(b->samples[0], 8, b->cell + from, s);
    f_load_fours(b->samples[0] + 4, 8, b->cell + from, s + 4);
    unsigned crossing = 0;
    for (int i = 0; i < scene->count; i++) {
        const float iso = (float)scene->isovalues[i];
        vf f[8];
        for (int k = 0; k < 8; k++)
            f[k] = s[k] - f_set(iso);
        const near_forms forms = ray_cell_forms(f, v.e, f_set(2.0f * UNIT * fabsf(iso)));
        crossing |= may_cross(&v.way, &forms);
    }
    return crossing;
}

#endif
#endif
