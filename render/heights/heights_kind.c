#include "render/heights/heights_kind.h"

#include <math.h>
#include <string.h>

#include "formats/base/box3.h"
#include "formats/base/colour_field.h"
#include "render/heights/heights_tile.h"
#include "render/heights/heights_walk.h"
#include "render/look/camera.h"
#include "render/look/picture_bytes.h"
#include "render/look/projection.h"
#include "render/look/scene_facts.h"
#include "render/ray/open_volume.h"

/* ---- An open volume ---- */

static status heights_open(leafcast *v) {
    heights_field *own = v->own = mem_zalloc(v->m, sizeof *own);
    if (!own)
        return ST_NOMEM;
    own->type = v->file->layout.type;
    own->halo = v->file->layout.halo;
    for (int k = 0; k < 256; k++)
        own->light[k] = picture_linear(k / 255.0);
    return ST_OK;
}

static void heights_close(leafcast *v) {
    mem_free(v->m, v->own);
}

/* Whether the samples are an image's colours, and no elevations. */
static bool are_colours(const leafcast *v) {
    const leaf_file *f = v->file;
    return f->layout.type == SAMPLE_F32 &&
           strcmp(leaf_file_field_name(f, v->set / f->layout.steps), COLOUR_FIELD) == 0;
}

/* The box in grid space, its elevations widened by a share of their range. */
static void whole_box(const leaf_file *f, double widened, double box[2][3]) {
    const leaf_header *h = &f->header;
    const bool any = h->value_min <= h->value_max;
    const double least = any ? h->value_min : 0.0, most = any ? h->value_max : 0.0;
    const double pad = widened * (1.0 + (most - least) + fabs(most) + fabs(least));
    for (int a = 0; a < 3; a++) {
        box[0][a] = 0.0;
        box[1][a] = h->dims[a] - 1.0;
    }
    box[0][1] = least - pad;
    box[1][1] = most + pad;
}

static void corners_of(const leafcast *v, double corners[8][3]) {
    double box[2][3], corner[3];
    whole_box(v->file, 0.0, box);
    for (int i = 0; i < 8; i++) {
        box3_corner(box, i, corner);
        affine_point_to_world(&v->space, corner, corners[i]);
    }
}

static void heights_describe(const leafcast *v, uint32_t step, leafcast_info *info) {
    (void)step;
    const leaf_header *h = &v->file->header;
    double corners[8][3];
    info->abilities = LEAFCAST_ABILITY_LEVELS | LEAFCAST_ABILITY_GIVEN;
    info->nodes = (uint64_t)h->dims[0] * h->dims[2];
    info->cells = (uint64_t)(h->dims[0] - 1) * (h->dims[2] - 1);
    info->cell_size = sqrt(affine_unit(&v->space, 0) * affine_unit(&v->space, 2));
    corners_of(v, corners);
    for (int a = 0; a < 3; a++) {
        info->bounds[0][a] = INFINITY;
        info->bounds[1][a] = -INFINITY;
        for (int i = 0; i < 8; i++) {
            info->bounds[0][a] = fmin(info->bounds[0][a], corners[i][a]);
            info->bounds[1][a] = fmax(info->bounds[1][a], corners[i][a]);
        }
    }
}

static void heights_active_box(const leafcast *v, uint32_t set, const double *isovalues, int count,
                               double corners[8][3]) {
    (void)set, (void)isovalues, (void)count;
    corners_of(v, corners);
}

static void heights_span(const leafcast *v, uint32_t t, double span[2][3]) {
    const leaf_layout *l = &v->file->layout;
    const uint32_t log2 = l->cells_log2 + l->level_of[t];
    for (int a = 0; a < 3; a++) {
        const double cells = v->file->header.dims[a] - 1.0;
        span[0][a] = ldexp(l->place[t][a], (int)log2) / cells;
        span[1][a] = fmin(1.0, ldexp(l->place[t][a] + 1.0, (int)log2) / cells);
    }
}

static double heights_cells_along(const leafcast *v, const double vector[3]) {
    double grid[3];
    affine_vector_to_grid(&v->space, vector, grid);
    return fmax(fabs(grid[0]), fabs(grid[2]));
}

/* ---- A frame ---- */

static status heights_check(const leafcast *v, const leafcast_scene *scene) {
    status st = ST_OK;
    if (v->file->header.bare && scene->lod == LEAFCAST_LOD_LEVEL && scene->lod_level > 0)
        st = leaf_file_check_level(v->file, scene->lod_level);
    if (st != ST_OK)
        return st;
    if (scene->smooth_normals || scene_intersector(scene) != LEAFCAST_MARMITT)
        return status_describe(ST_USAGE, "a height field has no intersectors or smooth normals");
    return ST_OK;
}

/* For --lod pixel: stop at the treelets whose cells are not larger than a pixel where they come
 * nearest to the eye. Returns whether any of them is coarser than the data. */
static bool stop_levels(leafcast *v, const camera *c) {
    const leaf_layout *l = &v->file->layout;
    const heights_field *own = v->own;
    bool coarse = false;
    for (uint32_t t = 0; t < l->treelets; t++) {
        const float *range = v->file->ranges[leaf_layout_samples(l, v->set, t)];
        const double cell = ldexp(1.0, l->level_of[t]), side = cell * (1U << l->cells_log2);
        const double lo[3] = {l->place[t][0] * side, (double)range[0], l->place[t][2] * side};
        const double hi[3] = {lo[0] + side, (double)range[1], lo[2] + side};
        double centre[3], world[3], radius = 0.0, distance = 0.0;
        v->stop[t] = 0;
        if (leaf_layout_is_bare(l, t))
            continue;
        for (int a = 0; a < 3; a++) {
            centre[a] = 0.5 * (lo[a] + hi[a]);
            radius += 0.5 * own->unit[a] * (hi[a] - lo[a]);
        }
        affine_point_to_world(&v->space, centre, world);
        for (int a = 0; a < 3; a++)
            distance += (world[a] - c->eye[a]) * (world[a] - c->eye[a]);
        v->stop[t] = cell * fmax(own->unit[0], own->unit[2]) <=
                     camera_pixel(c, fmax(sqrt(distance) - radius, 0.0));
        coarse = coarse || (v->stop[t] && l->level_of[t] > 0);
    }
    return coarse;
}

static void heights_aim(leafcast *v, const leafcast_scene *scene, const camera *c, tracer *tr) {
    heights_field *own = v->own;
    for (int a = 0; a < 3; a++)
        own->unit[a] = affine_unit(&v->space, a);
    tr->own = own;
    whole_box(v->file, 0x1p-10, tr->box);
    if (scene->lod == LEAFCAST_LOD_PIXEL && c) {
        tr->coarse = stop_levels(v, c);
        tr->stop = v->stop;
    }
    tr->coarse = tr->coarse || tr->target_level > 0;
    tr->coloured = are_colours(v);
    tr->boxed = tr->preview || tr->lenient || tr->stop || tr->target_level > 0;
}

/* Tiles compare distances along the axes of grid space, which must be at right angles. */
static bool is_square(const affine *s) {
    for (int a = 0; a < 3; a++) {
        const int b = (a + 1) % 3;
        double dot = 0.0;
        for (int i = 0; i < 3; i++)
            dot += s->to_world[i][a] * s->to_world[i][b];
        if (fabs(dot) > 0x1p-30 * affine_unit(s, a) * affine_unit(s, b))
            return false;
    }
    return true;
}

static status heights_project(leafcast *v, const camera *c, projection *out) {
    double box[2][3], worst = 0.0;
    whole_box(v->file, 0x1p-10, box);
    *out = (projection){.centre = {(float)(0.5 * c->middle[0]), (float)(0.5 * c->middle[1])}};
    affine_point_to_grid(&v->space, c->eye, out->eye);
    out->scale = projection_scale(&v->space);
    out->unscale = 1.0 / out->scale;
    for (int a = 0; a < 3; a++) {
        const axis_projection axis = projection_axis(&v->space, c, a);
        const double entries[4] = {axis.x, axis.y, axis.w, axis.far};
        for (int i = 0; i < 4; i++)
            out->axis[a][i] = (float)entries[i];
        /* The last treelets reach past the lattice, at most twice as far. */
        worst = fmax(worst, (fabs(axis.x) + fabs(axis.y) + axis.far) *
                                fmax(fabs(box[0][a] - out->eye[a]),
                                     fabs(2.0 * box[1][a] + 256.0 - out->eye[a])));
    }
    projection_set_bounds(out, c, worst, 2.0);
    out->usable = out->usable && is_square(&v->space);
    return ST_OK;
}

static size_t heights_projection_bytes(const leaf_layout *layout) {
    (void)layout;
    return 0;
}

CPU_KERNELS(tile_fn, heights_tile_kernels, NULL, heights_tile);

static const kind_tiles tiles = {.side = HEIGHTS_TILE,
                                 .scratch = HEIGHTS_TILE_SCRATCH,
                                 .colours = true,
                                 .kernels = heights_tile_kernels,
                                 .project = heights_project,
                                 .projection_bytes = heights_projection_bytes};

/* ---- The order of treelets ---- */

/* The place, on an axis, of the level-0 treelet that a coordinate falls into, or just beyond. */
static int64_t place_of(const tracer *tr, int a, double x) {
    const leaf_level *l = &tr->layout->level[0];
    if (!(x > 0.0))
        return -1;
    return x < l->cells[a] ? (int64_t)x >> tr->layout->cells_log2 : l->treelets[a];
}

/* As that of grids: on each axis a ray only moves away from the eye's treelet, or towards a
 * light's. */
static uint32_t heights_rank(const tracer *tr, uint32_t t, const ray_bundle *rays) {
    const uint32_t level = tr->layout->level_of[t];
    const int64_t far = (int64_t)1 << 24; /* more than any place */
    double vector[3];
    int64_t rank = 0;
    if (rays->way == RAYS_ALONG)
        affine_vector_to_grid(&tr->space, rays->vector, vector);
    else
        affine_point_to_grid(&tr->space, rays->vector, vector);
    for (int a = 0; a < 3; a += 2) {
        const int64_t place = (int64_t)tr->layout->place[t][a] << level;
        if (rays->way == RAYS_ALONG) {
            rank += vector[a] > 0.0 ? place : far - place;
            continue;
        }
        const int64_t size = (int64_t)1 << level;
        const int64_t centre = (place_of(tr, a, vector[a]) >> level) * size;
        const int64_t distance = place > centre ? place - centre : centre - place;
        rank += rays->way == RAYS_TOWARDS ? far - distance : distance;
    }
    return (uint32_t)rank;
}

/* ---- Questions that a surface has no answers to ---- */

static segments_result no_segments(const tracer *tr, const ray *r, segments_state *state,
                                   ray_counters *counters) {
    (void)tr, (void)r, (void)state, (void)counters;
    return SEGMENTS_END;
}

static void no_ways(const tracer *tr, const ray *r, extreme_ways *ways, ray_counters *counters) {
    (void)tr, (void)r, (void)ways, (void)counters;
}

static void no_extreme(const tracer *tr, const treelet *at, const ray *r, const extreme_way *way,
                       extreme_state *s, ray_counters *counters) {
    (void)tr, (void)at, (void)r, (void)way, (void)s, (void)counters;
}

static void no_extreme_near(const tracer *tr, const treelet *at, const ray *r, double t,
                            extreme_state *s, ray_counters *counters) {
    (void)tr, (void)at, (void)r, (void)t, (void)s, (void)counters;
}

static segments_error no_error(const tracer *tr, const ray *r, const double range[2]) {
    (void)tr, (void)r, (void)range;
    return (segments_error){.t = 0.0};
}

static void no_gradient(const tracer *tr, const treelet *at, const ray *r, const segment *s,
                        segment_gradient *out) {
    (void)tr, (void)at, (void)r, (void)s;
    *out = (segment_gradient){0};
}

/* ---- Points: of whatever height ---- */

/* A place in its cell of a level, along axes 0 and 2. */
typedef struct plan_place {
    uint32_t cell[2];
    double at[2];
} plan_place;

/* Find the cell above or below a world-space point. Returns false beside the lattice. A point that
 * rounding has brought out of it counts as on its border. */
static bool find_place(const leafcast *v, uint32_t level, const double point[3], plan_place *out) {
    const uint32_t *dims = v->file->header.dims, *cells = v->file->layout.level[level].cells;
    const double inverse = ldexp(1.0, -(int)level), far[3] = {dims[0], 0.0, dims[2]};
    double grid[3];
    affine_point_to_grid(&v->space, point, grid);
    for (int k = 0; k < 2; k++) {
        const int a = 2 * k;
        const double most = dims[a] - 1.0;
        const double slack = affine_grid_rounding(&v->space, point, far, a);
        if (!(grid[a] >= -slack && grid[a] <= most + slack && slack < (double)INFINITY))
            return false;
        const double x = fmin(fmax(grid[a], 0.0), most) * inverse;
        out->cell[k] = x < cells[a] ? (uint32_t)x : cells[a] - 1;
        out->at[k] = x - out->cell[k];
    }
    return true;
}

static uint32_t heights_treelet_at(const leafcast *v, uint32_t level, const double point[3],
                                   uint32_t after) {
    const leaf_layout *l = &v->file->layout;
    plan_place p;
    if (after != LEAF_NO_TREELET || !find_place(v, level, point, &p))
        return LEAF_NO_TREELET;
    const uint32_t place[3] = {p.cell[0] >> l->cells_log2, 0, p.cell[1] >> l->cells_log2};
    return leaf_layout_find(l, level, place);
}

static heights_block block_in(const leafcast *v, const treelet *at) {
    const tracer tr = {
        .own = v->own, .layout = &v->file->layout, .treelets = v->treelets, .set = v->set};
    return heights_block_of(&tr, at);
}

/* A place in its patch. */
typedef struct patch_place {
    plan_place at;
    heights_patch patch;
    bool whole; /* no hole */
    uint64_t cell;
} patch_place;

/* Returns false beside the lattice. */
static bool find_patch(const leafcast *v, const treelet *at, const double point[3],
                       patch_place *out) {
    const heights_block b = block_in(v, at);
    if (!find_place(v, b.of->level, point, &out->at))
        return false;
    const uint32_t i = out->at.cell[0] - b.of->first_cell[0],
                   k = out->at.cell[1] - b.of->first_cell[2];
    out->whole = heights_block_patch(&b, i, k, &out->patch);
    out->cell = heights_block_cell(&b, i, k);
    return true;
}

static void heights_cell_in(const leafcast *v, const treelet *at, const double point[3],
                            leafcast_sample *out) {
    patch_place p;
    if (!find_patch(v, at, point, &p))
        return;
    const double *share = p.at.at, *h = p.patch.h;
    const double slope[3] = {heights_patch_slope(&p.patch, 0, share[1]), 0.0,
                             heights_patch_slope(&p.patch, 1, share[0])};
    *out = (leafcast_sample){.inside = true, .treelet = at->id, .cell = p.cell};
    memcpy(out->at, share, sizeof p.at.at);
    out->nearest = h[(share[0] >= 0.5) + 2 * (share[1] >= 0.5)];
    out->value = p.whole ? heights_patch_at(h, share[0], share[1]) : (double)NAN;
    if (p.whole && are_colours(v))
        out->value = out->nearest; /* between two colours, numbers are others */
    else
        affine_gradient_to_world(&v->space, slope, out->gradient);
}

static bool heights_colour_in(const leafcast *v, const treelet *at, const double point[3],
                              float rgb[3]) {
    const heights_field *own = v->own;
    patch_place p;
    if (!find_patch(v, at, point, &p) || !p.whole)
        return false;
    for (int c = 0; c < 3; c++) {
        double light[4];
        for (int k = 0; k < 4; k++)
            light[k] = own->light[colour_field_bytes(p.patch.h[k]) >> (16 - 8 * c) & 255U];
        rgb[c] = (float)heights_patch_at(light, p.at.at[0], p.at.at[1]);
    }
    return true;
}

/* ---- Cells ---- */

static int heights_cell_indices(const leafcast *v, uint32_t level, uint64_t number,
                                uint32_t index[3]) {
    const uint32_t *cells = v->file->layout.level[level].cells;
    if (number >= (uint64_t)cells[0] * cells[2])
        return 0;
    index[0] = (uint32_t)(number % cells[0]);
    index[1] = (uint32_t)(number / cells[0]);
    index[2] = 0;
    return 3;
}

static status heights_cell_of_hit(leafcast *v, const tracer *tr, const ray *r, const hit *h,
                                  leafcast_hit *out) {
    uint32_t index[3];
    const double size = ldexp(1.0, (int)tr->target_level), inverse = 1.0 / size;
    if (heights_cell_indices(v, tr->target_level, h->cell, index) == 0)
        return ST_OK;
    out->at[0] = heights_share(r->o[0], r->d[0], h->t, index[0] * size, inverse);
    out->at[1] = heights_share(r->o[2], r->d[2], h->t, index[1] * size, inverse);
    return ST_OK;
}

static status heights_cell_corners(leafcast *v, uint32_t level, uint64_t number,
                                   leafcast_cell *out) {
    const leaf_layout *l = &v->file->layout;
    uint32_t index[3];
    if (heights_cell_indices(v, level, number, index) == 0)
        return status_describe(ST_USAGE, "cell %llu: there are %llu", (unsigned long long)number,
                               (unsigned long long)l->level[level].cells[0] *
                                   l->level[level].cells[2]);
    const uint32_t place[3] = {index[0] >> l->cells_log2, 0, index[1] >> l->cells_log2};
    const treelet *at;
    const status st = volume_treelet(v, leaf_layout_find(l, level, place), &at);
    if (st != ST_OK)
        return st;
    const heights_block b = block_in(v, at);
    heights_patch p;
    (void)heights_block_patch(&b, index[0] - b.of->first_cell[0], index[1] - b.of->first_cell[2],
                              &p);
    out->corners = 4;
    for (int c = 0; c < 4; c++) {
        const double node[3] = {p.x + (c & 1 ? p.size : 0.0), p.h[c], p.z + (c & 2 ? p.size : 0.0)};
        affine_point_to_world(&v->space, node, out->position[c]);
        out->value[c] = (float)p.h[c];
    }
    return ST_OK;
}

static const kind_walks walks = {.active_box = heights_active_box,
                                 .span = heights_span,
                                 .cells_along = heights_cells_along,
                                 .rank = heights_rank,
                                 .next = heights_walk_next,
                                 .segments = no_segments,
                                 .extreme_ways = no_ways,
                                 .extreme = no_extreme,
                                 .extreme_near = no_extreme_near,
                                 .treelet_at = heights_treelet_at};

const kind heights_kind = {.name = "heights",
                           .cell = "patch",
                           .given = true,
                           .draped = true,
                           .open = heights_open,
                           .close = heights_close,
                           .describe = heights_describe,
                           .check = heights_check,
                           .aim = heights_aim,
                           .walks = &walks,
                           .degree = 1,
                           .segments_error = no_error,
                           .gradient = no_gradient,
                           .cell_in = heights_cell_in,
                           .colour_in = heights_colour_in,
                           .tiles = &tiles,
                           .cell_of_hit = heights_cell_of_hit,
                           .cell_indices = heights_cell_indices,
                           .cell_corners = heights_cell_corners};
