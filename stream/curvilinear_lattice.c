#include "stream/curvilinear_lattice.h"

#include <math.h>
#include <string.h>

#include "formats/base/hexahedron.h"

enum { BLOCK = CURVILINEAR_BLOCK, SIDE = BLOCK + 1 };

/* ---- Blocks ---- */

static uint32_t blocks_along(uint32_t cells) {
    return (cells + BLOCK - 1) / BLOCK;
}

static uint32_t block_count(const uint32_t cells[3]) {
    return blocks_along(cells[0]) * blocks_along(cells[1]) * blocks_along(cells[2]);
}

/* Every third bit of a Morton number. */
static uint32_t third_bits(uint32_t n) {
    return (n & 1) | (n >> 2 & 2) | (n >> 4 & 4);
}

static void make_places(curvilinear_lattice *l) {
    uint32_t count = 0;
    for (uint32_t n = 0; n < 512; n++) {
        curvilinear_place p;
        bool exists = true;
        for (int a = 0; a < 3; a++) {
            const uint32_t at = third_bits(n >> a), left = l->cells[a] - at * BLOCK;
            exists = exists && at < blocks_along(l->cells[a]);
            p.first[a] = (uint8_t)at;
            p.cells[a] = (uint8_t)(left < BLOCK ? left : BLOCK);
        }
        if (exists)
            l->places[count++] = p;
    }
}

static void box_of(const curvilinear_lattice *l, const curvilinear_place *b, treelet_bounds out) {
    const uint32_t first = curvilinear_lattice_node(l, b);
    for (int a = 0; a < 3; a++) {
        float lo = INFINITY, hi = -INFINITY;
        for (uint32_t k = 0; k <= b->cells[2]; k++)
            for (uint32_t j = 0; j <= b->cells[1]; j++)
                for (uint32_t i = 0; i <= b->cells[0]; i++) {
                    const float p = l->p[a][first + i + l->nodes[0] * (j + l->nodes[1] * k)];
                    lo = p < lo ? p : lo;
                    hi = p > hi ? p : hi;
                }
        out[a] = lo;
        out[a + 3] = hi;
    }
}

static size_t own_bytes(uint32_t blocks) {
    return blocks * (sizeof(uint64_t) + sizeof(curvilinear_plane) + sizeof(float[2]) +
                     sizeof(curvilinear_place));
}

size_t curvilinear_lattice_bytes(const uint32_t cells[3]) {
    const uint32_t blocks = block_count(cells);
    return own_bytes(blocks) + treelet_tree_bytes(blocks);
}

status curvilinear_lattice_init(curvilinear_lattice *l, mem *m, const uint32_t cells[3],
                                const float *const p[3], const uint8_t *codes) {
    *l = (curvilinear_lattice){.blocks = block_count(cells), .codes = codes, .m = m};
    for (int a = 0; a < 3; a++) {
        l->cells[a] = cells[a];
        l->nodes[a] = cells[a] + 1;
        l->p[a] = p[a];
    }
    l->active = mem_zalloc(m, own_bytes(l->blocks));
    if (!l->active)
        return ST_NOMEM;
    l->planes = (curvilinear_plane *)(l->active + l->blocks);
    l->ranges = (float(*)[2])(l->planes + l->blocks);
    l->places = (curvilinear_place *)(l->ranges + l->blocks);
    make_places(l);
    const status st = treelet_tree_init(&l->tree, m, NULL, l->blocks);
    if (st != ST_OK)
        curvilinear_lattice_release(l);
    return st;
}

void curvilinear_lattice_move(curvilinear_lattice *l) {
    treelet_bounds *boxes = l->tree.bounds[0];
    for (uint32_t b = 0; b < l->blocks; b++)
        box_of(l, &l->places[b], boxes[b]);
    treelet_tree_move(&l->tree, (const treelet_bounds *)boxes);
}

void curvilinear_lattice_release(curvilinear_lattice *l) {
    treelet_tree_release(&l->tree);
    mem_free(l->m, l->active);
    l->active = NULL;
}

/* ---- Values ---- */

/* What a block's cells have: the least and the greatest value, and whether one is not finite. */
typedef struct block_values {
    float lo[SIDE][SIDE][SIDE], hi[SIDE][SIDE][SIDE]; /* [k][j][i] */
    float odd[SIDE][SIDE][SIDE];                      /* NaN: one is not finite; else 0 */
} block_values;

static void read_block(const curvilinear_lattice *l, const curvilinear_place *b, block_values *v) {
    const uint32_t first = curvilinear_lattice_node(l, b);
    for (uint32_t k = 0; k <= b->cells[2]; k++)
        for (uint32_t j = 0; j <= b->cells[1]; j++)
            for (uint32_t i = 0; i <= b->cells[0]; i++) {
                const float x = l->values[first + i + l->nodes[0] * (j + l->nodes[1] * k)];
                v->lo[k][j][i] = v->hi[k][j][i] = x;
                v->odd[k][j][i] = x - x;
            }
}

static void join(block_values *v, int k, int j, int i, int k1, int j1, int i1) {
    v->lo[k][j][i] = fminf(v->lo[k][j][i], v->lo[k1][j1][i1]);
    v->hi[k][j][i] = fmaxf(v->hi[k][j][i], v->hi[k1][j1][i1]);
    v->odd[k][j][i] += v->odd[k1][j1][i1];
}

/* From nodes to cells, axis by axis. */
static void join_nodes(const curvilinear_place *b, block_values *v) {
    for (int a = 0; a < 3; a++)
        for (int k = 0; k < b->cells[2] + (a < 2); k++)
            for (int j = 0; j < b->cells[1] + (a < 1); j++)
                for (int i = 0; i < b->cells[0]; i++)
                    join(v, k, j, i, k + (a == 2), j + (a == 1), i + (a == 0));
}

void curvilinear_lattice_fill(curvilinear_lattice *l, const float *values) {
    l->values = values;
    memset(l->active, 0, l->blocks * sizeof *l->active);
    memset(l->tree.active[0], 0, l->blocks);
    treelet_tree_select(&l->tree, l->tree.active[0]);
    for (uint32_t n = 0; n < l->blocks; n++) {
        const curvilinear_place *b = &l->places[n];
        const uint32_t first = curvilinear_lattice_node(l, b);
        float lo = INFINITY, hi = -INFINITY;
        for (uint32_t k = 0; k <= b->cells[2]; k++)
            for (uint32_t j = 0; j <= b->cells[1]; j++)
                for (uint32_t i = 0; i <= b->cells[0]; i++) {
                    const float x = values[first + i + l->nodes[0] * (j + l->nodes[1] * k)];
                    lo = isfinite(x) && x < lo ? x : lo;
                    hi = isfinite(x) && x > hi ? x : hi;
                }
        l->ranges[n][0] = lo;
        l->ranges[n][1] = hi;
    }
}

static uint64_t select_block(const curvilinear_lattice *l, const curvilinear_place *b,
                             const interest *in) {
    block_values v;
    uint64_t mask = 0;
    read_block(l, b, &v);
    join_nodes(b, &v);
    for (unsigned k = 0; k < b->cells[2]; k++)
        for (unsigned j = 0; j < b->cells[1]; j++)
            for (unsigned i = 0; i < b->cells[0]; i++) {
                const unsigned bit = i + BLOCK * (j + BLOCK * k);
                const uint32_t cell = curvilinear_lattice_cell(l, b, bit);
                if (v.odd[k][j][i] == 0.0f && curvilinear_lattice_code(l, cell) != HEX_NONE &&
                    interest_meets(in, v.lo[k][j][i], v.hi[k][j][i]))
                    mask |= UINT64_C(1) << bit;
            }
    return mask;
}

static hexahedron corners_of(const curvilinear_lattice *l, const curvilinear_place *b) {
    const uint32_t first = curvilinear_lattice_node(l, b);
    hexahedron h;
    for (uint32_t c = 0; c < HEX_CORNERS; c++) {
        const uint32_t i = c & 1 ? b->cells[0] : 0, j = c & 2 ? b->cells[1] : 0,
                       k = c & 4 ? b->cells[2] : 0;
        const uint32_t node = first + i + l->nodes[0] * (j + l->nodes[1] * k);
        for (int a = 0; a < 3; a++)
            h.p[c][a] = (double)l->p[a][node];
        h.value[c] = (double)l->values[node];
    }
    return h;
}

static curvilinear_plane plane_of(const curvilinear_lattice *l, const curvilinear_place *b) {
    const hexahedron h = corners_of(l, b);
    const uint32_t first = curvilinear_lattice_node(l, b);
    curvilinear_plane out = {.from = {h.p[0][0], h.p[0][1], h.p[0][2]},
                             .rest = {INFINITY, -INFINITY}};
    hexahedron_gradient(&h, out.gradient);
    for (uint32_t k = 0; k <= b->cells[2]; k++)
        for (uint32_t j = 0; j <= b->cells[1]; j++)
            for (uint32_t i = 0; i <= b->cells[0]; i++) {
                const uint32_t node = first + i + l->nodes[0] * (j + l->nodes[1] * k);
                double rest = (double)l->values[node];
                for (int a = 0; a < 3; a++)
                    rest -= out.gradient[a] * ((double)l->p[a][node] - out.from[a]);
                out.rest[0] = rest < out.rest[0] ? rest : out.rest[0];
                out.rest[1] = rest > out.rest[1] ? rest : out.rest[1];
            }
    return out;
}

void curvilinear_lattice_select(curvilinear_lattice *l, const interest *in) {
    for (uint32_t n = 0; n < l->blocks; n++) {
        const float *range = l->ranges[n];
        l->active[n] = range[0] <= range[1] && interest_meets(in, range[0], range[1])
                           ? select_block(l, &l->places[n], in)
                           : 0;
        l->tree.active[0][n] = l->active[n] != 0;
        if (l->active[n])
            l->planes[n] = plane_of(l, &l->places[n]);
    }
    treelet_tree_select(&l->tree, l->tree.active[0]);
}
