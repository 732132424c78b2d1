#include "prep/mesh/triangle_treelet.h"

#include <assert.h>
#include <string.h>

#include "formats/leaf/triangle_coder.h"
#include "formats/leaf/triangle_geometry.h"
#include "prep/mesh/mesh_fetch.h"

typedef struct builder {
    mem *m;
    mesh_vertices nodes;
    triangle_shape shape; /* of the current treelet */
    float (*xyz)[3];      /* of its vertices */
    char *topology, *values;
} builder;

static void counts_max(uint32_t treelet_cells, uint32_t counts[4]) {
    const uint32_t most[4] = {treelet_cells, TRIANGLE_CORNERS * treelet_cells};
    memcpy(counts, most, sizeof most);
}

static triangle_shape largest_shape(uint32_t treelet_cells) {
    uint32_t counts[4];
    counts_max(treelet_cells, counts);
    return triangle_shape_of(counts);
}

static size_t payload_max(uint32_t treelet_cells) {
    return largest_shape(treelet_cells).topology_bytes;
}

static uint64_t memory(uint32_t treelet_cells) {
    const triangle_shape s = largest_shape(treelet_cells);
    return sizeof(builder) + mesh_vertices_memory(treelet_cells, TRIANGLE_CORNERS) +
           (uint64_t)s.vertices * sizeof(float[3]) + s.topology_bytes + s.value_bytes + 1024;
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
    assert(treelet_cells > 0 && treelet_cells <= TRIANGLES_MAX);
    builder *b = mem_zalloc(m, sizeof *b);
    if (!b)
        return ST_NOMEM;
    const triangle_shape s = largest_shape(treelet_cells);
    b->m = m;
    status st = mesh_vertices_init(&b->nodes, m, treelet_cells, TRIANGLE_CORNERS);
    b->xyz = mem_array(m, s.vertices, sizeof *b->xyz);
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
    mesh_vertices_number_met(&b->nodes, cells[0], sizeof *cells, count);
    *out = (cell_treelet){.counts = {(uint32_t)count, b->nodes.count}};
    b->shape = triangle_shape_of(out->counts);
}

static void clear(char *payload, uint32_t from, uint32_t end) {
    memset(payload + from, 0, end - from);
}

static uint64_t count_flat(const builder *b) {
    uint64_t count = 0;
    for (uint32_t i = 0; i < b->shape.triangles; i++) {
        const uint16_t *row = b->nodes.corners + TRIANGLE_CORNERS * (size_t)i;
        float p[3][3];
        for (int k = 0; k < TRIANGLE_CORNERS; k++)
            memcpy(p[k], b->xyz[row[k]], sizeof p[k]);
        count += triangle_is_flat((const float(*)[3])p);
    }
    return count;
}

static status place(void *of, mesh_pages *points, uint32_t step, cell_treelet *out) {
    builder *b = of;
    const triangle_shape *s = &b->shape;
    const uint32_t rows = triangle_rows_bytes(s);
    float *to = (float *)(void *)b->topology;
    const status st = mesh_fetch(&b->nodes, points, b->xyz, sizeof *b->xyz);
    if (st != ST_OK)
        return st;
    mesh_fetch_bounds((const float(*)[3])b->xyz, s->vertices, out->bounds);
    for (int a = 0; a < 3; a++)
        for (uint32_t n = 0; n < s->vertices; n++)
            *to++ = b->xyz[n][a];
    clear(b->topology, s->vertices * (uint32_t)sizeof(float[3]), s->place_bytes);
    out->topology = out->positions = b->topology;
    out->folded = 0;
    if (step > 0)
        return ST_OK;
    out->folded = count_flat(b);
    memcpy(b->topology + s->place_bytes, b->nodes.corners, rows);
    clear(b->topology, s->place_bytes + rows, s->topology_bytes);
    return ST_OK;
}

static status value(void *of, mesh_pages *values, cell_treelet *out) {
    builder *b = of;
    const triangle_shape *s = &b->shape;
    float *to = (float *)(void *)b->values;
    const status st = mesh_fetch(&b->nodes, values, to, sizeof *to);
    if (st != ST_OK)
        return st;
    clear(b->values, s->vertices * (uint32_t)sizeof *to, s->value_bytes);
    out->entry = mesh_fetch_range(to, s->vertices);
    out->values = b->values;
    return ST_OK;
}

const cell_treelets triangle_treelets = {.kind = LEAF_KIND_TRIANGLES,
                                         .corners = TRIANGLE_CORNERS,
                                         .cells_max = TRIANGLES_MAX,
                                         .nodes_least = TRIANGLE_CORNERS,
                                         .cells = "triangles",
                                         .coder = &triangle_coder,
                                         .memory = memory,
                                         .payload_max = payload_max,
                                         .counts_max = counts_max,
                                         .create = create,
                                         .destroy = destroy,
                                         .begin = begin,
                                         .place = place,
                                         .value = value};
