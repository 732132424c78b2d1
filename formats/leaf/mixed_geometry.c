#include "formats/leaf/mixed_geometry.h"

#include "formats/curved/curved_cell.h"
#include "formats/leaf/hex_blending.h"
#include "formats/leaf/hex_treelet.h"
#include "formats/leaf/listed_geometry.h"
#include "formats/leaf/mixed_coder.h"
#include "formats/leaf/mixed_verify.h"

mixed_shape mixed_shape_of(const uint32_t counts[4]) {
    mixed_shape s = {.cells = counts[0],
                     .nodes = counts[1],
                     .quadratic = counts[2],
                     .width = counts[2] ? CELL_ROW : HEX_CORNERS};
    s.codes_at = s.nodes * (uint32_t)sizeof(float[3]);
    s.place_bytes = s.rows_at = leaf_aligned(s.codes_at + (s.cells + 3) / 4);
    s.topology_bytes = s.rows_at + leaf_aligned(mixed_rows_bytes(&s));
    s.value_bytes = leaf_aligned(s.nodes * (uint32_t)sizeof(float));
    return s;
}

const char *mixed_counts_fault(const uint32_t counts[4], uint32_t treelet_cells) {
    if (counts[0] < 1 || counts[0] > treelet_cells)
        return "so many cells";
    if (counts[2] > counts[0] || (counts[2] && counts[0] > MIXED_QUADRATIC_MAX))
        return "so many quadratic tets";
    if (counts[1] < 4 || counts[1] > (counts[2] ? CELL_ROW : HEX_CORNERS) * counts[0])
        return "so many nodes";
    return counts[3] ? "more than cells and nodes" : NULL;
}

void mixed_widen(const mixed_shape *s, const uint16_t *rows, const float *of_nodes, float *least,
                 float *greatest) {
    for (uint32_t i = 0; s->quadratic && i < s->cells; i++) {
        uint32_t row[CELL_ROW];
        float v[QUADRATIC_NODES], lo, hi, odd = 0.0F;
        mixed_row(s, rows, i, row);
        if (!cell_row_is_quadratic(row))
            continue;
        for (int n = 0; n < QUADRATIC_NODES; n++) {
            v[n] = of_nodes[row[n]];
            odd += v[n] - v[n]; /* NaN unless it is finite */
        }
        if (odd != 0.0F)
            continue;
        curved_quadratic_limits(v, &lo, &hi);
        *least = lo < *least ? lo : *least;
        *greatest = hi > *greatest ? hi : *greatest;
    }
}

/* ---- Cells ---- */

static void count(hex_treelet *h) {
    const mixed_shape s = mixed_shape_of(h->f->layout.counts[h->id]);
    h->nodes = s.nodes;
    h->cells = s.cells;
}

static void row_of(const hex_treelet *h, uint32_t cell, uint32_t row[CELL_ROW]) {
    const mixed_shape s = mixed_shape_of(h->f->layout.counts[h->id]);
    mixed_row(&s, mixed_rows(&s, h->topology), cell, row);
}

static const leaf_noded noded = {.listed = true,
                                 .hexahedra = true,
                                 .count = count,
                                 .row = row_of,
                                 .cells_max = MIXED_CELLS_MAX,
                                 .nodes_least = 4,
                                 .nodes_each = CELL_ROW,
                                 .counts_fault = mixed_counts_fault};

const leaf_geometry mixed_geometry = {LISTED_GEOMETRY, .coarse = true, .coder = &mixed_coder,
                                      .noded = &noded, .verifier = &mixed_verifier};
