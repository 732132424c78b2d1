#include "render/mixed/mixed_kind.h"

#include "formats/leaf/mixed_geometry.h"
#include "render/curved/hex_kind.h"
#include "render/mixed/mixed_tile.h"
#include "render/mixed/mixed_walk.h"
#include "render/ray/open_volume.h"
#include "render/walk/tree_points.h"
#include "stream/mixed_resident.h"

static const mixed_blocks *blocks_of(const treelet *at) {
    return &resident_mixed_of(at)->blocks;
}

/* ---- An open volume ---- */

static void mixed_describe(const leafcast *v, uint32_t step, leafcast_info *info) {
    info->cells = v->file->header.tets;
    info->nodes = v->file->header.vertices;
    tree_describe(v, step, 1.0 / (double)info->cells, info);
}

CPU_KERNELS(tile_fn, mixed_tile_kernels, NULL, mixed_tile);

static const kind_tiles tiles = {HEX_KIND_TILES, .kernels = mixed_tile_kernels};

/* ---- In a treelet ---- */

static bool walk_hits(const tracer *tr, const treelet *at, const ray *r, trace_state *state,
                      ray_counters *counters) {
    mixed_way w;
    mixed_way_begin(&w, blocks_of(at), r, &state->after, counters);
    return hex_walk_hits(&w.way, &tr->isos, state, NULL);
}

static void walk_pieces(const tracer *tr, const treelet *at, const ray *r, const hit *after,
                        segments_state *state, ray_counters *counters) {
    mixed_way w;
    mixed_way_begin(&w, blocks_of(at), r, after, counters);
    hex_walk_hold(&w.way, at->id, tr->above, hex_kind_tolerance(tr), state);
}

static void walk_extremes(const tracer *tr, const treelet *at, const ray *r, const ray *part,
                          extreme_state *s, ray_counters *counters) {
    const hit before = hit_from(part->t0);
    mixed_way w;
    mixed_way_begin(&w, blocks_of(at), r, &before, counters);
    hex_walk_extremes(&w.way, at->id, hex_kind_tolerance(tr), part->t1, s);
}

static const treelet_walks mixed_walks = {walk_hits, walk_pieces, walk_extremes};

static void mixed_gradient(const tracer *tr, const treelet *at, const ray *r, const segment *s,
                           segment_gradient *out) {
    const mixed_blocks *b = blocks_of(at);
    const curved_cell c = mixed_walk_cell(b, (uint32_t)(s->cell - b->first));
    (void)tr;
    hex_walk_gradient(&c, r, s, out);
}

/* ---- Cells ---- */

static status find_cell(leafcast *v, uint64_t number, curved_cell *out) {
    const leaf_cells_directory *d = mixed_directory_of(v->file);
    const uint32_t t = leaf_cells_treelet(d->first, v->file->layout.treelets, number);
    const treelet *at;
    const status st = volume_treelet(v, t, &at);
    if (st == ST_OK)
        *out = mixed_walk_cell(blocks_of(at), (uint32_t)(number - d->first[t]));
    return st;
}

static status mixed_cell_of_hit(leafcast *v, const tracer *tr, const ray *r, const hit *h,
                                leafcast_hit *out) {
    curved_cell c;
    (void)tr;
    const status st = find_cell(v, h->cell, &c);
    if (st == ST_OK)
        hex_walk_at(&c, r, h->t, out);
    return st;
}

static status mixed_cell_corners(leafcast *v, uint32_t level, uint64_t number, leafcast_cell *out) {
    curved_cell c;
    (void)level;
    const status st = find_cell(v, number, &c);
    if (st == ST_OK)
        hex_walk_corners(&c, out);
    return st;
}

static void mixed_cell_in(const leafcast *v, const treelet *at, const double point[3],
                          leafcast_sample *out) {
    (void)v;
    if (mixed_walk_point(blocks_of(at), point, out))
        out->treelet = at->id;
}

const kind mixed_kind = {HEX_KIND_ROW,
                         .name = "mixed mesh",
                         .cell = "cell",
                         .describe = mixed_describe,
                         .inside = &mixed_walks,
                         .gradient = mixed_gradient,
                         .cell_in = mixed_cell_in,
                         .tiles = &tiles,
                         .cell_of_hit = mixed_cell_of_hit,
                         .cell_corners = mixed_cell_corners};
