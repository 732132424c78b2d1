#include "render/mesh/mesh_kind.h"

#include <math.h>
#include <string.h>
#include <unistd.h>

#include "formats/base/box3.h"
#include "formats/base/exact.h"
#include "formats/base/vec3.h"
#include "formats/leaf/leaf_cells.h"
#include "render/look/box_projection.h"
#include "render/look/camera.h"
#include "render/look/scene_facts.h"
#include "render/mesh/mesh_batch.h"
#include "render/mesh/mesh_extreme.h"
#include "render/mesh/mesh_faces.h"
#include "render/mesh/mesh_gradient.h"
#include "render/mesh/mesh_segments.h"
#include "render/mesh/mesh_tile.h"
#include "render/mesh/mesh_tracer.h"
#include "render/mesh/mesh_walk.h"
#include "render/ray/open_volume.h"
#include "render/walk/tree_points.h"
#include "render/walk/tree_walks.h"

CPU_KERNELS(tile_fn, mesh_tile_kernels, NULL, mesh_tile);
CPU_KERNELS(batch_fn, mesh_batch_kernels, NULL, mesh_batch);

/* ---- An open volume ---- */

static status mesh_open(leafcast *v) {
    v->own = mem_zalloc(v->m, sizeof(mesh_rays));
    return v->own ? ST_OK : ST_NOMEM;
}

/* Keep the trees of all steps if they fit: that saves refitting. Otherwise keep one tree. A single
 * step and field never needs refitting; between steps, trees are made anew by themselves. */
static mesh_schema schema_of(const leafcast *v) {
    const uint64_t room =
        v->m->limit ? v->m->limit
                    : (uint64_t)sysconf(_SC_PHYS_PAGES) / 4 * (uint64_t)sysconf(_SC_PAGESIZE);
    if (v->file->below)
        return MESH_TREES;
    if (v->experiments.schema != LEAFCAST_SCHEMA_AUTO)
        return v->experiments.schema == LEAFCAST_SCHEMA_TREES ? MESH_TREES : MESH_REFIT;
    if (v->file->header.steps * v->file->header.fields == 1)
        return MESH_TREES;
    return v->file->header.payload_bytes <= room / 2 ? MESH_TREES : MESH_REFIT;
}

/* Readers refit trees, too: then have as many readers as threads. */
static void mesh_loading(const leafcast *v, loader_options *o) {
    o->schema = schema_of(v);
    if (v->options.neighbours)
        o->derived = mesh_faces_kind();
    if (v->file->header.steps > 1 && o->schema == MESH_REFIT && v->threads > o->workers)
        o->workers = v->threads;
}

static void mesh_close(leafcast *v) {
    mem_free(v->m, v->own);
}

/* Describe a mesh. cell_size is computed as if the tets filled the mesh's bounds, and six of them
 * made a cube. */
static void mesh_describe(const leafcast *v, uint32_t step, leafcast_info *info) {
    const leaf_header *h = &v->file->header;
    info->cells = h->tets;
    info->nodes = h->vertices;
    info->abilities = LEAFCAST_ABILITY_SMOOTH_NORMALS | LEAFCAST_ABILITY_PACKETS;
    tree_describe(v, step, 6.0 / (double)h->tets, info);
}

/* ---- A frame ---- */

static status mesh_check(const leafcast *v, const leafcast_scene *scene) {
    if (scene_intersector(scene) != LEAFCAST_MARMITT)
        return status_describe(ST_USAGE, "intersectors are for grids: in a mesh, surfaces are flat "
                                         "within a tetrahedron, and met exactly");
    if (scene->smooth_normals && v->file->layout.gradient_sets == 0)
        return status_describe(ST_USAGE, "this file has no gradients for smooth normals: "
                                         "leafcast convert --gradients stores them");
    return volume_check_level(v, scene);
}

static void mesh_aim(leafcast *v, const leafcast_scene *scene, const camera *c, tracer *tr) {
    mesh_rays *own = v->own;
    (void)c;
    *own = (mesh_rays){scene->smooth_normals, (unsigned)v->experiments.packets};
    tr->own = own;
    tr->boxed = tr->preview;
    box3_of_floats(v->file->header.bounds, tr->box);
}

static status mesh_project(leafcast *v, const camera *c, projection *out) {
    box_projection_init(out, v->file->header.bounds, c);
    return ST_OK;
}

static size_t mesh_projection_bytes(const leaf_layout *layout) {
    (void)layout;
    return 0;
}

/* ---- Cells ---- */

static status find_tet(leafcast *v, uint64_t number, tet *out) {
    const treelet *at;
    const status st = volume_treelet(
        v, leaf_cells_treelet(v->file->mesh->first_tet, v->file->layout.treelets, number), &at);
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

static const treelet_walks inside = {mesh_hits, mesh_pieces, mesh_extremes};

static const kind_tiles tiles = {.side = MESH_TILE,
                                 .scratch = MESH_TILE_SCRATCH,
                                 .kernels = mesh_tile_kernels,
                                 .project = mesh_project,
                                 .projection_bytes = mesh_projection_bytes};

static const kind_batches batches = {.scratch = MESH_BATCH_SCRATCH, .hits = mesh_batch_kernels};

const kind mesh_kind = {.name = "mesh",
                        .cell = "tet",
                        .open = mesh_open,
                        .close = mesh_close,
                        .describe = mesh_describe,
                        .check = mesh_check,
                        .aim = mesh_aim,
                        .walks = &tree_walks,
                        .inside = &inside,
                        .degree = 1,
                        .segments_error = mesh_segments_error,
                        .gradient = mesh_gradient,
                        .cell_in = mesh_cell_in,
                        .tiles = &tiles,
                        .batches = &batches,
                        .loading = mesh_loading,
                        .cell_of_hit = mesh_cell_of_hit,
                        .cell_corners = mesh_cell_corners};
