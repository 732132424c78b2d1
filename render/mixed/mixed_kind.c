#include "render/mixed/mixed_kind.h"

#include "formats/base/box3.h"
#include "formats/leaf/mixed_geometry.h"
#include "render/look/box_projection.h"
#include "render/mixed/mixed_tile.h"
#include "render/mixed/mixed_walk.h"
#include "render/ray/open_volume.h"
#include "render/walk/cell_walks.h"
#include "render/walk/tree_points.h"
#include "stream/mixed_resident.h"

/* What rays need beside treelets: v->own, tr->own. */
typedef struct mixed_rays {
    double tolerance; /* what the cubic of a piece may be off */
} mixed_rays;

static const mixed_blocks *blocks_of(const treelet *at) {
    return &resident_mixed_of(at)->blocks;
}

/* ---- An open volume ---- */

static status mixed_open(leafcast *v) {
    const leaf_header *h = &v->file->header;
    mixed_rays *own = v->own = mem_zalloc(v->m, sizeof *own);
    if (!own)
        return ST_NOMEM;
    own->tolerance = hex_walk_tolerance(h->value_min, h->value_max);
    return ST_OK;
}

static void mixed_close(leafcast *v) {
    mem_free(v->m, v->own);
}

static void mixed_describe(const leafcast *v, leafcast_info *info) {
    info->cells = v->file->header.tets;
    info->nodes = v->file->header.vertices;
    tree_describe(v, 1.0 / (double)info->cells, info);
}

static void mixed_aim(leafcast *v, const leafcast_scene *scene, const struct camera *c,
                      tracer *tr) {
    (void)scene, (void)c;
    tr->own = v->own;
    box3_of_floats(v->file->header.bounds, tr->box);
}

static status mixed_project(leafcast *v, const struct camera *c, projection *out) {
    box_projection_init(out, v->file->header.bounds, c);
    return ST_OK;
}

static size_t mixed_projection_bytes(const leaf_layout *layout) {
    (void)layout;
    return 0;
}

CPU_KERNELS(tile_fn, mixed_tile_kernels, NULL, mixed_tile);

static const kind_tiles tiles = {.side = HEX_TILE,
                                 .scratch = HEX_TILE_SCRATCH,
                                 .kernels = mixed_tile_kernels,
                                 .project = mixed_project,
                                 .projection_bytes = mixed_projection_bytes};

/* ---- In a treelet ---- */

static bool walk_hits(const tracer *tr, const treelet *at, const ray *r, trace_state *state,
                      ray_counters *counters) {
    mixed_way w;
    mixed_way_begin(&w, blocks_of(at), r, &state->after, counters);
    return hex_walk_hits(&w.way, &tr->isos, state, NULL);
}

static void walk_pieces(const tracer *tr, const treelet *at, const ray *r, const hit *after,
                        segments_state *state, ray_counters *counters) {
    const mixed_rays *own = tr->own;
    mixed_way w;
    mixed_way_begin(&w, blocks_of(at), r, after, counters);
    hex_walk_hold(&w.way, at->id, tr->above, own->tolerance, state);
}

static void walk_extremes(const tracer *tr, const treelet *at, const ray *r, const ray *part,
                          extreme_state *s, ray_counters *counters) {
    const mixed_rays *own = tr->own;
    const hit before = hit_from(part->t0);
    mixed_way w;
    mixed_way_begin(&w, blocks_of(at), r, &before, counters);
    hex_walk_extremes(&w.way, at->id, own->tolerance, part->t1, s);
}

static const treelet_walks mixed_walks = {walk_hits, walk_pieces, walk_extremes};

static void mixed_gradient(const tracer *tr, const treelet *at, const ray *r, const segment *s,
                           segment_gradient *out) {
    const mixed_blocks *b = blocks_of(at);
    const hex_cell c = mixed_walk_cell(b, (uint32_t)(s->cell - b->first));
    (void)tr;
    hex_walk_gradient(&c, r, s, out);
}

/* ---- Cells ---- */

static status find_cell(leafcast *v, uint64_t number, hex_cell *out) {
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
    hex_cell c;
    (void)tr;
    const status st = find_cell(v, h->cell, &c);
    if (st == ST_OK)
        hex_walk_at(&c, r, h->t, out);
    return st;
}

static status mixed_cell_corners(leafcast *v, uint32_t level, uint64_t number, leafcast_cell *out) {
    hex_cell c;
    (void)level;
    const status st = find_cell(v, number, &c);
    if (st == ST_OK)
        hex_walk_corners(&c.hexahedron, out);
    return st;
}

static void mixed_cell_in(const leafcast *v, const treelet *at, const double point[3],
                          leafcast_sample *out) {
    (void)v;
    if (mixed_walk_point(blocks_of(at), point, out))
        out->treelet = at->id;
}

static segments_error segments_error_in(const tracer *tr, const ray *r, const double range[2]) {
    const mixed_rays *own = tr->own;
    return hex_walk_error(tr->box, own->tolerance, r, range);
}

const kind mixed_kind = {.name = "mixed mesh",
                         .cell = "cell",
                         .open = mixed_open,
                         .close = mixed_close,
                         .describe = mixed_describe,
                         .check = cell_walks_check,
                         .aim = mixed_aim,
                         .walks = &tree_walks,
                         .inside = &mixed_walks,
                         .degree = 3,
                         .segments_error = segments_error_in,
                         .gradient = mixed_gradient,
                         .cell_in = mixed_cell_in,
                         .tiles = &tiles,
                         .cell_of_hit = mixed_cell_of_hit,
                         .cell_corners = mixed_cell_corners};
