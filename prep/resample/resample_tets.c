#include <math.h>

#include "formats/leaf/leaf_unpacker.h"
#include "formats/leaf/mesh_geometry.h"
#include "formats/mesh/mesh_leaf.h"
#include "formats/mesh/mesh_leaf_check.h"
#include "prep/resample/resample_cells.h"
#include "prep/resample/tet_value.h"

/* Do not narrow rows of fewer nodes: it does not pay. */
enum { NARROW_MIN = 6 };

/* ---- one tet ---- */

/* The tet's faces as functions of position, positive inside, with bounds for the rounding error. */
typedef struct faces {
    double normal[4][3], from[4][3], error[4];
} faces;

typedef struct drawing {
    const resample_block *block;
    uint64_t first_row, end_row;
    tet_value tet;
    uint32_t first[3], end[3]; /* range of nodes in the tet's box */
    faces faces;
} drawing;

/* Find the nodes in the tet's box. Returns false if there are none. */
static bool find_box(drawing *d, const float *const xyz[4]) {
    for (int a = 2; a >= 0; a--) {
        float lo = xyz[0][a], hi = lo;
        for (int i = 1; i < 4; i++) {
            lo = xyz[i][a] < lo ? xyz[i][a] : lo;
            hi = xyz[i][a] > hi ? xyz[i][a] : hi;
        }
        resample_grid_nodes(d->block->grid, a, (double)lo, (double)hi, &d->first[a], &d->end[a]);
        if (d->first[a] == d->end[a])
            return false;
    }
    return true;
}

static void find_faces(drawing *d) {
    static const int FACES[4][4] = {{1, 2, 3, 0}, {0, 2, 3, 1}, {0, 1, 3, 2}, {0, 1, 2, 3}};
    for (int n = 0; n < 4; n++) {
        const double *p = d->tet.at[FACES[n][0]], *q = d->tet.at[FACES[n][1]],
                     *r = d->tet.at[FACES[n][2]], *inner = d->tet.at[FACES[n][3]];
        double height = 0, error = 0;
        for (int a = 0; a < 3; a++) {
            const int b = (a + 1) % 3, c = (a + 2) % 3;
            const double plus = (q[b] - p[b]) * (r[c] - p[c]),
                         minus = (q[c] - p[c]) * (r[b] - p[b]);
            const double extent = fabs(q[a] - p[a]) + fabs(r[a] - p[a]) + fabs(inner[a] - p[a]);
            d->faces.normal[n][a] = plus - minus;
            d->faces.from[n][a] = p[a];
            height += d->faces.normal[n][a] * (inner[a] - p[a]);
            error += (fabs(plus) + fabs(minus)) * extent;
        }
        d->faces.error[n] = 0x1p-45 * error;
        if (fabs(height) <= d->faces.error[n])
            d->faces.error[n] = INFINITY; /* unknown which side is inside */
        if (height < 0)
            for (int a = 0; a < 3; a++)
                d->faces.normal[n][a] = -d->faces.normal[n][a];
    }
}

/* Narrow a row to the nodes that may be inside. Steps and heights are right to `error` over the
 * tet's box. One more node at either end makes up for the division's rounding. */
static void narrow(const drawing *d, const double at[3], uint32_t *first, uint32_t *end) {
    const resample_grid *g = d->block->grid;
    double lo = *first, hi = *end;
    for (int n = 0; n < 4; n++) {
        const double *normal = d->faces.normal[n], *from = d->faces.from[n];
        const double error = d->faces.error[n];
        double height = 4 * error;
        for (int a = 0; a < 3; a++)
            height += normal[a] * (at[a] - from[a]);
        const double step = normal[0] * g->spacing[0], all = fabs(step) * (*end - *first);
        if (!(error < INFINITY) || all <= 4 * error) {
            if (height + 4 * error < 0)
                hi = lo;
            continue;
        }
        const double zero = *first - height / step;
        if (step > 0 && zero - 2 > lo)
            lo = floor(zero) - 1;
        if (step < 0 && zero + 3 < hi)
            hi = floor(zero) + 3;
    }
    *end = hi <= *first ? *first : hi < *end ? (uint32_t)hi : *end;
    *first = lo >= *end ? *end : lo > *first ? (uint32_t)lo : *first;
}

static void draw_row(const drawing *d, uint64_t row) {
    const resample_grid *g = d->block->grid;
    uint32_t first = d->first[0], end = d->end[0];
    double at[3] = {resample_grid_node(g, 0, first),
                    resample_grid_node(g, 1, (uint32_t)(row % g->dims[1])),
                    resample_grid_node(g, 2, (uint32_t)(row / g->dims[1]))};
    if (end - first >= NARROW_MIN)
        narrow(d, at, &first, &end);
    float *samples = d->block->samples + (row - d->block->first_row) * g->dims[0];
    for (uint32_t i = first; i < end; i++) {
        if (!resample_block_is_empty(&samples[i]))
            continue;
        float value;
        at[0] = resample_grid_node(g, 0, i);
        if (tet_value_at(&d->tet, at, &value))
            resample_block_give(&samples[i], value);
    }
}

static void draw_tet(drawing *d) {
    const uint64_t across = d->block->grid->dims[1];
    if (d->end[0] - d->first[0] >= NARROW_MIN)
        find_faces(d);
    const uint64_t z_first = d->first_row / across, z_last = (d->end_row - 1) / across;
    for (uint64_t z = d->first[2] > z_first ? d->first[2] : z_first; z < d->end[2] && z <= z_last;
         z++)
        for (uint64_t y = d->first[1]; y < d->end[1]; y++) {
            const uint64_t row = z * across + y;
            if (row >= d->first_row && row < d->end_row)
                draw_row(d, row);
        }
}

/* ---- a treelet of them ---- */

/* Its payloads, in this order. */
enum { TOPOLOGY, VALUES, MOVED, PAYLOADS };

static bool moves(const leaf_file *f, uint32_t set) {
    return leaf_layout_place(&f->layout, leaf_layout_step(&f->layout, set)) > 0;
}

static int payloads(const leaf_file *f, uint32_t set) {
    return moves(f, set) ? PAYLOADS : MOVED;
}

static uint64_t nodes(const leaf_file *f) {
    return f->header.vertices;
}

static uint64_t coarse(const leaf_file *f) {
    return f->header.tets / 2;
}

static status load(const resample_treelet *t, leaf_unpacker *u) {
    const leaf_layout *l = &t->f->layout;
    const uint32_t step = leaf_layout_step(l, t->set);
    char *const topology = resample_treelet_payload(t, TOPOLOGY), *const moved =
                                                                      resample_treelet_payload(
                                                                          t, MOVED);
    status st = leaf_file_load(t->f, t->id, u, topology);
    if (st == ST_OK)
        st = mesh_leaf_check_loaded(t->f, t->id, topology);
    if (st == ST_OK)
        st = leaf_file_load(t->f, leaf_layout_values(l, t->set, t->id), u,
                            resample_treelet_payload(t, VALUES));
    if (st != ST_OK || !moves(t->f, t->set))
        return st;
    st = leaf_file_load(t->f, leaf_layout_positions(l, step, t->id), u, moved);
    return st == ST_OK ? mesh_leaf_check_moved(t->f, step, t->id, moved) : st;
}

/* Returns whether a tet reaches the planes from z_lo to z_hi. */
static bool reaches(const float (*positions)[3], const uint16_t ids[4], double z_lo, double z_hi) {
    float lo = positions[ids[0]][2], hi = lo;
    for (int i = 1; i < 4; i++) {
        const float z = positions[ids[i]][2];
        lo = z < lo ? z : lo;
        hi = z > hi ? z : hi;
    }
    return (double)lo <= z_hi && (double)hi >= z_lo;
}

static void draw(const resample_block *b, uint64_t first_row, uint64_t rows,
                 const resample_treelet *treelet) {
    const leaf_file *f = treelet->f;
    const resample_grid *g = b->grid;
    const mesh_shape s = mesh_leaf_shape(f->mesh->counts[treelet->id]);
    const char *topology = resample_treelet_payload(treelet, TOPOLOGY);
    const float(*positions)[3] = moves(f, treelet->set)
                                     ? mesh_leaf_moved(&s, resample_treelet_payload(treelet, MOVED))
                                     : mesh_leaf_positions(&s, topology);
    const float *value = mesh_leaf_values(&s, resample_treelet_payload(treelet, VALUES));
    const uint16_t(*tets)[4] = mesh_leaf_tets(&s, topology);
    drawing d = {.block = b, .first_row = first_row, .end_row = first_row + rows};
    const double z_lo = resample_grid_node(g, 2, (uint32_t)(first_row / g->dims[1])),
                 z_hi = resample_grid_node(g, 2, (uint32_t)((d.end_row - 1) / g->dims[1]));
    for (uint32_t t = 0; t < s.tets; t++) {
        if (!reaches(positions, tets[t], z_lo, z_hi))
            continue;
        const float *xyz[4];
        float values_of[4];
        for (int i = 0; i < 4; i++) {
            xyz[i] = positions[tets[t][i]];
            values_of[i] = value[tets[t][i]];
        }
        if (!find_box(&d, xyz))
            continue;
        tet_value_init(&d.tet, xyz, values_of);
        if (d.tet.sign != 0)
            draw_tet(&d);
    }
}

const resample_cells resample_tets = {&mesh_geometry, payloads, nodes, coarse, load, draw};
