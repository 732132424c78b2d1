#include "prep/export/tet_surface.h"

#include <math.h>

#include "formats/base/vec3.h"
#include "prep/export/cell_source.h"
#include "prep/export/surface_edges.h"

/* What a table of crossed edges takes as a rule. */
enum { EDGES_BYTES = 256 << 10 };

typedef struct bench {
    tet_bench tets;
    surface_edges edges;
    piece *p;
} bench;

uint64_t tet_surface_worker(const cell_choice *choice) {
    return tet_bench_bytes(choice) + EDGES_BYTES + 1024;
}

/* ---- vertices ---- */

/* Vertices have the same order in all treelets. */
static hash_id key_of(const bench *b, uint32_t low, uint32_t high) {
    const float *value = b->tets.value[0];
    return surface_edge_key(b->tets.at[low], value[low], b->tets.at[high], value[high],
                            b->p->isovalue);
}

/* Normal towards smaller values, by the file's gradients; 0 if there are none. */
static void orient(const bench *b, uint32_t low, uint32_t high, double t, double normal[3]) {
    const float(*g)[3] = b->tets.gradient;
    for (int a = 0; a < 3; a++)
        normal[a] = g ? (double)g[low][a] + t * ((double)g[high][a] - (double)g[low][a]) : 0;
    for (int a = 0; a < 3; a++)
        normal[a] = -normal[a];
}

static status make_vertex(bench *b, uint32_t low, uint32_t high, hash_id key, uint32_t *index) {
    const double from = (double)b->tets.value[0][low], to = (double)b->tets.value[0][high];
    const double t = (b->p->isovalue - from) / (to - from);
    piece_vertex v;
    for (int a = 0; a < 3; a++) {
        const double start = (double)b->tets.at[low][a], end = (double)b->tets.at[high][a];
        v.at[a] = t == 1 ? end : start + t * (end - start);
    }
    orient(b, low, high, t, v.normal);
    status st = piece_add_vertex(b->p, &v, index);
    return st == ST_OK ? piece_add_share(b->p, *index, key) : st;
}

static status find_vertex(bench *b, uint32_t one, uint32_t other, uint32_t *index) {
    const uint32_t low = one < other ? one : other, high = one < other ? other : one;
    const hash_id key = key_of(b, low, high);
    bool known;
    uint32_t *vertex = surface_edges_find(&b->edges, key, &known);
    if (!vertex)
        return ST_NOMEM;
    const status st = known ? ST_OK : make_vertex(b, low, high, key, vertex);
    *index = *vertex;
    return st;
}

/* ---- tets ---- */

/* Corners by mask of those inside: an even permutation with the inside first; with 3 inside, the
 * outside corner first. */
static const uint8_t order_of[16][4] = {{0, 0, 0, 0}, {0, 1, 2, 3}, {1, 0, 3, 2}, {0, 1, 2, 3},
                                        {2, 3, 0, 1}, {0, 2, 3, 1}, {1, 2, 0, 3}, {3, 2, 1, 0},
                                        {3, 2, 1, 0}, {0, 3, 1, 2}, {1, 3, 2, 0}, {2, 3, 0, 1},
                                        {2, 3, 0, 1}, {1, 0, 3, 2}, {0, 1, 2, 3}, {0, 0, 0, 0}};

/* Add the volume's gradient times six times the volume. Its sign does not matter. */
static void add_normals(bench *b, uint32_t tet, const uint32_t corner[], int count) {
    const uint16_t *v = b->tets.tets[tet];
    double edge[3][3], rise[3], sum[3] = {0, 0, 0};
    for (int i = 0; i < 3; i++) {
        for (int a = 0; a < 3; a++)
            edge[i][a] = (double)b->tets.at[v[i + 1]][a] - (double)b->tets.at[v[0]][a];
        rise[i] = (double)b->tets.value[0][v[i + 1]] - (double)b->tets.value[0][v[0]];
    }
    for (int i = 0; i < 3; i++) {
        double across[3];
        vec3_cross(edge[(i + 1) % 3], edge[(i + 2) % 3], across);
        for (int a = 0; a < 3; a++)
            sum[a] += rise[i] * across[a];
    }
    const double sign = vec3_det(edge[0], edge[1], edge[2]) < 0 ? 1 : -1;
    for (int i = 0; i < count; i++)
        for (int a = 0; a < 3; a++)
            b->p->vertex[corner[i]].normal[a] += sign * sum[a];
}

static status add_triangle(bench *b, const uint32_t c[4], int x, int y, int z, bool turned) {
    const uint32_t corner[3] = {c[x], c[turned ? z : y], c[turned ? y : z]};
    return piece_add_triangle(b->p, corner);
}

static status fill_tet(bench *b, uint32_t tet, int mask) {
    static const uint8_t of_three[3][2] = {{0, 1}, {0, 2}, {0, 3}},
                         of_four[4][2] = {{0, 2}, {0, 3}, {1, 3}, {1, 2}};
    const uint16_t *v = b->tets.tets[tet];
    const uint8_t *order = order_of[mask];
    const int inside = __builtin_popcount((unsigned)mask), count = inside == 2 ? 4 : 3;
    const bool turned = (tet_bench_sign(&b->tets, tet) < 0) != (inside == 3);
    uint32_t corner[4];
    status st = ST_OK;
    for (int i = 0; i < count && st == ST_OK; i++) {
        const uint8_t *ends = count == 4 ? of_four[i] : of_three[i];
        st = find_vertex(b, v[order[ends[0]]], v[order[ends[1]]], &corner[i]);
    }
    if (st == ST_OK)
        st = add_triangle(b, corner, 0, 1, 2, turned);
    if (st == ST_OK && count == 4)
        st = add_triangle(b, corner, 0, 2, 3, turned);
    if (st == ST_OK && !b->tets.gradient)
        add_normals(b, tet, corner, count);
    return st;
}

/* One bit per corner that is inside; 0 also if a corner has no data. */
static int mask_of(const bench *b, uint32_t tet) {
    int mask = 0;
    for (int i = 0; i < 4; i++) {
        const double value = (double)b->tets.value[0][b->tets.tets[tet][i]];
        if (!isfinite(value))
            return 0;
        mask |= (value >= b->p->isovalue) << i;
    }
    return mask;
}

static status make(void *bench_of, uint32_t treelet, piece *p) {
    bench *b = bench_of;
    b->p = p;
    surface_edges_clear(&b->edges);
    status st = tet_bench_load(&b->tets, treelet);
    for (uint32_t tet = 0; st == ST_OK && tet < b->tets.shape.tets; tet++) {
        const int mask = mask_of(b, tet);
        if (mask != 0 && mask != 15)
            st = fill_tet(b, tet, mask);
    }
    return st;
}

/* ---- all of it ---- */

static status create(mem *m, const cell_choice *choice, void *bench_of) {
    bench *b = bench_of;
    b->edges.m = m;
    return tet_bench_create(m, choice, &b->tets);
}

static void release(void *bench_of) {
    bench *b = bench_of;
    tet_bench_release(&b->tets);
    mem_free(b->edges.m, b->edges.crossing);
}

status tet_surface_create(mem *m, const cell_choice *choice, const double *isovalues,
                          uint32_t count, int threads, piece_source *out) {
    static const cell_source_kind kind = {sizeof(bench), create, release, make, .flat = false};
    return cell_source_create(m, &kind, choice, isovalues, count, threads, out);
}
