#include "render/curvilinear/curvilinear_kind.h"

#include <float.h>

#include "formats/base/box3.h"
#include "formats/base/vec3.h"
#include "formats/leaf/curvilinear_geometry.h"
#include "render/curved/hex_point.h"
#include "render/curvilinear/curvilinear_tile.h"
#include "render/curvilinear/curvilinear_walk.h"
#include "render/look/box_projection.h"
#include "render/ray/open_volume.h"
#include "render/walk/cell_walks.h"
#include "render/walk/tree_pieces.h"
#include "render/walk/tree_points.h"
#include "stream/curvilinear_resident.h"

/* What rays need beside treelets: v->own, tr->own. */
typedef struct curvilinear_rays {
    double tolerance; /* what the cubic of a piece may be off */
} curvilinear_rays;

static const curvilinear_lattice *lattice_of(const treelet *at) {
    return &resident_curvilinear_of(at)->lattice;
}

static hex_block_fn kernel_of(const tracer *tr) {
    return hex_block_cells[tr->kernels->isa];
}

/* ---- An open volume ---- */

static status curvilinear_open(leafcast *v) {
    const leaf_header *h = &v->file->header;
    const double range = h->value_max - h->value_min;
    curvilinear_rays *own = v->own = mem_zalloc(v->m, sizeof *own);
    if (!own)
        return ST_NOMEM;
    /* A picture shows steps of 2^-8. Of nothing but one value, or none, all pieces are exact. */
    own->tolerance = range > 0.0 ? 0x1p-22 * range : 1.0;
    return ST_OK;
}

static void curvilinear_close(leafcast *v) {
    mem_free(v->m, v->own);
}

static void curvilinear_describe(const leafcast *v, leafcast_info *info) {
    const curvilinear_directory *d = curvilinear_directory_of(v->file);
    info->cells = d->first[v->file->layout.treelets];
    info->nodes = 0;
    for (uint32_t z = 0; z < v->file->header.zones; z++)
        info->nodes += (uint64_t)d->zones[z][0] * d->zones[z][1] * d->zones[z][2];
    tree_describe(v, 1.0 / (double)info->cells, info);
}

static void curvilinear_aim(leafcast *v, const leafcast_scene *scene, const struct camera *c,
                            tracer *tr) {
    (void)scene, (void)c;
    tr->own = v->own;
    box3_of_floats(v->file->header.bounds, tr->box);
}

static status curvilinear_project(leafcast *v, const struct camera *c, projection *out) {
    box_projection_init(out, v->file->header.bounds, c);
    return ST_OK;
}

static size_t curvilinear_projection_bytes(const leaf_layout *layout) {
    (void)layout;
    return 0;
}

CPU_KERNELS(tile_fn, curvilinear_tile_kernels, NULL, curvilinear_tile);

static const kind_tiles tiles = {.side = CURVILINEAR_TILE,
                                 .scratch = CURVILINEAR_TILE_SCRATCH,
                                 .kernels = curvilinear_tile_kernels,
                                 .project = curvilinear_project,
                                 .projection_bytes = curvilinear_projection_bytes};

/* ---- In a treelet ---- */

static bool walk_hits(const tracer *tr, const treelet *at, const ray *r, trace_state *state,
                      ray_counters *counters) {
    return curvilinear_walk_hits(lattice_of(at), kernel_of(tr), &tr->isos, r, state, counters,
                                 NULL);
}

typedef struct piece_taker {
    segments_state *state;
    uint32_t treelet;
} piece_taker;

static void hold_piece(void *ctx, const segment *piece) {
    const piece_taker *to = ctx;
    segment s = *piece;
    s.treelet = to->treelet;
    tree_pieces_hold(to->state, &s);
}

static void walk_pieces(const tracer *tr, const treelet *at, const ray *r, const hit *after,
                        segments_state *state, ray_counters *counters) {
    const curvilinear_rays *own = tr->own;
    piece_taker to = {state, at->id};
    curvilinear_walk_pieces(lattice_of(at), kernel_of(tr), tr->above, own->tolerance, r, after,
                            state->limit.t0, hold_piece, &to, counters, NULL);
}

typedef struct extreme_taker {
    extreme_state *state;
    uint32_t treelet;
} extreme_taker;

static void offer_piece(void *ctx, const segment *piece) {
    const extreme_taker *to = ctx;
    const segment_extent e = segment_range(piece);
    extreme_offer(to->state, to->state->least ? -e.least : e.most,
                  to->state->least ? e.least_t : e.most_t, to->treelet);
}

static void walk_extremes(const tracer *tr, const treelet *at, const ray *r, const ray *part,
                          extreme_state *s, ray_counters *counters) {
    const curvilinear_rays *own = tr->own;
    const hit before = hit_from(part->t0);
    extreme_taker to = {s, at->id};
    curvilinear_walk_pieces(lattice_of(at), kernel_of(tr), 0.0, own->tolerance, r, &before,
                            part->t1, offer_piece, &to, counters, NULL);
}

static const treelet_walks curvilinear_walks = {walk_hits, walk_pieces, walk_extremes};

/* Where rounding puts a point beside the cell, the cell's middle stands in. */
static void locate(const hexahedron *h, int sense, const double point[3], double at[3]) {
    double value;
    if (!hex_point_find(h, sense, point, at, &value))
        at[0] = at[1] = at[2] = 0.5;
}

static void curvilinear_gradient(const tracer *tr, const treelet *at, const ray *r,
                                 const segment *s, segment_gradient *out) {
    const curvilinear_lattice *l = lattice_of(at);
    const uint32_t index = (uint32_t)(s->cell - l->first);
    const hexahedron h = curvilinear_walk_cell(l, index);
    double b[3][4];
    (void)tr;
    for (int i = 0; i < 4; i++) {
        const double t = segment_t(s, i / 3.0);
        double point[3], own[3], gradient[3];
        for (int a = 0; a < 3; a++)
            point[a] = r->o[a] + t * r->d[a];
        locate(&h, curvilinear_walk_sense(l, index), point, own);
        (void)hex_point_gradient(&h, own, gradient);
        for (int a = 0; a < 3; a++)
            b[a][i] = gradient[a];
    }
    *out = segment_gradient_through((const double(*)[4])b);
}

/* ---- Cells ---- */

static uint32_t treelet_of_cell(const curvilinear_directory *d, uint32_t treelets,
                                uint64_t number) {
    uint32_t lo = 0, hi = treelets;
    while (hi - lo > 1) {
        const uint32_t middle = lo + (hi - lo) / 2;
        if (d->first[middle] <= number)
            lo = middle;
        else
            hi = middle;
    }
    return lo;
}

/* In its zone. */
static int curvilinear_cell_indices(const leafcast *v, uint32_t level, uint64_t number,
                                    uint32_t index[3]) {
    const curvilinear_directory *d = curvilinear_directory_of(v->file);
    const uint32_t treelets = v->file->layout.treelets;
    (void)level;
    if (number >= d->first[treelets])
        return 0;
    const uint32_t t = treelet_of_cell(d, treelets, number), *along = d->counts[t];
    const uint32_t n = (uint32_t)(number - d->first[t]);
    const uint32_t at[3] = {n % along[0], n / along[0] % along[1], n / (along[0] * along[1])};
    for (int a = 0; a < 3; a++)
        index[a] = d->where[t].first[a] + at[a];
    return 3;
}

/* The cell of a number, and its hexahedron_sense(). */
static status find_cell(leafcast *v, uint64_t number, hexahedron *out, int *sense) {
    const curvilinear_directory *d = curvilinear_directory_of(v->file);
    const uint32_t t = treelet_of_cell(d, v->file->layout.treelets, number);
    const treelet *at;
    const status st = volume_treelet(v, t, &at);
    if (st != ST_OK)
        return st;
    const uint32_t index = (uint32_t)(number - d->first[t]);
    *out = curvilinear_walk_cell(lattice_of(at), index);
    *sense = curvilinear_walk_sense(lattice_of(at), index);
    return ST_OK;
}

static status curvilinear_cell_of_hit(leafcast *v, const tracer *tr, const ray *r, const hit *h,
                                      leafcast_hit *out) {
    hexahedron x;
    int sense;
    double point[3];
    (void)tr;
    const status st = find_cell(v, h->cell, &x, &sense);
    if (st != ST_OK)
        return st;
    for (int a = 0; a < 3; a++)
        point[a] = r->o[a] + h->t * r->d[a];
    locate(&x, sense, point, out->at);
    out->flat = sense == 0;
    return ST_OK;
}

static status curvilinear_cell_corners(leafcast *v, uint32_t level, uint64_t number,
                                       leafcast_cell *out) {
    hexahedron x;
    int sense;
    (void)level;
    const status st = find_cell(v, number, &x, &sense);
    if (st != ST_OK)
        return st;
    out->corners = HEX_CORNERS;
    for (int c = 0; c < HEX_CORNERS; c++) {
        out->value[c] = (float)x.value[c];
        for (int a = 0; a < 3; a++)
            out->position[c][a] = x.p[c][a];
    }
    return ST_OK;
}

static void curvilinear_cell_in(const leafcast *v, const treelet *at, const double point[3],
                                leafcast_sample *out) {
    (void)v;
    if (curvilinear_walk_point(lattice_of(at), point, out))
        out->treelet = at->id;
}

/* Values err by the tolerance and the roundings of the trilinear form, t by those of the way to the
 * cell; a face that is seen at less than 2^-20 of a right angle is not bounded. */
static segments_error segments_error_in(const tracer *tr, const ray *r, const double range[2]) {
    const curvilinear_rays *own = tr->own;
    double reach = 0.0;
    for (int a = 0; a < 3; a++)
        reach += fmax(fabs(tr->box[0][a] - r->o[a]), fabs(tr->box[1][a] - r->o[a]));
    return (segments_error){.t = 0x1p20 * 16.0 * DBL_EPSILON * reach / vec3_length(r->d),
                            .value = own->tolerance +
                                     64.0 * DBL_EPSILON * fmax(fabs(range[0]), fabs(range[1]))};
}

const kind curvilinear_kind = {.name = "curvilinear grid",
                               .cell = "hexahedron",
                               .open = curvilinear_open,
                               .close = curvilinear_close,
                               .describe = curvilinear_describe,
                               .check = cell_walks_check,
                               .aim = curvilinear_aim,
                               .walks = &tree_walks,
                               .inside = &curvilinear_walks,
                               .degree = 3,
                               .segments_error = segments_error_in,
                               .gradient = curvilinear_gradient,
                               .cell_in = curvilinear_cell_in,
                               .tiles = &tiles,
                               .cell_of_hit = curvilinear_cell_of_hit,
                               .cell_indices = curvilinear_cell_indices,
                               .cell_corners = curvilinear_cell_corners};
