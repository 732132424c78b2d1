/* mixed_block_template.h - a block of cells as seen by a tile: which pixels they can cover;
 * included by the units of an ISA (see formats/base/simd.h).
 */
#ifndef RENDER_MIXED_MIXED_BLOCK_TEMPLATE_H
#define RENDER_MIXED_MIXED_BLOCK_TEMPLATE_H

#include "formats/base/simd.h"

#ifdef SIMD_NAME

#include "render/mixed/mixed_walk.h"
#include "stream/mixed_resident.h"

static curved_cell hex_tile_cell(const treelet *at, uint32_t local) {
    return mixed_walk_cell(&resident_mixed_of(at)->blocks, local);
}

static uint64_t hex_tile_first(const treelet *at) {
    return resident_mixed_of(at)->blocks.first;
}

static const treelet_tree *hex_tile_tree(const treelet *at) {
    return &resident_mixed_of(at)->blocks.tree;
}

#include "render/curved/hex_tile_cells_template.h"

/* Active cells of a block, and what they can cover. */
typedef struct mixed_covers {
    unsigned count;
    uint8_t cell[MIXED_BLOCK]; /* in the block */
    _Alignas(64) float corner[3][CELL_ROW][MIXED_BLOCK];
    int points; /* of each cell: what it is in the hull of */
    tile_rect rect[MIXED_BLOCK];
    _Alignas(64) float depth[MIXED_BLOCK];
    uint32_t alive; /* a bit for each that covers something */
} mixed_covers;

/* A quadratic tet lies in the hull of its coefficients; those of edges take the place of their
 * nodes. */
static void gather_controls(mixed_covers *c, unsigned n) {
    for (int e = 0; e < QUADRATIC_EDGES; e++)
        for (int a = 0; a < 3; a++) {
            const float *end = c->corner[a][quadratic_edge(e)[0]],
                        *other = c->corner[a][quadratic_edge(e)[1]];
            float *between = &c->corner[a][QUADRATIC_CORNERS + e][n];
            *between = 2.0f * *between - 0.5f * (end[n] + other[n]);
        }
}

/* Positions are relative to the block's lower corner. The last cell stands for those that are not
 * there. */
static void gather_corners(const mixed_blocks *b, uint32_t block, mixed_covers *c) {
    const float *bounds = b->tree.bounds[0][block];
    c->count = 0;
    c->points = (int)b->shape.width;
    for (uint32_t left = b->active[block]; left; left &= left - 1)
        c->cell[c->count++] = (uint8_t)__builtin_ctz(left);
    for (unsigned n = 0; n < MIXED_BLOCK; n++) {
        const unsigned of = c->cell[n < c->count ? n : c->count - 1];
        const uint32_t at = MIXED_BLOCK * block + of;
        const uint16_t *row = b->rows + (size_t)b->shape.width * at;
        for (int k = 0; k < c->points; k++)
            for (int a = 0; a < 3; a++)
                c->corner[a][k][n] = b->p[a][row[k]] - bounds[a];
        if (mixed_blocks_is_quadratic(b, at))
            gather_controls(c, n);
    }
}

/* Extend by a corner of VF_N cells. eye: from the block's lower corner. */
SIMD void extend_by_corner(const projection *p, const mixed_covers *c, int corner, unsigned n,
                           const float eye[3], children_extent *e) {
    vf sum[3] = {f_set(0.0f), f_set(0.0f), f_set(0.0f)};
    for (int a = 0; a < 3; a++) {
        const vf q = f_load(c->corner[a][corner] + n) - f_set(eye[a]);
        for (int k = 0; k < 3; k++)
            sum[k] = sum[k] + f_set(p->axis[a][k]) * q;
    }
    extend(e, sum[0], sum[1], sum[2]);
}

/* A cell is in the convex hull of its points. Errors are a few units of 2^-24 of the distance and
 * of the block's size. One nearer than a sixteenth of the bound on distances counts as covering all
 * of the block's pixels. */
static void find_covers(const hex_tile *w, const float bounds[6], const tile_rect *within,
                        mixed_covers *c) {
    const projection *p = w->b.view.p;
    const rect_lanes all = rect_lanes_of(within);
    float eye[3], far = 0.0f;
    c->alive = 0;
    for (int a = 0; a < 3; a++) {
        eye[a] = (float)(w->b.eye[a] - (double)bounds[a]);
        far += p->axis[a][3] * (fabsf(eye[a]) + 2.0f * (bounds[a + 3] - bounds[a]));
    }
    for (unsigned n = 0; n < MIXED_BLOCK; n += VF_N) {
        const vf most = f_set(INFINITY), least = f_set(-INFINITY);
        children_extent e = {most, least, most, least, most, least};
        for (int corner = 0; corner < c->points; corner++)
            extend_by_corner(p, c, corner, n, eye, &e);
        mf alive;
        const mf whole = mf_of_bits(~mf_bits(f_ge(e.w0, f_set(far * projection_depth_share))));
        const vi packed = rects_of_extent(&w->b.view, &e, 2.0f * p->margin, whole, all, &alive);
        memcpy(c->rect + n, &packed, sizeof packed);
        f_store(c->depth + n, f_select(whole, f_set(0.0f), e.w0 - f_set(0x1p-19f * far)));
        c->alive |= (mf_bits(alive) & ((1u << VF_N) - 1u)) << n;
    }
    c->alive &= (1u << c->count) - 1u;
}

/* Walk the active cells of a block that cover pixels, near ones first. */
static void hex_walk_block(void *work, const tile_pending *p) {
    hex_tile *w = work;
    const mixed_blocks *b = &resident_mixed_of(w->at)->blocks;
    mixed_covers covers;
    unsigned count = 0;
    uint8_t order[MIXED_BLOCK];
    near_cell cell;
    gather_corners(b, p->i, &covers);
    find_covers(w, b->tree.bounds[0][p->i], &p->rect, &covers);
    for (uint32_t left = covers.alive; left; left &= left - 1) {
        const unsigned n = (unsigned)__builtin_ctz(left);
        unsigned at = count++;
        for (; at > 0 && covers.depth[order[at - 1]] > covers.depth[n]; at--)
            order[at] = order[at - 1];
        order[at] = (uint8_t)n;
    }
    for (unsigned k = 0; k < count; k++) {
        cell.depth = covers.depth[order[k]];
        cell.rect = covers.rect[order[k]];
        cell.number = MIXED_BLOCK * p->i + covers.cell[order[k]];
        if (in_sight(&w->b, cell.rect, cell.depth * cell.depth))
            walk_cell(w, &cell);
    }
}

#endif
#endif
