#include "prep/mesh/mixed_treelet.h"

#include <string.h>

#include "formats/curved/curved_cell.h"
#include "formats/leaf/mixed_coder.h"

static cell_treelet_most most(uint32_t treelet_cells) {
    cell_treelet_most out = {.counts = {treelet_cells, CELL_ROW * treelet_cells, treelet_cells}};
    const mixed_shape s = mixed_shape_of(out.counts);
    out.topology_bytes = s.topology_bytes;
    out.value_bytes = s.value_bytes;
    return out;
}

static void begin(cell_builder *b, const uint32_t (*cells)[CELL_ROW], size_t count,
                  cell_treelet *out) {
    uint32_t quadratic = 0;
    for (size_t i = 0; i < count; i++)
        quadratic += cell_row_is_quadratic(cells[i]);
    mesh_vertices_number_met(&b->nodes, cells[0], sizeof *cells, count);
    *out = (cell_treelet){.counts = {(uint32_t)count, b->nodes.count, quadratic}};
    memcpy(b->counts, out->counts, sizeof b->counts);
    /* Rows of hexahedra alone are as short as they can be. */
    const uint32_t width = mixed_shape_of(b->counts).width;
    for (size_t i = 0; i < count; i++)
        memmove(b->nodes.corners + width * i, b->nodes.corners + CELL_ROW * i,
                width * sizeof *b->nodes.corners);
}

static hex_code code_of(const cell_builder *b, const mixed_shape *s, uint32_t cell) {
    uint32_t row[CELL_ROW];
    mixed_row(s, b->nodes.corners, cell, row);
    curved_cell c = {.quadratic = cell_row_is_quadratic(row)};
    for (int n = 0; n < curved_cell_nodes(&c); n++) {
        const float *x = b->xyz[row[n]];
        curved_cell_put(&c, n, (const double[3]){(double)x[0], (double)x[1], (double)x[2]}, 0.0);
    }
    return hex_code_of(curved_cell_sense(&c));
}

/* Behind the coordinates are the cells' codes. Bounds are those of edges, too. */
static void code_cells(cell_builder *b, const mixed_shape *s, cell_treelet *out) {
    uint8_t *codes = (uint8_t *)b->topology + s->codes_at;
    cell_builder_clear(b->topology, s->codes_at, s->place_bytes);
    for (int a = 0; a < 3; a++)
        mixed_widen(s, b->nodes.corners, mixed_coordinates(s, b->topology, a), &out->bounds[a],
                    &out->bounds[a + 3]);
    out->folded = 0;
    for (uint32_t i = 0; i < s->cells; i++) {
        const hex_code code = code_of(b, s, i);
        codes[i / 4] |= (uint8_t)(code << 2 * (i % 4));
        out->folded += code == HEX_FOLDED;
    }
}

static status place(cell_builder *b, mesh_pages *points, uint32_t step, cell_treelet *out) {
    const mixed_shape s = mixed_shape_of(b->counts);
    const uint32_t rows = mixed_rows_bytes(&s);
    const status st = cell_builder_place(b, points, out);
    if (st != ST_OK)
        return st;
    code_cells(b, &s, out);
    if (step > 0)
        return ST_OK;
    memcpy(b->topology + s.rows_at, b->nodes.corners, rows);
    cell_builder_clear(b->topology, s.rows_at + rows, s.topology_bytes);
    return ST_OK;
}

static status value(cell_builder *b, mesh_pages *values, cell_treelet *out) {
    const mixed_shape s = mixed_shape_of(b->counts);
    const status st = cell_builder_value(b, values, s.value_bytes, out);
    if (st == ST_OK)
        mixed_widen(&s, b->nodes.corners, (const float *)(const void *)b->values,
                    &out->entry.own[0], &out->entry.own[1]);
    return st;
}

const cell_treelets mixed_treelets = {.kind = LEAF_KIND_MIXED,
                                      .corners = CELL_ROW,
                                      .cells_max = MIXED_TREELET_MAX,
                                      .nodes_least = 4,
                                      .cells = "cells",
                                      .histograms = true,
                                      .coder = &mixed_coder,
                                      .most = most,
                                      .begin = begin,
                                      .place = place,
                                      .value = value};
