#include "formats/leaf/leaf_active.h"

#include <math.h>

#include "formats/leaf/hex_treelet.h"
#include "formats/mesh/mesh_leaf_check.h"

/* On which sides of the isovalue the values of an edge, a face or a cell lie. */
enum { SIDE_OUT = 1, SIDE_IN = 2, SIDE_NONE = 4, SIDE_BOTH = SIDE_OUT | SIDE_IN };

enum { ROW_MAX = (1 << LEAF_CELLS_LOG2_MAX) + 1 };

static unsigned side_of(float v, double iso) {
    return !isfinite(v) ? SIDE_NONE : (double)v >= iso ? SIDE_IN : SIDE_OUT;
}

/* ---- grids ---- */

/* Find the sides for each edge along x in the line of samples at (y, z). */
static void row_sides(const leaf_layout *l, const leaf_payload *p, const char *samples, double iso,
                      uint32_t y, uint32_t z, uint8_t sides[ROW_MAX]) {
    size_t first =
        l->halo + (size_t)p->samples[0] * (y + l->halo + (size_t)p->samples[1] * (z + l->halo));
    uint8_t before = 0;
    for (uint32_t x = 0; x <= p->cells[0]; x++) {
        const uint8_t side = (uint8_t)side_of(sample_get(l->type, samples, first + x), iso);
        if (x > 0)
            sides[x - 1] = before | side;
        before = side;
    }
}

static uint64_t count_grid(const leaf_layout *l, uint32_t t, const void *payload, double iso) {
    leaf_payload p = leaf_layout_payload(l, t);
    const char *samples = (const char *)payload + p.samples_at;
    uint64_t count = 0;
    for (uint32_t z = 0; z < p.cells[2]; z++) {
        uint8_t near[2][ROW_MAX],
            far[2][ROW_MAX]; /* rows y and y + 1 (in alternating places) of slices z and z + 1 */
        row_sides(l, &p, samples, iso, 0, z, near[0]);
        row_sides(l, &p, samples, iso, 0, z + 1, far[0]);
        for (uint32_t y = 0; y < p.cells[1]; y++) {
            const uint32_t now = y & 1, next = now ^ 1;
            row_sides(l, &p, samples, iso, y + 1, z, near[next]);
            row_sides(l, &p, samples, iso, y + 1, z + 1, far[next]);
            for (uint32_t x = 0; x < p.cells[0]; x++)
                count += (near[now][x] | near[next][x] | far[now][x] | far[next][x]) == SIDE_BOTH;
        }
    }
    return count;
}

static status active_grid(const leaf_active *a, uint64_t *cells) {
    const leaf_layout *l = &a->f->layout;
    const status st =
        leaf_file_load(a->f, leaf_layout_samples(l, a->set, a->treelet), a->unpacker, a->room);
    if (st == ST_OK)
        *cells = count_grid(l, a->treelet, a->room, a->iso);
    return st;
}

/* ---- meshes ---- */

static uint64_t count_tets(const leaf_active *a, const void *topology, const void *values) {
    const mesh_shape s = mesh_leaf_shape(a->f->mesh->counts[a->treelet]);
    const uint16_t(*tet)[4] = mesh_leaf_tets(&s, topology);
    const float *value = mesh_leaf_values(&s, values);
    uint64_t count = 0;
    for (uint32_t i = 0; i < s.tets; i++) {
        unsigned sides = 0;
        for (int c = 0; c < 4; c++)
            sides |= side_of(value[tet[i][c]], a->iso);
        count += sides == SIDE_BOTH;
    }
    return count;
}

static status active_tets(const leaf_active *a, uint64_t *cells) {
    leaf_file *f = a->f;
    char *topology = a->room, *values = topology + leaf_layout_payload_max(&f->layout);
    status st = leaf_file_load(f, a->treelet, a->unpacker, topology);
    if (st == ST_OK)
        st = mesh_leaf_check_loaded(f, a->treelet, topology);
    if (st == ST_OK)
        st = leaf_file_load(f, leaf_layout_values(&f->layout, a->set, a->treelet), a->unpacker,
                            values);
    if (st == ST_OK)
        *cells = count_tets(a, topology, values);
    return st;
}

/* ---- hexahedra ---- */

/* The sides of what a quadratic tet may have beyond the values of its nodes. */
static unsigned beyond_nodes(const float *values, const uint32_t row[CELL_ROW], double iso) {
    float v[QUADRATIC_NODES], limits[2];
    for (int n = 0; n < QUADRATIC_NODES; n++)
        v[n] = values[row[n]];
    curved_quadratic_limits(v, &limits[0], &limits[1]);
    return side_of(limits[0], iso) | side_of(limits[1], iso);
}

static status active_hexes(const leaf_active *a, uint64_t *cells) {
    const float *values;
    hex_treelet h;
    const status st = hex_treelet_load(a->f, a->treelet, a->set, a->unpacker, a->room, &h, &values);
    if (st != ST_OK)
        return st;
    for (uint32_t i = 0; i < h.cells; i++) {
        uint32_t row[CELL_ROW];
        unsigned sides = 0;
        if (hex_treelet_code(&h, i) == HEX_NONE)
            continue;
        hex_treelet_row(&h, i, row);
        for (int n = 0; n < CELL_ROW; n++)
            sides |= side_of(values[row[n]], a->iso);
        if (cell_row_is_quadratic(row))
            sides |= beyond_nodes(values, row, a->iso);
        *cells += sides == SIDE_BOTH;
    }
    return ST_OK;
}

status leaf_active_count(const leaf_active *a, uint64_t *cells) {
    const leaf_file *f = a->f;
    *cells = 0;
    if (f->geometry->cells || (f->geometry->noded && !f->geometry->noded->hexahedra))
        return ST_OK;
    return (f->geometry->noded ? active_hexes : f->mesh ? active_tets : active_grid)(a, cells);
}
