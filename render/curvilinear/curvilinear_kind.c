#include "render/curvilinear/curvilinear_kind.h"

#include "formats/leaf/curvilinear_geometry.h"
#include "formats/leaf/leaf_cells.h"
#include "render/curved/hex_kind.h"
#include "render/curvilinear/curvilinear_tile.h"
#include "render/curvilinear/curvilinear_walk.h"
#include "render/ray/open_volume.h"
#include "render/walk/tree_points.h"
#include "stream/curvilinear_resident.h"

static const curvilinear_lattice *lattice_of(const treelet *at) {
    return &resident_curvilinear_of(at)->lattice;
}

static hex_block_fn kernel_of(const tracer *tr) {
    return hex_block_cells[tr->kernels->isa];
}

/* ---- An open volume ---- */

static void curvilinear_describe(const leafcast *v, uint32_t step, leafcast_info *info) {
    const curvilinear_directory *d = curvilinear_directory_of(v->file);
    info->cells = d->first[v->file->layout.treelets];
    info->nodes = 0;
    for (uint32_t z = 0; z < v->file->header.zones; z++)
        info->nodes += (uint64_t)d->zones[z][0] * d->zones[z][1] * d->zones[z][2];
    tree_describe(v, step, 1.0 / (double)info->cells, info);
}

CPU_KERNELS(tile_fn, curvilinear_tile_kernels, NULL, curvilinear_tile);

static const kind_tiles tiles = {HEX_KIND_TILES, .kernels = curvilinear_tile_kernels};

/* ---- In a treelet ---- */

static bool walk_hits(const tracer *tr, const treelet *at, const ray *r, trace_state *state,
                      ray_counters *counters) {
    return curvilinear_walk_hits(lattice_of(at), kernel_of(tr), &tr->isos, r, state, counters,
                                 NULL);
}

static void walk_pieces(const tracer *tr, const treelet *at, const ray *r, const hit *after,
                        segments_state *state, ray_counters *counters) {
    curvilinear_walk_hold(lattice_of(at), kernel_of(tr), at->id, tr->above, hex_kind_tolerance(tr),
                          r, after, state, counters);
}

static void walk_extremes(const tracer *tr, const treelet *at, const ray *r, const ray *part,
                          extreme_state *s, ray_counters *counters) {
    curvilinear_walk_extremes(lattice_of(at), kernel_of(tr), at->id, hex_kind_tolerance(tr), r,
                              part, s, counters);
}

static const treelet_walks curvilinear_walks = {walk_hits, walk_pieces, walk_extremes};

static void curvilinear_gradient(const tracer *tr, const treelet *at, const ray *r,
                                 const segment *s, segment_gradient *out) {
    const curvilinear_lattice *l = lattice_of(at);
    const curved_cell c = curvilinear_walk_hexahedron(l, (uint32_t)(s->cell - l->first));
    (void)tr;
    hex_walk_gradient(&c, r, s, out);
}

/* ---- Cells ---- */

/* In its zone. */
static int curvilinear_cell_indices(const leafcast *v, uint32_t level, uint64_t number,
                                    uint32_t index[3]) {
    const curvilinear_directory *d = curvilinear_directory_of(v->file);
    const uint32_t treelets = v->file->layout.treelets;
    (void)level;
    if (number >= d->first[treelets])
        return 0;
    const uint32_t t = leaf_cells_treelet(d->first, treelets, number), *along = d->counts[t];
    const uint32_t n = (uint32_t)(number - d->first[t]);
    const uint32_t at[3] = {n % along[0], n / along[0] % along[1], n / (along[0] * along[1])};
    for (int a = 0; a < 3; a++)
        index[a] = d->where[t].first[a] + at[a];
    return 3;
}

/* *l: NULL on failure; *local: its number in there. */
static status find_cell(leafcast *v, uint64_t number, const curvilinear_lattice **l,
                        uint32_t *local) {
    const curvilinear_directory *d = curvilinear_directory_of(v->file);
    const uint32_t t = leaf_cells_treelet(d->first, v->file->layout.treelets, number);
    const treelet *at;
    const status st = volume_treelet(v, t, &at);
    *l = st == ST_OK ? lattice_of(at) : NULL;
    *local = (uint32_t)(number - d->first[t]);
    return st;
}

static status curvilinear_cell_of_hit(leafcast *v, const tracer *tr, const ray *r, const hit *h,
                                      leafcast_hit *out) {
    const curvilinear_lattice *l;
    uint32_t local;
    (void)tr;
    const status st = find_cell(v, h->cell, &l, &local);
    if (st == ST_OK) {
        const curved_cell c = curvilinear_walk_hexahedron(l, local);
        hex_walk_at(&c, r, h->t, out);
    }
    return st;
}

static status curvilinear_cell_corners(leafcast *v, uint32_t level, uint64_t number,
                                       leafcast_cell *out) {
    const curvilinear_lattice *l;
    uint32_t local;
    (void)level;
    const status st = find_cell(v, number, &l, &local);
    if (st == ST_OK && curvilinear_lattice_code(l, local) != HEX_NONE) {
        const curved_cell c = curvilinear_walk_hexahedron(l, local);
        hex_walk_corners(&c, out);
    }
    return st;
}

static void curvilinear_cell_in(const leafcast *v, const treelet *at, const double point[3],
                                leafcast_sample *out) {
    (void)v;
    if (curvilinear_walk_point(lattice_of(at), point, out))
        out->treelet = at->id;
}

const kind curvilinear_kind = {HEX_KIND_ROW,
                               .name = "curvilinear grid",
                               .cell = "hexahedron",
                               .describe = curvilinear_describe,
                               .inside = &curvilinear_walks,
                               .gradient = curvilinear_gradient,
                               .cell_in = curvilinear_cell_in,
                               .tiles = &tiles,
                               .cell_of_hit = curvilinear_cell_of_hit,
                               .cell_indices = curvilinear_cell_indices,
                               .cell_corners = curvilinear_cell_corners};
