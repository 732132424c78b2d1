#include "prep/export/hex_surface.h"

#include <math.h>
#include <string.h>

#include "formats/base/cell_shape.h"
#include "formats/base/vec3.h"
#include "prep/export/cell_source.h"
#include "prep/export/hex_bench.h"
#include "prep/export/marching_cell.h"
#include "prep/export/surface_edges.h"

/* What a table of crossed edges takes as a rule. */
enum { EDGES_BYTES = 256 << 10 };

typedef struct bench {
    hex_bench hexes;
    surface_edges edges;
    marching_table table;
    piece *p;
    /* The cell at hand. */
    uint32_t corner[HEX_CORNERS];
    double at[HEX_CORNERS][3], f[HEX_CORNERS]; /* f: minus the isovalue */
} bench;

uint64_t hex_surface_worker(const cell_choice *choice) {
    return hex_bench_bytes(choice) + EDGES_BYTES + sizeof(bench);
}

/* ---- vertices ---- */

/* Add the cell's gradient at u, turned towards smaller values, times the volume that its edges have
 * there: no division by that, which collapsed edges make 0. */
static void add_normal(const bench *b, const double u[3], double normal[3]) {
    double at[3], along[3][3], rise[3], sum[3] = {0, 0, 0};
    hex_bench_map((const double(*)[3])b->at, u, at, along);
    (void)marching_cell_value(b->f, u, rise);
    for (int i = 0; i < 3; i++) {
        double across[3];
        vec3_cross(along[(i + 1) % 3], along[(i + 2) % 3], across);
        for (int a = 0; a < 3; a++)
            sum[a] += rise[i] * across[a];
    }
    const double sign = vec3_det(along[0], along[1], along[2]) < 0 ? 1 : -1;
    for (int a = 0; a < 3; a++)
        normal[a] += sign * sum[a];
}

/* An edge, from the end outside to the one inside: in all cells around alike. */
typedef struct edge_ends {
    float at[2][3], value[2];
} edge_ends;

static edge_ends ends_of(const bench *b, int outside, int inside) {
    const uint32_t node[2] = {b->corner[outside], b->corner[inside]};
    edge_ends e;
    for (int i = 0; i < 2; i++) {
        hex_bench_at(&b->hexes, node[i], e.at[i]);
        e.value[i] = b->hexes.value[0][node[i]];
    }
    return e;
}

static status make_vertex(bench *b, const edge_ends *e, double t, hash_id key, uint32_t *index) {
    piece_vertex v = {.normal = {0}};
    for (int a = 0; a < 3; a++) {
        const double start = (double)e->at[0][a], end = (double)e->at[1][a];
        v.at[a] = t == 1 ? end : start + t * (end - start);
    }
    status st = piece_add_vertex(b->p, &v, index);
    return st == ST_OK ? piece_add_share(b->p, *index, key) : st;
}

static status find_vertex(bench *b, int edge, uint32_t *index) {
    const uint8_t *ends = b->table.edge[edge];
    const int inside = b->f[ends[0]] >= 0 ? 0 : 1;
    const edge_ends e = ends_of(b, ends[1 - inside], ends[inside]);
    const hash_id key = surface_edge_key(e.at[0], e.value[0], e.at[1], e.value[1], b->p->isovalue);
    const double from = (double)e.value[0], to = (double)e.value[1],
                 t = (b->p->isovalue - from) / (to - from);
    bool known;
    uint32_t *vertex = surface_edges_find(&b->edges, key, &known);
    if (!vertex)
        return ST_NOMEM;
    const status st = known ? ST_OK : make_vertex(b, &e, t, key, vertex);
    *index = *vertex;
    if (st != ST_OK)
        return st;
    double u[3];
    for (int a = 0; a < 3; a++)
        u[a] = a == edge / 4 ? (inside == 1 ? t : 1 - t) : ends[0] >> a & 1;
    add_normal(b, u, b->p->vertex[*index].normal);
    return ST_OK;
}

static status make_centre(bench *b, const marching_case *m, int n, uint32_t *index) {
    piece_vertex v = {.normal = {0}};
    double u[3], along[3][3];
    marching_cell_centre(&b->table, m, n, b->f, u);
    hex_bench_map((const double(*)[3])b->at, u, v.at, along);
    add_normal(b, u, v.normal);
    return piece_add_vertex(b->p, &v, index);
}

/* ---- cells ---- */

/* Take a cell up, whose corners are there. Returns one bit per corner that is inside; 0 also if it
 * has no surface. */
static int take_cell(bench *b) {
    int mask = 0;
    for (int c = 0; c < HEX_CORNERS; c++) {
        b->f[c] = (double)b->hexes.value[0][b->corner[c]] - b->p->isovalue;
        if (!isfinite(b->f[c]))
            return 0;
        mask |= (b->f[c] >= 0) << c;
    }
    return mask;
}

static status fill_cell(bench *b, uint32_t cell, int mask) {
    hex_bench_cell(&b->hexes, b->corner, b->at);
    const bool turned = hex_bench_sense(&b->hexes, cell, (const double(*)[3])b->at) < 0;
    const marching_case *m = marching_cell_case(&b->table, mask, b->f);
    uint32_t index[MARCHING_EDGES + MARCHING_CENTRES];
    bool known[MARCHING_EDGES + MARCHING_CENTRES] = {false};
    status st = ST_OK;
    for (int i = 0; i < m->triangles && st == ST_OK; i++) {
        uint32_t corner[3];
        for (int k = 0; k < 3 && st == ST_OK; k++) {
            const int at = m->corner[i][k];
            if (!known[at])
                st = at < MARCHING_EDGES ? find_vertex(b, at, &index[at])
                                         : make_centre(b, m, at - MARCHING_EDGES, &index[at]);
            known[at] = true;
            corner[turned ? 2 - k : k] = index[at];
        }
        const bool flat =
            corner[0] == corner[1] || corner[1] == corner[2] || corner[2] == corner[0];
        if (st == ST_OK && !flat)
            st = piece_add_triangle(b->p, corner);
    }
    return st;
}

/* A quadratic tet is drawn as the linear ones between its nodes. */
static void set_corners(bench *b, const uint32_t row[CELL_ROW], int part) {
    const uint8_t *of = cell_shape_row(CELL_TET);
    if (!cell_row_is_quadratic(row)) {
        memcpy(b->corner, row, sizeof b->corner);
        return;
    }
    for (int c = 0; c < HEX_CORNERS; c++)
        b->corner[c] = row[quadratic_part(part)[of[c]]];
}

static status add_cell(bench *b, uint32_t cell) {
    uint32_t row[CELL_ROW];
    status st = ST_OK;
    if (hex_treelet_code(&b->hexes.tr, cell) == HEX_NONE)
        return ST_OK;
    hex_treelet_row(&b->hexes.tr, cell, row);
    const int parts = cell_row_is_quadratic(row) ? QUADRATIC_PARTS : 1;
    for (int part = 0; part < parts && st == ST_OK; part++) {
        set_corners(b, row, part);
        const int mask = take_cell(b);
        if (mask != 0 && mask != 255)
            st = fill_cell(b, cell, mask);
    }
    return st;
}

static status make(void *bench_of, uint32_t treelet, piece *p) {
    bench *b = bench_of;
    b->p = p;
    surface_edges_clear(&b->edges);
    status st = hex_bench_load(&b->hexes, treelet);
    for (uint32_t cell = 0; st == ST_OK && cell < b->hexes.tr.cells; cell++)
        st = add_cell(b, cell);
    return st;
}

/* ---- all of it ---- */

static status create(mem *m, const cell_choice *choice, void *bench_of) {
    bench *b = bench_of;
    b->edges.m = m;
    marching_table_init(&b->table);
    return hex_bench_create(m, choice, &b->hexes);
}

static void release(void *bench_of) {
    bench *b = bench_of;
    hex_bench_release(&b->hexes);
    mem_free(b->edges.m, b->edges.crossing);
}

status hex_surface_create(mem *m, const cell_choice *choice, const double *isovalues,
                          uint32_t count, int threads, piece_source *out) {
    static const cell_source_kind kind = {sizeof(bench), create, release, make, .flat = false};
    return cell_source_create(m, &kind, choice, isovalues, count, threads, out);
}
