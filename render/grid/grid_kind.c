#include "render/grid/grid_kind.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "formats/base/box3.h"
#include "render/grid/grid_batch.h"
#include "render/grid/grid_extreme.h"
#include "render/grid/grid_extreme_batch.h"
#include "render/grid/grid_gradient.h"
#include "render/grid/grid_pieces.h"
#include "render/grid/grid_projection.h"
#include "render/grid/grid_segments.h"
#include "render/grid/grid_tile.h"
#include "render/grid/grid_tracer.h"
#include "render/grid/surface.h"
#include "render/grid/walk_choice.h"
#include "render/look/camera.h"
#include "render/ray/open_volume.h"

/* leafcast.own of an open grid. */
typedef struct grid_volume {
    level_planes_table planes;
    double narrowest[3]; /* width of the narrowest cell of level 0 on each axis */
} grid_volume;

static grid_volume *grid_of(const leafcast *v) {
    return v->own;
}

CPU_KERNELS(tile_fn, grid_tile_kernels, NULL, grid_tile_trace);
CPU_KERNELS(batch_fn, grid_batch_kernels, NULL, grid_batch_trace);
CPU_KERNELS(segment_batch_fn, grid_pieces_kernels, NULL, grid_pieces);
CPU_KERNELS(extreme_batch_fn, grid_extreme_batch_kernels, NULL, grid_extreme_batch);

/* ---- An open volume ---- */

static double narrowest_cell(const double *axis, uint32_t nodes) {
    double width = INFINITY;
    for (uint32_t i = 0; i + 1 < nodes; i++)
        width = fmin(width, axis[i + 1] - axis[i]);
    return width;
}

static status grid_open(leafcast *v) {
    v->own = mem_zalloc(v->m, sizeof(grid_volume));
    if (!v->own)
        return ST_NOMEM;
    for (int a = 0; a < 3; a++)
        grid_of(v)->narrowest[a] = narrowest_cell(v->file->axis[a], v->file->header.dims[a]);
    return level_planes_init(&grid_of(v)->planes, v->m, v->file);
}

static void grid_close(leafcast *v) {
    if (v->own)
        level_planes_release(&grid_of(v)->planes);
    mem_free(v->m, v->own);
}

/* Describe what a grid has, where it is, and how large its cells are. */
static void grid_describe(const leafcast *v, uint32_t step, leafcast_info *info) {
    (void)step;
    const leaf_header *h = &v->file->header;
    info->cells = info->nodes = 1;
    info->abilities = LEAFCAST_ABILITY_LEVELS | LEAFCAST_ABILITY_LAYERS |
                      LEAFCAST_ABILITY_ANALYTIC_NORMALS | LEAFCAST_ABILITY_INTERSECTORS;
    for (int a = 0; a < 3; a++) {
        info->dims[a] = h->dims[a];
        info->nodes *= h->dims[a];
        info->cells *= h->dims[a] - 1;
        info->bounds[0][a] = INFINITY;
        info->bounds[1][a] = -INFINITY;
    }
    for (int corner = 0; corner < 8; corner++) {
        double grid[3], world[3];
        for (int a = 0; a < 3; a++)
            grid[a] = v->file->axis[a][corner >> a & 1 ? h->dims[a] - 1 : 0];
        affine_point_to_world(&v->space, grid, world);
        for (int a = 0; a < 3; a++) {
            info->bounds[0][a] = fmin(info->bounds[0][a], world[a]);
            info->bounds[1][a] = fmax(info->bounds[1][a], world[a]);
        }
    }
    for (int a = 0; a < 3; a++) {
        const double *axis = v->file->axis[a], edge = affine_unit(&v->space, a);
        info->cell_size *= cbrt(edge * (axis[h->dims[a] - 1] - axis[0]) / (h->dims[a] - 1));
    }
}

/* ---- The box of active cells ---- */

/* Widen the box, in node coordinates, by the boxes that the histogram gives for the isovalue's bin
 * and the next one. */
static void widen_by_histogram(const leafcast *v, uint32_t set, double isovalue, double box[2][3]) {
    const histogram *h = &v->file->histograms[set];
    const uint32_t *dims = v->file->header.dims;
    for (uint32_t k = 0; k < h->bins; k++) {
        const bool near = h->edges[k + 1] > isovalue && (k == 0 || h->edges[k - 1] <= isovalue);
        double lo[3], hi[3];
        if (!near || !h->active[k])
            continue;
        for (int a = 0; a < 3; a++) {
            const double last = dims[a] - 1.0;
            lo[a] = h->box[k][a] * last / 255.0;
            hi[a] = fmin(last, (h->box[k][3 + a] + 1) * last / 255.0 + 1.0);
        }
        box3_widen(box, lo, hi);
    }
}

/* Widen the box, in node coordinates, by the active treelets of level 0. */
static void widen_by_treelets(const leafcast *v, uint32_t set, const double *isovalues, int count,
                              double box[2][3]) {
    const interest in = interest_of_isovalues(isovalues, count);
    const leaf_layout *l = &v->file->layout;
    const float(*own)[2] = (const float(*)[2])v->file->own + leaf_layout_samples(l, set, 0);
    for (uint32_t t = l->level[0].first; t < l->treelets; t++) {
        double lo[3], hi[3];
        if (!interest_meets(&in, own[t][0], own[t][1]))
            continue;
        for (int a = 0; a < 3; a++) {
            lo[a] = (double)l->place[t][a] * (1u << l->cells_log2);
            hi[a] = fmin(lo[a] + (1u << l->cells_log2), v->file->header.dims[a] - 1.0);
        }
        box3_widen(box, lo, hi);
    }
}

static double axis_at(const leafcast *v, int a, double node) {
    const double *axis = v->file->axis[a], before = floor(node);
    const uint32_t i = (uint32_t)before, last = v->file->header.dims[a] - 1;
    return i >= last ? axis[last] : axis[i] + (node - before) * (axis[i + 1] - axis[i]);
}

static void grid_active_box(const leafcast *v, uint32_t set, const double *isovalues, int count,
                            double corners[8][3]) {
    double box[2][3];
    box3_begin(box);
    if (v->file->histograms)
        for (int i = 0; i < count; i++)
            widen_by_histogram(v, set, isovalues[i], box);
    else
        widen_by_treelets(v, set, isovalues, count, box);
    for (int a = 0; a < 3; a++) {
        const bool any = box[0][a] <= box[1][a];
        box[0][a] = axis_at(v, a, any ? box[0][a] : 0.0);
        box[1][a] = axis_at(v, a, any ? box[1][a] : v->file->header.dims[a] - 1.0);
    }
    for (int i = 0; i < 8; i++) {
        double corner[3];
        box3_corner(box, i, corner);
        affine_point_to_world(&v->space, corner, corners[i]);
    }
}

static void grid_span(const leafcast *v, uint32_t t, double span[2][3]) {
    const leaf_layout *l = &v->file->layout;
    const uint32_t log2 = l->cells_log2 + l->level_of[t];
    for (int a = 0; a < 3; a++) {
        const double cells = v->file->header.dims[a] - 1.0;
        span[0][a] = ldexp(l->place[t][a], (int)log2) / cells;
        span[1][a] = fmin(1.0, ldexp(l->place[t][a] + 1.0, (int)log2) / cells);
    }
}

/* ---- A frame ---- */

static status grid_check(const leafcast *v, const leafcast_scene *scene) {
    if (v->file->header.bare && scene->lod == LEAFCAST_LOD_LEVEL && scene->lod_level > 0)
        return leaf_file_check_level(v->file, scene->lod_level);
    if (scene->smooth_normals)
        return status_describe(ST_USAGE, "smooth normals are for meshes: a volume has central and "
                                         "analytic ones");
    return ST_OK;
}

/* For --lod pixel: stop at the treelets whose cells are not larger than a pixel where they come
 * nearest to the eye. Returns whether any of them is coarser than the data. */
static bool stop_levels(leafcast *v, const camera *c) {
    const leaf_layout *layout = &v->file->layout;
    bool coarse = false;
    for (uint32_t t = 0; t < layout->treelets; t++) {
        v->stop[t] = 0;
        if (leaf_layout_is_bare(layout, t))
            continue;
        const level_planes *planes = &grid_of(v)->planes.levels[layout->level_of[t]];
        double centre[3], radius = 0.0, edge = 0.0, distance = 0.0, world[3];
        for (int a = 0; a < 3; a++) {
            const uint32_t first = layout->place[t][a] << layout->cells_log2;
            const double lo = planes->at[a][first],
                         hi = planes->at[a][first + (1u << layout->cells_log2)];
            const double unit = affine_unit(&v->space, a);
            centre[a] = 0.5 * (lo + hi);
            radius += 0.5 * unit * (hi - lo);
            edge = fmax(edge, unit * (hi - lo) / (1u << layout->cells_log2));
        }
        affine_point_to_world(&v->space, centre, world);
        for (int a = 0; a < 3; a++)
            distance += (world[a] - c->eye[a]) * (world[a] - c->eye[a]);
        v->stop[t] = edge <= camera_pixel(c, fmax(sqrt(distance) - radius, 0.0));
        coarse = coarse || (v->stop[t] && layout->level_of[t] > 0);
    }
    return coarse;
}

static void grid_aim(leafcast *v, const leafcast_scene *scene, const camera *c, tracer *tr) {
    const leaf_layout *layout = &v->file->layout;
    const walk_choice *choice = tr->choice;
    const grid_volume *g = grid_of(v);
    walk_scene *walked = (walk_scene *)(void *)tr->room;
    *walked = (walk_scene){.levels = g->planes.levels,
                           .isovalues = tr->isos.isovalues,
                           .count = tr->isos.count,
                           .type = layout->type,
                           .halo = layout->halo,
                           .walk = choice && choice->walk ? choice->walk : walk_treelet,
                           .packet = choice && choice->packet > 0 ? choice->packet : GRID_TILE,
                           .by_cell = choice && choice->by_cell,
                           .analytic_normals = scene->analytic_normals};
    tr->own = walked;
    if (choice && choice->walk)
        tr->kernels = &ray_kernels_none;
    for (int a = 0; a < 3; a++) {
        walked->narrowest[a] = g->narrowest[a];
        tr->box[0][a] = v->file->axis[a][0];
        tr->box[1][a] = v->file->axis[a][v->file->header.dims[a] - 1];
    }
    if (scene->lod == LEAFCAST_LOD_PIXEL && c) {
        tr->coarse = stop_levels(v, c);
        tr->stop = v->stop;
    }
    tr->coarse = tr->coarse || tr->target_level > 0;
    tr->boxed = tr->preview || tr->lenient || tr->stop || tr->target_level > 0;
}

static status grid_project(leafcast *v, const camera *c, projection *out) {
    return grid_projection_init(out, v->m, &v->file->layout, grid_of(v)->planes.levels, &v->space,
                                c);
}

_Static_assert(sizeof(walk_scene) <= TRACER_ROOM, "a tracer has room for it");

/* ---- The order of treelets ---- */

/* Returns the place, on one axis, of the level-0 treelet that a coordinate falls into. Outside the
 * volume: the place just beyond. */
static int64_t treelet_of(const tracer *tr, int a, double x) {
    const walk_scene *scene = tr->own;
    const level_planes *planes = &scene->levels[0];
    uint32_t lo = 0, hi = planes->cells[a];
    if (!(x > planes->at[a][0]))
        return -1;
    if (!(x < planes->at[a][hi]))
        return tr->layout->level[0].treelets[a];
    while (hi - lo > 1) {
        const uint32_t middle = lo + (hi - lo) / 2;
        if (planes->at[a][middle] <= x)
            lo = middle;
        else
            hi = middle;
    }
    return lo >> tr->layout->cells_log2;
}

static uint32_t grid_rank(const tracer *tr, uint32_t t, const ray_bundle *rays) {
    const uint32_t level = tr->layout->level_of[t];
    const int64_t far = (int64_t)1 << 24; /* more than any place */
    double vector[3];
    if (rays->way == RAYS_ALONG)
        affine_vector_to_grid(&tr->space, rays->vector, vector);
    else
        affine_point_to_grid(&tr->space, rays->vector, vector);
    int64_t rank = 0;
    for (int a = 0; a < 3; a++) {
        const int64_t place = (int64_t)tr->layout->place[t][a] << level;
        if (rays->way == RAYS_ALONG) {
            rank += vector[a] > 0.0 ? place : far - place;
            continue;
        }
        /* A ray only moves away from the eye's treelet on every axis (and towards a light's), so
         * the Manhattan distance rises (falls). A coarse treelet's distance is from the treelet of
         * its own level there. */
        const int64_t size = (int64_t)1 << level;
        const int64_t centre = (treelet_of(tr, a, vector[a]) >> level) * size;
        const int64_t distance = place > centre ? place - centre : centre - place;
        rank += rays->way == RAYS_TOWARDS ? far - distance : distance;
    }
    return (uint32_t)rank;
}

/* ---- Cells ---- */

static status grid_cell_of_hit(leafcast *v, const tracer *tr, const ray *r, const hit *h,
                               leafcast_hit *out) {
    const walk_scene *scene = tr->own;
    const level_planes *planes = &scene->levels[tr->target_level];
    uint32_t cell[3];
    (void)v;
    surface_cell_of(planes, h->cell, cell);
    for (int a = 0; a < 3; a++) {
        const uint32_t c = cell[a];
        const double x = r->o[a] + h->t * r->d[a];
        out->at[a] = fmin(fmax((x - planes->at[a][c]) * planes->inverse[a][c], 0.0), 1.0);
    }
    return ST_OK;
}

static uint64_t cells_of(const level_planes *planes) {
    return (uint64_t)planes->cells[0] * planes->cells[1] * planes->cells[2];
}

static int grid_cell_indices(const leafcast *v, uint32_t level, uint64_t cell, uint32_t index[3]) {
    const level_planes *planes = &grid_of(v)->planes.levels[level];
    if (cell >= cells_of(planes))
        return 0;
    surface_cell_of(planes, cell, index);
    return 3;
}

/* What walk_cell_samples() needs of a scene. */
static walk_scene scene_of_samples(const leafcast *v) {
    return (walk_scene){.levels = grid_of(v)->planes.levels,
                        .type = v->file->layout.type,
                        .halo = v->file->layout.halo};
}

static status grid_cell_corners(leafcast *v, uint32_t level, uint64_t cell, leafcast_cell *out) {
    const walk_scene scene = scene_of_samples(v);
    const level_planes *planes = &scene.levels[level];
    const uint64_t cells = cells_of(planes);
    uint32_t index[3], place[3];
    const treelet *at;
    if (cell >= cells)
        return status_describe(ST_USAGE, "cell %llu: there are %llu", (unsigned long long)cell,
                               (unsigned long long)cells);
    surface_cell_of(planes, cell, index);
    out->corners = 8;
    for (int a = 0; a < 3; a++)
        place[a] = index[a] >> v->file->layout.cells_log2;
    for (int c = 0; c < 8; c++) {
        double node[3];
        for (int a = 0; a < 3; a++)
            node[a] = planes->at[a][index[a] + (c >> a & 1)];
        affine_point_to_world(&v->space, node, out->position[c]);
    }
    status st = volume_treelet(v, leaf_layout_find(&v->file->layout, level, place), &at);
    if (st == ST_OK)
        walk_cell_samples(&scene, resident_grid_of(at), index, out->value);
    return st;
}

/* ---- Points ---- */

/* Returns the cell that owns a coordinate in at[0] .. at[cells]. Cell i owns [i, i + 1), the last
 * one its end, too. Most axes are even: the guess is right. */
static uint32_t cell_owning(const double *at, uint32_t cells, double x) {
    const double share = (x - at[0]) / (at[cells] - at[0]) * cells;
    const uint32_t guess = share < cells ? (uint32_t)share : cells - 1;
    if (at[guess] <= x && (guess + 1 == cells || x < at[guess + 1]))
        return guess;
    uint32_t lo = 0, hi = cells;
    while (hi - lo > 1) {
        const uint32_t middle = lo + (hi - lo) / 2;
        if (at[middle] <= x)
            lo = middle;
        else
            hi = middle;
    }
    return lo;
}

/* A point in its cell of a level. */
typedef struct cell_point {
    uint32_t cell[3];
    double at[3], inverse[3]; /* in the cell; 1 / its edges */
} cell_point;

/* Find the cell of a world-space point. Returns false outside the volume. A point that rounding has
 * brought out of the volume counts as on its border. */
static bool find_cell(const leafcast *v, uint32_t level, const double point[3], cell_point *out) {
    const level_planes *planes = &grid_of(v)->planes.levels[level];
    double grid[3], far[3];
    affine_point_to_grid(&v->space, point, grid);
    for (int a = 0; a < 3; a++) {
        const double *axis = v->file->axis[a];
        far[a] = fmax(fabs(axis[0]), fabs(axis[v->file->header.dims[a] - 1]));
    }
    for (int a = 0; a < 3; a++) {
        const double *axis = v->file->axis[a];
        const double lo = axis[0], hi = axis[v->file->header.dims[a] - 1];
        double x = grid[a];
        if (!(x >= lo && x <= hi)) {
            const double slack = affine_grid_rounding(&v->space, point, far, a);
            if (!(x >= lo - slack && x <= hi + slack && slack < (double)INFINITY))
                return false;
            x = x < lo ? lo : hi;
        }
        const uint32_t c = out->cell[a] = cell_owning(planes->at[a], planes->cells[a], x);
        out->inverse[a] = planes->inverse[a][c];
        out->at[a] = (x - planes->at[a][c]) * out->inverse[a];
    }
    return true;
}

static uint32_t grid_treelet_at(const leafcast *v, uint32_t level, const double point[3],
                                uint32_t after) {
    cell_point found;
    if (after != LEAF_NO_TREELET || !find_cell(v, level, point, &found))
        return LEAF_NO_TREELET;
    for (int a = 0; a < 3; a++)
        found.cell[a] >>= v->file->layout.cells_log2;
    return leaf_layout_find(&v->file->layout, level, found.cell);
}

static bool all_finite(const float samples[8]) {
    bool finite = true;
    for (int i = 0; i < 8; i++)
        finite &= isfinite(samples[i]) != 0;
    return finite;
}

static double nearest_of(const float samples[8], const double at[3]) {
    int corner = 0;
    for (int a = 0; a < 3; a++)
        corner |= (at[a] >= 0.5) << a;
    return (double)samples[corner];
}

static void grid_cell_in(const leafcast *v, const treelet *at, const double point[3],
                         leafcast_sample *out) {
    const walk_scene scene = scene_of_samples(v);
    const uint32_t level = v->file->layout.level_of[at->id], *cells = scene.levels[level].cells;
    cell_point found;
    double gradient[3];
    float samples[8];
    if (!find_cell(v, level, point, &found))
        return;
    *out = (leafcast_sample){.inside = true, .treelet = at->id};
    out->cell =
        found.cell[0] + (uint64_t)cells[0] * (found.cell[1] + (uint64_t)cells[1] * found.cell[2]);
    memcpy(out->at, found.at, sizeof out->at);
    walk_cell_samples(&scene, resident_grid_of(at), found.cell, samples);
    out->value = surface_trilinear(samples, found.at, found.inverse, gradient);
    out->nearest = nearest_of(samples, found.at);
    if (!all_finite(samples))
        out->value = (double)NAN;
    affine_gradient_to_world(&v->space, gradient, out->gradient);
}

static double grid_cells_along(const leafcast *v, const double vector[3]) {
    double grid[3], most = 0.0;
    affine_vector_to_grid(&v->space, vector, grid);
    for (int a = 0; a < 3; a++) {
        const double *axis = v->file->axis[a];
        const uint32_t cells = v->file->header.dims[a] - 1;
        most = fmax(most, fabs(grid[a]) * cells / (axis[cells] - axis[0]));
    }
    return most;
}

static status grid_layer(const leafcast *v, int axis, uint32_t node, double origin[3],
                         double edges[2][3]) {
    const uint32_t *dims = v->file->header.dims;
    double first[3], end[3];
    if (node >= dims[axis])
        return status_describe(ST_USAGE, "node %u along %c: there are 0 to %u", node, "xyz"[axis],
                               dims[axis] - 1);
    for (int a = 0; a < 3; a++)
        first[a] = v->file->axis[a][a == axis ? node : 0];
    affine_point_to_world(&v->space, first, origin);
    for (int a = 0, edge = 0; a < 3; a++) {
        if (a == axis)
            continue;
        memcpy(end, first, sizeof end);
        end[a] = v->file->axis[a][dims[a] - 1];
        affine_point_to_world(&v->space, end, edges[edge]);
        for (int i = 0; i < 3; i++)
            edges[edge][i] -= origin[i];
        edge++;
    }
    return ST_OK;
}

_Static_assert((int)GRID_EXTREME_BATCH_SCRATCH >= (int)GRID_PIECES_SCRATCH &&
                   (int)GRID_EXTREME_BATCH_SCRATCH >= (int)GRID_BATCH_SCRATCH,
               "one scratch for all");

static const kind_walks walks = {.active_box = grid_active_box,
                                 .span = grid_span,
                                 .cells_along = grid_cells_along,
                                 .rank = grid_rank,
                                 .next = grid_tracer_next,
                                 .segments = grid_segments,
                                 .extreme_ways = grid_extreme_ways,
                                 .extreme = grid_extreme,
                                 .extreme_near = grid_extreme_near,
                                 .treelet_at = grid_treelet_at};

static const kind_tiles tiles = {.side = GRID_TILE,
                                 .scratch = GRID_TILE_SCRATCH,
                                 .kernels = grid_tile_kernels,
                                 .project = grid_project,
                                 .projection_bytes = grid_projection_bytes};

static const kind_batches batches = {.scratch =
                                         GRID_EXTREME_BATCH_SCRATCH, /* more than the others need */
                                     .hits = grid_batch_kernels,
                                     .pieces = grid_pieces_kernels,
                                     .extremes = grid_extreme_batch_kernels};

const kind grid_kind = {.name = "grid",
                        .cell = "cell",
                        .open = grid_open,
                        .close = grid_close,
                        .describe = grid_describe,
                        .check = grid_check,
                        .aim = grid_aim,
                        .walks = &walks,
                        .degree = 3,
                        .segments_error = grid_segments_error,
                        .gradient = grid_gradient,
                        .cell_in = grid_cell_in,
                        .tiles = &tiles,
                        .batches = &batches,
                        .cell_of_hit = grid_cell_of_hit,
                        .cell_indices = grid_cell_indices,
                        .cell_corners = grid_cell_corners,
                        .layer = grid_layer};
