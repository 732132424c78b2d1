#include "render/bench/peer_tets.h"

#include <string.h>

#include "formats/leaf/leaf_unpacker.h"
#include "formats/mesh/mesh_leaf_check.h"
#include "render/mesh/tet_kernel.h"
#include "stream/mesh_active.h"

/* ---- Loading ---- */

status peer_tets_payload(mem *m, leaf_file *f, uint32_t p, void **payload) {
    leaf_unpacker *u = NULL;
    *payload = mem_alloc(m, leaf_layout_payload_bytes(&f->layout, p));
    status st = *payload ? leaf_unpacker_create(m, f, &u) : ST_NOMEM;
    if (st == ST_OK)
        st = leaf_file_load(f, p, u, *payload);
    leaf_unpacker_destroy(u);
    return st;
}

static status load_treelet(void *ctx, size_t index, int worker) {
    const peer_tets *x = ctx;
    const uint32_t t = (uint32_t)index;
    (void)worker;
    status st = peer_tets_payload(x->m, x->file, t, &x->topology[t]);
    if (st == ST_OK)
        st = mesh_leaf_check_loaded(x->file, t, x->topology[t]);
    if (st == ST_OK)
        st = peer_tets_payload(x->m, x->file, leaf_layout_values(&x->file->layout, 0, t),
                               &x->values[t]);
    return st;
}

status peer_tets_load(mem *m, const char *path, pool *threads, peer_tets *tets) {
    *tets = (peer_tets){.m = m};
    status st = leaf_file_open(m, path, &tets->file);
    if (st == ST_OK && !tets->file->mesh)
        st = status_describe(ST_UNSUPPORTED, "%s: peers draw grids and meshes", path);
    if (st != ST_OK)
        return st;
    const uint32_t treelets = tets->file->layout.treelets;
    tets->topology = mem_array(m, treelets, sizeof *tets->topology);
    tets->values = mem_array(m, treelets, sizeof *tets->values);
    if (!tets->topology || !tets->values)
        return ST_NOMEM;
    return pool_run(threads, treelets, load_treelet, tets);
}

void peer_tets_release(peer_tets *x) {
    if (!x->file)
        return;
    for (uint32_t t = 0; t < x->file->layout.treelets; t++) {
        mem_free(x->m, x->topology ? x->topology[t] : NULL);
        mem_free(x->m, x->values ? x->values[t] : NULL);
    }
    mem_free(x->m, x->topology);
    mem_free(x->m, x->values);
    leaf_file_close(x->file);
    *x = (peer_tets){0};
}

/* ---- Triangles ---- */

typedef struct extraction {
    const peer_tets *tets;
    double isovalue;
    peer_mesh *mesh;
    size_t *first; /* triangle of each treelet */
    bool counting;
} extraction;

static void put_triangle(const extraction *x, size_t triangle, const isopolygon *g,
                         const uint8_t corners[3], const float normal[3]) {
    for (int k = 0; k < 3; k++) {
        const size_t at = 3 * (3 * triangle + (size_t)k);
        for (int a = 0; a < 3; a++) {
            x->mesh->positions[at + (size_t)a] = (float)(g->p[corners[k]][a] - x->mesh->origin[a]);
            x->mesh->normals[at + (size_t)a] = normal[a];
        }
        x->mesh->corners[3 * triangle + (size_t)k] = (uint32_t)(3 * triangle + (size_t)k);
    }
}

/* A tet's triangles: counted, or written from `triangle` on. */
static size_t do_tet(const extraction *x, const tet *of, size_t triangle) {
    static const uint8_t corners[2][3] = {{0, 1, 2}, {0, 2, 3}};
    isopolygon g;
    float normal[3];
    if (!isopolygon_of(of, x->isovalue, &g))
        return 0;
    if (!x->counting)
        tet_normal(of, x->isovalue, normal);
    for (size_t k = 0; k + 2 < g.count && !x->counting; k++)
        put_triangle(x, triangle + k, &g, corners[k], normal);
    return g.count - 2u;
}

static status do_treelet(void *ctx, size_t t, int worker) {
    const extraction *x = ctx;
    const peer_tets *tets = x->tets;
    const mesh_shape shape = mesh_leaf_shape(tets->file->mesh->counts[t]);
    const uint16_t(*ids)[4] = mesh_leaf_tets(&shape, tets->topology[t]);
    const float(*at)[3] = mesh_leaf_positions(&shape, tets->topology[t]);
    const float *values = mesh_leaf_values(&shape, tets->values[t]);
    size_t triangle = x->counting ? 0 : x->first[t];
    (void)worker;
    for (uint32_t i = 0; i < shape.tets; i++) {
        tet of;
        for (int k = 0; k < 4; k++) {
            memcpy(of.p[k], at[ids[i][k]], sizeof of.p[k]);
            of.f[k] = values[ids[i][k]];
        }
        triangle += do_tet(x, &of, triangle);
    }
    if (x->counting)
        x->first[t] = triangle;
    return ST_OK;
}

status peer_tets_extract(mem *m, const peer_tets *tets, double isovalue, pool *threads,
                         peer_mesh *mesh) {
    const uint32_t treelets = tets->file->layout.treelets;
    extraction x = {.tets = tets, .isovalue = isovalue, .mesh = mesh, .counting = true};
    *mesh = (peer_mesh){.m = m};
    for (int a = 0; a < 3; a++)
        mesh->origin[a] = (double)tets->file->header.bounds[a];
    x.first = mem_array(m, treelets, sizeof *x.first);
    status st = x.first ? pool_run(threads, treelets, do_treelet, &x) : ST_NOMEM;
    for (uint32_t t = 0; t < treelets && st == ST_OK; t++) {
        const size_t count = x.first[t];
        x.first[t] = mesh->triangles;
        mesh->triangles += count;
    }
    mesh->vertices = 3 * mesh->triangles;
    if (st == ST_OK && mesh->vertices >= UINT32_MAX - 1)
        st = status_describe(ST_UNSUPPORTED, "%zu triangles are more than the peers number",
                             mesh->triangles);
    if (st == ST_OK) {
        mesh->positions = mem_array(m, 3 * (mesh->vertices + 1), sizeof(float));
        mesh->normals = mem_array(m, 3 * (mesh->vertices + 1), sizeof(float));
        mesh->corners = mem_array(m, mesh->vertices + 1, sizeof(uint32_t));
        st = mesh->positions && mesh->normals && mesh->corners ? ST_OK : ST_NOMEM;
    }
    x.counting = false;
    if (st == ST_OK)
        st = pool_run(threads, treelets, do_treelet, &x);
    mem_free(m, x.first);
    return st;
}
