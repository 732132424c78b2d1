#include "formats/leaf/mixed_verify.h"

#include <math.h>
#include <string.h>

#include "formats/leaf/leaf_histogram.h"
#include "formats/leaf/mixed_geometry.h"
#include "formats/leaf/places_verify.h"

/* A treelet while it is checked. */
typedef struct subject {
    places_subject of;
    mixed_shape shape;
    const uint16_t *rows;
} subject;

/* ---- topology ---- */

/* How many of a treelet's cells are quadratic tets. -1: a row is neither such a tet nor a
 * hexahedron's. */
static int64_t count_quadratic(const subject *s) {
    int64_t count = 0;
    for (uint32_t i = 0; i < s->shape.cells; i++) {
        uint32_t row[CELL_ROW];
        mixed_row(&s->shape, s->rows, i, row);
        if (!cell_row_is_quadratic(row)) {
            if (row[CELL_ROW - 1] != row[0])
                return -1;
            continue;
        }
        count++;
        for (int n = 1; n < CELL_ROW; n++)
            for (int k = 0; k < n; k++)
                if (row[n] == row[k])
                    return -1;
    }
    return count;
}

static status check_rows(const subject *s, const char *topology) {
    const mixed_shape *shape = &s->shape;
    uint32_t met = 0;
    for (uint32_t i = 0; i < shape->cells; i++)
        for (uint32_t c = 0; c < shape->width; c++) {
            const size_t k = (size_t)shape->width * i + c;
            const uint16_t node = s->rows[k];
            const size_t at = shape->rows_at + k * sizeof(uint16_t);
            if (node >= shape->nodes)
                return places_wrong(&s->of, at, "a cell is at no node");
            if (node > met)
                return places_wrong(&s->of, at, "nodes are not in the order of their first use");
            met += node == met;
        }
    if (met < shape->nodes)
        return places_wrong(&s->of, met * sizeof(float), "a node is at no cell");
    if (count_quadratic(s) != (int64_t)shape->quadratic)
        return places_wrong(&s->of, shape->rows_at, "quadratic tets are not as many as it says");
    return places_check_zeros(&s->of, topology, shape->rows_at + mixed_rows_bytes(shape),
                              shape->topology_bytes);
}

/* ---- places ---- */

static status check_codes(const subject *s) {
    const mixed_shape *shape = &s->shape;
    const char *places = (const char *)s->of.places;
    for (uint32_t i = 0; i < shape->cells; i++) {
        uint32_t row[CELL_ROW];
        mixed_row(shape, s->rows, i, row);
        if (mixed_code(shape, places, i) != places_code(&s->of, row))
            return places_wrong(&s->of, shape->codes_at + i / 4,
                                "a cell's bits are not those of its nodes");
    }
    const uint8_t last = (uint8_t)places[shape->codes_at + (shape->cells - 1) / 4];
    if (shape->cells % 4 && last >> 2 * (shape->cells % 4))
        return places_wrong(&s->of, shape->codes_at + shape->cells / 4,
                            "expected 0 behind the last cell's bits");
    return places_check_zeros(&s->of, places, shape->codes_at + (shape->cells + 3) / 4,
                              shape->place_bytes);
}

static void widen(const places_subject *of, const float *of_nodes, float *least, float *greatest) {
    const subject *s = (const subject *)of;
    mixed_widen(&s->shape, s->rows, of_nodes, least, greatest);
}

static status check_places(subject *s, uint32_t step) {
    const leaf_layout *l = &s->of.f->layout;
    const uint32_t place = leaf_layout_place(l, step), t = s->of.t;
    s->of.payload = place ? leaf_layout_positions(l, place, t) : t;
    const status st = places_check_box(
        &s->of, mixed_directory_of(s->of.f)->bounds[leaf_layout_bounds(l, step, t)]);
    return st == ST_OK ? check_codes(s) : st;
}

/* ---- histograms ---- */

static void measure(const leaf_verifying *v, const subject *s, uint32_t set) {
    const leaf_cells_directory *d = mixed_directory_of(s->of.f);
    const histogram_run r = leaf_histogram_run(s->of.f, set, d->first[s->of.f->layout.treelets]);
    const uint64_t first = d->first[s->of.t], end = first + s->shape.cells;
    for (uint64_t i = first / r.step; i * r.step < end; i++) {
        const uint64_t cell = histogram_draw_tet(&r, (uint32_t)i);
        if (cell < first || cell >= end)
            continue;
        const float *at[HISTOGRAM_CORNERS];
        float places[HISTOGRAM_CORNERS][3], values[HISTOGRAM_CORNERS];
        uint32_t row[CELL_ROW], corner[HEX_CORNERS];
        mixed_row(&s->shape, s->rows, (uint32_t)(cell - first), row);
        cell_row_corners(row, corner);
        for (uint32_t c = 0; c < HISTOGRAM_CORNERS; c++) {
            const uint32_t node = corner[c];
            for (uint32_t a = 0; a < 3; a++)
                places[c][a] = s->of.places[a * s->shape.nodes + node];
            values[c] = s->of.values[node];
            at[c] = places[c];
        }
        v->cells[set * v->count + i] = histogram_hex(at, values);
    }
}

/* ---- a treelet ---- */

static uint64_t cells_of(const leaf_file *f) {
    return f->header.tets;
}

/* The topology, the places of another step, values. */
static size_t room_of(const leaf_file *f) {
    return 3 * (size_t)leaf_layout_payload_max(&f->layout);
}

static status verify_step(const leaf_verifying *v, subject *s, uint32_t step, char *room,
                          uint64_t *non_finite) {
    const leaf_layout *l = &v->f->layout;
    const uint32_t place = leaf_layout_place(l, step);
    char *values = room + leaf_layout_payload_max(l);
    status st = ST_OK;
    if (place > 0) {
        st = v->load(v, leaf_layout_positions(l, place, s->of.t), room);
        s->of.places = (const float *)(void *)room;
    }
    if (st == ST_OK && (step == 0 || place > 0))
        st = check_places(s, step);
    for (uint32_t field = 0; field * l->steps < l->sets && st == ST_OK; field++) {
        const uint32_t set = leaf_layout_set(l, field, step);
        st = v->load(v, leaf_layout_values(l, set, s->of.t), values);
        s->of.values = (const float *)(void *)values;
        if (st == ST_OK)
            st = places_check_values(&s->of, set, s->shape.value_bytes, non_finite);
        if (st == ST_OK && v->cells)
            measure(v, s, set);
    }
    return st;
}

static status verify_treelet(const leaf_verifying *v, uint32_t treelet, uint64_t *non_finite) {
    const leaf_layout *l = &v->f->layout;
    const size_t each = leaf_layout_payload_max(l);
    subject s = {.of = {.f = v->f, .t = treelet, .payload = treelet},
                 .shape = mixed_shape_of(l->counts[treelet])};
    s.of.nodes = s.shape.nodes;
    s.of.places = (const float *)(void *)v->room;
    s.rows = mixed_rows(&s.shape, v->room);
    s.of.widen = widen;
    status st = v->load(v, treelet, v->room);
    if (st == ST_OK)
        st = check_rows(&s, v->room);
    for (uint32_t step = 0; step < l->steps && st == ST_OK; step++)
        st = verify_step(v, &s, step, v->room + each, non_finite);
    return st;
}

const leaf_verifier mixed_verifier = {"cells", cells_of, room_of, verify_treelet};
