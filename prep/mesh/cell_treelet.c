#include "prep/mesh/cell_treelet.h"

#include <assert.h>
#include <string.h>

#include "prep/mesh/mesh_fetch.h"

uint64_t cell_builder_memory(const cell_treelets *kind, uint32_t treelet_cells) {
    const cell_treelet_most most = kind->most(treelet_cells);
    return sizeof(cell_builder) + mesh_vertices_memory(treelet_cells, kind->corners) +
           (uint64_t)most.counts[1] * sizeof(float[3]) + most.topology_bytes + most.value_bytes +
           1024;
}

void cell_builder_destroy(cell_builder *b) {
    if (!b)
        return;
    mesh_vertices_release(&b->nodes);
    mem_free(b->m, b->xyz);
    mem_free(b->m, b->topology);
    mem_free(b->m, b->values);
    mem_free(b->m, b);
}

status cell_builder_create(const cell_treelets *kind, mem *m, uint32_t treelet_cells,
                           cell_builder **out) {
    assert(treelet_cells > 0 && treelet_cells <= kind->cells_max);
    cell_builder *b = mem_zalloc(m, sizeof *b);
    if (!b)
        return ST_NOMEM;
    const cell_treelet_most most = kind->most(treelet_cells);
    b->m = m;
    status st = mesh_vertices_init(&b->nodes, m, treelet_cells, kind->corners);
    b->xyz = mem_array(m, most.counts[1], sizeof *b->xyz);
    b->topology = mem_alloc(m, most.topology_bytes);
    b->values = mem_alloc(m, most.value_bytes);
    if (st == ST_OK && !(b->xyz && b->topology && b->values))
        st = ST_NOMEM;
    if (st != ST_OK) {
        cell_builder_destroy(b);
        return st;
    }
    *out = b;
    return ST_OK;
}

void cell_builder_clear(char *payload, uint32_t from, uint32_t end) {
    memset(payload + from, 0, end - from);
}

status cell_builder_place(cell_builder *b, mesh_pages *points, cell_treelet *out) {
    float *to = (float *)(void *)b->topology;
    const status st = mesh_fetch(&b->nodes, points, b->xyz, sizeof *b->xyz);
    if (st != ST_OK)
        return st;
    mesh_fetch_bounds((const float(*)[3])b->xyz, b->nodes.count, out->bounds);
    for (int a = 0; a < 3; a++)
        for (uint32_t n = 0; n < b->nodes.count; n++)
            *to++ = b->xyz[n][a];
    out->topology = out->positions = b->topology;
    return ST_OK;
}

status cell_builder_value(cell_builder *b, mesh_pages *values, uint32_t value_bytes,
                          cell_treelet *out) {
    float *to = (float *)(void *)b->values;
    const status st = mesh_fetch(&b->nodes, values, to, sizeof *to);
    if (st != ST_OK)
        return st;
    cell_builder_clear(b->values, b->nodes.count * (uint32_t)sizeof *to, value_bytes);
    out->entry = mesh_fetch_range(to, b->nodes.count);
    out->values = b->values;
    return ST_OK;
}
