/* test_curvilinear_thinned.c - every 2^n-th node of a curvilinear grid: each one's place and value,
 * and which nodes and cells are there, against the arrays that the grid was made from; what is
 * embedded, and drawn of a thin shell.
 */
/* marks: threads, bits */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "formats/leaf/curvilinear_geometry.h"
#include "formats/leaf/leaf_verify.h"
#include "prep/curvilinear/curvilinear_thinned.h"
#include "tests/support/curvilinear_steps.h"
#include "tests/support/fields.h"
#include "tests/support/fixture.h"
#include "tests/support/pictures.h"
#include "tests/support/scratch.h"

static mem m;

/* ---- the grid ---- */

enum { ZONES = 3 };

/* Several treelets along an axis, where 32 is one; a lone cell; nothing blanked. */
static const uint32_t NODES[ZONES][3] = {{70, 5, 38}, {2, 2, 2}, {33, 34, 3}};

typedef struct blocks {
    curvilinear_zone zones[ZONES];
    float (*p[ZONES])[3], *values[ZONES];
    uint8_t *blank[ZONES];
} blocks;

static size_t node_at(const uint32_t n[3], const uint32_t at[3]) {
    return at[0] + n[0] * ((size_t)at[1] + n[1] * (size_t)at[2]);
}

static size_t nodes_of(const uint32_t n[3]) {
    return (size_t)n[0] * n[1] * n[2];
}

/* Blocks of nodes are blanked, and blocks of cells are hidden. */
static uint8_t blank_at(field_random *r, const uint32_t at[3]) {
    const uint32_t block = at[0] / 6 + 3 * (at[1] / 3) + 7 * (at[2] / 5);
    return block % 11 == 4 ? 0 : block % 7 == 2 || field_random_below(r, 40) == 0 ? 3 : 1;
}

static void make_zone(blocks *g, uint32_t z, field_random *r) {
    const uint32_t *n = NODES[z];
    g->p[z] = malloc(nodes_of(n) * sizeof *g->p[z]);
    g->values[z] = malloc(nodes_of(n) * sizeof *g->values[z]);
    g->blank[z] = malloc(nodes_of(n));
    for (uint32_t k = 0; k < n[2]; k++)
        for (uint32_t j = 0; j < n[1]; j++)
            for (uint32_t i = 0; i < n[0]; i++) {
                const uint32_t at[3] = {i, j, k};
                const size_t node = node_at(n, at);
                for (int a = 0; a < 3; a++)
                    g->p[z][node][a] =
                        (float)at[a] + 100.0F * (float)z + 0.2F * (float)field_random_unit(r);
                g->values[z][node] = (float)field_random_unit(r);
                g->blank[z][node] = blank_at(r, at);
            }
    g->zones[z] = (curvilinear_zone){
        .p = (const float(*)[3])g->p[z], .values = g->values[z], .blank = z ? NULL : g->blank[z]};
    memcpy(g->zones[z].nodes, n, sizeof g->zones[z].nodes);
}

static void release(blocks *g) {
    for (int z = 0; z < ZONES; z++) {
        free(g->p[z]);
        free(g->values[z]);
        free(g->blank[z]);
    }
}

/* ---- what is expected ---- */

static bool has_cell(const curvilinear_zone *z, const uint32_t at[3]) {
    for (int a = 0; a < 3; a++)
        if (at[a] + 1 == z->nodes[a])
            return false;
    bool all = !z->blank || z->blank[node_at(z->nodes, at)] == CURVILINEAR_NODE;
    for (uint32_t c = 0; all && z->blank && c < 8; c++) {
        const uint32_t corner[3] = {at[0] + (c & 1), at[1] + (c >> 1 & 1), at[2] + (c >> 2)};
        all = z->blank[node_at(z->nodes, corner)] != 0;
    }
    return all;
}

/* Whether a cell of [from, end) is there. */
static bool any_cell(const curvilinear_zone *z, const uint32_t from[3], const uint32_t end[3]) {
    for (uint32_t k = from[2]; k < end[2]; k++)
        for (uint32_t j = from[1]; j < end[1]; j++)
            for (uint32_t i = from[0]; i < end[0]; i++)
                if (has_cell(z, (const uint32_t[3]){i, j, k}))
                    return true;
    return false;
}

/* What blanks() says of the node that is a coarse one, and is the first of a coarse cell. */
static uint8_t expected_blank(const curvilinear_zone *z, const uint32_t at[3], uint32_t log2) {
    uint32_t from[3], end[3], last[3];
    for (int a = 0; a < 3; a++) {
        from[a] = at[a] ? at[a] - 1 : 0;
        end[a] = at[a] + 1;
        last[a] = at[a] + (1U << log2) < z->nodes[a] ? at[a] + (1U << log2) : z->nodes[a] - 1;
    }
    if (!any_cell(z, from, end))
        return 0;
    return any_cell(z, at, last) ? CURVILINEAR_NODE : CURVILINEAR_NODE | CURVILINEAR_HIDDEN;
}

/* ---- tests ---- */

static void convert_steps(const curvilinear_steps *s, const char *name, bool coarse) {
    curvilinear_result r;
    curvilinear_options o = {.file = leaf_parameters_default(),
                             .memory = UINT64_C(1) << 30,
                             .threads = 2,
                             .force = true,
                             .coarse = coarse};
    if (curvilinear_convert(&m, &s->series, "g", scratch_path(name), &o, NULL, &r) != ST_OK)
        fail_msg("%s", status_text());
    assert_int_equal(r.header.moving, s->moves && s->series.sets.steps > 1);
}

static void convert(const curvilinear_zone *zones, uint32_t count, const char *name, bool coarse) {
    curvilinear_steps s;
    curvilinear_steps_init(&s, zones, count, 1, 1);
    convert_steps(&s, name, coarse);
}

/* Planes [first, first + count) of a zone. Returns the nodes that are there. */
static uint64_t check_planes(const blocks *g, curvilinear_thinned *t, uint32_t zone, uint32_t first,
                             uint32_t count) {
    const curvilinear_zone *z = &g->zones[zone];
    const uint32_t *n = t->source.nodes[zone];
    const size_t plane = (size_t)n[0] * n[1], all = plane * count;
    float(*p)[3] = malloc(all * sizeof *p), *values = malloc(all * sizeof *values);
    uint8_t *is_node = malloc(all);
    uint64_t there = 0;
    assert_int_equal(t->source.places(t, zone, first, count, p), ST_OK);
    assert_int_equal(t->source.values(t, zone, 0, first, count, values), ST_OK);
    assert_int_equal(t->source.blanks(t, zone, first, count, is_node), ST_OK);
    for (size_t i = 0; i < all; i++) {
        uint32_t at[3] = {(uint32_t)(i % n[0]), (uint32_t)(i / n[0] % n[1]),
                          first + (uint32_t)(i / plane)};
        for (int a = 0; a < 3; a++)
            at[a] = at[a] + 1 == n[a] ? z->nodes[a] - 1 : at[a] << t->log2;
        const size_t node = node_at(z->nodes, at);
        assert_int_equal(is_node[i], expected_blank(z, at, t->log2));
        if (!is_node[i])
            continue;
        there++;
        assert_memory_equal(p[i], z->p[node], sizeof p[i]);
        assert_true(values[i] == z->values[node]);
    }
    free(p);
    free(values);
    free(is_node);
    return there;
}

static void test_nodes(void **state) {
    (void)state;
    blocks g;
    field_random r = {11};
    leaf_file *f = NULL;
    for (uint32_t z = 0; z < ZONES; z++)
        make_zone(&g, z, &r);
    convert(g.zones, ZONES, "thin.leaf", false);
    assert_int_equal(leaf_file_open(&m, scratch_path("thin.leaf"), &f), ST_OK);
    for (uint32_t log2 = 1; log2 < 8; log2++) {
        curvilinear_thinned t;
        assert_int_equal(curvilinear_thinned_init(&t, &m, f, 0, log2), ST_OK);
        assert_true(t.source.blanked);
        for (uint32_t zone = 0; zone < ZONES; zone++) {
            uint32_t nodes[3];
            for (int a = 0; a < 3; a++)
                nodes[a] = (NODES[zone][a] - 2) / (1U << log2) + 2;
            assert_memory_equal(t.source.nodes[zone], nodes, sizeof nodes);
            const uint64_t all = check_planes(&g, &t, zone, 0, nodes[2]);
            uint64_t there = 0;
            for (uint32_t k = 0, run = 1; k < nodes[2]; k += run, run = run % 3 + 1)
                there += check_planes(&g, &t, zone, k, run < nodes[2] - k ? run : nodes[2] - k);
            assert_int_equal(there, all);
            assert_true(all > 0 && (zone == 0 || all == nodes_of(nodes)));
            assert_true(zone > 0 || log2 > 2 || all < nodes_of(nodes));
        }
        curvilinear_thinned_release(&t);
    }
    leaf_file_close(f);
    release(&g);
    assert_int_equal(mem_used(&m), 0);
}

/* The least n that has so few cells, all zones together. */
static void test_how_thin(void **state) {
    (void)state;
    blocks g;
    field_random r = {12};
    leaf_file *f = NULL;
    for (uint32_t z = 0; z < ZONES; z++)
        make_zone(&g, z, &r);
    convert(g.zones, ZONES, "thin.leaf", false);
    assert_int_equal(leaf_file_open(&m, scratch_path("thin.leaf"), &f), ST_OK);
    uint64_t before = UINT64_MAX;
    for (uint32_t log2 = 1; log2 <= 7; log2++) {
        uint64_t cells = 0;
        for (int z = 0; z < ZONES; z++) {
            uint64_t of = 1;
            for (int a = 0; a < 3; a++)
                of *= (NODES[z][a] - 2) / (1U << log2) + 1;
            cells += of;
        }
        assert_int_equal(curvilinear_thinned_log2(f, cells), log2);
        if (log2 > 1)
            assert_int_equal(curvilinear_thinned_log2(f, before - 1), log2);
        before = cells;
    }
    assert_int_equal(before, 3);
    assert_int_equal(curvilinear_thinned_log2(f, 0), 7);
    leaf_file_close(f);
    release(&g);
}

/* As convert --coarse makes it: sound, and of the same zones. */
static void test_embedded(void **state) {
    (void)state;
    blocks g;
    field_random r = {13};
    leaf_file *f = NULL, *coarse = NULL;
    for (uint32_t z = 0; z < ZONES; z++)
        make_zone(&g, z, &r);
    convert(g.zones, ZONES, "thin.leaf", true);
    assert_int_equal(leaf_file_open(&m, scratch_path("thin.leaf"), &f), ST_OK);
    assert_int_equal(leaf_verify(&m, f, 2, NULL), ST_OK);
    assert_int_equal(leaf_file_open_coarse(&m, f, 0, &coarse), ST_OK);
    assert_ptr_equal(coarse->geometry, f->geometry);
    assert_int_equal(coarse->header.zones, ZONES);
    for (int z = 0; z < ZONES; z++)
        for (int a = 0; a < 3; a++)
            assert_int_equal(curvilinear_directory_of(coarse)->zones[z][a],
                             (NODES[z][a] - 2) / 2 + 2);
    leaf_file_close(coarse);
    leaf_file_close(f);
    release(&g);
    assert_int_equal(mem_used(&m), 0);
}

/* Of each step, whether its nodes move or not, what is embedded in a file of it alone: its nodes'
 * own places, in the box that they have then. */
static void test_steps(void **state) {
    (void)state;
    enum { STEPS = 3 };
    blocks g;
    field_random r = {14};
    for (uint32_t z = 0; z < ZONES; z++)
        make_zone(&g, z, &r);
    for (int moves = 0; moves < 2; moves++) {
        leaf_file *f = NULL, *alone = NULL, *coarse = NULL;
        curvilinear_steps s;
        curvilinear_steps_init(&s, g.zones, ZONES, 1, STEPS);
        s.moves = moves;
        convert_steps(&s, "steps.leaf", true);
        assert_int_equal(leaf_file_open(&m, scratch_path("steps.leaf"), &f), ST_OK);
        assert_int_equal(leaf_verify(&m, f, 2, NULL), ST_OK);
        for (uint32_t step = 0; step < STEPS; step++) {
            curvilinear_steps_init(&s, g.zones, ZONES, 1, 1);
            s.moves = moves;
            s.before = step;
            convert_steps(&s, "alone.leaf", true);
            assert_int_equal(leaf_file_open(&m, scratch_path("alone.leaf"), &alone), ST_OK);
            assert_memory_equal(f->coarse[step].id, alone->coarse[0].id, sizeof alone->coarse->id);
            assert_int_equal(f->coarse[step].bytes, alone->coarse[0].bytes);
            leaf_file_close(alone);
            assert_int_equal(leaf_file_open_coarse(&m, f, step, &coarse), ST_OK);
            const float far = moves ? 0.5F * (float)step : 0.0F;
            assert_true(fabsf(coarse->header.bounds[0] - f->header.bounds[0] - far) < 0.3F);
            leaf_file_close(coarse);
        }
        leaf_file_close(f);
    }
    release(&g);
    assert_int_equal(mem_used(&m), 0);
}

/* A thin shell, of which a regular grid would show nothing: none is inside, and what is thinned is
 * the last level. */
static void test_shell(void **state) {
    (void)state;
    enum { SIDE = 33 };
    static float p[2 * SIDE * SIDE][3], values[2 * SIDE * SIDE];
    const curvilinear_zone zone = {
        .nodes = {SIDE, SIDE, 2}, .p = (const float(*)[3])p, .values = values};
    for (uint32_t n = 0; n < 2 * SIDE * SIDE; n++) {
        const double u = 0.05 * (n % SIDE), v = 0.05 * (n / SIDE % SIDE) - 0.8,
                     radius = 1.0 + 0.001 * (n / (SIDE * SIDE));
        p[n][0] = (float)(radius * cos(u) * cos(v));
        p[n][1] = (float)(radius * sin(u) * cos(v));
        p[n][2] = (float)(radius * sin(v));
        values[n] = n < SIDE * SIDE ? 0.0F : 1.0F;
    }
    convert(&zone, 1, "shell.leaf", true);
    leaf_file *f = NULL, *coarse = NULL;
    assert_int_equal(leaf_file_open(&m, scratch_path("shell.leaf"), &f), ST_OK);
    assert_int_equal(leaf_file_open_coarse(&m, f, 0, &coarse), ST_OK);
    assert_false(leaf_file_has_coarse(coarse, 0));
    leaf_file_close(coarse);
    leaf_file_close(f);
    leafcast *shell = fixture_open(scratch_path("shell.leaf"), NULL);
    const leafcast_surface s = leafcast_surface_default(0.5);
    leafcast_scene scene = leafcast_scene_default();
    const leafcast_camera view = leafcast_standard_view(shell, 1, PICTURE_WIDTH, PICTURE_HEIGHT);
    uint64_t hits[4];
    assert_int_equal(leafcast_describe(shell).preview_levels, 2);
    assert_int_equal(leafcast_select(shell, &s, 1), LEAFCAST_OK);
    for (uint32_t level = 0; level < 4; level++) {
        static picture drawn;
        leafcast_stats stats = {.size = sizeof stats};
        scene.preview = level > 0;
        scene.lod = LEAFCAST_LOD_LEVEL;
        scene.lod_level = level;
        pictures_draw(shell, &scene, &view, &drawn, &stats);
        hits[level] = stats.covered_pixels;
        assert_int_equal(stats.provisional_pixels, level ? PICTURE_PIXELS : 0);
    }
    assert_true(hits[0] > 0 && hits[1] > hits[0] / 2);
    assert_true(hits[2] == hits[1] && hits[3] == hits[1]);
    leafcast_close(shell);
    assert_int_equal(mem_used(&m), 0);
}

/* A ring whose nodes that are left lie in a plane: no regular grid is made of it, and it is
 * converted all the same. */
static void test_flat(void **state) {
    (void)state;
    static const float around[5][2] = {{1, 0}, {0, 1}, {-1, 0}, {0, -1}, {1, 0}};
    float p[5 * 3 * 3][3], values[5 * 3 * 3];
    const curvilinear_zone zone = {.nodes = {5, 3, 3}, .p = (const float(*)[3])p, .values = values};
    leaf_file *f = NULL, *coarse = NULL;
    for (int n = 0; n < 5 * 3 * 3; n++) {
        const float radius = 1.0F + (float)(n / 5 % 3);
        p[n][0] = radius * around[n % 5][0];
        p[n][1] = radius * around[n % 5][1];
        p[n][2] = (float)(n / 15);
        values[n] = radius;
    }
    convert(&zone, 1, "flat.leaf", true);
    assert_int_equal(leaf_file_open(&m, scratch_path("flat.leaf"), &f), ST_OK);
    assert_int_equal(leaf_verify(&m, f, 2, NULL), ST_OK);
    assert_int_equal(leaf_file_open_coarse(&m, f, 0, &coarse), ST_OK);
    assert_false(leaf_file_has_coarse(coarse, 0));
    leaf_file_close(coarse);
    leaf_file_close(f);
    assert_int_equal(mem_used(&m), 0);
}

int main(void) {
    mem_init(&m, 0);
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_nodes),    cmocka_unit_test(test_how_thin),
        cmocka_unit_test(test_embedded), cmocka_unit_test(test_steps),
        cmocka_unit_test(test_shell),    cmocka_unit_test(test_flat),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
