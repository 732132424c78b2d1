#include "prep/generate/tet_lattice.h"

#include <assert.h>
#include <math.h>
#include <stdbool.h>
#include <string.h>

#include "formats/base/num.h"
#include "formats/base/portable_math.h"
#include "formats/mesh/mesh_input.h"

/* Outside of this range, a product with a number of cells might leave the range of floats. */
#define SPACING_LEAST 1e-30
#define SPACING_MOST  1e30

/* ---- limits ---- */

static status check_axis(const tet_lattice_shape *s, int a) {
    assert(s->dims[a] >= 2 && s->copies[a] >= 1);
    uint64_t cells = (uint64_t)(s->dims[a] - 1) * s->copies[a];
    if (cells > TET_LATTICE_CELLS_MAX)
        return status_describe(ST_USAGE, "%llu cells along %c, more than %d",
                               (unsigned long long)cells, "xyz"[a], TET_LATTICE_CELLS_MAX);
    char text[NUM_TEXT_MAX];
    double size = fabs(s->spacing[a]);
    if (!(size >= SPACING_LEAST && size <= SPACING_MOST))
        return status_describe(ST_USAGE, "the spacing %s along %c is not within 1e-30 .. 1e30",
                               num_print(s->spacing[a], text), "xyz"[a]);
    return ST_OK;
}

/* The limits of the axes keep these counts below 2^60. */
uint64_t tet_lattice_count_points(const tet_lattice_shape *s) {
    uint64_t points = 1;
    for (int a = 0; a < 3; a++)
        points *= (uint64_t)s->dims[a] * s->copies[a];
    return points;
}

uint64_t tet_lattice_count_tets(const tet_lattice_shape *s) {
    uint64_t tets = 6;
    for (int a = 0; a < 3; a++)
        tets *= (uint64_t)(s->dims[a] - 1) * s->copies[a];
    return tets;
}

status tet_lattice_check(const tet_lattice_shape *s) {
    for (int a = 0; a < 3; a++) {
        status st = check_axis(s, a);
        if (st != ST_OK)
            return st;
    }
    char text[NUM_TEXT_MAX];
    if (!(fabs(s->deform) <= TET_LATTICE_DEFORM_MAX))
        return status_describe(ST_USAGE, "a deformation of %s is not within 0 .. %g",
                               num_print(s->deform, text), TET_LATTICE_DEFORM_MAX);
    uint64_t points = tet_lattice_count_points(s);
    if (points > MESH_POINTS_MAX)
        return status_describe(ST_USAGE, "%llu points, more than the %llu that a mesh may have",
                               (unsigned long long)points, (unsigned long long)MESH_POINTS_MAX);
    return ST_OK;
}

/* ---- set-up ---- */

/* An order of the axes, and whether a tet along it would be inverted. */
static const struct {
    uint8_t axis[3];
    uint8_t odd;
} orders[6] = {{{0, 1, 2}, 0}, {{1, 2, 0}, 0}, {{2, 0, 1}, 0},
               {{0, 2, 1}, 1}, {{2, 1, 0}, 1}, {{1, 0, 2}, 1}};

static void set_corners(tet_lattice *l) {
    const tet_lattice_shape *s = &l->shape;
    const uint32_t step[3] = {1, s->dims[0], s->dims[0] * s->dims[1]};
    bool mirrored = (s->spacing[0] < 0) ^ (s->spacing[1] < 0) ^ (s->spacing[2] < 0);
    for (int t = 0; t < 6; t++) {
        uint32_t *corner = l->corner[t];
        corner[0] = 0;
        for (int n = 0; n < 3; n++)
            corner[n + 1] = corner[n] + step[orders[t].axis[n]];
        if (mirrored != orders[t].odd) {
            uint32_t second = corner[1];
            corner[1] = corner[2];
            corner[2] = second;
        }
    }
}

/* Tabulate both sines for an axis of n nodes; they are exactly 0 at its ends. */
static void tabulate(double *sine, uint32_t n) {
    double turns = 2.0 * (n - 1);
    for (uint32_t i = 1; i + 1 < n; i++) {
        sine[i] = portable_sin(i / turns);
        sine[n + i] = portable_sin(2 * i / turns);
    }
}

status tet_lattice_init(tet_lattice *l, mem *m, const tet_lattice_shape *shape) {
    const uint32_t *dims = shape->dims, *copies = shape->copies;
    uint32_t least = dims[0] < dims[1] ? dims[0] : dims[1];
    least = least < dims[2] ? least : dims[2];
    uint32_t total = copies[0] * copies[1] * copies[2];
    *l = (tet_lattice){
        .shape = *shape,
        .points = tet_lattice_count_points(shape),
        .tets = tet_lattice_count_tets(shape),
        .row_points = dims[0],
        .row_tets = 6 * (dims[0] - 1),
        .copy_points = dims[0] * dims[1] * dims[2],
        .copies = total,
        .point_rows = (uint64_t)dims[1] * dims[2] * total,
        .tet_rows = (uint64_t)(dims[1] - 1) * (dims[2] - 1) * total,
        .amplitude = shape->deform * (least - 1) / 12.566370614359172,
    };
    set_corners(l);
    for (int a = 0; a < 3; a++) {
        l->sine[a] = mem_array(m, 2 * (size_t)dims[a], sizeof(double));
        if (!l->sine[a])
            return ST_NOMEM;
        tabulate(l->sine[a], dims[a]);
    }
    return ST_OK;
}

void tet_lattice_release(tet_lattice *l, mem *m) {
    for (int a = 0; a < 3; a++)
        mem_free(m, l->sine[a]);
}

/* ---- rows ---- */

/* A row's copy, and the place of its first node in that copy. */
typedef struct row_index {
    uint32_t copy;
    uint32_t j, k;
} row_index;

static row_index row_index_of(uint64_t row, uint32_t rows, uint32_t slices) {
    uint64_t slice = row / rows;
    return (row_index){.copy = (uint32_t)(slice / slices),
                       .j = (uint32_t)(row % rows),
                       .k = (uint32_t)(slice % slices)};
}

void tet_lattice_points(const tet_lattice *l, uint64_t row, float (*xyz)[3]) {
    const tet_lattice_shape *s = &l->shape;
    const uint32_t *dims = s->dims, *copies = s->copies;
    const row_index p = row_index_of(row, dims[1], dims[2]);
    const double x = (double)(p.copy % copies[0]) * (dims[0] - 1);
    const double y = (double)(p.copy / copies[0] % copies[1]) * (dims[1] - 1) + p.j;
    const double z = (double)(p.copy / copies[0] / copies[1]) * (dims[2] - 1) + p.k;
    /* The swirl's factors along y and z: [0] of one half wave, [1] of two. */
    const double sy[2] = {l->sine[1][p.j], l->sine[1][dims[1] + p.j]};
    const double sz[2] = {l->sine[2][p.k], l->sine[2][dims[2] + p.k]};
    const double along_x = l->amplitude * (sy[1] * sz[0]);
    const double along_y = l->amplitude * (sy[0] * sz[1]);
    const double along_z = l->amplitude * (sy[0] * sz[0]);
    const double *sx = l->sine[0], *sx2 = sx + dims[0];
    for (uint32_t i = 0; i < dims[0]; i++) {
        xyz[i][0] = (float)(s->spacing[0] * (x + i + along_x * sx[i]));
        xyz[i][1] = (float)(s->spacing[1] * (y + along_y * sx[i]));
        xyz[i][2] = (float)(s->spacing[2] * (z + along_z * sx2[i]));
    }
}

void tet_lattice_tets(const tet_lattice *l, uint64_t row, uint32_t (*ids)[4]) {
    const uint32_t *dims = l->shape.dims;
    const row_index p = row_index_of(row, dims[1] - 1, dims[2] - 1);
    uint32_t node = p.copy * l->copy_points + (p.k * dims[1] + p.j) * dims[0];
    for (uint32_t i = 0; i + 1 < dims[0]; i++, node++)
        for (int t = 0; t < 6; t++, ids++)
            for (int c = 0; c < 4; c++)
                (*ids)[c] = node + l->corner[t][c];
}
