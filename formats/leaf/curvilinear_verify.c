#include "formats/leaf/curvilinear_verify.h"

#include <math.h>
#include <stddef.h>

#include "formats/base/hexahedron.h"
#include "formats/leaf/curvilinear_draw.h"
#include "formats/leaf/curvilinear_geometry.h"
#include "formats/leaf/hex_treelet.h"
#include "formats/leaf/leaf_histogram.h"
#include "formats/leaf/places_verify.h"

/* A treelet while it is checked. */
typedef struct subject {
    places_subject of;
    const uint32_t *cells;
} subject;

/* ---- places ---- */

/* The corners of the cell that begins at a node. */
static uint32_t corner_of(const subject *s, uint32_t node, uint32_t corner) {
    const uint32_t row = s->cells[0] + 1, plane = row * (s->cells[1] + 1);
    return node + (corner & 1) + (corner >> 1 & 1) * row + (corner >> 2) * plane;
}

static hex_code made_again(const subject *s, uint32_t node) {
    uint32_t row[CELL_ROW];
    for (uint32_t c = 0; c < CELL_ROW; c++)
        row[c] = corner_of(s, node, c < HEX_CORNERS ? c : 0);
    return places_code(&s->of, row);
}

static const uint8_t *codes_of(const subject *s) {
    return (const uint8_t *)(s->of.places + 3 * (size_t)s->of.nodes);
}

static hex_code code_of(const subject *s, uint32_t cell) {
    return (hex_code)(codes_of(s)[cell / 4] >> 2 * (cell % 4) & 3);
}

typedef status check_cell(const subject *s, uint32_t cell, uint32_t node);

/* node: the cell's first one. */
static status each_cell(const subject *s, check_cell *check) {
    status st = ST_OK;
    uint32_t cell = 0;
    for (uint32_t k = 0; k < s->cells[2]; k++)
        for (uint32_t j = 0; j < s->cells[1]; j++)
            for (uint32_t i = 0; i < s->cells[0] && st == ST_OK; i++)
                st = check(s, cell++, i + (s->cells[0] + 1) * (j + (s->cells[1] + 1) * k));
    return st;
}

static status check_code(const subject *s, uint32_t cell, uint32_t node) {
    const hex_code code = code_of(s, cell);
    return code == HEX_NONE || code == made_again(s, node)
               ? ST_OK
               : places_wrong(&s->of, 3 * sizeof(float) * s->of.nodes + cell / 4,
                              "a cell's bits are not those of its corners");
}

/* Bits behind the last cell are zero, and so is the rest. */
static status check_tail(const subject *s) {
    const uint32_t cells = curvilinear_cells(s->cells), begin = 3 * sizeof(float) * s->of.nodes;
    if (cells % 4 && codes_of(s)[cells / 4] >> 2 * (cells % 4))
        return places_wrong(&s->of, begin + cells / 4, "expected 0 behind the last cell's bits");
    return places_check_zeros(&s->of, s->of.places, begin + (cells + 3) / 4,
                              curvilinear_place_bytes(s->cells));
}

static status check_places(subject *s, uint32_t step) {
    const leaf_layout *l = &s->of.f->layout;
    s->of.payload = hex_treelet_places(l, step, s->of.t);
    status st = places_check_box(
        &s->of, curvilinear_directory_of(s->of.f)->bounds[leaf_layout_bounds(l, step, s->of.t)]);
    if (st == ST_OK)
        st = each_cell(s, check_code);
    return st == ST_OK ? check_tail(s) : st;
}

/* ---- histograms ---- */

static void measure(const leaf_verifying *v, const subject *s, uint32_t set) {
    const curvilinear_directory *d = curvilinear_directory_of(s->of.f);
    const histogram_run run = leaf_histogram_run(s->of.f, set, d->first[s->of.f->layout.treelets]);
    curvilinear_draw draw;
    for (curvilinear_draw_begin(&draw, &run, d->first[s->of.t], s->cells);
         curvilinear_draw_next(&draw);) {
        const float *at[HISTOGRAM_CORNERS];
        float places[HISTOGRAM_CORNERS][3], values[HISTOGRAM_CORNERS];
        const uint32_t *of = draw.place;
        const bool none =
            code_of(s, of[0] + s->cells[0] * (of[1] + s->cells[1] * of[2])) == HEX_NONE;
        for (uint32_t c = 0; c < HISTOGRAM_CORNERS; c++) {
            const uint32_t node = corner_of(s, draw.node, c);
            for (uint32_t a = 0; a < 3; a++)
                places[c][a] = s->of.places[a * s->of.nodes + node];
            values[c] = none ? NAN : s->of.values[node];
            at[c] = places[c];
        }
        v->cells[set * v->count + draw.run] = histogram_hex(at, values);
    }
}

/* ---- a treelet ---- */

static uint64_t cells_of(const leaf_file *f) {
    return curvilinear_directory_of(f)->first[f->layout.treelets];
}

static size_t room_of(const leaf_file *f) {
    return 2 * (size_t)leaf_layout_payload_max(&f->layout);
}

static status verify_treelet(const leaf_verifying *v, uint32_t treelet, uint64_t *non_finite) {
    const leaf_layout *l = &v->f->layout;
    char *values = v->room + leaf_layout_payload_max(l);
    subject s = {{.f = v->f, .t = treelet}, l->counts[treelet]};
    s.of.nodes = curvilinear_nodes(s.cells);
    s.of.places = (const float *)(void *)v->room;
    s.of.values = (const float *)(void *)values;
    status st = ST_OK;
    for (uint32_t step = 0; step < l->steps && st == ST_OK; step++) {
        if (step == 0 || leaf_layout_place(l, step) > 0) {
            st = v->load(v, hex_treelet_places(l, step, treelet), v->room);
            if (st == ST_OK)
                st = check_places(&s, step);
        }
        for (uint32_t field = 0; field * l->steps < l->sets && st == ST_OK; field++) {
            const uint32_t set = leaf_layout_set(l, field, step);
            st = v->load(v, leaf_layout_values(l, set, treelet), values);
            if (st == ST_OK)
                st = places_check_values(&s.of, set, curvilinear_value_bytes(s.cells), non_finite);
            if (st == ST_OK && v->cells)
                measure(v, &s, set);
        }
    }
    return st;
}

const leaf_verifier curvilinear_verifier = {"cells", cells_of, room_of, verify_treelet};
