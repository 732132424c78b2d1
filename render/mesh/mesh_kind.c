#include "render/mesh/mesh_kind.h"

#include <math.h>
#include <string.h>
#include <unistd.h>

#include "formats/base/box3.h"
#include "formats/base/exact.h"
#include "formats/base/vec3.h"
#include "render/look/camera.h"
#include "render/look/scene_facts.h"
#include "render/mesh/isopolygon_cache.h"
#include "render/mesh/mesh_batch.h"
#include "render/mesh/mesh_extreme.h"
#include "render/mesh/mesh_faces.h"
#include "render/mesh/mesh_gradient.h"
#include "render/mesh/mesh_packet.h"
#include "render/mesh/mesh_projection.h"
#include "render/mesh/mesh_segments.h"
#include "render/mesh/mesh_tile.h"
#include "render/mesh/mesh_tracer.h"
#include "render/mesh/mesh_walk.h"
#include "render/ray/open_volume.h"

CPU_KERNELS(tile_fn, mesh_tile_kernels, NULL, mesh_tile);
CPU_KERNELS(tile_fn, mesh_packet_kernels, NULL, mesh_packet);
CPU_KERNELS(batch_fn, mesh_batch_kernels, NULL, mesh_batch);

/* ---- An open volume ---- */

/* Use packets instead of tiles, if asked for. */
static status mesh_open(leafcast *v) {
    const int side = v->experiments.packets;
    v->own = mem_zalloc(v->m, sizeof(mesh_rays));
    if (!v->own || side == 0)
        return v->own ? ST_OK : ST_NOMEM;
    v->kernels.tile = mesh_packet_kernels[v->kernels.isa];
    return ST_OK;
}

static mesh_derived derived_of(const leafcast *v) {
    const leafcast_experiments *e = &v->experiments;
    if (v->options.neighbours)
        return mesh_faces_kind();
    if (e->isopolygons == LEAFCAST_ISOPOLYGONS_ONTHEFLY)
        return (mesh_derived){NULL, NULL};
    return isopolygon_cache_kind(e->isopolygons == LEAFCAST_ISOPOLYGONS_PRECOMPUTE);
}

/* Keep the trees of all steps if they fit: that saves refitting. Otherwise keep one tree. A single
 * step and field never needs refitting. */
static mesh_schema schema_of(const leafcast *v) {
    const uint64_t room =
        v->m->limit ? v->m->limit
                    : (uint64_t)sysconf(_SC_PHYS_PAGES) / 4 * (uint64_t)sysconf(_SC_PAGESIZE);
    if (v->experiments.schema != LEAFCAST_SCHEMA_AUTO)
        return v->experiments.schema == LEAFCAST_SCHEMA_TREES ? MESH_TREES : MESH_REFIT;
    if (v->file->header.steps * v->file->header.fields == 1)
        return MESH_TREES;
    return v->file->header.payload_bytes <= room / 2 ? MESH_TREES : MESH_REFIT;
}

/* Readers refit trees, too: then have as many readers as threads. */
static void mesh_loading(const leafcast *v, loader_options *o) {
    o->schema = schema_of(v);
    o->derived = derived_of(v);
    if (v->file->header.steps > 1 && o->schema == MESH_REFIT && v->threads > o->workers)
        o->workers = v->threads;
}

static void mesh_close(leafcast *v) {
    mem_free(v->m, v->own);
}

/* Facts of a mesh. The edge of a cell is computed as if six tets in its box made a cube. */
static void mesh_describe(const leafcast *v, leafcast_info *info) {
    const leaf_header *h = &v->file->header;
    info->cell = "tet";
    info->cells = h->tets;
    info->nodes = h->vertices;
    info->abilities = LEAFCAST_ABILITY_SMOOTH_NORMALS | LEAFCAST_ABILITY_PACKETS;
    for (int a = 0; a < 3; a++) {
        info->bounds[0][a] = (double)h->bounds[a];
        info->bounds[1][a] = (double)h->bounds[a + 3];
        info->cell_size *= cbrt(info->bounds[1][a] - info->bounds[0][a]);
    }
    info->cell_size *= cbrt(6.0 / (double)h->tets);
}

static void mesh_active_box(const leafcast *v, uint32_t set, const double *isovalues, int count,
                            double corners[8][3]) {
    const leaf_layout *l = &v->file->layout;
    const float(*own)[2] = (const float(*)[2])v->file->own + (size_t)set * l->treelets;
    const interest in = interest_of_isovalues(isovalues, count);
    double box[2][3], some[2][3];
    box3_begin(box);
    for (uint32_t t = 0; t < l->treelets; t++) {
        box3_of_floats(v->file->mesh->bounds[leaf_layout_bounds(l, set % l->steps, t)], some);
        if (interest_meets(&in, own[t][0], own[t][1]))
            box3_widen(box, some[0], some[1]);
    }
    if (!box3_any(box))
        box3_of_floats(v->file->header.bounds, box);
    for (int i = 0; i < 8; i++)
        box3_corner(box, i, corners[i]);
}

static void mesh_span(const leafcast *v, uint32_t t, double span[2][3]) {
    const size_t at = leaf_layout_bounds(&v->file->layout, v->step, t);
    box3_share_of(v->file->mesh->bounds[at], v->file->header.bounds, span);
}

/* ---- A frame ---- */

static status mesh_check(const leafcast *v, const leafcast_scene *scene) {
    if (scene_intersector(scene) != LEAFCAST_MARMITT)
        return status_describe(ST_USAGE, "intersectors are for grids: in a mesh, surfaces are flat "
                                         "within a tetrahedron, and met exactly");
    if (scene->smooth_normals && v->file->layout.gradient_sets == 0)
        return status_describe(ST_USAGE, "this file has no gradients for smooth normals: "
                                         "leafcast convert --gradients stores them");
    const bool coarse = scene->preview && v->preview_levels > 1;
    if (scene->lod == LEAFCAST_LOD_LEVEL && scene->lod_level > 0 && !coarse)
        return status_describe(ST_USAGE,
                               "this mesh has no coarse levels: of one with a coarse grid "
                               "(leafcast convert --coarse) a preview has them");
    return ST_OK;
}

static void mesh_aim(leafcast *v, const leafcast_scene *scene, const camera *c, tracer *tr) {
    mesh_rays *own = v->own;
    (void)c;
    *own = (mesh_rays){v->treelets->tree, scene->smooth_normals, (unsigned)v->experiments.packets};
    tr->own = own;
    tr->boxed = tr->preview;
    box3_of_floats(v->file->header.bounds, tr->box);
}

static status mesh_project(leafcast *v, const camera *c, projection *out) {
    mesh_projection_init(out, v->file->header.bounds, c);
    return ST_OK;
}

static size_t mesh_projection_bytes(const leaf_layout *layout) {
    (void)layout;
    return 0;
}

/* ---- The order of treelets ---- */

/* Map floats to integers in the same order. */
static uint32_t ordered(double x) {
    const float f = (float)x;
    uint32_t bits;
    memcpy(&bits, &f, sizeof bits);
    return bits >> 31 ? ~bits : bits | 1u << 31;
}

/* Returns the square of the distance from a point to a box. */
static double distance_to(const float bounds[6], const double from[3]) {
    double sum = 0.0;
    for (int a = 0; a < 3; a++) {
        const double below = (double)bounds[a] - from[a], above = from[a] - (double)bounds[a + 3];
        const double outside = below > 0.0 ? below : above > 0.0 ? above : 0.0;
        sum += outside * outside;
    }
    return sum;
}

/* Returns where a box begins in a direction. */
static double along(const float bounds[6], const double direction[3]) {
    double sum = 0.0;
    for (int a = 0; a < 3; a++)
        sum += direction[a] * (double)bounds[direction[a] > 0.0 ? a : a + 3];
    return sum;
}

static uint32_t mesh_rank(const tracer *tr, uint32_t t, const ray_bundle *rays) {
    const float *bounds = mesh_rays_of(tr)->tree->bounds[0][t];
    switch (rays->way) {
    case RAYS_FROM: return ordered(distance_to(bounds, rays->vector));
    case RAYS_TOWARDS: return ~ordered(distance_to(bounds, rays->vector));
    default: return ordered(along(bounds, rays->vector));
    }
}

/* ---- Cells ---- */

static uint32_t treelet_of_tet(const leaf_file *f, uint64_t number) {
    uint32_t lo = 0, hi = f->layout.treelets;
    while (hi - lo > 1) {
        const uint32_t middle = lo + (hi - lo) / 2;
        if (f->mesh->first_tet[middle] <= number)
            lo = middle;
        else
            hi = middle;
    }
    return lo;
}

static status find_tet(leafcast *v, uint64_t number, tet *out) {
    const treelet *at;
    const status st = volume_treelet(v, treelet_of_tet(v->file, number), &at);
    if (st != ST_OK)
        return st;
    const resident_mesh *own = resident_mesh_of(at);
    *out = mesh_walk_tet(own, (uint32_t)(number - own->first_tet));
    return ST_OK;
}

static status mesh_cell_of_hit(leafcast *v, const tracer *tr, const ray *r, const hit *h,
                               leafcast_hit *out) {
    (void)tr;
    (void)r;
    tet x;
    double p[4][3];
    const status st = find_tet(v, h->cell, &x);
    if (st != ST_OK)
        return st;
    for (int i = 0; i < 4; i++)
        for (int k = 0; k < 3; k++)
            p[i][k] = (double)x.p[i][k];
    out->flat = exact_orientation((const double(*)[3])p) == 0;
    return ST_OK;
}

static status mesh_cell_corners(leafcast *v, uint32_t level, uint64_t cell, leafcast_cell *out) {
    tet x;
    (void)level;
    const status st = find_tet(v, cell, &x);
    if (st != ST_OK)
        return st;
    out->corners = 4;
    for (int i = 0; i < 4; i++) {
        out->value[i] = x.f[i];
        for (int a = 0; a < 3; a++)
            out->position[i][a] = (double)x.p[i][a];
    }
    return ST_OK;
}

/* ---- Points ---- */

/* Returns the value at the vertex nearest to a point. */
static double nearest_of(const tet *x, const double point[3]) {
    double least = INFINITY;
    int nearest = 0;
    for (int k = 0; k < 4; k++) {
        double distance = 0.0;
        for (int a = 0; a < 3; a++) {
            const double away = (double)x->p[k][a] - point[a];
            distance += away * away;
        }
        if (distance < least) {
            least = distance;
            nearest = k;
        }
    }
    return (double)x->f[nearest];
}

static void mesh_cell_in(const leafcast *v, const treelet *found, const double point[3],
                         leafcast_sample *sample) {
    const resident_mesh *at = resident_mesh_of(found);
    uint32_t local;
    double weights[4];
    (void)v;
    if (!mesh_walk_find(at, point, &local, weights))
        return;
    const tet x = mesh_walk_tet(at, local);
    *sample =
        (leafcast_sample){.inside = true, .treelet = found->id, .cell = at->first_tet + local};
    sample->nearest = nearest_of(&x, point);
    for (int k = 0; k < 4; k++)
        if (weights[k] > 0.0)
            sample->value += weights[k] * (isfinite(x.f[k]) ? (double)x.f[k] : (double)NAN);
    (void)tet_gradient(&x, sample->gradient);
}

static bool holds(const float bounds[6], const double point[3]) {
    bool within = true;
    for (int a = 0; a < 3; a++)
        within &= (double)bounds[a] <= point[a] && point[a] <= (double)bounds[a + 3];
    return within;
}

typedef struct tree_node {
    uint32_t level, i;
} tree_node;

/* Returns the last treelet below a node. */
static uint64_t last_below(tree_node n) {
    return ((uint64_t)n.i + 1) * (UINT64_C(1) << (TREELET_TREE_ARITY_LOG2 * n.level)) - 1;
}

/* Return treelets in the order of their numbers, so that the first of the tets that share a point
 * is found. Of a node's children the first is pushed last. */
static uint32_t mesh_treelet_at(const leafcast *v, uint32_t level, const double point[3],
                                uint32_t after) {
    const treelet_tree *tree = v->treelets->tree;
    tree_node stack[TREELET_TREE_LEVELS_MAX * TREELET_TREE_ARITY];
    int top = 0;
    (void)level;
    stack[top++] = (tree_node){tree->levels - 1, 0};
    while (top > 0) {
        const tree_node n = stack[--top];
        if ((after != LEAF_NO_TREELET && last_below(n) <= after) ||
            !holds(tree->bounds[n.level][n.i], point))
            continue;
        if (n.level == 0)
            return n.i;
        uint32_t count, first = treelet_tree_children(tree, n.level, n.i, &count);
        while (count-- > 0)
            stack[top++] = (tree_node){n.level - 1, first + count};
    }
    return LEAF_NO_TREELET;
}

static double mesh_cells_along(const leafcast *v, const double vector[3]) {
    leafcast_info info = {.cell_size = 1.0};
    mesh_describe(v, &info);
    return sqrt(vec3_dot(vector, vector)) / info.cell_size;
}

static status mesh_layer(const leafcast *v, int axis, uint32_t node, double origin[3],
                         double edges[2][3]) {
    (void)v, (void)axis, (void)node, (void)origin, (void)edges;
    return status_describe(ST_USAGE, "a mesh has no planes of nodes");
}

const kind mesh_kind = {.name = "mesh",
                        .open = mesh_open,
                        .close = mesh_close,
                        .loading = mesh_loading,
                        .describe = mesh_describe,
                        .active_box = mesh_active_box,
                        .span = mesh_span,
                        .check = mesh_check,
                        .aim = mesh_aim,
                        .project = mesh_project,
                        .projection_bytes = mesh_projection_bytes,
                        .tile_side = MESH_TILE,
                        .tile_scratch = MESH_TILE_SCRATCH,
                        .tile = mesh_tile_kernels,
                        .rank = mesh_rank,
                        .next = mesh_tracer_next,
                        .batch_scratch = MESH_BATCH_SCRATCH,
                        .batch = mesh_batch_kernels,
                        .segments = mesh_segments,
                        .segments_error = mesh_segments_error,
                        .gradient = mesh_gradient,
                        .overlaps = true,
                        .extreme_ways = mesh_extreme_ways,
                        .extreme = mesh_extreme,
                        .extreme_near = mesh_extreme_near,
                        .cell_of_hit = mesh_cell_of_hit,
                        .cell_corners = mesh_cell_corners,
                        .treelet_at = mesh_treelet_at,
                        .cell_in = mesh_cell_in,
                        .cells_along = mesh_cells_along,
                        .layer = mesh_layer};
