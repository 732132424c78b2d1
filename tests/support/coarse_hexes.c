#include "tests/support/coarse_hexes.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#include "prep/curvilinear/curvilinear_convert.h"
#include "prep/mesh/mesh_series.h"
#include "prep/mesh/mixed_treelet.h"
#include "tests/support/mesh_cases.h"
#include "tests/support/scratch.h"

enum { ZONES = 4, STEPS_MAX = 4, TREELET_CELLS = 200 };

coarse_hexes coarse_hexes_of(bool whole, uint32_t cells, uint32_t dims) {
    return (coarse_hexes){.whole = whole,
                          .cells = cells,
                          .steps = 1,
                          .coarse = true,
                          .dims = dims,
                          .codec = LEAF_CODEC_RAW,
                          .threads = 2,
                          .memory = UINT64_C(1) << 30};
}

static leaf_parameters parameters_of(const coarse_hexes *c) {
    leaf_parameters p = leaf_parameters_default();
    p.codec = c->codec;
    p.zstd_level = 1;
    return p;
}

static float value_at(const mesh_case *points, size_t i, uint32_t step) {
    return points->values[i] + 0.3F * (float)step;
}

/* ---- A curvilinear grid ---- */

/* Zones lie on one another along k. */
typedef struct lattice {
    const mesh_case *points;
    uint32_t nodes[ZONES][3], step;
    curvilinear_source source;
} lattice;

static size_t from(const lattice *l, uint32_t zone, uint32_t first) {
    const uint32_t layer = zone * (l->nodes[0][2] - 1) + first;
    return (size_t)layer * l->nodes[0][0] * l->nodes[0][1];
}

static size_t count_of(const lattice *l, uint32_t count) {
    return (size_t)count * l->nodes[0][0] * l->nodes[0][1];
}

static status places(void *own, uint32_t zone, uint32_t first, uint32_t count, float (*p)[3]) {
    const lattice *l = own;
    memcpy(p, l->points->points + from(l, zone, first), count_of(l, count) * sizeof *p);
    return ST_OK;
}

static status values(void *own, uint32_t zone, uint32_t field, uint32_t first, uint32_t count,
                     float *to) {
    const lattice *l = own;
    (void)field;
    for (size_t i = 0; i < count_of(l, count); i++)
        to[i] = value_at(l->points, from(l, zone, first) + i, l->step);
    return ST_OK;
}

static status open_step(void *ctx, uint32_t step, const curvilinear_source **out) {
    lattice *l = ctx;
    l->step = step;
    *out = &l->source;
    return ST_OK;
}

static const char *path_of(void *ctx, uint32_t step) {
    (void)ctx, (void)step;
    return "arrays";
}

static status convert_lattice(mem *m, const coarse_hexes *c, const mesh_case *points,
                              const char *path) {
    const uint32_t side = c->cells + 1;
    lattice l = {.points = points};
    l.source = (curvilinear_source){&l,     ZONES, (const uint32_t(*)[3])l.nodes, false, 1, places,
                                    values, NULL};
    for (int z = 0; z < ZONES; z++) {
        l.nodes[z][0] = l.nodes[z][1] = side;
        l.nodes[z][2] = c->cells / ZONES + 1;
    }
    const curvilinear_series series = {
        &l, open_step, path_of, {.fields = 1, .steps = c->steps}, false};
    const curvilinear_options o = {.file = parameters_of(c),
                                   .memory = c->memory,
                                   .threads = c->threads,
                                   .force = true,
                                   .coarse = c->coarse,
                                   .coarse_dims = c->dims};
    curvilinear_result r;
    return curvilinear_convert(m, &series, "lattice", path, &o, c->progress, &r);
}

/* ---- A mesh ---- */

static void write_mesh(const coarse_hexes *c, const mesh_case *points, uint32_t step,
                       const char *path) {
    const uint32_t n = c->cells, side = n + 1, all = n * n * n;
    FILE *f = fopen(path, "w");
    assert_non_null(f);
    fprintf(f, "# vtk DataFile Version 3.0\nlattice\nASCII\nDATASET UNSTRUCTURED_GRID\n");
    fprintf(f, "POINTS %zu float\n", points->point_count);
    for (size_t i = 0; i < points->point_count; i++)
        fprintf(f, "%.9g %.9g %.9g\n", (double)points->points[i][0], (double)points->points[i][1],
                (double)points->points[i][2]);
    fprintf(f, "CELLS %u %u\n", all, 9 * all);
    for (uint32_t i = 0; i < all; i++) {
        const uint32_t node = i % n + side * (i / n % n + side * (i / n / n));
        fprintf(f, "8");
        for (uint32_t k = 0; k < 2; k++)
            fprintf(f, " %u %u %u %u", node + k * side * side, node + k * side * side + 1,
                    node + k * side * side + side + 1, node + k * side * side + side);
        fputc('\n', f);
    }
    fprintf(f, "CELL_TYPES %u\n", all);
    for (uint32_t i = 0; i < all; i++)
        fprintf(f, "12\n");
    fprintf(f, "POINT_DATA %zu\nSCALARS f float 1\nLOOKUP_TABLE default\n", points->point_count);
    for (size_t i = 0; i < points->point_count; i++)
        fprintf(f, "%.9g\n", (double)value_at(points, i, step));
    assert_int_equal(fclose(f), 0);
}

static status convert_mesh(mem *m, const coarse_hexes *c, const mesh_case *points,
                           const char *output) {
    const char *paths[STEPS_MAX];
    const mesh_series series = {.of = {.paths = paths, .sets = {.fields = 1, .steps = c->steps}}};
    mesh_options o = mesh_options_default();
    mesh_input *x = NULL;
    mesh_result r;
    assert_true(c->steps <= STEPS_MAX);
    for (uint32_t s = 0; s < c->steps; s++) {
        char name[32];
        (void)snprintf(name, sizeof name, "hexes%u.vtk", s);
        paths[s] = scratch_path(name);
        write_mesh(c, points, s, paths[s]);
    }
    o.file = parameters_of(c);
    o.series = &series;
    o.cells = &mixed_treelets;
    o.force = true;
    o.treelet_tets = TREELET_CELLS;
    o.memory = c->memory;
    o.threads = c->threads;
    o.coarse = c->coarse;
    o.coarse_dims = c->dims;
    status st = mesh_input_open(m, paths[0], NULL, &x);
    if (st == ST_OK)
        st = mesh_convert_run(m, x, output, &o, c->progress, &r);
    mesh_input_close(x);
    return st;
}

status coarse_hexes_convert(mem *m, const coarse_hexes *c, const char *name) {
    mesh_case points = mesh_cases_kuhn(c->cells, c->cells, c->cells);
    const char *path = scratch_path(name);
    const size_t limit = m->limit;
    m->limit = (size_t)c->memory;
    const status st =
        c->whole ? convert_mesh(m, c, &points, path) : convert_lattice(m, c, &points, path);
    m->limit = limit;
    mesh_cases_free(&points);
    return st;
}
