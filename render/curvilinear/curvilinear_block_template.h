/* curvilinear_block_template.h - a block of 4^3 cells as seen by a tile: which pixels its cells can
 * cover; included by the units of an ISA (see formats/base/simd.h).
 */
#ifndef RENDER_CURVILINEAR_CURVILINEAR_BLOCK_TEMPLATE_H
#define RENDER_CURVILINEAR_CURVILINEAR_BLOCK_TEMPLATE_H

#include "formats/base/simd.h"

#ifdef SIMD_NAME

#include "render/curvilinear/curvilinear_walk.h"
#include "stream/curvilinear_resident.h"

static curved_cell hex_tile_cell(const treelet *at, uint32_t local) {
    return curvilinear_walk_hexahedron(&resident_curvilinear_of(at)->lattice, local);
}

static uint64_t hex_tile_first(const treelet *at) {
    return resident_curvilinear_of(at)->lattice.first;
}

static const treelet_tree *hex_tile_tree(const treelet *at) {
    return &resident_curvilinear_of(at)->lattice.tree;
}

#include "render/curved/hex_tile_cells_template.h"

static const curvilinear_lattice *lattice_of_tile(const hex_tile *w) {
    return &resident_curvilinear_of(w->at)->lattice;
}

/* Node (i, j, k), and cell (i, j, k), is at i + BLOCK_J j + BLOCK_K k. */
enum {
    BLOCK_J = CURVILINEAR_READ,
    BLOCK_K = BLOCK_J * (CURVILINEAR_BLOCK + 1),
    BLOCK_NODES = BLOCK_K * (CURVILINEAR_BLOCK + 1),
    BLOCK_CELLS = BLOCK_K * (CURVILINEAR_BLOCK - 1) + BLOCK_J * CURVILINEAR_BLOCK,
    BLOCK_ROOM = BLOCK_NODES + BLOCK_K + BLOCK_J + 32 /* what vectors read behind them */
};

/* A number of each node or cell. */
typedef struct block_plane {
    _Alignas(64) float of[BLOCK_ROOM];
} block_plane;

/* A block's nodes from the eye, relative to the picture: x / w, y / w, w. */
typedef struct block_view {
    block_plane node[3];
    float far; /* bound of the nodes' distances */
} block_view;

/* Positions, and the eye's in double, are relative to the block's lower corner. So errors are a few
 * units of 2^-24 of the distance and of the block's size. Rows and slabs that are not there repeat
 * the last; what is read behind a row belongs to no cell. */
static void view_block(const hex_tile *w, uint32_t block, block_view *v) {
    const curvilinear_lattice *l = lattice_of_tile(w);
    const curvilinear_place *place = &l->places[block];
    const float *bounds = l->tree.bounds[0][block];
    const projection *p = w->b.view.p;
    const uint32_t first = curvilinear_lattice_node(l, place);
    block_plane at[3];
    float eye[3];
    v->far = 0.0f;
    for (int a = 0; a < 3; a++) {
        const float size = bounds[a + 3] - bounds[a];
        eye[a] = (float)(w->b.eye[a] - (double)bounds[a]);
        v->far += p->axis[a][3] * (fabsf(eye[a]) + 2.0f * size);
        for (uint32_t k = 0; k <= CURVILINEAR_BLOCK; k++)
            for (uint32_t j = 0; j <= CURVILINEAR_BLOCK; j++) {
                const uint32_t of[2] = {j < place->cells[1] ? j : place->cells[1],
                                        k < place->cells[2] ? k : place->cells[2]};
                memcpy(at[a].of + BLOCK_J * j + BLOCK_K * k,
                       l->p[a] + first + l->nodes[0] * (of[0] + l->nodes[1] * of[1]),
                       CURVILINEAR_READ * sizeof(float));
            }
    }
    for (unsigned n = 0; n < BLOCK_NODES; n += VF_N) {
        vf sum[3] = {f_set(0.0f), f_set(0.0f), f_set(0.0f)};
        for (int a = 0; a < 3; a++) {
            const vf q = (f_load(at[a].of + n) - f_set(bounds[a])) - f_set(eye[a]);
            for (int k = 0; k < 3; k++)
                sum[k] = sum[k] + f_set(p->axis[a][k]) * q;
        }
        const vf r = f_reciprocal(sum[2]);
        f_store(v->node[0].of + n, sum[0] * r);
        f_store(v->node[1].of + n, sum[1] * r);
        f_store(v->node[2].of + n, sum[2]);
    }
}

/* The least and the greatest number among a cell's corners. */
SIMD void corner_range(const float *node, vf *lo, vf *hi) {
    *lo = *hi = f_load(node);
    for (unsigned c = 1; c < HEX_CORNERS; c++) {
        const vf x = f_load(node + (c & 1) + BLOCK_J * (c >> 1 & 1) + BLOCK_K * (c >> 2));
        *lo = f_min(*lo, x);
        *hi = f_max(*hi, x);
    }
}

/* What cells can cover. */
typedef struct block_covers {
    tile_rect rect[BLOCK_CELLS + 32];
    block_plane depth;
    uint64_t alive; /* as curvilinear_lattice.active */
} block_covers;

/* A cell is in the convex hull of its corners. One nearer than a sixteenth of the bound on
 * distances counts as covering all of the block's pixels. */
static void find_covers(const hex_tile *w, const block_view *v, const tile_rect *within,
                        block_covers *out) {
    const rect_lanes all = rect_lanes_of(within);
    out->alive = 0;
    for (unsigned n = 0; n < BLOCK_CELLS; n += VF_N) {
        children_extent e;
        vf deepest;
        mf alive;
        corner_range(v->node[0].of + n, &e.x0, &e.x1);
        corner_range(v->node[1].of + n, &e.y0, &e.y1);
        corner_range(v->node[2].of + n, &e.w0, &deepest);
        const mf whole = mf_of_bits(~mf_bits(f_ge(e.w0, f_set(v->far * projection_depth_share))));
        const vi packed =
            rects_of_extent(&w->b.view, &e, 2.0f * w->b.view.p->margin, whole, all, &alive);
        memcpy(out->rect + n, &packed, sizeof packed);
        f_store(out->depth.of + n, f_select(whole, f_set(0.0f), e.w0 - f_set(0x1p-19f * v->far)));
        for (unsigned at = n; at < n + VF_N; at += 4) {
            const unsigned j = at % BLOCK_K / BLOCK_J, k = at / BLOCK_K;
            if (at % BLOCK_J < CURVILINEAR_BLOCK && j < CURVILINEAR_BLOCK && k < CURVILINEAR_BLOCK)
                out->alive |= (uint64_t)(mf_bits(alive) >> (at - n) & 15u) << (4 * j + 16 * k);
        }
    }
}

/* Walk the active cells of a block that cover pixels, near ones first. */
static void hex_walk_block(void *work, const tile_pending *p) {
    hex_tile *w = work;
    const curvilinear_lattice *l = lattice_of_tile(w);
    block_view view;
    block_covers covers;
    unsigned count = 0;
    uint8_t order[64];
    near_cell cell;
    view_block(w, p->i, &view);
    find_covers(w, &view, &p->rect, &covers);
    for (uint64_t left = l->active[p->i] & covers.alive; left; left &= left - 1) {
        const unsigned bit = (unsigned)__builtin_ctzll(left);
        const unsigned n = (bit & 3) + BLOCK_J * (bit >> 2 & 3) + BLOCK_K * (bit >> 4);
        unsigned at = count++;
        covers.depth.of[bit] = covers.depth.of[n];
        covers.rect[bit] = covers.rect[n];
        for (; at > 0 && covers.depth.of[order[at - 1]] > covers.depth.of[bit]; at--)
            order[at] = order[at - 1];
        order[at] = (uint8_t)bit;
    }
    for (unsigned k = 0; k < count; k++) {
        cell.depth = covers.depth.of[order[k]];
        cell.rect = covers.rect[order[k]];
        cell.number = curvilinear_lattice_cell(l, &l->places[p->i], order[k]);
        if (in_sight(&w->b, cell.rect, cell.depth * cell.depth))
            walk_cell(w, &cell);
    }
}

#endif
#endif
