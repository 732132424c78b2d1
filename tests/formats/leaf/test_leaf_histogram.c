/* test_leaf_histogram.c - the histograms in treelet files: counted again by a second reader, the
 * same bytes whatever the memory and the threads, and damage that verify finds.
 */
/* marks: threads */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "formats/leaf/leaf_histogram.h"
#include "formats/leaf/leaf_verify.h"
#include "prep/mesh/mesh_convert.h"
#include "tests/support/leaf_files.h"
#include "tests/support/leaf_image.h"
#include "tests/support/naive_histogram.h"
#include "tests/support/scratch.h"
#include "tests/support/watched.h"

static mem m;

static status verify(const char *path) {
    leaf_file *f = NULL;
    status st = leaf_file_open(&m, path, &f);
    if (st == ST_OK)
        st = leaf_verify(&m, f, 2, NULL);
    leaf_file_close(f);
    return st;
}

static leaf_case case_of(uint32_t x, uint32_t y, uint32_t z, sample_type type) {
    leaf_case c = leaf_files_case(x, y, z, type);
    c.options.file.histograms = true;
    return c;
}

static void check_grid(const leaf_case *c, const char *what) {
    const char *path = leaf_files_make(c, "h.leaf");
    static naive_leaf leaf;
    if (!naive_leaf_load(&leaf, path))
        fail_msg("%s: %s", what, leaf.why);
    const char *why = naive_histogram_grid(&leaf);
    if (why)
        fail_msg("%s: %s", what, why);
    naive_leaf_release(&leaf);
    if (verify(path) != ST_OK)
        fail_msg("%s: %s", what, status_text());
}

static void test_grids(void **state) {
    (void)state;
    skip_under_thread();
    static const sample_type types[] = {SAMPLE_U8,  SAMPLE_I8,  SAMPLE_U16, SAMPLE_I16,
                                        SAMPLE_F32, SAMPLE_U32, SAMPLE_F64};
    for (size_t i = 0; i < sizeof types / sizeof *types; i++) {
        leaf_case c = case_of(37, 50, 34, types[i]);
        c.options.file.halo = i % 2;
        c.options.file.codec = i % 3 ? LEAF_CODEC_RAW : LEAF_CODEC_ZSTD;
        c.options.file.zstd_level = 1;
        void *samples = leaf_files_random(&c, 7 + i, 200);
        c.samples = samples;
        check_grid(&c, sample_name(types[i]));
        free(samples);
    }
}

/* Of a part of the samples; and on axes of its own. */
static void test_large_grids(void **state) {
    (void)state;
    skip_under_thread();
    leaf_case c = case_of(120, 90, 81, SAMPLE_U8);
    void *samples = leaf_files_random(&c, 3, 0);
    c.samples = samples;
    check_grid(&c, "drawn");
    char text[4096];
    size_t n = 0;
    for (int i = 0; i < 90; i++)
        n += (size_t)snprintf(text + n, sizeof text - n, "%g\n", 0.5 * i + 0.01 * i * i);
    c.axis_file[1] = scratch_text("y.txt", text);
    check_grid(&c, "rectilinear");
    free(samples);
}

static void test_same_bytes(void **state) {
    (void)state;
    leaf_case c = case_of(100, 90, 80, SAMPLE_F32);
    void *samples = leaf_files_random(&c, 5, 500);
    c.samples = samples;
    size_t size = 0, other = 0;
    char *first = scratch_read(leaf_files_make(&c, "one.leaf"), &size);
    for (int threads = 1; threads <= 5; threads += 2)
        for (int tight = 0; tight < 2; tight++) {
            c.options.threads = threads;
            c.options.memory = tight ? leaf_files_least(&c) : 1 << 30;
            char *again = scratch_read(leaf_files_make(&c, "two.leaf"), &other);
            assert_int_equal(size, other);
            assert_memory_equal(first, again, size);
            free(again);
        }
    free(first);
    free(samples);
}

/* Each number of a sealed histogram changed in turn: opening or verify says no. */
static void test_damage(void **state) {
    (void)state;
    skip_under_thread();
    static const size_t places[] = {0,  4,    8,    16,   24,   32,   63,
                                    71, 2112, 2116, 3140, 4164, 5188, 6214};
    leaf_case c = case_of(40, 30, 20, SAMPLE_U8);
    void *samples = leaf_files_random(&c, 11, 0);
    c.samples = samples;
    size_t size = 0;
    const char *path = leaf_files_make(&c, "sound.leaf");
    char *bytes = scratch_read(path, &size);
    leaf_image i = leaf_image_of(bytes, size);
    char *h = leaf_image_section(&i, LEAF_SECTION_HISTOGRAMS);
    assert_non_null(h);
    for (size_t k = 0; k < sizeof places / sizeof *places; k++) {
        h[places[k]] ^= 1;
        leaf_image_seal(&i);
        if (verify(scratch_write("bad.leaf", i.bytes, i.size)) != ST_CORRUPT)
            fail_msg("byte %zu of a histogram was changed, and nobody noticed", places[k]);
        h[places[k]] ^= 1;
    }
    leaf_image_seal(&i);
    assert_int_equal(verify(scratch_write("good.leaf", i.bytes, i.size)), ST_OK);
    free(i.bytes);
    free(samples);
}

/* Sealed bins that are sound in themselves, but miss some or all of the values, or hold some where
 * there are none. */
static void test_bins(void **state) {
    (void)state;
    skip_under_thread();
    leaf_case c = case_of(40, 30, 20, SAMPLE_U8);
    void *samples = leaf_files_random(&c, 11, 0);
    c.samples = samples;
    size_t size = 0;
    char *bytes = scratch_read(leaf_files_make(&c, "sound.leaf"), &size);
    leaf_image i = leaf_image_of(bytes, size);
    char *at = leaf_image_section(&i, LEAF_SECTION_HISTOGRAMS);
    assert_non_null(at);
    histogram sound, h;
    memcpy(&sound, at, sizeof sound);
    for (int k = 0; k < 4; k++) {
        h = (histogram){.total = sound.total};
        if (k) {
            h = (histogram){.bins = 1, .cells = sound.cells, .total = sound.total};
            h.edges[0] = k == 1 ? 1000 : k == 2 ? -1 : -0.5;
            h.edges[1] = k == 1 ? 1001 : k == 2 ? -0.25 : 255.5;
            h.samples[0] = k == 3 ? (uint32_t)sound.drawn : 0;
            h.drawn = h.samples[0];
        }
        assert_null(histogram_fault(&h));
        memcpy(at, &h, sizeof h);
        leaf_image_seal(&i);
        const status st = verify(scratch_write("bins.leaf", i.bytes, i.size));
        if (st != (k == 3 ? ST_OK : ST_CORRUPT))
            fail_msg("bins %d: verify says %d", k, st);
    }
    free(i.bytes);
    free(samples);
}

/* Without the section: one from the treelets, which suggests something within the range. */
static void test_without(void **state) {
    (void)state;
    skip_under_thread();
    leaf_case c = case_of(70, 60, 50, SAMPLE_U8);
    c.options.file.histograms = false;
    void *samples = leaf_files_random(&c, 2, 0);
    c.samples = samples;
    leaf_file *f = NULL;
    histogram h;
    double isovalue = 0;
    assert_int_equal(leaf_file_open(&m, leaf_files_make(&c, "old.leaf"), &f), ST_OK);
    assert_null(f->histograms);
    assert_int_equal(leaf_histogram_get(&m, f, 0, &h), ST_OK);
    assert_null(histogram_fault(&h));
    assert_int_equal(h.total, f->layout.level[0].count);
    assert_int_equal(histogram_suggest(&h, &isovalue, 1), 1);
    assert_true(isovalue > f->header.value_min && isovalue <= f->header.value_max);
    leaf_file_close(f);
    free(samples);
}

/* ---- meshes ---- */

/* n^3 cells of six tets, as a mesh stream; values of a wave, or of another. */
static const char *write_mesh(const char *name, int n, double phase) {
    static const int paths[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2},
                                    {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
    char path[128];
    snprintf(path, sizeof path, "%s", scratch_path(name));
    FILE *out = fopen(path, "w");
    const int row = n + 1, points = row * row * row;
    fprintf(out, "# vtk DataFile Version 3.0\nx\nASCII\nDATASET UNSTRUCTURED_GRID\n");
    fprintf(out, "POINTS %d float\n", points);
    for (int i = 0; i < points; i++)
        fprintf(out, "%g %g %g\n", i % row + 0.1 * phase * (i % 3), i / row % row * 1.25,
                i / (row * row) * 0.75);
    fprintf(out, "CELLS %d %d\n", 6 * n * n * n, 30 * n * n * n);
    for (int i = 0; i < n * n * n; i++)
        for (int p = 0; p < 6; p++) {
            const int step[3] = {1, row, row * row};
            int at = i % n + row * (i / n % n) + row * row * (i / (n * n));
            fprintf(out, "4 %d", at);
            for (int k = 0; k < 3; k++)
                fprintf(out, " %d", at += step[paths[p][k]]);
            fprintf(out, "\n");
        }
    fprintf(out, "CELL_TYPES %d\n", 6 * n * n * n);
    for (int i = 0; i < 6 * n * n * n; i++)
        fprintf(out, "10\n");
    fprintf(out, "POINT_DATA %d\nSCALARS v float\nLOOKUP_TABLE default\n", points);
    for (int i = 0; i < points; i++)
        fprintf(out, "%g\n", (i * 7919 % 1000) * 0.01 + phase * (i % row));
    fclose(out);
    static char kept[4][128];
    static int next;
    char *to = kept[next++ % 4];
    snprintf(to, sizeof kept[0], "%s", path);
    return to;
}

static void convert_mesh(const char *const *paths, uint32_t steps, uint64_t memory, int threads,
                         const char *name) {
    mesh_options o = mesh_options_default();
    const mesh_series series = {.of = {.paths = paths, .sets = {.fields = 1, .steps = steps}}};
    mesh_result result;
    mesh_input *x = NULL;
    o.file.histograms = true;
    o.treelet_tets = 300;
    o.memory = memory;
    o.threads = threads;
    o.force = true;
    o.series = &series;
    if (mesh_input_open(&m, paths[0], NULL, &x) != ST_OK ||
        mesh_convert_run(&m, x, scratch_path(name), &o, NULL, &result) != ST_OK)
        fail_msg("%s", status_text());
    mesh_input_close(x);
}

static void test_meshes(void **state) {
    (void)state;
    const char *paths[2] = {write_mesh("a.vtk", 9, 0), write_mesh("b.vtk", 9, 1)};
    static naive_mesh plain;
    size_t size = 0, other = 0;
    convert_mesh(paths, 2, (uint64_t)1 << 30, 1, "m.leaf");
    if (!naive_mesh_load(&plain, scratch_path("m.leaf")))
        fail_msg("%s", plain.why);
    const char *why = naive_histogram_mesh(&plain);
    if (why)
        fail_msg("%s", why);
    naive_mesh_release(&plain);
    if (verify(scratch_path("m.leaf")) != ST_OK)
        fail_msg("%s", status_text());
    char *first = scratch_read(scratch_path("m.leaf"), &size);
    convert_mesh(paths, 2, (uint64_t)12 << 20, 3, "n.leaf");
    char *again = scratch_read(scratch_path("n.leaf"), &other);
    assert_int_equal(size, other);
    assert_memory_equal(first, again, size);
    leaf_image i = leaf_image_of(first, size);
    char *h = leaf_image_section(&i, LEAF_SECTION_HISTOGRAMS);
    h[sizeof(histogram) + 4160 + 4 * 100] ^= 1;
    leaf_image_seal(&i);
    assert_int_equal(verify(scratch_write("bad.leaf", i.bytes, i.size)), ST_CORRUPT);
    free(i.bytes);
    free(again);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_grids),      cmocka_unit_test(test_large_grids),
        cmocka_unit_test(test_same_bytes), cmocka_unit_test(test_damage),
        cmocka_unit_test(test_bins),       cmocka_unit_test(test_without),
        cmocka_unit_test(test_meshes),
    };
    mem_init(&m, 0);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
