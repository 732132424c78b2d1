/* test_resample_hexes.c - hexahedra to grids: each node against all cells by brute force in long
 * double, for curvilinear grids and for meshes of whole cells; no gaps where nodes lie on faces;
 * the same samples whatever the memory and the threads; steps whose nodes move; cells without a
 * value.
 */
/* marks: threads */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "prep/resample/resample.h"
#include "tests/support/curvilinear_steps.h"
#include "tests/support/hex_truth.h"
#include "tests/support/mixed_file.h"
#include "tests/support/scratch.h"
#include "tests/support/watched.h"

enum { TREELET = 60, SHAPES_MAX = SLOW ? 3 : 100, N = 11 };

static mem m;
static cell_mix mix;

/* ---- resampling into memory ---- */

typedef struct samples {
    float *at;
    size_t count, room;
    resample_result result;
} samples;

static status take(void *ctx, const float *from, size_t count) {
    samples *s = ctx;
    assert_true(s->count + count <= s->room);
    memcpy(s->at + s->count, from, count * sizeof *from);
    s->count += count;
    return ST_OK;
}

static status try_resample(const char *path, const resample_grid *g, uint32_t set, uint64_t memory,
                           int threads, samples *s) {
    leaf_file *f = NULL;
    if (leaf_file_open(&m, path, &f) != ST_OK)
        fail_msg("%s", status_text());
    const resample_options o = {.set = set, .memory = memory + mem_used(&m), .threads = threads};
    *s = (samples){.room = (size_t)g->dims[0] * g->dims[1] * g->dims[2]};
    s->at = malloc(s->room * sizeof *s->at);
    assert_non_null(s->at);
    atomic_store(&m.peak, 0);
    const status st = resample_run(&m, f, g, &o, NULL, take, s, &s->result);
    assert_true(mem_peak(&m) <= o.memory);
    leaf_file_close(f);
    assert_int_equal(mem_used(&m), 0);
    return st;
}

static samples resample(const char *path, const resample_grid *g, uint32_t set) {
    samples s;
    if (try_resample(path, g, set, 1 << 30, 2, &s) != ST_OK)
        fail_msg("%s", status_text());
    assert_int_equal(s.count, s.room);
    return s;
}

/* ---- files ---- */

static const char *file_of_mix(void) {
    mesh_result result;
    (void)mixed_file_write(mix.cell, mix.count, scratch_path("mix.vtk"));
    mixed_file_convert(scratch_path("mix.vtk"), scratch_path("mix.leaf"), TREELET,
                       UINT64_C(1) << 32, &result);
    return scratch_path("mix.leaf");
}

static const char *file_of_zones(const curvilinear_zone zones[], uint32_t count) {
    const leaf_image image = curvilinear_file(zones, count);
    const char *path = scratch_write("grid.leaf", image.bytes, image.size);
    free(image.bytes);
    return path;
}

static const char *file_of_lab(const hex_lab *s) {
    const curvilinear_zone zone = {{HEX_LAB_NODES, HEX_LAB_NODES, HEX_LAB_NODES},
                                   (const float(*)[3])s->p,
                                   (const float *)s->value,
                                   NULL};
    return file_of_zones(&zone, 1);
}

/* ---- the truth ---- */

#define NEAR  1e-6 /* parameters outside of a cell that may be rounding */
#define WRONG 1e-6 /* of a value */

typedef struct held {
    int surely, maybe; /* cells that hold a node, and those on whose boundary it nearly is */
    bool folded;       /* it is near a folded cell */
    bool right;        /* one of them has the value */
} held;

static bool near_box(const hexahedron *h, const double at[3]) {
    for (int a = 0; a < 3; a++) {
        double lo = INFINITY, hi = -INFINITY;
        for (int c = 0; c < HEX_CORNERS; c++) {
            lo = fmin(lo, h->p[c][a]);
            hi = fmax(hi, h->p[c][a]);
        }
        if (at[a] < lo - NEAR * (hi - lo) || at[a] > hi + NEAR * (hi - lo))
            return false;
    }
    return true;
}

/* Newton's method from 27 places of the cell. Returns how far inside of the cell the best solution
 * is, in parameters. */
static double depth_in(const hexahedron *h, const double at[3], long double *value) {
    double best = -INFINITY;
    for (int start = 0; start < 27; start++) {
        long double u[3] = {0.1L + 0.4L * (start % 3), 0.1L + 0.4L * (start / 3 % 3),
                            0.1L + 0.4L * (start / 9)},
                    v;
        if (!hex_truth_value(h->p, h->value, at, (const double[3]){0, 0, 1}, 0.0, u, &v))
            continue;
        double depth = INFINITY;
        for (int a = 0; a < 3; a++)
            depth = fmin(depth, fmin((double)u[a], (double)(1 - u[a])));
        if (depth > best) {
            best = depth;
            *value = v;
        }
    }
    return best;
}

static held truth_of(const double at[3], float got) {
    held h = {0};
    for (int i = 0; i < mix.count; i++) {
        const hexahedron cell = cell_mix_hexahedron(&mix.cell[i], 0);
        long double value = 0;
        if (!near_box(&cell, at))
            continue;
        if (hexahedron_sense(cell.p) == 0) {
            h.folded = true;
            continue;
        }
        const double depth = depth_in(&cell, at, &value);
        if (depth < -NEAR)
            continue;
        h.surely += depth > NEAR;
        h.maybe += depth <= NEAR;
        h.right |= fabsl((long double)got - value) <= WRONG;
    }
    return h;
}

static resample_grid grid_over(double margin) {
    resample_grid g = {.dims = {N, N + 1, N + 2}};
    for (int a = 0; a < 3; a++) {
        double lo = INFINITY, hi = -INFINITY;
        for (int i = 0; i < mix.count; i++)
            for (int v = 0; v < cell_shape_vertices(mix.cell[i].shape); v++) {
                lo = fmin(lo, mix.cell[i].p[v][a]);
                hi = fmax(hi, mix.cell[i].p[v][a]);
            }
        g.origin[a] = lo - margin * (hi - lo);
        g.spacing[a] = (1 + 2 * margin) * (hi - lo) / (g.dims[a] - 1);
    }
    return g;
}

static void node_at(const resample_grid *g, size_t i, double at[3]) {
    const size_t across = g->dims[0], all = across * g->dims[1];
    const size_t index[3] = {i % across, i / across % g->dims[1], i / all};
    for (int a = 0; a < 3; a++)
        at[a] = g->origin[a] + (double)index[a] * g->spacing[a];
}

static void check_nodes(const char *path) {
    const resample_grid g = grid_over(0.04);
    samples s = resample(path, &g, 0);
    size_t judged = 0, inside = 0, held_in_all = 0;
    for (size_t i = 0; i < s.room; i++) {
        double at[3];
        node_at(&g, i, at);
        const held h = truth_of(at, s.at[i]);
        held_in_all += !isnan(s.at[i]);
        if (h.folded)
            continue;
        const bool any = h.surely + h.maybe > 0;
        if (isnan(s.at[i]) ? h.surely > 0 : !any || !h.right)
            fail_msg("%s: node %zu has %g; %d cells hold it, of %d it is on the boundary",
                     mix.lab.name, i, (double)s.at[i], h.surely, h.maybe);
        judged++;
        inside += h.surely > 0;
    }
    assert_int_equal(held_in_all, s.result.held);
    if (judged < s.room / (mix.lab.may_be_folded ? 20 : 2) || inside < s.room / 20)
        fail_msg("%s: %zu nodes judged, %zu inside", mix.lab.name, judged, inside);
    free(s.at);
}

/* ---- tests ---- */

static void test_grids(void **state) {
    (void)state;
    skip_under_thread();
    for (int n = 0; n < hex_lab_count() && n < SHAPES_MAX; n++) {
        static hex_lab lab;
        hex_lab_make(&lab, n, FIELD_SEED);
        cell_mix_whole(&mix, &lab);
        mix.lab = lab;
        check_nodes(file_of_lab(&lab));
    }
}

static void test_mixes(void **state) {
    (void)state;
    skip_under_thread();
    for (int n = 0; n < hex_lab_count() && n < SHAPES_MAX; n++) {
        cell_mix_make(&mix, n, FIELD_SEED);
        check_nodes(file_of_mix());
    }
}

/* Cells whose faces, edges and corners have nodes on them, as a grid and as a mesh. */
static void test_nodes_on_faces(void **state) {
    (void)state;
    skip_under_thread();
    static hex_lab lab;
    hex_lab_make(&lab, 0, FIELD_SEED);
    for (int k = 0; k < HEX_LAB_NODES; k++)
        for (int j = 0; j < HEX_LAB_NODES; j++)
            for (int i = 0; i < HEX_LAB_NODES; i++) {
                lab.p[k][j][i][0] = (float)i;
                lab.p[k][j][i][1] = (float)j;
                lab.p[k][j][i][2] = (float)k;
            }
    cell_mix_whole(&mix, &lab);
    const uint32_t half = 2 * HEX_LAB_CELLS + 1;
    const resample_grid g = {.dims = {half, half, half}, .spacing = {0.5, 0.5, 0.5}};
    for (int form = 0; form < 2; form++) {
        samples s = resample(form ? file_of_mix() : file_of_lab(&lab), &g, 0);
        assert_int_equal(s.result.held, s.room);
        for (size_t n = 0; n < s.room; n++) {
            const size_t x = n % half, y = n / half % half, z = n / half / half;
            double want = 0;
            for (size_t c = 0; c < HEX_CORNERS; c++)
                want +=
                    (double)lab
                        .value[(z + (c >> 2 & 1)) / 2][(y + (c >> 1 & 1)) / 2][(x + (c & 1)) / 2] /
                    HEX_CORNERS;
            if (!(fabs((double)s.at[n] - want) < 2e-7))
                fail_msg("node %zu, %zu, %zu: %.9g, expected %.9g", x, y, z, (double)s.at[n], want);
        }
        free(s.at);
    }
}

/* Corners without a value, and cells that are blanked. */
static void test_no_data(void **state) {
    (void)state;
    skip_under_thread();
    static float p[3][3][5][3], values[3][3][5];
    static uint8_t blank[3][3][5];
    for (int k = 0; k < 3; k++)
        for (int j = 0; j < 3; j++)
            for (int i = 0; i < 5; i++) {
                p[k][j][i][0] = (float)i;
                p[k][j][i][1] = (float)j;
                p[k][j][i][2] = (float)k;
                values[k][j][i] = (float)i;
                blank[k][j][i] = 1;
            }
    values[1][1][0] = INFINITY;
    values[0][0][1] = NAN;
    blank[1][1][4] = 0;
    const curvilinear_zone zone = {
        {5, 3, 3}, (const float(*)[3])p, (const float *)values, (const uint8_t *)blank};
    const resample_grid g = {.dims = {4, 2, 2}, .origin = {0.5, 0.5, 0.5}, .spacing = {1, 1, 1}};
    samples s = resample(file_of_zones(&zone, 1), &g, 0);
    assert_int_equal(s.result.held, 12); /* all but those of the last column */
    for (size_t n = 0; n < s.room; n++) {
        const size_t x = n % 4;
        const bool missing = x == 0 || (x == 1 && n < 4) || x == 3;
        assert_true(missing ? isnan(s.at[n]) : s.at[n] == (float)x + 0.5F);
    }
    free(s.at);
}

/* Of zones that overlap, the first one counts. */
static void test_overlap(void **state) {
    (void)state;
    skip_under_thread();
    static float p[2][2][2][2][3], values[2][2][2][2];
    curvilinear_zone zones[2];
    for (int z = 0; z < 2; z++) {
        for (int n = 0; n < HEX_CORNERS; n++) {
            for (int a = 0; a < 3; a++)
                p[z][n >> 2][n >> 1 & 1][n & 1][a] = (float)((n >> a & 1) * 2 + (a == 0) * z);
            values[z][n >> 2][n >> 1 & 1][n & 1] = (float)z;
        }
        zones[z] =
            (curvilinear_zone){{2, 2, 2}, (const float(*)[3])p[z], (const float *)values[z], NULL};
    }
    const resample_grid g = {.dims = {3, 2, 2}, .origin = {0.5, 0.5, 0.5}, .spacing = {1, 1, 1}};
    samples s = resample(file_of_zones(zones, 2), &g, 0);
    for (size_t n = 0; n < s.room; n++)
        assert_true(s.at[n] == (n % 3 == 2 ? 1.0F : 0.0F));
    free(s.at);
}

/* A step whose nodes have moved is the file of that step alone; so are its other fields. */
static void test_steps(void **state) {
    (void)state;
    skip_under_thread();
    hex_lab_make(&mix.lab, 1, FIELD_SEED);
    cell_mix_whole(&mix, &mix.lab);
    const resample_grid g = grid_over(0.3);
    const curvilinear_zone zone = {{HEX_LAB_NODES, HEX_LAB_NODES, HEX_LAB_NODES},
                                   (const float(*)[3])mix.lab.p,
                                   (const float *)mix.lab.value,
                                   NULL};
    for (int moves = 0; moves < 2; moves++) {
        const curvilinear_options o = {
            .file = {.run_align_log2 = 12}, .memory = 1 << 30, .threads = 2, .force = true};
        curvilinear_steps s;
        curvilinear_result r;
        size_t different = 0;
        curvilinear_steps_init(&s, &zone, 1, 2, 3);
        s.moves = moves;
        if (curvilinear_convert(&m, &s.series, "", scratch_path("steps.leaf"), &o, NULL, &r) !=
            ST_OK)
            fail_msg("%s", status_text());
        for (uint32_t set = 0; set < 6; set++) {
            leaf_file *f = NULL;
            assert_int_equal(leaf_file_open(&m, scratch_path("steps.leaf"), &f), ST_OK);
            const uint32_t at = leaf_layout_set(&f->layout, set % 2, set / 2);
            leaf_file_close(f);
            static hex_lab alone;
            for (size_t n = 0; n < sizeof alone.value / sizeof(float); n++) {
                curvilinear_steps_place(&s, 0, n, set / 2, ((float(*)[3])alone.p)[n]);
                ((float *)alone.value)[n] = curvilinear_steps_value(&s, 0, n, set % 2, set / 2);
            }
            samples got = resample(scratch_path("steps.leaf"), &g, at);
            samples want = resample(file_of_lab(&alone), &g, 0);
            samples first = resample(scratch_path("steps.leaf"), &g, 0);
            for (size_t n = 0; n < got.room; n++) {
                /* The file's box, by which nodes are moved inside, is that of all steps. */
                assert_true(isnan(got.at[n]) ? isnan(want.at[n])
                                             : fabsf(got.at[n] - want.at[n]) <= 1e-6F);
                different += got.at[n] != first.at[n];
            }
            assert_true(got.result.held > got.room / 20);
            free(got.at);
            free(want.at);
            free(first.at);
        }
        assert_true(different > g.dims[0]);
    }
}

static void test_same_bits(void **state) {
    (void)state;
    cell_mix_make(&mix, 1, FIELD_SEED);
    const resample_grid g = grid_over(0.05);
    for (int form = 0; form < 2; form++) {
        const char *path = form ? file_of_mix() : file_of_lab(&mix.lab);
        samples want = resample(path, &g, 0);
        assert_true(want.result.bytes_read > 0);
        int right = 0;
        for (int threads = 1; threads <= 5; threads += 2)
            for (uint64_t room = 32 << 10; room <= 2 << 20; room *= 2) {
                samples s;
                const status st = try_resample(path, &g, 0, room, threads, &s);
                assert_true(st == ST_OK || (st == ST_NOMEM && room < 2 << 20));
                if (st == ST_OK) {
                    assert_memory_equal(s.at, want.at, s.room * sizeof *s.at);
                    assert_int_equal(s.result.held, want.result.held);
                    right++;
                }
                free(s.at);
            }
        assert_true(right > 3);
        free(want.at);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_grids),          cmocka_unit_test(test_mixes),
        cmocka_unit_test(test_no_data),        cmocka_unit_test(test_overlap),
        cmocka_unit_test(test_nodes_on_faces), cmocka_unit_test(test_steps),
        cmocka_unit_test(test_same_bits),
    };
    mem_init(&m, 0);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
