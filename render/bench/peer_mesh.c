#include "render/bench/peer_mesh.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

/* Corners of a cell: x + 2y + 4z. Edges: 0-3 along x at (y, z) = (e & 1, e >> 1), 4-7 along y at
 * (x, z), 8-11 along z at (x, y). */
enum { EDGES = 12, CASES = 256, TRIANGLES_MAX = 10, NO_EDGE = 255 };

typedef struct cell_case {
    uint8_t triangles;
    uint8_t edge[3 * TRIANGLES_MAX];
} cell_case;

/* What begins in a row of nodes: cut edges along x, y, z, triangles of the row's cells. Counts
 * first, then where they go. */
typedef struct row_counts {
    uint32_t edges[3];
    uint64_t triangles;
} row_counts;

typedef struct extraction {
    const peer_field *field;
    peer_mesh *mesh;
    float isovalue;
    size_t words;   /* of a row's bits */
    uint64_t *bits; /* rows of nodes, y fastest */
    row_counts *rows;
    cell_case cases[CASES];
} extraction;

/* ---- the table ---- */

static int edge_between(int a, int b) {
    const int low = a < b ? a : b, axis = (a ^ b) >> 1; /* 1 2 4 -> 0 1 2 */
    const int rest = axis == 0 ? low >> 1 : axis == 1 ? (low & 1) | (low >> 1 & 2) : low & 3;
    return 4 * axis + rest;
}

/* The corners of a face in a cycle, as seen from outside the cell. */
static void face_cycle(int axis, int side, int corner[4]) {
    const int u = 1 << (axis + 1) % 3, v = 1 << (axis + 2) % 3, base = side << axis;
    corner[0] = base;
    corner[2] = base | u | v;
    corner[1] = base | (side ? u : v);
    corner[3] = base | (side ? v : u);
}

/* Along a face's cycle an inside run begins at one cut edge and ends at another: a piece of the
 * surface goes from its end to its beginning. Neighbouring faces run along their common edge in
 * opposite ways, so each cut edge has one successor. */
static void join_edges(int inside, uint8_t next[EDGES]) {
    memset(next, NO_EDGE, EDGES);
    for (int face = 0; face < 6; face++) {
        int c[4];
        face_cycle(face >> 1, face & 1, c);
        for (int i = 0; i < 4; i++) {
            if (!(inside >> c[i] & 1) || (inside >> c[(i + 1) % 4] & 1))
                continue;
            int first = i;
            while (inside >> c[(first + 3) % 4] & 1)
                first = (first + 3) % 4;
            next[edge_between(c[i], c[(i + 1) % 4])] =
                (uint8_t)edge_between(c[(first + 3) % 4], c[first]);
        }
    }
}

static void make_case(int inside, cell_case *out) {
    uint8_t next[EDGES];
    join_edges(inside, next);
    out->triangles = 0;
    for (int e = 0; e < EDGES; e++) {
        if (next[e] == NO_EDGE)
            continue;
        int at = next[e];
        next[e] = NO_EDGE;
        while (next[at] != NO_EDGE && next[at] != e) {
            const uint8_t triangle[3] = {(uint8_t)e, (uint8_t)at, next[at]};
            memcpy(out->edge + 3 * out->triangles++, triangle, 3);
            const int then = next[at];
            next[at] = NO_EDGE;
            at = then;
        }
        next[at] = NO_EDGE;
    }
}

/* ---- bits ---- */

static size_t row_of(const extraction *x, size_t y, size_t z) {
    return y + x->field->dims[1] * z;
}

static status make_bits(void *ctx, size_t z, int worker) {
    extraction *x = ctx;
    const uint32_t *dims = x->field->dims;
    (void)worker;
    for (uint32_t y = 0; y < dims[1]; y++) {
        const float *samples = x->field->samples + peer_field_at(x->field, 0, y, (uint32_t)z);
        uint64_t *bits = x->bits + x->words * row_of(x, y, z);
        for (size_t w = 0; w < x->words; w++) {
            const size_t first = 64 * w, left = dims[0] - first, count = left < 64 ? left : 64;
            uint64_t word = 0;
            for (size_t i = 0; i < count; i++)
                word |= (uint64_t)(samples[first + i] >= x->isovalue) << i;
            bits[w] = word;
        }
    }
    return ST_OK;
}

/* 64 cells of a row: the bits of its four rows of nodes at x and at x + 1, and which edges are cut.
 * Rows: y + 2z. */
typedef struct row_word {
    uint64_t here[4], there[4];
    uint64_t cut_x[4], cut_y[2], cut_z[2]; /* y-edges at z, z + 1; z-edges at y, y + 1 */
    uint64_t active;
} row_word;

/* Rows beyond the volume repeat the last: nothing is cut there. */
static row_word load_word(const extraction *x, const uint64_t *const row[4], size_t w) {
    const size_t cells = x->field->dims[0] - 1, first = 64 * w;
    const uint64_t valid = first >= cells        ? 0
                           : cells - first >= 64 ? ~(uint64_t)0
                                                 : ((uint64_t)1 << (cells - first)) - 1;
    row_word r;
    uint64_t any = 0, all = ~(uint64_t)0;
    for (int i = 0; i < 4; i++) {
        const uint64_t beyond = w + 1 < x->words ? row[i][w + 1] : 0;
        r.here[i] = row[i][w];
        r.there[i] = row[i][w] >> 1 | beyond << 63;
        r.cut_x[i] = (r.here[i] ^ r.there[i]) & valid;
        any |= r.here[i] | r.there[i];
        all &= r.here[i] & r.there[i];
    }
    r.cut_y[0] = r.here[0] ^ r.here[1];
    r.cut_y[1] = r.here[2] ^ r.here[3];
    r.cut_z[0] = r.here[0] ^ r.here[2];
    r.cut_z[1] = r.here[1] ^ r.here[3];
    r.active = any & ~all & valid;
    return r;
}

static void rows_around(const extraction *x, size_t y, size_t z, size_t index[4],
                        const uint64_t *row[4]) {
    const size_t y1 = y + 1 < x->field->dims[1] ? y + 1 : y;
    const size_t z1 = z + 1 < x->field->dims[2] ? z + 1 : z;
    for (int i = 0; i < 4; i++) {
        index[i] = row_of(x, i & 1 ? y1 : y, i & 2 ? z1 : z);
        row[i] = x->bits + x->words * index[i];
    }
}

/* A last row has no cells. */
static bool has_cells(const extraction *x, size_t y, size_t z) {
    return y + 1 < x->field->dims[1] && z + 1 < x->field->dims[2];
}

static int case_of(const row_word *r, int bit) {
    int inside = 0;
    for (int i = 0; i < 4; i++)
        inside |= (int)((r->here[i] >> bit & 1) | (r->there[i] >> bit & 1) << 1) << 2 * i;
    return inside;
}

static status count_rows(void *ctx, size_t z, int worker) {
    extraction *x = ctx;
    (void)worker;
    for (size_t y = 0; y < x->field->dims[1]; y++) {
        size_t index[4];
        const uint64_t *row[4];
        rows_around(x, y, z, index, row);
        row_counts n = {0};
        for (size_t w = 0; w < x->words; w++) {
            const row_word r = load_word(x, row, w);
            n.edges[0] += (uint32_t)__builtin_popcountll(r.cut_x[0]);
            n.edges[1] += (uint32_t)__builtin_popcountll(r.cut_y[0]);
            n.edges[2] += (uint32_t)__builtin_popcountll(r.cut_z[0]);
            for (uint64_t left = has_cells(x, y, z) ? r.active : 0; left; left &= left - 1)
                n.triangles += x->cases[case_of(&r, __builtin_ctzll(left))].triangles;
        }
        x->rows[index[0]] = n;
    }
    return ST_OK;
}

/* Counts to places. */
static status place_rows(extraction *x) {
    const size_t rows = (size_t)x->field->dims[1] * x->field->dims[2];
    uint64_t vertices = 0, triangles = 0;
    for (size_t r = 0; r < rows; r++) {
        row_counts *n = &x->rows[r];
        for (int a = 0; a < 3; a++) {
            const uint32_t count = n->edges[a];
            n->edges[a] = (uint32_t)vertices;
            vertices += count;
        }
        const uint64_t count = n->triangles;
        n->triangles = triangles;
        triangles += count;
    }
    x->mesh->vertices = vertices;
    x->mesh->triangles = triangles;
    return vertices < UINT32_MAX
               ? ST_OK
               : status_describe(ST_UNSUPPORTED, "a mesh of %llu vertices: more than 2^32 - 2",
                                 (unsigned long long)vertices);
}

/* ---- vertices ---- */

static void node_gradient(const peer_field *f, const uint32_t node[3], double gradient[3]) {
    const size_t step[3] = {1, f->dims[0], (size_t)f->dims[0] * f->dims[1]};
    const size_t at = peer_field_at(f, node[0], node[1], node[2]);
    for (int a = 0; a < 3; a++) {
        const uint32_t below = node[a] > 0, above = node[a] + 1 < f->dims[a];
        const double rise =
            (double)f->samples[at + above * step[a]] - (double)f->samples[at - below * step[a]];
        gradient[a] = rise / (f->axis[a][node[a] + above] - f->axis[a][node[a] - below]);
    }
}

static void unit_against(const double gradient[3], float normal[3]) {
    const double largest = fmax(fabs(gradient[0]), fmax(fabs(gradient[1]), fabs(gradient[2])));
    const double inverse = largest > 0.0 ? 1.0 / largest : 0.0;
    const double v[3] = {gradient[0] * inverse, gradient[1] * inverse, gradient[2] * inverse};
    const double length = largest > 0.0 ? sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]) : 1.0;
    for (int a = 0; a < 3; a++)
        normal[a] = (float)(-v[a] / length);
}

static void make_vertex(const extraction *x, const uint32_t node[3], int axis, size_t vertex) {
    const peer_field *f = x->field;
    uint32_t far_node[3] = {node[0], node[1], node[2]};
    far_node[axis]++;
    const double here = (double)f->samples[peer_field_at(f, node[0], node[1], node[2])];
    const double there =
        (double)f->samples[peer_field_at(f, far_node[0], far_node[1], far_node[2])];
    const double share = ((double)x->isovalue - here) / (there - here);
    double at[3], world[3], from[3], to[3], gradient[3], outwards[3];
    for (int a = 0; a < 3; a++)
        at[a] = f->axis[a][node[a]];
    at[axis] += share * (f->axis[axis][far_node[axis]] - at[axis]);
    affine_point_to_world(&f->space, at, world);
    node_gradient(f, node, from);
    node_gradient(f, far_node, to);
    for (int a = 0; a < 3; a++)
        gradient[a] = from[a] + share * (to[a] - from[a]);
    affine_gradient_to_world(&f->space, gradient, outwards);
    unit_against(outwards, x->mesh->normals + 3 * vertex);
    for (int a = 0; a < 3; a++)
        x->mesh->positions[3 * vertex + a] = (float)(world[a] - x->mesh->origin[a]);
}

static void make_vertices(const extraction *x, uint64_t cut, size_t w, size_t y, size_t z, int axis,
                          size_t vertex) {
    for (; cut; cut &= cut - 1, vertex++) {
        const uint32_t node[3] = {(uint32_t)(64 * w) + (uint32_t)__builtin_ctzll(cut), (uint32_t)y,
                                  (uint32_t)z};
        make_vertex(x, node, axis, vertex);
    }
}

/* ---- triangles ---- */

/* The vertices of a row of cells so far, by the rows of nodes that own them. */
typedef struct row_vertices {
    uint32_t x[4], y[2], z[2];
} row_vertices;

static uint32_t rank(uint64_t word, uint64_t below) {
    return (uint32_t)__builtin_popcountll(word & below);
}

/* The vertex of each cut edge of the cell at a bit; edges that are not cut get some number. */
static void cell_vertices(const row_word *r, const row_vertices *base, int bit,
                          uint32_t vertex[EDGES]) {
    const uint64_t below = ((uint64_t)1 << bit) - 1;
    for (int i = 0; i < 4; i++)
        vertex[i] = base->x[i] + rank(r->cut_x[i], below);
    for (int i = 0; i < 2; i++) {
        vertex[4 + 2 * i] = base->y[i] + rank(r->cut_y[i], below);
        vertex[5 + 2 * i] = vertex[4 + 2 * i] + (uint32_t)(r->cut_y[i] >> bit & 1);
        vertex[8 + 2 * i] = base->z[i] + rank(r->cut_z[i], below);
        vertex[9 + 2 * i] = vertex[8 + 2 * i] + (uint32_t)(r->cut_z[i] >> bit & 1);
    }
}

static uint32_t *make_triangles(const extraction *x, const row_word *r, const row_vertices *base,
                                uint32_t *corner) {
    for (uint64_t left = r->active; left; left &= left - 1) {
        const int bit = __builtin_ctzll(left);
        const cell_case *c = &x->cases[case_of(r, bit)];
        uint32_t vertex[EDGES];
        cell_vertices(r, base, bit, vertex);
        for (int i = 0; i < 3 * c->triangles; i++)
            *corner++ = vertex[c->edge[i]];
    }
    return corner;
}

static void advance(const row_word *r, row_vertices *base) {
    for (int i = 0; i < 4; i++)
        base->x[i] += (uint32_t)__builtin_popcountll(r->cut_x[i]);
    for (int i = 0; i < 2; i++) {
        base->y[i] += (uint32_t)__builtin_popcountll(r->cut_y[i]);
        base->z[i] += (uint32_t)__builtin_popcountll(r->cut_z[i]);
    }
}

static status make_rows(void *ctx, size_t z, int worker) {
    extraction *x = ctx;
    (void)worker;
    for (size_t y = 0; y < x->field->dims[1]; y++) {
        size_t index[4];
        const uint64_t *row[4];
        rows_around(x, y, z, index, row);
        const row_counts *n = x->rows;
        row_vertices base;
        for (int i = 0; i < 4; i++)
            base.x[i] = n[index[i]].edges[0];
        for (int i = 0; i < 2; i++) {
            base.y[i] = n[index[2 * i]].edges[1];
            base.z[i] = n[index[i]].edges[2];
        }
        uint32_t *corner = x->mesh->corners + 3 * n[index[0]].triangles;
        for (size_t w = 0; w < x->words; w++) {
            const row_word r = load_word(x, row, w);
            make_vertices(x, r.cut_x[0], w, y, z, 0, base.x[0]);
            make_vertices(x, r.cut_y[0], w, y, z, 1, base.y[0]);
            make_vertices(x, r.cut_z[0], w, y, z, 2, base.z[0]);
            if (has_cells(x, y, z))
                corner = make_triangles(x, &r, &base, corner);
            advance(&r, &base);
        }
    }
    return ST_OK;
}

/* ---- the whole ---- */

static void middle_of(const peer_field *f, double world[3]) {
    double middle[3];
    for (int a = 0; a < 3; a++)
        middle[a] = 0.5 * (f->axis[a][0] + f->axis[a][f->dims[a] - 1]);
    affine_point_to_world(&f->space, middle, world);
}

static status make_mesh(extraction *x, pool *threads) {
    const peer_field *f = x->field;
    peer_mesh *mesh = x->mesh;
    status st = pool_run(threads, f->dims[2], make_bits, x);
    if (st == ST_OK)
        st = pool_run(threads, f->dims[2], count_rows, x);
    if (st == ST_OK)
        st = place_rows(x);
    if (st)
        return st;
    mesh->positions = mem_alloc(mesh->m, (mesh->vertices + 1) * 3 * sizeof *mesh->positions);
    mesh->normals = mem_alloc(mesh->m, (mesh->vertices + 1) * 3 * sizeof *mesh->normals);
    mesh->corners = mem_alloc(mesh->m, (mesh->triangles + 1) * 3 * sizeof *mesh->corners);
    if (!mesh->positions || !mesh->normals || !mesh->corners)
        return ST_NOMEM;
    return pool_run(threads, f->dims[2], make_rows, x);
}

status peer_mesh_extract(mem *m, const peer_field *field, double isovalue, pool *threads,
                         peer_mesh *mesh) {
    const size_t rows = (size_t)field->dims[1] * field->dims[2];
    status st = ST_NOMEM;
    *mesh = (peer_mesh){.m = m};
    middle_of(field, mesh->origin);
    extraction x = {.field = field, .mesh = mesh, .isovalue = (float)isovalue};
    for (int i = 0; i < CASES; i++)
        make_case(i, &x.cases[i]);
    x.words = (field->dims[0] + 63) / 64;
    x.bits = mem_alloc(m, rows * x.words * sizeof *x.bits);
    x.rows = mem_alloc(m, rows * sizeof *x.rows);
    if (x.bits && x.rows)
        st = make_mesh(&x, threads);
    mem_free(m, x.rows);
    mem_free(m, x.bits);
    return st;
}

void peer_mesh_release(peer_mesh *mesh) {
    mem_free(mesh->m, mesh->corners);
    mem_free(mesh->m, mesh->normals);
    mem_free(mesh->m, mesh->positions);
    *mesh = (peer_mesh){0};
}
