#include "prep/resample/grid_cover.h"

#include <assert.h>
#include <math.h>

#include "formats/leaf/hex_treelet.h"

static size_t nodes_of(const resample_grid *g) {
    return (size_t)g->dims[0] * g->dims[1] * g->dims[2];
}

status grid_cover_init(grid_cover *c, mem *m, const resample_grid *g) {
    *c = (grid_cover){.grid = g, .m = m, .node = mem_array(m, nodes_of(g), 1)};
    return c->node ? ST_OK : ST_NOMEM;
}

void grid_cover_release(grid_cover *c) {
    mem_free(c->m, c->node);
}

void grid_cover_take(grid_cover *c, const float *samples, size_t count) {
    assert(count <= nodes_of(c->grid) - c->taken);
    for (size_t i = 0; i < count; i++)
        c->node[c->taken++] = (uint8_t)!isnan(samples[i]);
}

/* Whether the grid's cell around a point has data. */
static bool covers(const grid_cover *c, const double point[3]) {
    const resample_grid *g = c->grid;
    size_t at[3];
    for (int a = 0; a < 3; a++) {
        const double x = (point[a] - g->origin[a]) / g->spacing[a];
        if (!(x >= 0.0 && x < g->dims[a] - 1))
            return false;
        at[a] = (size_t)x;
    }
    for (size_t corner = 0; corner < HEX_CORNERS; corner++)
        if (!c->node[at[0] + (corner & 1) +
                     g->dims[0] *
                         (at[1] + (corner >> 1 & 1) + g->dims[1] * (at[2] + (corner >> 2)))])
            return false;
    return true;
}

/* The middle of a cell. Returns false if there is none, or it has no value. */
static bool middle_of(const hex_treelet *h, uint32_t cell, const float *values, double point[3]) {
    uint32_t row[CELL_ROW], corner[HEX_CORNERS];
    if (hex_treelet_code(h, cell) == HEX_NONE)
        return false;
    hex_treelet_row(h, cell, row);
    cell_row_corners(row, corner);
    for (int a = 0; a < 3; a++) {
        const float *x = hex_treelet_coordinates(h, a);
        point[a] = 0.0;
        for (int c = 0; c < HEX_CORNERS; c++)
            point[a] += (double)x[corner[c]] / HEX_CORNERS;
    }
    bool finite = true;
    for (int c = 0; c < HEX_CORNERS; c++)
        finite = finite && isfinite(values[corner[c]]);
    return finite;
}

static status count_all(const grid_cover *c, leaf_file *f, uint32_t set, leaf_unpacker *u,
                        char *room, uint64_t *cells, uint64_t *covered) {
    status st = ST_OK;
    for (uint32_t t = 0; t < f->layout.treelets && st == ST_OK; t++) {
        hex_treelet h;
        const float *values;
        double point[3];
        st = hex_treelet_load(f, t, set, u, room, &h, &values);
        for (uint32_t cell = 0; st == ST_OK && cell < h.cells; cell++)
            if (middle_of(&h, cell, values, point)) {
                ++*cells;
                *covered += covers(c, point);
            }
    }
    return st;
}

status grid_cover_count(const grid_cover *c, leaf_file *f, uint32_t set, uint64_t *cells,
                        uint64_t *covered) {
    leaf_unpacker *u = NULL;
    char *room = mem_alloc(c->m, HEX_TREELET_PAYLOADS * leaf_layout_payload_max(&f->layout));
    *cells = *covered = 0;
    assert(c->taken == nodes_of(c->grid));
    status st = room ? leaf_unpacker_create(c->m, f, &u) : ST_NOMEM;
    if (st == ST_OK)
        st = count_all(c, f, set, u, room, cells, covered);
    leaf_unpacker_destroy(u);
    mem_free(c->m, room);
    return st;
}
