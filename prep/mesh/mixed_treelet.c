#include "prep/mesh/mixed_treelet.h"

#include <assert.h>
#include <string.h>

#include "formats/curved/curved_cell.h"
#include "formats/leaf/mixed_coder.h"
#include "prep/mesh/mesh_fetch.h"

typedef struct builder {
    mem *m;
    mesh_vertices nodes;
    mixed_shape shape; /* of the current treelet */
    float (*xyz)[3];   /* of its nodes */
    char *topology, *values;
} builder;

static void counts_max(uint32_t treelet_cells, uint32_t counts[4]) {
    const uint32_t most[4] = {treelet_cells, CELL_ROW * treelet_cells, treelet_cells};
    memcpy(counts, most, sizeof most);
}

static mixed_shape largest_shape(uint32_t treelet_cells) {
    uint32_t counts[4];
    counts_max(treelet_cells, counts);
    return mixed_shape_of(counts);
}

static size_t payload_max(uint32_t treelet_cells) {
    return largest_shape(treelet_cells).topology_bytes;
}

static uint64_t memory(uint32_t treelet_cells) {
    const mixed_shape s = largest_shape(treelet_cells);
    return sizeof(builder) + mesh_vertices_memory(treelet_cells, CELL_ROW) +
           (uint64_t)s.nodes * sizeof(float[3]) + s.topology_bytes + s.value_bytes + 1024;
}

static void destroy(void *made) {
    builder *b = made;
    if (!b)
        return;
    mesh_vertices_release(&b->nodes);
    mem_free(b->m, b->xyz);
    mem_free(b->m, b->topology);
    mem_free(b->m, b->values);
    mem_free(b->m, b);
}

static status create(mem *m, uint32_t treelet_cells, void **out) {
    assert(treelet_cells > 0 && treelet_cells <= MIXED_TREELET_MAX);
    builder *b = mem_zalloc(m, sizeof *b);
    if (!b)
        return ST_NOMEM;
    const mixed_shape s = largest_shape(treelet_cells);
    b->m = m;
    status st = mesh_vertices_init(&b->nodes, m, treelet_cells, CELL_ROW);
    b->xyz = mem_array(m, s.nodes, sizeof *b->xyz);
    b->topology = mem_alloc(m, s.topology_bytes);
    b->values = mem_alloc(m, s.value_bytes);
    if (st == ST_OK && !(b->xyz && b->topology && b->values))
        st = ST_NOMEM;
    if (st != ST_OK) {
        destroy(b);
        return st;
    }
    *out = b;
    return ST_OK;
}

static void begin(void *of, const uint32_t (*cells)[CELL_ROW], size_t count, cell_treelet *out) {
    builder *b = of;
    uint32_t quadratic = 0;
    for (size_t i = 0; i < count; i++)
        quadratic += cell_row_is_quadratic(cells[i]);
    mesh_vertices_number_met(&b->nodes, cells[0], sizeof *cells, count);
    *out = (cell_treelet){.counts = {(uint32_t)count, b->nodes.count, quadratic}};
    b->shape = mixed_shape_of(out->counts);
    /* Rows of hexahedra alone are as short as they can be. */
    for (size_t i = 0; i < count; i++)
        memmove(b->nodes.corners + b->shape.width * i, b->nodes.corners + CELL_ROW * i,
                b->shape.width * sizeof *b->nodes.corners);
}

static void clear(char *payload, uint32_t from, uint32_t end) {
    memset(payload + from, 0, end - from);
}

static hex_code code_of(const builder *b, uint32_t cell) {
    uint32_t row[CELL_ROW];
    mixed_row(&b->shape, b->nodes.corners, cell, row);
    curved_cell c = {.quadratic = cell_row_is_quadratic(row)};
    for (int n = 0; n < curved_cell_nodes(&c); n++) {
        const float *x = b->xyz[row[n]];
        curved_cell_put(&c, n, (const double[3]){(double)x[0], (double)x[1], (double)x[2]}, 0.0);
    }
    return hex_code_of(curved_cell_sense(&c));
}

/* Places: coordinates one axis after another, then the cells' codes. */
static void place_nodes(builder *b, cell_treelet *out) {
    const mixed_shape *s = &b->shape;
    float *to = (float *)(void *)b->topology;
    uint8_t *codes = (uint8_t *)b->topology + s->codes_at;
    for (int a = 0; a < 3; a++)
        for (uint32_t n = 0; n < s->nodes; n++)
            *to++ = b->xyz[n][a];
    clear(b->topology, s->codes_at, s->place_bytes);
    for (int a = 0; a < 3; a++)
        mixed_widen(s, b->nodes.corners, mixed_coordinates(s, b->topology, a), &out->bounds[a],
                    &out->bounds[a + 3]);
    out->folded = 0;
    for (uint32_t i = 0; i < s->cells; i++) {
        const hex_code code = code_of(b, i);
        codes[i / 4] |= (uint8_t)(code << 2 * (i % 4));
        out->folded += code == HEX_FOLDED;
    }
}

static status place(void *of, mesh_pages *points, uint32_t step, cell_treelet *out) {
    builder *b = of;
    const mixed_shape *s = &b->shape;
    const uint32_t rows = mixed_rows_bytes(s);
    const status st = mesh_fetch(&b->nodes, points, b->xyz, sizeof *b->xyz);
    if (st != ST_OK)
        return st;
    mesh_fetch_bounds((const float(*)[3])b->xyz, s->nodes, out->bounds);
    place_nodes(b, out);
    out->topology = out->positions = b->topology;
    if (step > 0)
        return ST_OK;
    memcpy(b->topology + s->rows_at, b->nodes.corners, rows);
    clear(b->topology, s->rows_at + rows, s->topology_bytes);
    return ST_OK;
}

static status value(void *of, mesh_pages *values, cell_treelet *out) {
    builder *b = of;
    const mixed_shape *s = &b->shape;
    float *value = (float *)(void *)b->values;
    const status st = mesh_fetch(&b->nodes, values, value, sizeof *value);
    if (st != ST_OK)
        return st;
    clear(b->values, s->nodes * (uint32_t)sizeof *value, s->value_bytes);
    out->entry = mesh_fetch_range(value, s->nodes);
    mixed_widen(s, b->nodes.corners, value, &out->entry.own[0], &out->entry.own[1]);
    out->values = b->values;
    return ST_OK;
}

const cell_treelets mixed_treelets = {.kind = LEAF_KIND_MIXED,
                                      .corners = CELL_ROW,
                                      .cells_max = MIXED_TREELET_MAX,
                                      .nodes_least = 4,
                                      .cells = "cells",
                                      .histograms = true,
                                      .coder = &mixed_coder,
                                      .memory = memory,
                                      .payload_max = payload_max,
                                      .counts_max = counts_max,
                                      .create = create,
                                      .destroy = destroy,
                                      .begin = begin,
                                      .place = place,
                                      .value = value};
