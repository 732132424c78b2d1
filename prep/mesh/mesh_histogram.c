#include "prep/mesh/mesh_histogram.h"

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

static status take_tet(const uint32_t ids[4], mesh_pages *points, mesh_pages *values,
                       histogram_cell *out) {
    uint32_t id[4];
    float position[4][3], value[4];
    sort_ids(ids, id);
    for (int c = 0; c < 4; c++) {
        const void *p = mesh_pages_at(points, id[c]);
        if (!p)
            return points->st;
        memcpy(position[c], p, sizeof position[c]);
        const void *v = mesh_pages_at(values, id[c]);
        if (!v)
            return values->st;
        memcpy(&value[c], v, sizeof value[c]);
    }
    const float *const corners[4] = {position[0], position[1], position[2], position[3]};
    *out = histogram_tet(corners, value);
    return ST_OK;
}

status mesh_histogram_take(const mesh_histogram *h, uint32_t set, uint64_t first,
                           const mesh_record *records, size_t count, mesh_pages *points,
                           mesh_pages *values) {
    const histogram_run *r = &h->run;
    const uint64_t end = first + count;
    if (!h->cells)
        return ST_OK;
    for (uint64_t i = first / r->step; i * r->step < end; i++) {
        const uint64_t tet = histogram_draw_tet(r, (uint32_t)i);
        if (tet < first || tet >= end)
            continue;
        status st = take_tet(records[tet - first].id, points, values,
                             &h->cells[(size_t)set * r->count + i]);
        if (st != ST_OK)
            return st;
    }
    return ST_OK;
}
