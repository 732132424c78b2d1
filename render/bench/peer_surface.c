#include "render/bench/peer_surface.h"

#include <string.h>

#include "formats/leaf/leaf_file.h"
#include "formats/leaf/triangle_geometry.h"
#include "render/bench/peer_tets.h"

typedef struct loading {
    leaf_file *file;
    peer_mesh *mesh;
    size_t *first; /* vertex of each treelet */
} loading;

/* Put a treelet's triangles into the mesh. False: a corner is no vertex. */
static bool put(const loading *x, uint32_t t, const void *topology) {
    const leaf_cells_directory *d = triangle_directory_of(x->file);
    const triangle_shape s = triangle_shape_of(d->counts[t]);
    const uint16_t(*rows)[3] = triangle_rows(&s, topology);
    float *to = x->mesh->positions + 3 * x->first[t];
    uint32_t *corners = x->mesh->corners + 3 * d->first[t];
    for (int a = 0; a < 3; a++) {
        const float *from = triangle_coordinates(&s, topology, a);
        for (uint32_t i = 0; i < s.vertices; i++)
            to[3 * (size_t)i + (size_t)a] = (float)((double)from[i] - x->mesh->origin[a]);
    }
    for (uint32_t i = 0; i < s.triangles; i++)
        for (int k = 0; k < 3; k++) {
            if (rows[i][k] >= s.vertices)
                return false;
            corners[3 * (size_t)i + (size_t)k] = (uint32_t)x->first[t] + rows[i][k];
        }
    return true;
}

static status load_treelet(void *ctx, size_t index, int worker) {
    const loading *x = ctx;
    const uint32_t t = (uint32_t)index;
    void *topology;
    (void)worker;
    status st = peer_tets_payload(x->mesh->m, x->file, t, &topology);
    if (st == ST_OK && !put(x, t, topology))
        st = status_describe(ST_CORRUPT, "%s: treelet %u: a corner is none of its vertices",
                             file_path(x->file->source), t);
    mem_free(x->mesh->m, topology);
    return st;
}

static status load(loading *x, pool *threads) {
    const leaf_cells_directory *d = triangle_directory_of(x->file);
    const uint32_t treelets = x->file->layout.treelets;
    peer_mesh *mesh = x->mesh;
    x->first = mem_array(mesh->m, treelets, sizeof *x->first);
    if (!x->first)
        return ST_NOMEM;
    for (uint32_t t = 0; t < treelets; t++) {
        x->first[t] = mesh->vertices;
        mesh->vertices += triangle_shape_of(d->counts[t]).vertices;
    }
    mesh->triangles = (size_t)x->file->header.tets;
    for (int a = 0; a < 3; a++)
        mesh->origin[a] = (double)x->file->header.bounds[a];
    if (mesh->vertices >= UINT32_MAX - 1)
        return status_describe(ST_UNSUPPORTED, "%zu vertices are more than the peers number",
                               mesh->vertices);
    mesh->positions = mem_array(mesh->m, 3 * (mesh->vertices + 1), sizeof(float));
    mesh->corners = mem_array(mesh->m, 3 * mesh->triangles, sizeof(uint32_t));
    return mesh->positions && mesh->corners ? pool_run(threads, treelets, load_treelet, x)
                                            : ST_NOMEM;
}

status peer_surface_load(mem *m, const char *path, pool *threads, peer_mesh *mesh) {
    leaf_file *f = NULL;
    *mesh = (peer_mesh){.m = m};
    status st = leaf_file_open(m, path, &f);
    loading x = {.file = f, .mesh = mesh};
    if (st == ST_OK && f->geometry != &triangle_geometry)
        st =
            status_describe(ST_UNSUPPORTED, "%s: peers draw grids, tetrahedra and triangles", path);
    if (st == ST_OK)
        st = load(&x, threads);
    mem_free(m, x.first);
    leaf_file_close(f);
    return st;
}
