#include "prep/mesh/mesh_histogram.h"

#include "formats/base/hexahedron.h"
#include <string.h>

uint64_t mesh_histogram_memory(void) {
    return HISTOGRAM_TETS * sizeof(histogram_cell);
}

status mesh_histogram_begin(mesh_histogram *h, mem *m, uint64_t tets, uint32_t sets) {
    *h = (mesh_histogram){.run = histogram_draw_tets(tets, sets), .sets = sets, .m = m};
    h->cells = mem_array(m, (size_t)h->run.count * sets, sizeof *h->cells);
    return h->cells ? ST_OK : ST_NOMEM;
}

void mesh_histogram_end(const mesh_histogram *h, leaf_writer *w) {
    histogram *out = leaf_writer_histograms(w);
    for (uint32_t set = 0; h->cells && set < h->sets; set++) {
        double range[2];
        leaf_writer_range(w, set, range);
        histogram_build(&out[set], h->cells + (size_t)set * h->run.count, h->run.count, SAMPLE_F32,
                        range, h->run.total);
    }
}

void mesh_histogram_release(mesh_histogram *h) {
    if (h->cells)
        mem_free(h->m, h->cells);
    h->cells = NULL;
}

status mesh_histogram_keep(mesh_histogram *h, state_io *io) {
    const size_t size = (size_t)h->run.count * h->sets * sizeof *h->cells;
    return h->cells ? state_io_bytes(io, h->cells, size) : ST_OK;
}

/* Sort a tet's corners by their ids, as the file has them. */
static void sort_ids(const uint32_t from[4], uint32_t to[4]) {
    for (int i = 0; i < 4; i++) {
        int k = i;
        for (; k > 0 && to[k - 1] > from[i]; k--)
            to[k] = to[k - 1];
        to[k] = from[i];
    }
}

/* The position and the value of a point. */
static status take_point(uint32_t id, mesh_pages *points, mesh_pages *values, float position[3],
                         float *value) {
    const void *p = mesh_pages_at(points, id);
    if (!p)
        return points->st;
    memcpy(position, p, sizeof(float[3]));
    const void *v = mesh_pages_at(values, id);
    if (!v)
        return values->st;
    memcpy(value, v, sizeof *value);
    return ST_OK;
}

static status take_tet(const uint32_t ids[4], mesh_pages *points, mesh_pages *values,
                       histogram_cell *out) {
    uint32_t id[4];
    float position[4][3], value[4];
    status st = ST_OK;
    sort_ids(ids, id);
    for (int c = 0; c < 4 && st == ST_OK; c++)
        st = take_point(id[c], points, values, position[c], &value[c]);
    if (st != ST_OK)
        return st;
    const float *const corners[4] = {position[0], position[1], position[2], position[3]};
    *out = histogram_tet(corners, value);
    return ST_OK;
}

/* A quadratic tet counts as the linear one of its corners. */
static status take_cell(const uint32_t row[CELL_ROW], mesh_pages *points, mesh_pages *values,
                        histogram_cell *out) {
    uint32_t ids[HEX_CORNERS];
    float position[HEX_CORNERS][3], value[HEX_CORNERS];
    const float *corners[HEX_CORNERS];
    status st = ST_OK;
    cell_row_corners(row, ids);
    for (int c = 0; c < HEX_CORNERS && st == ST_OK; c++) {
        st = take_point(ids[c], points, values, position[c], &value[c]);
        corners[c] = position[c];
    }
    if (st == ST_OK)
        *out = histogram_hex(corners, value);
    return st;
}

/* The cells that are drawn from a treelet, one of tets and cells. */
static status take(const mesh_histogram *h, uint32_t set, uint64_t first,
                   const mesh_record *records, const uint32_t (*cells)[CELL_ROW], size_t count,
                   mesh_pages *points, mesh_pages *values) {
    const histogram_run *r = &h->run;
    const uint64_t end = first + count;
    status st = ST_OK;
    if (!h->cells)
        return ST_OK;
    for (uint64_t i = first / r->step; i * r->step < end && st == ST_OK; i++) {
        const uint64_t drawn = histogram_draw_tet(r, (uint32_t)i);
        histogram_cell *to = &h->cells[(size_t)set * r->count + i];
        if (drawn < first || drawn >= end)
            continue;
        st = cells ? take_cell(cells[drawn - first], points, values, to)
                   : take_tet(records[drawn - first].id, points, values, to);
    }
    return st;
}

status mesh_histogram_take(const mesh_histogram *h, uint32_t set, uint64_t first,
                           const mesh_record *records, size_t count, mesh_pages *points,
                           mesh_pages *values) {
    return take(h, set, first, records, NULL, count, points, values);
}

status mesh_histogram_take_cells(const mesh_histogram *h, uint32_t set, uint64_t first,
                                 const uint32_t (*cells)[CELL_ROW], size_t count,
                                 mesh_pages *points, mesh_pages *values) {
    return take(h, set, first, NULL, cells, count, points, values);
}
