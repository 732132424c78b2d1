#include "tests/support/between_hexes.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <math.h>
#include <string.h>

#include "formats/leaf/leaf_grow.h"
#include "prep/curvilinear/curvilinear_convert.h"
#include "prep/mesh/mixed_treelet.h"
#include "tests/support/mesh_movies.h"

enum { SIDE = BETWEEN_MESH_NODES, CELLS = BETWEEN_MESH_CELLS };

void between_hexes_hide(int step, float *to) {
    for (int i = 0; i < BETWEEN_MESH_POINTS; i++)
        to[i] = i * 7919 % 31 == step ? INFINITY : 0;
}

void between_hexes_fold(int step, float (*to)[3]) {
    for (int i = 0; i < BETWEEN_MESH_POINTS; i++)
        if (i * 104729 % 173 == step)
            to[i][i % 3] += 1.5F * BETWEEN_MESH_STRIDE;
}

/* ---- A curvilinear grid ---- */

/* Zones lie on one another along k. */
enum { ZONES = 4, LAYERS = CELLS / ZONES };
static const uint32_t nodes[ZONES][3] = {
    {SIDE, SIDE, LAYERS + 1},
    {SIDE, SIDE, LAYERS + 1},
    {SIDE, SIDE, LAYERS + 1},
    {SIDE, SIDE, LAYERS + 1},
};

/* The steps, as a reader hands them over. */
typedef struct lattice {
    const float *const *steps;
    const float *at; /* the one that was opened last */
    curvilinear_source source;
} lattice;

/* The nodes before a plane of a zone. */
static size_t before(uint32_t zone, uint32_t first) {
    return (size_t)(zone * LAYERS + first) * SIDE * SIDE;
}

static const float *at_step(const void *own) {
    return ((const lattice *)own)->at;
}

static status places(void *own, uint32_t zone, uint32_t first, uint32_t count, float (*p)[3]) {
    memcpy(p, at_step(own) + BETWEEN_MESH_POINTS + 3 * before(zone, first),
           count * SIDE * SIDE * sizeof *p);
    return ST_OK;
}

static status values(void *own, uint32_t zone, uint32_t of, uint32_t first, uint32_t count,
                     float *to) {
    (void)of;
    memcpy(to, at_step(own) + before(zone, first), count * SIDE * SIDE * sizeof *to);
    return ST_OK;
}

static status blanks(void *own, uint32_t zone, uint32_t first, uint32_t count, uint8_t *to) {
    const float *hidden = at_step(own) + BETWEEN_MESH_HIDDEN + before(zone, first);
    for (uint32_t i = 0; i < count * SIDE * SIDE; i++)
        to[i] = CURVILINEAR_NODE | (hidden[i] != 0 ? CURVILINEAR_HIDDEN : 0);
    return ST_OK;
}

static status open_step(void *ctx, uint32_t step, const curvilinear_source **out) {
    lattice *l = ctx;
    l->at = l->steps[step];
    *out = &l->source;
    return ST_OK;
}

static const char *path_of(void *ctx, uint32_t step) {
    (void)ctx, (void)step;
    return "arrays";
}

static void convert_lattice(mem *m, const between_kind *of, const float *const *steps,
                            uint32_t first, uint32_t count, const char *path) {
    lattice l = {
        .steps = steps + first,
        .source = {&l, ZONES, nodes, true, 1, places, values, blanks},
    };
    const curvilinear_series series = {
        &l,
        open_step,
        path_of,
        {.fields = 1, .steps = count, .times = between_times + first},
        false};
    curvilinear_options o = {.file = leaf_parameters_default(),
                             .memory = UINT64_C(1) << 30,
                             .threads = 2,
                             .force = true,
                             .grows = of->grown};
    curvilinear_result r;
    o.file.codec = of->codec;
    o.file.zstd_level = 1;
    o.file.histograms = true;
    m->limit = (size_t)o.memory;
    if (first > 0)
        assert_int_equal(leaf_grow_open(m, path, &o.grow), ST_OK);
    if (curvilinear_convert(m, &series, "between", path, &o, NULL, &r) != ST_OK)
        fail_msg("%s", status_text());
    leaf_grow_close(o.grow);
}

/* ---- A mesh ---- */

static void convert_mesh(mem *m, const between_kind *of, const float *const *steps, uint32_t first,
                         uint32_t count, const char *path) {
    static uint32_t corners[CELLS * CELLS * CELLS][8];
    mesh_movie v = between_mesh_movie(of, steps, first, count);
    mesh_result r;
    for (uint32_t i = 0; i < CELLS * CELLS * CELLS; i++) {
        const uint32_t node = i % CELLS + SIDE * (i / CELLS % CELLS + SIDE * (i / CELLS / CELLS));
        const uint32_t along[8] = {0, 1, SIDE + 1, SIDE}; /* as VTK has them */
        for (uint32_t c = 0; c < 8; c++)
            corners[i][c] = node + along[c % 4] + c / 4 * SIDE * SIDE;
    }
    v.hexes = (const uint32_t(*)[8])corners;
    v.hex_count = CELLS * CELLS * CELLS;
    v.c.options.cells = &mixed_treelets;
    v.c.options.treelet_tets = 200;
    mesh_movies_write(&v);
    if (first > 0)
        assert_int_equal(leaf_grow_open(m, path, &v.c.options.grow), ST_OK);
    if (mesh_movies_convert(m, &v, path, &r, false) != ST_OK)
        fail_msg("%s", status_text());
    leaf_grow_close(v.c.options.grow);
    mesh_movies_release(&v);
}

void between_hexes_convert(const between_kind *of, const float *const *steps, uint32_t first,
                           uint32_t count, const char *path) {
    mem m;
    mem_init(&m, 0);
    (of->cells == BETWEEN_CURVILINEAR ? convert_lattice : convert_mesh)(&m, of, steps, first, count,
                                                                        path);
    assert_int_equal(mem_used(&m), 0);
}
