#include "formats/leaf/curvilinear_verify.h"

#include <math.h>
#include <stddef.h>

#include "formats/base/hexahedron.h"
#include "formats/leaf/curvilinear_draw.h"
#include "formats/leaf/curvilinear_geometry.h"
#include "formats/leaf/leaf_histogram.h"

/* A treelet while it is checked. */
typedef struct subject {
    const leaf_file *f;
    uint32_t t, payload; /* the one that is looked at */
    const uint32_t *cells;
    uint32_t nodes;
    const float *places, *values; /* as loaded */
} subject;

static status wrong(const subject *s, uint64_t at, const char *what) {
    return status_describe(ST_CORRUPT, "%s: byte %llu: treelet %u: %s", file_path(s->f->source),
                           (unsigned long long)(s->f->offsets[s->payload] + at), s->t, what);
}

static status check_zeros(const subject *s, const char *bytes, uint32_t from, uint32_t end) {
    for (uint32_t i = from; i < end; i++)
        if (bytes[i])
            return wrong(s, i, "expected 0 as padding");
    return ST_OK;
}

/* ---- places ---- */

static status check_box(const subject *s, const float bounds[6]) {
    for (uint32_t a = 0; a < 3; a++) {
        float lo = INFINITY, hi = -INFINITY;
        for (uint32_t n = 0; n < s->nodes; n++) {
            const float x = s->places[a * s->nodes + n];
            if (!isfinite(x))
                return wrong(s, (a * s->nodes + n) * sizeof(float), "a node is nowhere");
            lo = x < lo ? x : lo;
            hi = x > hi ? x : hi;
        }
        if (lo != bounds[a] || hi != bounds[a + 3])
            return wrong(s, a * s->nodes * sizeof(float), "its box is not that of its nodes");
    }
    return ST_OK;
}

/* The corners of the cell that begins at a node. */
static uint32_t corner_of(const subject *s, uint32_t node, uint32_t corner) {
    const uint32_t row = s->cells[0] + 1, plane = row * (s->cells[1] + 1);
    return node + (corner & 1) + (corner >> 1 & 1) * row + (corner >> 2) * plane;
}

static curvilinear_code made_again(const subject *s, uint32_t node) {
    double p[HEX_CORNERS][3];
    for (uint32_t c = 0; c < HEX_CORNERS; c++)
        for (uint32_t a = 0; a < 3; a++)
            p[c][a] = (double)s->places[a * s->nodes + corner_of(s, node, c)];
    const int sense = hexahedron_sense((const double(*)[3])p);
    return sense > 0 ? CURVILINEAR_RIGHT : sense < 0 ? CURVILINEAR_LEFT : CURVILINEAR_FOLDED;
}

static const uint8_t *codes_of(const subject *s) {
    return (const uint8_t *)(s->places + 3 * (size_t)s->nodes);
}

static curvilinear_code code_of(const subject *s, uint32_t cell) {
    return (curvilinear_code)(codes_of(s)[cell / 4] >> 2 * (cell % 4) & 3);
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
    const curvilinear_code code = code_of(s, cell);
    return code == CURVILINEAR_NONE || code == made_again(s, node)
               ? ST_OK
               : wrong(s, 3 * sizeof(float) * s->nodes + cell / 4,
                       "a cell's bits are not those of its corners");
}

/* Bits behind the last cell are zero, and so is the rest. */
static status check_tail(const subject *s) {
    const uint32_t cells = curvilinear_cells(s->cells), begin = 3 * sizeof(float) * s->nodes;
    if (cells % 4 && codes_of(s)[cells / 4] >> 2 * (cells % 4))
        return wrong(s, begin + cells / 4, "expected 0 behind the last cell's bits");
    return check_zeros(s, (const char *)s->places, begin + (cells + 3) / 4,
                       curvilinear_place_bytes(s->cells));
}

static status check_places(subject *s, uint32_t step) {
    const leaf_layout *l = &s->f->layout;
    s->payload = curvilinear_place_payload(l, step, s->t);
    status st =
        check_box(s, curvilinear_directory_of(s->f)->bounds[leaf_layout_bounds(l, step, s->t)]);
    if (st == ST_OK)
        st = each_cell(s, check_code);
    return st == ST_OK ? check_tail(s) : st;
}

/* ---- values ---- */

static status check_values(subject *s, uint32_t set, uint64_t *non_finite) {
    const size_t element = leaf_layout_samples(&s->f->layout, set, s->t);
    const float *own = s->f->own[element];
    float lo = INFINITY, hi = -INFINITY;
    uint64_t odd = 0;
    s->payload = leaf_layout_values(&s->f->layout, set, s->t);
    for (uint32_t n = 0; n < s->nodes; n++) {
        const float v = s->values[n];
        odd += !isfinite(v);
        lo = isfinite(v) && v < lo ? v : lo;
        hi = isfinite(v) && v > hi ? v : hi;
    }
    *non_finite += odd;
    if (lo != own[0] || hi != own[1])
        return wrong(s, 0, "its range is not that of its values");
    if ((odd > 0) != ((s->f->flags[element] & LEAF_FLAG_NON_FINITE) != 0))
        return wrong(s, 0, "its flags and its values differ about what is not finite");
    return check_zeros(s, (const char *)s->values, sizeof(float) * s->nodes,
                       curvilinear_value_bytes(s->cells));
}

/* ---- histograms ---- */

static void measure(const leaf_verifying *v, const subject *s, uint32_t set) {
    const curvilinear_directory *d = curvilinear_directory_of(s->f);
    const histogram_run run = leaf_histogram_run(s->f, set, d->first[s->f->layout.treelets]);
    curvilinear_draw draw;
    for (curvilinear_draw_begin(&draw, &run, d->first[s->t], s->cells);
         curvilinear_draw_next(&draw);) {
        const float *at[HISTOGRAM_CORNERS];
        float places[HISTOGRAM_CORNERS][3], values[HISTOGRAM_CORNERS];
        const uint32_t *of = draw.place;
        const bool none =
            code_of(s, of[0] + s->cells[0] * (of[1] + s->cells[1] * of[2])) == CURVILINEAR_NONE;
        for (uint32_t c = 0; c < HISTOGRAM_CORNERS; c++) {
            const uint32_t node = corner_of(s, draw.node, c);
            for (uint32_t a = 0; a < 3; a++)
                places[c][a] = s->places[a * s->nodes + node];
            values[c] = none ? NAN : s->values[node];
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
    subject s = {.f = v->f, .t = treelet, .cells = l->counts[treelet]};
    s.nodes = curvilinear_nodes(s.cells);
    s.places = (const float *)(void *)v->room;
    s.values = (const float *)(void *)values;
    status st = ST_OK;
    for (uint32_t step = 0; step < l->steps && st == ST_OK; step++) {
        if (step == 0 || leaf_layout_place(l, step) > 0) {
            st = v->load(v, curvilinear_place_payload(l, step, treelet), v->room);
            if (st == ST_OK)
                st = check_places(&s, step);
        }
        for (uint32_t field = 0; field * l->steps < l->sets && st == ST_OK; field++) {
            const uint32_t set = leaf_layout_set(l, field, step);
            st = v->load(v, leaf_layout_values(l, set, treelet), values);
            if (st == ST_OK)
                st = check_values(&s, set, non_finite);
            if (st == ST_OK && v->cells)
                measure(v, &s, set);
        }
    }
    return st;
}

const leaf_verifier curvilinear_verifier = {"cells", cells_of, room_of, verify_treelet};
