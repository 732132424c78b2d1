#include "render/triangle/triangle_kind.h"

#include <math.h>
#include <string.h>

#include "formats/base/box3.h"
#include "formats/base/colour_field.h"
#include "render/look/box_projection.h"
#include "render/ray/open_volume.h"
#include "render/triangle/triangle_batch.h"
#include "render/triangle/triangle_tile.h"
#include "render/triangle/triangle_walk.h"
#include "render/walk/cell_walks.h"
#include "render/walk/tree_points.h"
#include "stream/triangle_resident.h"

static const triangle_blocks *blocks_of(const treelet *at) {
    return &resident_triangles_of(at)->blocks;
}

/* ---- An open volume ---- */

CPU_KERNELS(tile_fn, triangle_tile_kernels, NULL, triangle_tile);
CPU_KERNELS(batch_fn, triangle_batch_kernels, NULL, triangle_batch);

/* The box of what is shown. */
static const float *bounds_of(const leafcast *v) {
    return leaf_file_bounds(v->file, leaf_layout_step(&v->file->layout, v->set));
}

static status triangle_project(leafcast *v, const struct camera *c, struct projection *out) {
    box_projection_init(out, bounds_of(v), c);
    return ST_OK;
}

static size_t triangle_projection_bytes(const leaf_layout *layout) {
    (void)layout;
    return 0;
}

static const kind_tiles tiles = {.side = TRIANGLE_TILE,
                                 .scratch = TRIANGLE_TILE_SCRATCH,
                                 .colours = true,
                                 .kernels = triangle_tile_kernels,
                                 .project = triangle_project,
                                 .projection_bytes = triangle_projection_bytes};

static const kind_batches batches = {.scratch = TRIANGLE_BATCH_SCRATCH,
                                     .hits = triangle_batch_kernels};

static void triangle_describe(const leafcast *v, uint32_t step, leafcast_info *info) {
    info->cells = v->file->header.tets;
    info->nodes = v->file->header.vertices;
    info->abilities = LEAFCAST_ABILITY_GIVEN;
    tree_describe(v, step, 1.0, info);
    /* A share of the box's largest side: a surface in a plane has no other. */
    double side[3];
    for (int a = 0; a < 3; a++)
        side[a] = info->bounds[1][a] - info->bounds[0][a];
    const double area =
        fmax(side[0] * side[1], fmax(side[1] * side[2], side[2] * side[0])) / (double)info->cells;
    info->cell_size = sqrt(area);
}

/* ---- A frame ---- */

static void triangle_aim(leafcast *v, const leafcast_scene *scene, const struct camera *c,
                         tracer *tr) {
    const leaf_file *f = v->file;
    const uint32_t shown = v->set / f->layout.steps;
    (void)scene, (void)c;
    box3_of_floats(bounds_of(v), tr->box);
    /* Between two steps packed numbers are not those of colours. */
    tr->coloured = !f->below && strcmp(leaf_file_field_name(f, shown), COLOUR_FIELD) == 0;
}

/* ---- In a treelet ---- */

static bool walk_hits(const tracer *tr, const treelet *at, const ray *r, trace_state *state,
                      ray_counters *counters) {
    return triangle_walk_hits(blocks_of(at), tr->coloured, r, state, counters);
}

/* A surface has no pieces, no extremes, and holds no points. */
static void walk_pieces(const tracer *tr, const treelet *at, const ray *r, const hit *after,
                        segments_state *state, ray_counters *counters) {
    (void)tr, (void)at, (void)r, (void)after, (void)state, (void)counters;
}

static void walk_extremes(const tracer *tr, const treelet *at, const ray *r, const ray *part,
                          extreme_state *s, ray_counters *counters) {
    (void)tr, (void)at, (void)r, (void)part, (void)s, (void)counters;
}

static const treelet_walks triangle_walks = {walk_hits, walk_pieces, walk_extremes};

static segments_error no_error(const tracer *tr, const ray *r, const double range[2]) {
    (void)tr, (void)r, (void)range;
    return (segments_error){0};
}

static void no_gradient(const tracer *tr, const treelet *at, const ray *r, const segment *s,
                        segment_gradient *out) {
    (void)tr, (void)at, (void)r, (void)s;
    *out = (segment_gradient){0};
}

static void no_cell_in(const leafcast *v, const treelet *at, const double point[3],
                       leafcast_sample *out) {
    (void)v, (void)at, (void)point, (void)out;
}

/* ---- Triangles ---- */

static status find_triangle(leafcast *v, uint64_t number, triangle *out) {
    uint32_t local;
    const uint32_t t = triangle_walk_place(v->file, number, &local);
    const treelet *at;
    const status st = volume_treelet(v, t, &at);
    if (st == ST_OK)
        *out = triangle_walk_one(blocks_of(at), local);
    return st;
}

static status triangle_of_hit(leafcast *v, const tracer *tr, const ray *r, const hit *h,
                              leafcast_hit *out) {
    triangle x;
    (void)tr, (void)r, (void)out;
    return find_triangle(v, h->cell, &x);
}

static status triangle_corners(leafcast *v, uint32_t level, uint64_t number, leafcast_cell *out) {
    triangle x;
    (void)level;
    const status st = find_triangle(v, number, &x);
    if (st != ST_OK)
        return st;
    out->corners = TRIANGLE_CORNERS;
    for (int k = 0; k < TRIANGLE_CORNERS; k++) {
        out->value[k] = x.value[k];
        for (int a = 0; a < 3; a++)
            out->position[k][a] = (double)x.p[k][a];
    }
    return ST_OK;
}

const kind triangle_kind = {.name = "triangles",
                            .cell = "triangle",
                            .given = true,
                            .describe = triangle_describe,
                            .check = cell_walks_check,
                            .aim = triangle_aim,
                            .walks = &tree_walks,
                            .inside = &triangle_walks,
                            .degree = 1,
                            .segments_error = no_error,
                            .gradient = no_gradient,
                            .cell_in = no_cell_in,
                            .tiles = &tiles,
                            .batches = &batches,
                            .cell_of_hit = triangle_of_hit,
                            .cell_corners = triangle_corners};
