#include <math.h>

#include "formats/leaf/hex_treelet.h"
#include "prep/resample/resample_cells.h"

static int payloads(const leaf_file *f, uint32_t set) {
    (void)f, (void)set;
    return HEX_TREELET_PAYLOADS;
}

/* A curvilinear grid has about as many nodes as cells. */
static uint64_t nodes(const leaf_file *f) {
    return f->header.vertices ? f->header.vertices : f->geometry->verifier->cells(f);
}

/* Finding where in a hexahedron a node lies takes long: with more, converting would, too. */
enum { COARSE_NODES = 1 << 22 };

static uint64_t coarse(const leaf_file *f) {
    const uint64_t all = nodes(f);
    return all < COARSE_NODES ? all : COARSE_NODES;
}

static status load(const resample_treelet *t, leaf_unpacker *u) {
    hex_treelet h;
    const float *values;
    return hex_treelet_load(t->f, t->id, t->set, u, t->room, &h, &values);
}

/* ---- one cell ---- */

typedef struct drawing {
    const resample_block *block;
    uint64_t first_row, end_row;
    double lo[3], hi[3]; /* the box that all nodes are taken to */
    curved_cell cell;
    bool finite;               /* all nodes have values */
    double least, most;        /* of them */
    uint32_t first[3], end[3]; /* range of nodes in the cell's box */
} drawing;

/* Take up a cell. Returns false if there is none, or no node in its box. */
static bool take(drawing *d, const hex_treelet *h, uint32_t cell, const float *values) {
    double box[2][3], range[2];
    if (hex_treelet_code(h, cell) == HEX_NONE)
        return false;
    hex_treelet_cell(h, cell, values, &d->cell);
    curved_cell_box(&d->cell, box);
    for (int a = 2; a >= 0; a--) {
        resample_grid_nodes(d->block->grid, a, box[0][a], box[1][a], &d->first[a], &d->end[a]);
        if (d->first[a] == d->end[a])
            return false;
    }
    curved_cell_range(&d->cell, range);
    d->finite = true;
    for (int n = 0; n < curved_cell_nodes(&d->cell); n++)
        d->finite = d->finite && isfinite(curved_cell_value(&d->cell, n));
    d->least = range[0];
    d->most = range[1];
    return true;
}

static void draw_node(const drawing *d, const double at[3], float *sample) {
    double point[3], in[3], value;
    for (int a = 0; a < 3; a++)
        point[a] = fmin(fmax(at[a], d->lo[a]), d->hi[a]);
    if (curved_cell_find(&d->cell, point, in, &value))
        resample_block_give(sample, d->finite ? (float)fmin(fmax(value, d->least), d->most) : NAN);
}

static void draw_row(const drawing *d, uint32_t y, uint32_t z) {
    const resample_grid *g = d->block->grid;
    const uint64_t row = (uint64_t)z * g->dims[1] + y;
    if (row < d->first_row || row >= d->end_row)
        return;
    float *samples = d->block->samples + (row - d->block->first_row) * g->dims[0];
    double at[3] = {0.0, resample_grid_node(g, 1, y), resample_grid_node(g, 2, z)};
    for (uint32_t x = d->first[0]; x < d->end[0]; x++) {
        at[0] = resample_grid_node(g, 0, x);
        if (resample_block_is_empty(&samples[x]))
            draw_node(d, at, &samples[x]);
    }
}

/* ---- a treelet of them ---- */

static void find_sides(drawing *d, const float bounds[6]) {
    for (int a = 0; a < 3; a++) {
        const double lo = (double)bounds[a], hi = (double)bounds[a + 3],
                     inset = 0x1p-30 * (hi - lo);
        d->lo[a] = lo + inset;
        d->hi[a] = hi - inset;
    }
}

static void draw(const resample_block *b, uint64_t first_row, uint64_t rows,
                 const resample_treelet *t) {
    const float *values;
    const hex_treelet h = hex_treelet_in(t->f, t->id, t->set, t->room, &values);
    drawing d = {.block = b, .first_row = first_row, .end_row = first_row + rows};
    find_sides(&d, t->f->header.bounds);
    for (uint32_t i = 0; i < h.cells; i++)
        if (take(&d, &h, i, values))
            for (uint32_t z = d.first[2]; z < d.end[2]; z++)
                for (uint32_t y = d.first[1]; y < d.end[1]; y++)
                    draw_row(&d, y, z);
}

const resample_cells resample_hexes = {NULL, payloads, nodes, coarse, load, draw};
