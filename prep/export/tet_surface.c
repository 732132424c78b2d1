#include "prep/export/tet_surface.h"

#include <assert.h>
#include <math.h>
#include <string.h>

#include "formats/base/vec3.h"

#define NO_EDGE UINT32_MAX /* no valid pair: in a pair the first vertex is lower */

typedef struct unit {
    uint32_t treelet, isovalue;
} unit;

/* A crossed edge of the treelet. */
typedef struct crossing {
    uint32_t ends; /* lower vertex << 16 | higher vertex */
    uint32_t vertex;
} crossing;

typedef struct bench {
    tet_bench tets;
    crossing *edges; /* a hash table */
    piece *p;
} bench;

struct tet_surface {
    mem *m;
    const tet_choice *choice;
    const double *isovalues;
    unit *units;
    size_t count, room;
    uint32_t slots; /* slots of the hash tables: a power of two */
    int threads;
    bench *benches;
};

/* ---- treelets with a surface ---- */

static status find_units(tet_surface *s, uint32_t isovalues) {
    const leaf_file *f = s->choice->f;
    const uint32_t n = f->layout.treelets;
    const size_t set = leaf_layout_set(&f->layout, s->choice->fields[0], s->choice->step);
    for (uint32_t i = 0; i < isovalues; i++)
        for (uint32_t t = 0; t < n; t++) {
            const float *own = f->own[set * n + t];
            if (!((double)own[0] < s->isovalues[i] && s->isovalues[i] <= (double)own[1]))
                continue;
            status st = mem_grow(s->m, &s->units, sizeof *s->units, s->count, 64, &s->room);
            if (st != ST_OK)
                return st;
            s->units[s->count++] = (unit){t, i};
        }
    return ST_OK;
}

static uint32_t slots_of(const leaf_file *f) {
    uint32_t slots = 1;
    while (slots < 12 * f->header.treelet_tets)
        slots *= 2;
    return slots;
}

uint64_t tet_surface_worker(const tet_choice *choice) {
    return tet_bench_bytes(choice) + slots_of(choice->f) * sizeof(crossing) + 1024;
}

status tet_surface_create(mem *m, const tet_choice *choice, const double *isovalues, uint32_t count,
                          int threads, tet_surface **out) {
    tet_surface *s = mem_zalloc(m, sizeof *s);
    if (!s)
        return ST_NOMEM;
    *s = (tet_surface){.m = m,
                       .choice = choice,
                       .isovalues = isovalues,
                       .slots = slots_of(choice->f),
                       .threads = threads};
    status st = find_units(s, count);
    if (st == ST_OK && !(s->benches = mem_array(m, (size_t)threads, sizeof *s->benches)))
        st = ST_NOMEM;
    for (int i = 0; st == ST_OK && i < threads; i++) {
        st = tet_bench_create(m, choice, &s->benches[i].tets);
        if (st == ST_OK && !(s->benches[i].edges = mem_alloc(m, s->slots * sizeof(crossing))))
            st = ST_NOMEM;
    }
    if (st != ST_OK) {
        tet_surface_destroy(s);
        return st;
    }
    *out = s;
    return ST_OK;
}

void tet_surface_destroy(tet_surface *s) {
    if (!s)
        return;
    for (int i = 0; s->benches && i < s->threads; i++) {
        bench *b = &s->benches[i];
        if (b->tets.m)
            tet_bench_release(&b->tets);
        mem_free(s->m, b->edges);
    }
    mem_free(s->m, s->benches);
    mem_free(s->m, s->units);
    mem_free(s->m, s);
}

/* ---- vertices ---- */

static hash_id key_of(const bench *b, uint32_t low, uint32_t high) {
    struct {
        float low[3], low_value, high[3], high_value;
        double isovalue;
    } name;
    memset(&name, 0, sizeof name);
    memcpy(name.low, b->tets.at[low], sizeof name.low);
    memcpy(name.high, b->tets.at[high], sizeof name.high);
    name.low_value = b->tets.value[0][low];
    name.high_value = b->tets.value[0][high];
    name.isovalue = b->p->isovalue;
    return hash_identity(&name, sizeof name);
}

/* Normal towards smaller values, by the file's gradients; 0 if there are none. */
static void orient(const bench *b, uint32_t low, uint32_t high, double t, double normal[3]) {
    const float(*g)[3] = b->tets.gradient;
    for (int a = 0; a < 3; a++)
        normal[a] = g ? (double)g[low][a] + t * ((double)g[high][a] - (double)g[low][a]) : 0;
    for (int a = 0; a < 3; a++)
        normal[a] = -normal[a];
}

static status make_vertex(bench *b, uint32_t low, uint32_t high, uint32_t *index) {
    const double from = (double)b->tets.value[0][low], to = (double)b->tets.value[0][high];
    const double t = (b->p->isovalue - from) / (to - from);
    piece_vertex v;
    for (int a = 0; a < 3; a++) {
        const double start = (double)b->tets.at[low][a], end = (double)b->tets.at[high][a];
        v.at[a] = t == 1 ? end : start + t * (end - start);
    }
    orient(b, low, high, t, v.normal);
    status st = piece_add_vertex(b->p, &v, index);
    return st == ST_OK ? piece_add_share(b->p, *index, key_of(b, low, high)) : st;
}

static status find_vertex(tet_surface *s, bench *b, uint32_t one, uint32_t other, uint32_t *index) {
    const uint32_t low = one < other ? one : other, high = one < other ? other : one;
    const uint32_t ends = low << 16 | high;
    uint32_t slot = (ends * 2654435761u) >> 8 & (s->slots - 1);
    while (b->edges[slot].ends != NO_EDGE && b->edges[slot].ends != ends)
        slot = (slot + 1) & (s->slots - 1);
    if (b->edges[slot].ends == NO_EDGE) {
        status st = make_vertex(b, low, high, &b->edges[slot].vertex);
        if (st != ST_OK)
            return st;
        b->edges[slot].ends = ends;
    }
    *index = b->edges[slot].vertex;
    return ST_OK;
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
    return piece_add_cell(b->p, corner);
}

static status fill_tet(tet_surface *s, bench *b, uint32_t tet, int mask) {
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
        st = find_vertex(s, b, v[order[ends[0]]], v[order[ends[1]]], &corner[i]);
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

static void finish_normals(piece *p) {
    for (uint32_t v = 0; v < p->vertices; v++) {
        double *n = p->vertex[v].normal;
        if (!vec3_unit(n, n) || !isfinite(n[0] + n[1] + n[2]))
            memset(n, 0, sizeof p->vertex[v].normal);
    }
}

static status make(void *ctx, uint32_t index, int worker, piece *p) {
    tet_surface *s = ctx;
    bench *b = &s->benches[worker];
    const unit *u = &s->units[index];
    b->p = p;
    piece_begin(p, 3, s->isovalues[u->isovalue]);
    memset(b->edges, 0xff, s->slots * sizeof *b->edges);
    status st = tet_bench_load(&b->tets, u->treelet);
    for (uint32_t tet = 0; st == ST_OK && tet < b->tets.shape.tets; tet++) {
        const int mask = mask_of(b, tet);
        if (mask != 0 && mask != 15)
            st = fill_tet(s, b, tet, mask);
    }
    if (st == ST_OK)
        finish_normals(p);
    return st;
}

piece_source tet_surface_source(tet_surface *s) {
    assert(s->count <= UINT32_MAX);
    return (piece_source){.ctx = s, .pieces = (uint32_t)s->count, .corners = 3, .make = make};
}
