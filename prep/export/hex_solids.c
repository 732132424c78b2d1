#include "prep/export/hex_solids.h"

#include <string.h>

#include "prep/export/cell_source.h"
#include "prep/export/hex_bench.h"

#define UNUSED UINT32_MAX

typedef struct bench {
    hex_bench hexes;
    float *name;      /* what a node's key is made from */
    uint32_t *vertex; /* [nodes]: its number; UNUSED: no cell has it */
    uint32_t *node;   /* [vertices] */
} bench;

static uint32_t most_nodes(const leaf_file *f) {
    uint32_t most = 0;
    for (uint32_t t = 0; t < f->layout.treelets; t++) {
        const uint32_t nodes = hex_treelet_of(f, t).nodes;
        most = nodes > most ? nodes : most;
    }
    return most;
}

static size_t name_of(const cell_choice *c) {
    return 3 + (size_t)c->count;
}

uint64_t hex_solids_worker(const cell_choice *c) {
    return hex_bench_bytes(c) + name_of(c) * sizeof(float) +
           2 * sizeof(uint32_t) * most_nodes(c->f) + 1024;
}

static void find_used(bench *b) {
    const hex_treelet *tr = &b->hexes.tr;
    memset(b->vertex, 0xff, tr->nodes * sizeof *b->vertex);
    for (uint32_t cell = 0; cell < tr->cells; cell++) {
        uint32_t row[CELL_ROW];
        if (hex_treelet_code(tr, cell) == HEX_NONE)
            continue;
        hex_treelet_row(tr, cell, row);
        for (int c = 0; c < CELL_ROW; c++)
            b->vertex[row[c]] = 0;
    }
}

static status add_nodes(bench *b, piece *p) {
    const uint32_t fields = b->hexes.choice->count;
    status st = ST_OK;
    for (uint32_t n = 0; st == ST_OK && n < b->hexes.tr.nodes; n++) {
        piece_vertex v = {.at = {0}};
        if (b->vertex[n] == UNUSED)
            continue;
        hex_bench_at(&b->hexes, n, b->name);
        for (int a = 0; a < 3; a++)
            v.at[a] = (double)b->name[a];
        for (uint32_t i = 0; i < fields; i++)
            b->name[3 + i] = b->hexes.value[i][n];
        b->node[p->vertices] = n;
        st = piece_add_vertex(p, &v, &b->vertex[n]);
        if (st == ST_OK)
            st = piece_add_share(p, b->vertex[n], piece_key(b->name, name_of(b->hexes.choice)));
    }
    return st;
}

/* The shape with the fewest vertices whose corners are the same where these are. */
static cell_shape shape_of(const uint32_t corner[CELL_ROW]) {
    if (cell_row_is_quadratic(corner))
        return CELL_QUADRATIC_TET;
    static const cell_shape shapes[] = {CELL_TET, CELL_PYRAMID, CELL_WEDGE};
    for (size_t i = 0; i < sizeof shapes / sizeof *shapes; i++) {
        const uint8_t *at = cell_shape_row(shapes[i]);
        bool fits = true;
        for (int c = 0; c < HEX_CORNERS; c++)
            for (int d = 0; d < c; d++)
                fits = fits && (at[c] != at[d] || corner[c] == corner[d]);
        if (fits)
            return shapes[i];
    }
    return CELL_HEXAHEDRON;
}

/* Pairs of vertices that trade places where a shape is mirrored. */
static void mirror(cell_shape shape, uint32_t vertex[CELL_ROW]) {
    static const uint8_t pairs[CELL_SHAPES][4][2] = {
        [CELL_HEXAHEDRON] = {{0, 4}, {1, 5}, {2, 6}, {3, 7}},
        [CELL_WEDGE] = {{0, 3}, {1, 4}, {2, 5}},
        [CELL_PYRAMID] = {{1, 3}},
        [CELL_TET] = {{1, 2}},
        [CELL_QUADRATIC_TET] = {{1, 2}, {4, 6}, {8, 9}},
    };
    for (int i = 0; i < 4; i++) {
        const uint8_t *pair = pairs[shape][i];
        const uint32_t kept = vertex[pair[0]];
        vertex[pair[0]] = vertex[pair[1]];
        vertex[pair[1]] = kept;
    }
}

static status add_cell(const bench *b, uint32_t cell, piece *p) {
    uint32_t row[CELL_ROW], corner[HEX_CORNERS], vertex[CELL_ROW];
    double at[HEX_CORNERS][3];
    hex_treelet_row(&b->hexes.tr, cell, row);
    cell_row_corners(row, corner);
    hex_bench_cell(&b->hexes, corner, at);
    const cell_shape shape = shape_of(row);
    const uint8_t *of = cell_shape_row(shape);
    for (int c = 0; c < CELL_ROW; c++)
        vertex[of[c]] = b->vertex[row[c]];
    if (hex_bench_sense(&b->hexes, cell, (const double(*)[3])at) < 0)
        mirror(shape, vertex);
    return piece_add_solid(p, shape, vertex);
}

static status make(void *bench_of, uint32_t treelet, piece *p) {
    bench *b = bench_of;
    status st = hex_bench_load(&b->hexes, treelet);
    if (st != ST_OK)
        return st;
    find_used(b);
    st = add_nodes(b, p);
    for (uint32_t cell = 0; st == ST_OK && cell < b->hexes.tr.cells; cell++)
        if (hex_treelet_code(&b->hexes.tr, cell) != HEX_NONE)
            st = add_cell(b, cell, p);
    hex_bench_keep(&b->hexes, b->node, p->vertices);
    p->values = b->hexes.value;
    return st;
}

/* ---- all of it ---- */

static status create(mem *m, const cell_choice *choice, void *bench_of) {
    bench *b = bench_of;
    const size_t nodes = most_nodes(choice->f);
    const status st = hex_bench_create(m, choice, &b->hexes);
    if (st != ST_OK)
        return st;
    b->name = mem_array(m, name_of(choice), sizeof *b->name);
    b->vertex = mem_array(m, nodes, sizeof *b->vertex);
    b->node = mem_array(m, nodes, sizeof *b->node);
    return b->name && b->vertex && b->node ? ST_OK : ST_NOMEM;
}

static void release(void *bench_of) {
    bench *b = bench_of;
    hex_bench_release(&b->hexes);
    mem_free(b->hexes.m, b->name);
    mem_free(b->hexes.m, b->vertex);
    mem_free(b->hexes.m, b->node);
}

status hex_solids_create(mem *m, const cell_choice *choice, int threads, piece_source *out) {
    static const cell_source_kind kind = {sizeof(bench), create, release, make, .flat = false};
    return cell_source_create(m, &kind, choice, NULL, 0, threads, out);
}
