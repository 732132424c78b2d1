/* test_resample.c - meshes to grids: each node against all tets, by brute force in long double with
 * exact signs; the same samples whatever the memory, the threads and the treelets.
 */
/* marks: threads, long */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "formats/base/fault.h"
#include "prep/resample/resample.h"
#include "prep/resample/resample_input.h"
#include "tests/support/exact_sum.h"
#include "tests/support/fields.h"
#include "tests/support/mesh_cases.h"
#include "tests/support/scratch.h"
#include "tests/support/watched.h"

static mem m;

/* ---- resampling into memory ---- */

typedef struct samples {
    float *at;
    size_t count, room, fail_at; /* fail_at: the samples from which on taking fails; 0: never */
    resample_result result;
} samples;

static status take(void *ctx, const float *from, size_t count) {
    samples *s = ctx;
    if (s->fail_at && s->count + count >= s->fail_at)
        return status_describe(ST_NOSPACE, "no more");
    assert_true(s->count + count <= s->room);
    memcpy(s->at + s->count, from, count * sizeof *from);
    s->count += count;
    return ST_OK;
}

static leaf_file *open_case(const mesh_case *c) {
    mesh_result r;
    leaf_file *f = NULL;
    if (mesh_cases_convert(&m, c, "case.leaf", 0, &r) != ST_OK)
        fail_msg("%s", status_text());
    m.limit = 0;
    if (leaf_file_open(&m, scratch_path("case.leaf"), &f) != ST_OK)
        fail_msg("%s", status_text());
    return f;
}

static status try_resample(leaf_file *f, const resample_grid *g, uint64_t memory, int threads,
                           samples *s) {
    const resample_options o = {.memory = memory, .threads = threads};
    *s = (samples){.room = (size_t)g->dims[0] * g->dims[1] * g->dims[2], .fail_at = s->fail_at};
    s->at = malloc(s->room * sizeof *s->at);
    assert_non_null(s->at);
    return resample_run(&m, f, g, &o, NULL, take, s, &s->result);
}

static samples resample(leaf_file *f, const resample_grid *g, uint64_t memory, int threads) {
    samples s = {0};
    if (try_resample(f, g, memory, threads, &s) != ST_OK)
        fail_msg("%s", status_text());
    assert_int_equal(s.count, s.room);
    assert_int_equal(s.result.nodes, s.room);
    return s;
}

static samples resample_case(const mesh_case *c, const resample_grid *g) {
    leaf_file *f = open_case(c);
    samples s = resample(f, g, 1 << 30, 2);
    leaf_file_close(f);
    assert_int_equal(mem_used(&m), 0);
    return s;
}

/* ---- the truth ---- */

/* Whether the tet holds p, and the value there: NaN for no data. */
static bool truth_in_tet(const mesh_case *c, size_t tet, const double p[3], long double *value) {
    double at[4][3];
    long double weight[4], all = 0, sum = 0;
    for (int i = 0; i < 4; i++)
        for (int a = 0; a < 3; a++)
            at[i][a] = (double)c->points[c->tets[tet][i]][a];
    for (int a = 0; a < 3; a++) {
        const double lo = fmin(fmin(at[0][a], at[1][a]), fmin(at[2][a], at[3][a])),
                     hi = fmax(fmax(at[0][a], at[1][a]), fmax(at[2][a], at[3][a]));
        if (p[a] < lo || p[a] > hi)
            return false;
    }
    const long double volume = exact_sum_volume(at[1], at[2], at[3], at[0]);
    if (volume == 0)
        return false;
    for (int i = 0; i < 4; i++) {
        double moved[4][3];
        memcpy(moved, at, sizeof at);
        memcpy(moved[i], p, sizeof moved[i]);
        weight[i] = exact_sum_volume(moved[1], moved[2], moved[3], moved[0]);
        if (volume < 0 ? weight[i] > 0 : weight[i] < 0)
            return false;
    }
    for (int i = 0; i < 4; i++)
        if (weight[i] != 0) {
            sum += weight[i] * (long double)c->values[c->tets[tet][i]];
            all += weight[i];
        }
    *value = sum / all;
    return true;
}

/* Each node: held where a tet holds it, and with the value that one of those has. Returns how many
 * are held. */
static size_t check_nodes(const mesh_case *c, const resample_grid *g, const samples *s) {
    size_t held = 0, at = 0;
    float most = 0;
    for (size_t i = 0; i < c->point_count; i++)
        if (isfinite(c->values[i]) && fabsf(c->values[i]) > most)
            most = fabsf(c->values[i]);
    for (uint32_t z = 0; z < g->dims[2]; z++)
        for (uint32_t y = 0; y < g->dims[1]; y++)
            for (uint32_t x = 0; x < g->dims[0]; x++, at++) {
                const double p[3] = {g->origin[0] + x * g->spacing[0],
                                     g->origin[1] + y * g->spacing[1],
                                     g->origin[2] + z * g->spacing[2]};
                const float got = s->at[at];
                bool any = false, right = false;
                for (size_t t = 0; t < c->tet_count; t++) {
                    long double want = 0;
                    if (!truth_in_tet(c, t, p, &want))
                        continue;
                    any = true;
                    right |= isfinite(want) ? fabsl((long double)got - want) <=
                                                  (long double)most * (long double)FLT_EPSILON
                                            : isnan(got);
                }
                held += any;
                if (any ? !right : !isnan(got))
                    fail_msg("node %u, %u, %u: %g; %s", x, y, z, (double)got,
                             any ? "no tet that holds it has that" : "no tet holds it");
            }
    assert_int_equal(held, s->result.held);
    return held;
}

static resample_grid grid_over(const mesh_case *c, uint32_t n, double margin) {
    resample_grid g = {.dims = {n, n + 1, n + 2}};
    for (int a = 0; a < 3; a++) {
        double lo = INFINITY, hi = -INFINITY;
        for (size_t i = 0; i < c->point_count; i++) {
            lo = fmin(lo, (double)c->points[i][a]);
            hi = fmax(hi, (double)c->points[i][a]);
        }
        const double extent = hi - lo;
        g.origin[a] = lo - margin * extent;
        g.spacing[a] = (1 + 2 * margin) * extent / (g.dims[a] - 1);
    }
    return g;
}

static size_t check_case(mesh_case *c, uint32_t n, double margin) {
    const resample_grid g = grid_over(c, n, margin);
    samples s = resample_case(c, &g);
    const size_t held = check_nodes(c, &g, &s);
    free(s.at);
    return held;
}

/* ---- tests ---- */

/* Points moved by up to a part of a cell, those of the boundary along it. */
static void jitter(mesh_case *c, const uint32_t n[3], double amount, uint64_t seed) {
    field_random r = {seed};
    for (size_t i = 0; i < c->point_count; i++)
        for (int a = 0; a < 3; a++)
            if (c->points[i][a] > 0 && c->points[i][a] < (float)n[a])
                c->points[i][a] += (float)field_random_in(&r, -amount, amount);
}

static void move(mesh_case *c, const double scale[3], const double offset[3]) {
    for (size_t i = 0; i < c->point_count; i++)
        for (int a = 0; a < 3; a++)
            c->points[i][a] = (float)((double)c->points[i][a] * scale[a] + offset[a]);
}

/* A mesh without gaps: every node of its box is held, and none beside it. */
static void test_every_node(void **state) {
    (void)state;
    skip_under_thread();
    const double scales[][3] = {{1, 1, 1}, {1e-4, 3, 1e4}, {1e-30, 1e-30, 1e-30}, {1, 1, 1}};
    const double offsets[][3] = {{0, 0, 0}, {0, 0, 0}, {0, 0, 0}, {1e6, -1e6, 3e5}};
    for (size_t i = 0; i < sizeof scales / sizeof *scales; i++) {
        mesh_case c = mesh_cases_kuhn(4, 3, 5);
        c.options.treelet_tets = 50;
        mesh_cases_shuffle(&c, 3);
        if (i < 3)
            jitter(&c, (const uint32_t[3]){4, 3, 5}, 0.12, 7);
        move(&c, scales[i], offsets[i]);
        assert_int_equal(check_case(&c, 8, -0.01), 8 * 9 * 10);
        assert_true(check_case(&c, 11, 0.2) < 11 * 12 * 13);
        mesh_cases_free(&c);
    }
}

/* Flat, inverted, overlapping, long tets of few different coordinates; NaN and inf. */
static void test_soup(void **state) {
    (void)state;
    skip_under_thread();
    for (uint64_t seed = 1; seed <= 6; seed++) {
        mesh_case c = mesh_cases_soup(60, 120, seed);
        c.options.treelet_tets = 30;
        const double scale[3] = {seed % 2 ? 1 : 1000, 1, seed % 3 ? 1 : 1e-5};
        if (seed > 3) /* coordinates of few values: nodes on faces, edges, vertices */
            for (size_t i = 0; i < c.point_count; i++)
                for (int a = 0; a < 3; a++)
                    c.points[i][a] = rintf(c.points[i][a] * 3);
        move(&c, scale, (const double[3]){0, 0, 0});
        assert_true(check_case(&c, 13, seed > 3 ? 0 : 0.1) > 100);
        mesh_cases_free(&c);
    }
}

/* A node on a vertex has its bits; in the middle of an edge it has its ends' mean. */
static void test_places_of_no_volume(void **state) {
    (void)state;
    skip_under_thread();
    mesh_case c = mesh_cases_kuhn(4, 4, 4);
    mesh_cases_shuffle(&c, 5);
    for (size_t i = 0; i < c.point_count; i++)
        c.values[i] = sinf((float)i) * 1e3F;
    const resample_grid g = {.dims = {9, 9, 9}, .spacing = {0.5, 0.5, 0.5}};
    samples s = resample_case(&c, &g);
    float vertex[5][5][5];
    for (size_t i = 0; i < c.point_count; i++)
        vertex[(int)c.points[i][2]][(int)c.points[i][1]][(int)c.points[i][0]] = c.values[i];
    /* All edges of a Kuhn mesh go up, or not at all, along each axis. */
    for (int z = 0; z < 9; z++)
        for (int y = 0; y < 9; y++)
            for (int x = 0; x < 9; x++) {
                const float lo = vertex[z / 2][y / 2][x / 2],
                            hi = vertex[(z + 1) / 2][(y + 1) / 2][(x + 1) / 2];
                const float want = (float)(((double)lo + (double)hi) / 2);
                assert_memory_equal(&s.at[(z * 9 + y) * 9 + x], &want, sizeof want);
            }
    free(s.at);
    mesh_cases_free(&c);
}

static void test_linear(void **state) {
    (void)state;
    skip_under_thread();
    const uint32_t n[3] = {9, 7, 8};
    mesh_case c = mesh_cases_kuhn(n[0], n[1], n[2]);
    mesh_cases_shuffle(&c, 11);
    jitter(&c, n, 0.15, 13);
    for (size_t i = 0; i < c.point_count; i++)
        c.values[i] = (float)(3 + 0.7 * (double)c.points[i][0] - 1.3 * (double)c.points[i][1] +
                              0.1 * (double)c.points[i][2]);
    const resample_grid g = grid_over(&c, 40, -1e-6);
    samples s = resample_case(&c, &g);
    double worst = 0;
    size_t at = 0;
    for (uint32_t z = 0; z < g.dims[2]; z++)
        for (uint32_t y = 0; y < g.dims[1]; y++)
            for (uint32_t x = 0; x < g.dims[0]; x++, at++)
                worst = fmax(worst,
                             fabs((double)s.at[at] - (3 + 0.7 * (g.origin[0] + x * g.spacing[0]) -
                                                      1.3 * (g.origin[1] + y * g.spacing[1]) +
                                                      0.1 * (g.origin[2] + z * g.spacing[2]))));
    /* Values up to 16: half a last bit as the vertices are rounded, half as the samples are. */
    if (!(worst <= 0x1p-20))
        fail_msg("off by %g", worst);
    free(s.at);
    mesh_cases_free(&c);
}

static void test_same_bits(void **state) {
    (void)state;
    mesh_case c = mesh_cases_kuhn(12, 11, 10);
    mesh_cases_shuffle(&c, 17);
    jitter(&c, (const uint32_t[3]){12, 11, 10}, 0.1, 19);
    const resample_grid g = grid_over(&c, 33, 0.05);
    samples want = resample_case(&c, &g);
    assert_int_equal(want.result.slabs, 1);
    for (int round = 0; round < 4; round++) {
        c.options.treelet_tets = round % 2 ? 100 : 700;
        c.options.file.codec = round < 2 ? LEAF_CODEC_RAW : LEAF_CODEC_ZSTD;
        c.options.file.zstd_level = 3;
        leaf_file *f = open_case(&c);
        const size_t used = mem_used(&m);
        for (int threads = 1; threads <= 5; threads += 2)
            for (uint64_t room = 64 << 10; room <= 1 << 20; room *= 2) {
                const uint64_t memory = used + room;
                samples s = {0};
                atomic_store(&m.peak, 0);
                status st = try_resample(f, &g, memory, threads, &s);
                if (st == ST_OK)
                    assert_memory_equal(s.at, want.at, s.room * sizeof *s.at);
                else
                    assert_true(st == ST_NOMEM && room < 512 << 10);
                if (st == ST_OK)
                    assert_int_equal(s.result.held, want.result.held);
                assert_true(mem_peak(&m) <= memory);
                free(s.at);
            }
        leaf_file_close(f);
    }
    free(want.at);
    mesh_cases_free(&c);
}

/* The smallest budget is named, and enough: rows of a plane, treelet by treelet. */
static void test_least_memory(void **state) {
    (void)state;
    skip_under_thread();
    mesh_case c = mesh_cases_kuhn(6, 6, 6);
    const resample_grid g = grid_over(&c, WATCHED ? 120 : 300, 0.01);
    samples want = resample_case(&c, &g);
    leaf_file *f = open_case(&c);
    samples s = {0};
    assert_int_equal(try_resample(f, &g, 1 << 10, 1, &s), ST_NOMEM);
    free(s.at);
    unsigned long long least = 0;
    const char *need = strstr(status_text(), "need ");
    assert_non_null(need);
    assert_int_equal(sscanf(need, "need %llu KiB", &least), 1);
    s = resample(f, &g, least << 10, 1);
    assert_true(s.result.slabs > g.dims[2]);
    assert_memory_equal(s.at, want.at, s.room * sizeof *s.at);
    leaf_file_close(f);
    free(s.at);
    free(want.at);
    mesh_cases_free(&c);
}

static void test_faults(void **state) {
    (void)state;
    mesh_case c = mesh_cases_kuhn(3, 3, 3);
    const resample_grid g = grid_over(&c, 7, 0);
    leaf_file *f = open_case(&c);
    const size_t used = mem_used(&m);
    for (fault_kind kind = FAULT_ALLOC; kind < FAULT_KINDS; kind++) {
        long k = 0;
        for (bool fired = true; fired;) {
            samples s = {0};
            fault_arm(kind, ++k);
            const status st = try_resample(f, &g, 1 << 20, 2, &s);
            fired = fault_fired(kind);
            fault_arm(kind, 0);
            assert_int_equal(st == ST_OK, !fired);
            assert_int_equal(mem_used(&m), used);
            free(s.at);
        }
        assert_true(k > 1 || kind == FAULT_WRITE);
    }
    samples s = {.fail_at = 100};
    assert_int_equal(try_resample(f, &g, 1 << 20, 2, &s), ST_NOSPACE);
    free(s.at);
    leaf_file_close(f);
    assert_int_equal(mem_used(&m), 0);
    mesh_cases_free(&c);
}

static void test_damage(void **state) {
    (void)state;
    skip_under_thread();
    mesh_case c = mesh_cases_kuhn(3, 3, 3);
    leaf_file *f = open_case(&c);
    const size_t at = (size_t)f->offsets[0] + 70;
    leaf_file_close(f);
    size_t size;
    char *bytes = scratch_read(scratch_path("case.leaf"), &size);
    bytes[at] ^= 1;
    (void)scratch_write("case.leaf", bytes, size);
    free(bytes);
    assert_int_equal(leaf_file_open(&m, scratch_path("case.leaf"), &f), ST_OK);
    const resample_grid g = grid_over(&c, 7, 0);
    samples s = {0};
    assert_int_equal(try_resample(f, &g, 1 << 20, 2, &s), ST_CORRUPT);
    assert_non_null(strstr(status_text(), "treelet 0"));
    free(s.at);
    leaf_file_close(f);
    mesh_cases_free(&c);
}

/* ---- the grid ---- */

static void test_choosing(void **state) {
    (void)state;
    skip_under_thread();
    const float bounds[6] = {0.1F, -7.3F, 1e5F, 1.7F, 23.9F, 1e5F + 3};
    resample_grid g;
    grid out;
    for (uint32_t n = 2; n < 400; n++) {
        const resample_wish w = {.dims = {n}};
        assert_int_equal(resample_grid_choose(&w, bounds, "name", &g, &out), ST_OK);
        assert_int_equal(g.dims[1], n);
        for (int a = 0; a < 3; a++) {
            const double last = resample_grid_node(&g, a, g.dims[a] - 1),
                         hi = (double)bounds[a + 3];
            assert_true(last <= hi && last > hi - 1e-9);
            assert_true(g.dims[a] >= 2 && g.dims[a] <= n);
        }
    }
    const resample_wish by_spacing = {.spacing = 0.4};
    assert_int_equal(resample_grid_choose(&by_spacing, bounds, "name", &g, &out), ST_OK);
    assert_true(g.dims[0] == 5 && g.dims[1] == 78 && g.dims[2] == 8 && g.spacing[1] == 0.4);
    assert_string_equal(out.name, "name");
    assert_true(out.to_world[1][1] == 0.4 && out.to_world[1][3] == g.origin[1]);
    const resample_wish by_nodes = {.nodes = 100000};
    assert_int_equal(resample_grid_choose(&by_nodes, bounds, "name", &g, &out), ST_OK);
    const uint64_t nodes = grid_samples(&out);
    assert_true(nodes <= 100000 && nodes > 90000);
    const resample_wish few = {.nodes = 1};
    assert_int_equal(resample_grid_choose(&few, bounds, "name", &g, &out), ST_OK);
    assert_int_equal(grid_samples(&out), 8);
}

static void test_refused(void **state) {
    (void)state;
    skip_under_thread();
    const float bounds[6] = {0, 0, 0, 1, 1, 1}, flat[6] = {0, 0, 2, 1, 1, 2};
    resample_grid g;
    grid out;
    const resample_wish w = {.dims = {9}}, fine = {.spacing = 1e-7},
                        far = {
                            .dims = {1000}, .bounded = true, .box = {1e6, 0, 0, 1e6 + 1e-8, 1, 1}};
    assert_int_equal(resample_grid_choose(&w, flat, "", &g, &out), ST_UNSUPPORTED);
    assert_non_null(strstr(status_text(), "along z"));
    assert_int_equal(resample_grid_choose(&fine, bounds, "", &g, &out), ST_UNSUPPORTED);
    assert_int_equal(resample_grid_choose(&far, bounds, "", &g, &out), ST_UNSUPPORTED);
    assert_non_null(strstr(status_text(), "along x"));
}

int main(void) {
    mem_init(&m, 0);
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_every_node),
        cmocka_unit_test(test_soup),
        cmocka_unit_test(test_places_of_no_volume),
        cmocka_unit_test(test_linear),
        cmocka_unit_test(test_same_bits),
        cmocka_unit_test(test_least_memory),
        cmocka_unit_test(test_faults),
        cmocka_unit_test(test_damage),
        cmocka_unit_test(test_choosing),
        cmocka_unit_test(test_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
