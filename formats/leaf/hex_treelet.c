#include "formats/leaf/hex_treelet.h"

#include <math.h>

#include "formats/leaf/leaf_coder.h"

hex_treelet hex_treelet_of(const leaf_file *f, uint32_t t) {
    hex_treelet h = {.f = f, .id = t};
    f->geometry->noded->count(&h);
    return h;
}

uint32_t hex_treelet_places(const leaf_layout *l, uint32_t step, uint32_t t) {
    const uint32_t place = leaf_layout_place(l, step);
    return place ? leaf_layout_positions(l, place, t) : t;
}

uint32_t hex_treelet_stored_bytes(const leaf_layout *l, uint32_t p, leaf_block *block) {
    uint32_t index;
    *block = leaf_layout_block_of(l, p, &index);
    return (uint32_t)l->geometry->coder->bytes(*block, l->counts[p % l->treelets]);
}

leaf_beside hex_treelet_beside(const leaf_layout *l, uint32_t p) {
    leaf_block block;
    const uint32_t bytes = hex_treelet_stored_bytes(l, p, &block);
    return leaf_layout_block_beside(l, block, bytes, 0);
}

uint32_t hex_treelet_payload_bytes(const leaf_layout *l, uint32_t p) {
    leaf_block block;
    const leaf_beside b = hex_treelet_beside(l, p);
    return leaf_layout_block_bytes(&b, hex_treelet_stored_bytes(l, p, &block));
}

void hex_treelet_cell(const hex_treelet *h, uint32_t i, const float *values, curved_cell *out) {
    uint32_t row[CELL_ROW];
    hex_treelet_row(h, i, row);
    out->quadratic = cell_row_is_quadratic(row);
    out->sense = hex_code_sense(hex_treelet_code(h, i));
    out->number = i;
    for (int n = 0; n < curved_cell_nodes(out); n++) {
        double p[3];
        for (int a = 0; a < 3; a++)
            p[a] = (double)hex_treelet_coordinates(h, a)[row[n]];
        curved_cell_put(out, n, p, values ? (double)values[row[n]] : 0.0);
    }
}

/* ---- checks ---- */

static status fault(const hex_treelet *h, const char *what, uint32_t i, const char *how) {
    return status_describe(ST_CORRUPT, "%s: treelet %u's %s %u %s", file_path(h->f->source), h->id,
                           what, i, how);
}

status hex_treelet_check_values(const hex_treelet *h, uint32_t set, const float *values) {
    const size_t element = leaf_layout_samples(&h->f->layout, set, h->id);
    const float *own = h->f->own[element];
    const bool may_miss = h->f->flags[element] & LEAF_FLAG_NON_FINITE;
    for (uint32_t n = 0; n < h->nodes; n++) {
        const float v = values[n];
        if (isfinite(v) ? v < own[0] || v > own[1] : !may_miss)
            return fault(h, "node", n, "is not inside of its range");
    }
    return ST_OK;
}

status hex_treelet_check_places(const hex_treelet *h, uint32_t step) {
    const float(*boxes)[6] = h->f->geometry->section(h->f, LEAF_SECTION_BOUNDS);
    const float *bounds = boxes[leaf_layout_bounds(&h->f->layout, step, h->id)];
    for (int a = 0; a < 3; a++) {
        const float *x = hex_treelet_coordinates(h, a), lo = bounds[a], hi = bounds[a + 3];
        for (uint32_t n = 0; n < h->nodes; n++)
            if (!(x[n] >= lo && x[n] <= hi))
                return fault(h, "node", n, "is not inside of it");
    }
    return ST_OK;
}

status hex_treelet_check_corners(const hex_treelet *h) {
    for (uint32_t i = 0; i < h->cells; i++) {
        uint32_t row[CELL_ROW];
        hex_treelet_row(h, i, row);
        for (int c = 0; c < CELL_ROW; c++)
            if (row[c] >= h->nodes)
                return fault(h, "cell", i, "has a corner at no node");
    }
    return ST_OK;
}

status hex_treelet_check(const hex_treelet *h, uint32_t set, const float *values) {
    status st = hex_treelet_check_places(h, leaf_layout_step(&h->f->layout, set));
    if (st == ST_OK && h->f->geometry->noded->listed)
        st = hex_treelet_check_corners(h);
    return st == ST_OK ? hex_treelet_check_values(h, set, values) : st;
}

/* ---- reading ---- */

static size_t payload_bytes(const leaf_file *f) {
    return leaf_layout_aligned(leaf_layout_payload_max(&f->layout), LEAF_ALIGN_LOG2);
}

hex_treelet hex_treelet_in(const leaf_file *f, uint32_t t, uint32_t set, const void *room,
                           const float **values) {
    const char *const topology = room, *const places = topology + payload_bytes(f),
                      *const last = places + payload_bytes(f);
    const uint32_t at = hex_treelet_places(&f->layout, leaf_layout_step(&f->layout, set), t);
    hex_treelet h = hex_treelet_of(f, t);
    h.topology = topology;
    h.places = (const float *)(const void *)(at == t ? topology : places);
    *values = (const float *)(const void *)last;
    return h;
}

status hex_treelet_load(leaf_file *f, uint32_t t, uint32_t set, leaf_unpacker *u, void *room,
                        hex_treelet *h, const float **values) {
    char *const topology = room, *const places = topology + payload_bytes(f),
                *const last = places + payload_bytes(f);
    const uint32_t at = hex_treelet_places(&f->layout, leaf_layout_step(&f->layout, set), t);
    status st = ST_OK;
    if (at == t || f->geometry->noded->listed)
        st = leaf_file_load(f, t, u, topology);
    if (st == ST_OK && at != t)
        st = leaf_file_load(f, at, u, places);
    if (st == ST_OK)
        st = leaf_file_load(f, leaf_layout_values(&f->layout, set, t), u, last);
    *h = hex_treelet_in(f, t, set, room, values);
    return st == ST_OK ? hex_treelet_check(h, set, *values) : st;
}

status hex_treelet_load_values(leaf_file *f, const hex_treelet *h, uint32_t set, leaf_unpacker *u,
                               void *to, const float **values) {
    const status st = leaf_file_load(f, leaf_layout_values(&f->layout, set, h->id), u, to);
    *values = to;
    return st == ST_OK ? hex_treelet_check_values(h, set, *values) : st;
}
