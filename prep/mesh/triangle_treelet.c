#include "prep/mesh/triangle_treelet.h"

#include <string.h>

#include "formats/leaf/triangle_coder.h"
#include "formats/leaf/triangle_geometry.h"
#include "prep/mesh/mesh_fetch.h"

static cell_treelet_most most(uint32_t treelet_cells) {
    const uint32_t vertices = TRIANGLE_CORNERS * treelet_cells;
    cell_treelet_most out = {.counts = {treelet_cells, vertices, vertices}};
    const triangle_shape s = triangle_shape_of(out.counts);
    out.topology_bytes = s.topology_bytes;
    out.value_bytes = s.value_bytes;
    return out;
}

static void begin(cell_builder *b, const uint32_t (*cells)[CELL_ROW], size_t count,
                  cell_treelet *out) {
    mesh_vertices_number_met(&b->nodes, cells[0], sizeof *cells, count);
    *out = (cell_treelet){
        .counts = {(uint32_t)count, b->nodes.count, b->normals ? b->nodes.count : 0}};
    memcpy(b->counts, out->counts, sizeof b->counts);
}

static uint64_t count_flat(const cell_builder *b) {
    uint64_t count = 0;
    for (uint32_t i = 0; i < b->counts[0]; i++) {
        const uint16_t *row = b->nodes.corners + TRIANGLE_CORNERS * (size_t)i;
        float p[3][3];
        for (int k = 0; k < TRIANGLE_CORNERS; k++)
            memcpy(p[k], b->xyz[row[k]], sizeof p[k]);
        count += triangle_is_flat((const float(*)[3])p);
    }
    return count;
}

static status place(cell_builder *b, mesh_pages *points, uint32_t step, cell_treelet *out) {
    const triangle_shape s = triangle_shape_of(b->counts);
    const uint32_t rows = triangle_rows_bytes(&s);
    status st = cell_builder_place(b, points, out);
    if (st == ST_OK && b->normals)
        st = mesh_fetch(&b->nodes, b->normals, b->topology + s.vertices * sizeof(float[3]),
                        sizeof(uint32_t));
    if (st != ST_OK)
        return st;
    cell_builder_clear(b->topology, triangle_place_bytes(&s), s.place_bytes);
    out->folded = 0;
    if (step > 0)
        return ST_OK;
    out->folded = count_flat(b);
    memcpy(b->topology + s.place_bytes, b->nodes.corners, rows);
    cell_builder_clear(b->topology, s.place_bytes + rows, s.topology_bytes);
    return ST_OK;
}

static status value(cell_builder *b, mesh_pages *values, cell_treelet *out) {
    return cell_builder_value(b, values, triangle_shape_of(b->counts).value_bytes, out);
}

const cell_treelets triangle_treelets = {.kind = LEAF_KIND_TRIANGLES,
                                         .corners = TRIANGLE_CORNERS,
                                         .cells_max = TRIANGLES_MAX,
                                         .nodes_least = TRIANGLE_CORNERS,
                                         .cells = "triangles",
                                         .coder = &triangle_coder,
                                         .most = most,
                                         .begin = begin,
                                         .place = place,
                                         .value = value};
