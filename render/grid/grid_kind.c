#include "render/grid/grid_kind.h"

#include <math.h>
#include <string.h>

#include "formats/base/box3.h"
#include "render/grid/grid_batch.h"
#include "render/grid/grid_extreme.h"
#include "render/grid/grid_projection.h"
#include "render/grid/grid_segments.h"
#include "render/grid/grid_tile.h"
#include "render/grid/grid_tracer.h"
#include "render/grid/surface.h"
#include "render/leafcast_scene.h"

/* What an open grid has beside its treelets: leafcast.own. */
typedef struct grid_volume {
    level_planes_table planes;
    double narrowest[3]; /* cell of level 0 along each axis */
    walk_scene scene;    /* of the frame, or of the question, that is under way */
} grid_volume;

static grid_volume *grid_of(const leafcast *v) {
    return v->own;
}

/* ---- An open volume ---- */

static double narrowest_cell(const double *axis, uint32_t nodes) {
    double width = INFINITY;
    for (uint32_t i = 0; i + 1 < nodes; i++)
        width = fmin(width, axis[i + 1] - axis[i]);
    return width;
}

static status grid_open(leafcast *v) {
    if (v->experiments.packets != 0)
        return status_describe(ST_USAGE, "packets are for meshes: in a grid, tiles of rays walk");
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

/* Where a grid is, and how large its cells are. */
static void grid_describe(const leafcast *v, leafcast_info *info) {
    const leaf_header *h = &v->file->header;
    for (int a = 0; a < 3; a++) {
        info->dims[a] = h->dims[a];
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

/* ---- The box of what is active ---- */

/* Of the cells that the histogram has seen in the isovalue's bin and the next one: nodes. */
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

/* Of the treelets of level 0: nodes. */
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

/* ---- A frame ---- */

static status grid_check(const leafcast *v, const leafcast_scene *scene) {
    (void)v;
    if (scene->smooth_normals)
        return status_describe(ST_USAGE, "smooth normals are for meshes: a volume has central and "
                                         "analytic ones");
    return ST_OK;
}

/* For --lod pixel: stop at the treelets whose cells are not larger than a pixel where they come
 * nearest to the eye. */
static void stop_levels(leafcast *v, const camera *c) {
    const leaf_layout *layout = &v->file->layout;
    for (uint32_t t = 0; t < layout->treelets; t++) {
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
    }
}

static void grid_aim(leafcast *v, const leafcast_scene *scene, const camera *c, tracer *tr) {
    const leaf_layout *layout = &v->file->layout;
    const leafcast_intersector how = scene_intersector(scene);
    grid_volume *g = grid_of(v);
    g->scene =
        (walk_scene){.levels = g->planes.levels,
                     .isovalues = tr->isos.isovalues,
                     .count = tr->isos.count,
                     .type = layout->type,
                     .halo = layout->halo,
                     .intersector = how,
                     .intersect = v->intersect ? v->intersect : intersector_find(how)->next_hit,
                     .walk = v->kernels.grid_walk,
                     .analytic_normals = scene->analytic_normals};
    tr->own = &g->scene;
    for (int a = 0; a < 3; a++) {
        g->scene.narrowest[a] = g->narrowest[a];
        tr->box[0][a] = v->file->axis[a][0];
        tr->box[1][a] = v->file->axis[a][v->file->header.dims[a] - 1];
    }
    if (scene->lod == LEAFCAST_LOD_LEVEL)
        tr->target_level =
            scene->lod_level < layout->levels ? scene->lod_level : layout->levels - 1;
    if (scene->lod == LEAFCAST_LOD_PIXEL && c) {
        stop_levels(v, c);
        tr->stop = v->stop;
    }
    tr->boxed = tr->preview || tr->stop || tr->target_level > 0;
}

static status grid_project(leafcast *v, const camera *c, projection *out) {
    return grid_projection_init(out, v->m, &v->file->layout, grid_of(v)->planes.levels, &v->space,
                                c);
}

static tile_fn grid_tile(const kernels *k) {
    return k->grid_tile;
}

static batch_fn grid_batch(const kernels *k) {
    return k->grid_batch;
}

/* ---- The order of treelets ---- */

/* The treelet of the level-0 grid that a coordinate falls into; outside, the one beyond. */
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
         * the Manhattan distance rises. Of a coarse treelet: from the one of its level there. */
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
    uint32_t place[3];
    const treelet *at;
    surface_cell_of(planes, h->cell, out->cell);
    for (int a = 0; a < 3; a++) {
        const uint32_t c = out->cell[a];
        const double x = r->o[a] + h->t * r->d[a];
        out->at[a] = fmin(fmax((x - planes->at[a][c]) * planes->inverse[a][c], 0.0), 1.0);
        place[a] = c >> v->file->layout.cells_log2;
    }
    status st = volume_treelet(v, leaf_layout_find(&v->file->layout, tr->target_level, place), &at);
    if (st == ST_OK)
        walk_cell_samples(scene, resident_grid_of(at), out->cell, out->samples);
    return st;
}

static void grid_cell_of_segment(const tracer *tr, const segment *s, leafcast_segment *out) {
    const walk_scene *scene = tr->own;
    surface_cell_of(&scene->levels[tr->layout->level_of[s->treelet]], s->cell, out->cell);
}

/* The cell that owns a coordinate: [i, i + 1), the last one its end too. */
static uint32_t cell_owning(const double *axis, uint32_t nodes, double x) {
    uint32_t lo = 0, hi = nodes - 1;
    while (hi - lo > 1) {
        const uint32_t middle = lo + (hi - lo) / 2;
        if (axis[middle] <= x)
            lo = middle;
        else
            hi = middle;
    }
    return lo;
}

static status grid_cell_at(leafcast *v, const double point[3], leafcast_sample *sample) {
    const level_planes *planes = &grid_of(v)->planes.levels[0];
    const leaf_layout *layout = &v->file->layout;
    double grid[3];
    uint32_t place[3];
    affine_point_to_grid(&v->space, point, grid);
    for (int a = 0; a < 3; a++) {
        const double *axis = v->file->axis[a];
        if (!(grid[a] >= axis[0] && grid[a] <= axis[planes->cells[a]]))
            return ST_OK;
        sample->cell[a] = cell_owning(axis, planes->cells[a] + 1, grid[a]);
        sample->at[a] =
            (grid[a] - planes->at[a][sample->cell[a]]) * planes->inverse[a][sample->cell[a]];
        place[a] = sample->cell[a] >> layout->cells_log2;
    }
    sample->inside = true;
    sample->treelet = leaf_layout_find(layout, 0, place);
    const treelet *at;
    status st = volume_treelet(v, sample->treelet, &at);
    if (st != ST_OK)
        return st;
    const walk_scene scene = {
        .levels = grid_of(v)->planes.levels, .type = layout->type, .halo = layout->halo};
    double gradient[3], inverse[3];
    for (int a = 0; a < 3; a++)
        inverse[a] = planes->inverse[a][sample->cell[a]];
    walk_cell_samples(&scene, resident_grid_of(at), sample->cell, sample->samples);
    sample->value = surface_trilinear(sample->samples, sample->at, inverse, gradient);
    affine_gradient_to_world(&v->space, gradient, sample->gradient);
    return ST_OK;
}

const kind grid_kind = {.name = "grid",
                        .open = grid_open,
                        .close = grid_close,
                        .describe = grid_describe,
                        .active_box = grid_active_box,
                        .check = grid_check,
                        .aim = grid_aim,
                        .project = grid_project,
                        .projection_bytes = grid_projection_bytes,
                        .tile_side = GRID_TILE,
                        .tile_scratch = GRID_TILE_SCRATCH,
                        .tile = grid_tile,
                        .rank = grid_rank,
                        .next = grid_tracer_next,
                        .surface = grid_tracer_surface,
                        .batch_scratch = GRID_BATCH_SCRATCH,
                        .batch = grid_batch,
                        .segments = grid_segments,
                        .segments_error = grid_segments_error,
                        .extreme_ways = grid_extreme_ways,
                        .extreme = grid_extreme,
                        .extreme_near = grid_extreme_near,
                        .cell_of_hit = grid_cell_of_hit,
                        .cell_of_segment = grid_cell_of_segment,
                        .cell_at = grid_cell_at};
