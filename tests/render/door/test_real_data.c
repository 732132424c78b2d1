/* test_real_data.c - every regular set of the data folder converts; active cells are counted as the
 * list there has them (half-open: min < iso && iso <= max).
 */
/* marks: long */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <zstd.h>

#include "formats/leaf/leaf_stats.h"
#include "formats/leaf/leaf_verify.h"
#include "prep/grid/convert.h"
#include "tests/support/scratch.h"
#include "tests/support/watched.h"

/* Where every access is watched, some of the sets: all are converted in the same way. */
enum { THREADS = 2, EVERY = WATCHED ? 5 : 1 };

static mem m;

/* A data file's samples in the scratch folder under its own name: decompressed, if it is NAME.zst.
 * NULL when it is not there. */
static const char *stage(const char *set, const char *name) {
    char packed[PATH_MAX];
    snprintf(packed, sizeof packed, "%s/%s.zst", set, name);
    const char *path = scratch_data(packed);
    size_t size;
    if (!path) {
        snprintf(packed, sizeof packed, "%s/%s", set, name);
        path = scratch_data(packed);
        if (!path)
            return NULL;
        char *bytes = scratch_read(path, &size);
        const char *copy = scratch_write(name, bytes, size);
        free(bytes);
        return copy;
    }
    char *bytes = scratch_read(path, &size);
    unsigned long long raw = ZSTD_getFrameContentSize(bytes, size);
    assert_true(raw != ZSTD_CONTENTSIZE_UNKNOWN && raw != ZSTD_CONTENTSIZE_ERROR);
    char *samples = malloc((size_t)raw);
    assert_non_null(samples);
    assert_int_equal(ZSTD_decompress(samples, (size_t)raw, bytes, size), raw);
    const char *copy = scratch_write(name, samples, (size_t)raw);
    free(samples);
    free(bytes);
    return copy;
}

/* Convert, open and verify. */
static leaf_file *convert(const char *path, const volume_hints *hints) {
    const char *output = scratch_path("real.leaf");
    convert_options o = {
        .file = leaf_parameters_default(), .memory = 256 << 20, .threads = THREADS, .force = true};
    volume *v = NULL;
    convert_plan plan;
    convert_result result;
    leaf_file *f = NULL;
    status st = volume_open(&m, path, hints, &v);
    if (st == ST_OK)
        st = convert_plan_make(&m, volume_grid(v), &o, &plan);
    if (st == ST_OK)
        st = convert_run(&m, v, output, &o, &plan, NULL, &result);
    volume_close(v);
    if (st == ST_OK)
        st = leaf_file_open(&m, output, &f);
    if (st == ST_OK)
        st = leaf_verify(&m, f, THREADS, NULL);
    if (st != ST_OK)
        fail_msg("%s: %s", path, status_text());
    return f;
}

/* Done with: the files go, for there are many. */
static void drop(leaf_file *f, const char *path) {
    leaf_file_close(f);
    (void)remove(scratch_path("real.leaf"));
    (void)remove(path);
    assert_int_equal(mem_used(&m), 0);
}

/* One line of the list: is it a regular set, whose field is a raw file with dimensions in its name?
 */
static bool parse_line(char *line, char **set, char **name, double *iso,
                       unsigned long long *half_open) {
    char *cells, *closed, *rest = line;
    *set = strtok_r(line, "\t", &rest);
    *name = strtok_r(NULL, "\t", &rest);
    char *value = strtok_r(NULL, "\t", &rest);
    closed = strtok_r(NULL, "\t", &rest);
    cells = strtok_r(NULL, "\t", &rest);
    unsigned dims[3];
    const char *sizes = *name ? strpbrk(*name, "0123456789") : NULL;
    while (sizes && sscanf(sizes, "%ux%ux%u_", &dims[0], &dims[1], &dims[2]) != 3)
        sizes = strpbrk(sizes + strspn(sizes, "0123456789"), "0123456789");
    if (line[0] == '#' || !closed || !cells || !sizes)
        return false;
    *iso = strtod(value, NULL);
    *half_open = strtoull(cells, NULL, 10);
    return true;
}

static void test_active_cells(void **state) {
    (void)state;
    const char *list = scratch_data("ACTIVE_CELLS.tsv");
    if (!list)
        skip();
    mem_init(&m, 0);
    FILE *in = fopen(list, "r");
    assert_non_null(in);
    char line[512], current[256] = "";
    const char *path = NULL;
    leaf_file *f = NULL;
    int sets = 0, counts = 0;
    while (fgets(line, sizeof line, in)) {
        char *set, *name;
        double iso;
        unsigned long long half_open;
        if (!parse_line(line, &set, &name, &iso, &half_open))
            continue;
        if (strcmp(current, name) != 0) {
            if (f)
                drop(f, path);
            snprintf(current, sizeof current, "%s", name);
            f = NULL;
            if (sets++ % EVERY == 0) {
                path = stage(set, name);
                assert_non_null(path);
                f = convert(path, NULL);
            }
        }
        if (!f)
            continue;
        /* The list takes isovalues as floats. */
        leaf_activity levels[LEAF_LEVELS_MAX];
        assert_int_equal(leaf_stats_activity(&m, f, 0, (double)(float)iso, THREADS, NULL, levels),
                         ST_OK);
        if (levels[0].cells != half_open)
            fail_msg("%s at %g: %llu active cells, expected %llu", name, iso,
                     (unsigned long long)levels[0].cells, half_open);
        counts++;
    }
    fclose(in);
    if (f)
        drop(f, path);
    print_message("%d sets, %d isovalues\n", sets, counts);
    assert_true(sets >= 40 && counts >= 60 / EVERY);
}

/* Rectilinear sets, which the list does not have. */
static void test_rectilinear(void **state) {
    (void)state;
    if (!scratch_data("ACTIVE_CELLS.tsv"))
        skip();
    mem_init(&m, 0);
    volume_hints hints = {0};
    hints.axis_file[2] = scratch_text(
        "levitus.z",
        "0 10 20 30 50 75 100 150 200 300 400 600 800 1000 1200 1500 2000 3000 4000 5000");
    const char *path = stage("levitus_temp", "levitus_temp_360x180x20_float32.raw");
    assert_non_null(path);
    leaf_file *f = convert(path, &hints);
    assert_int_equal(f->header.rectilinear, 1);
    assert_true(f->axis[2][19] == 5000);
    drop(f, path);
    hints.axis_file[2] = scratch_text(
        "ocean.z", "0 10 20 30 50 75 100 125 150 200 250 300 400 500 600 700 800 900 1000");
    for (int month = 1; month <= 12; month += EVERY) {
        char name[64];
        snprintf(name, sizeof name, "ocean_temp_m%02d_180x90x19_float32.raw", month);
        path = stage("ocean_monthly", name);
        assert_non_null(path);
        f = convert(path, &hints);
        assert_int_equal(f->header.dims[2], 19);
        drop(f, path);
    }
}

/* What an isovalue needs of the payloads' bytes, if each had some: the measure of treelets that are
 * small enough. */
static void test_active_share(void **state) {
    (void)state;
    static const struct {
        const char *set, *name;
        double iso, share;
    } cases[] = {
        {"bonsai", "bonsai_256x256x256_uint8.raw", 37, 0.53},
        {"engine", "engine_256x256x128_uint8.raw", 80, 0.63},
        {"ch2better", "ch2better_301x370x316_uint8.raw", 60, 0.653},
    };
    if (!scratch_data("ACTIVE_CELLS.tsv"))
        skip();
    mem_init(&m, 0);
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        const char *path = stage(cases[i].set, cases[i].name);
        assert_non_null(path);
        leaf_file *f = convert(path, NULL);
        leaf_activity levels[LEAF_LEVELS_MAX];
        assert_int_equal(leaf_stats_activity(&m, f, 0, cases[i].iso, THREADS, NULL, levels), ST_OK);
        uint64_t bytes = 0, all = 0;
        for (uint32_t n = 0; n < f->layout.levels; n++)
            bytes += levels[n].bytes;
        for (uint32_t p = 0; p < f->layout.payloads; p++)
            all += leaf_layout_payload_bytes(&f->layout, p);
        double share = (double)bytes / (double)all;
        print_message("%s at %g: %.4f of the payload bytes, %.4f of the file\n", cases[i].set,
                      cases[i].iso, share, (double)bytes / (double)f->header.file_bytes);
        assert_true(share <= cases[i].share);
        drop(f, path);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_active_cells),
        cmocka_unit_test(test_rectilinear),
        cmocka_unit_test(test_active_share),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
