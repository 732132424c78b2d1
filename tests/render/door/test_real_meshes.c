/* test_real_meshes.c - the VTK files of the data folder against the raw arrays that lie beside
 * them: every point, tet and value to the bit.
 */
/* marks: bits */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <zstd.h>

#include "tests/support/mesh_files.h"
#include "tests/support/scratch.h"

/* A file of a set: its bytes, decompressed, which the caller frees. */
static void *load(const char *set, const char *name, size_t *size) {
    char packed[200];
    snprintf(packed, sizeof packed, "%s/%s.zst", set, name);
    const char *path = scratch_data(packed);
    assert_non_null(path);
    size_t stored;
    char *bytes = scratch_read(path, &stored);
    *size = (size_t)ZSTD_getFrameContentSize(bytes, stored);
    char *raw = malloc(*size);
    assert_non_null(raw);
    assert_int_equal(ZSTD_decompress(raw, *size, bytes, stored), *size);
    free(bytes);
    return raw;
}

static void check_array(const char *set, const char *name, const void *got, size_t got_size) {
    size_t size;
    void *want = load(set, name, &size);
    assert_int_equal(got_size, size);
    assert_memory_equal(got, want, size);
    free(want);
}

static void check_set(const char *set, const char *file, const char *field, const char *values) {
    char name[200];
    snprintf(name, sizeof name, "%s/%s", set, file);
    const char *path = scratch_data(name);
    if (!path)
        skip();
    assert_true(mesh_files_recognised(path));
    const mesh_copy *a = mesh_files_good(path, &(mesh_hints){.field = field});
    assert_int_equal(a->report.bad_indices + a->report.repeated + a->report.skipped, 0);
    check_array(set, "points_f32x3.raw", a->xyz, a->report.points * sizeof *a->xyz);
    check_array(set, "tets_i32x4.raw", a->tets, a->report.tets * sizeof *a->tets);
    check_array(set, values, a->values, a->report.points * sizeof *a->values);
}

static void test_pipe_flow(void **state) {
    (void)state;
    check_set("tet_pipe_flow", "rigid_wall_flow.vtu", "Velocity", "speed_f32.raw");
    check_set("tet_pipe_flow", "rigid_wall_flow.vtu", "Pressure", "pressure_f32.raw");
}

static void test_beam(void **state) {
    (void)state;
    check_set("tet_beam", "result_100.vtu", "VonMises_stress", "vonmises_f32.raw");
}

static void test_heart(void **state) {
    (void)state;
    check_set("tet_heart_lv", "result_200.vtu", "VonMises_stress", "vonmises_f32.raw");
    check_set("tet_heart_lv", "result_200.vtu", "Displacement", "displacement_f32.raw");
}

static void test_turb_degenerate(void **state) {
    (void)state;
    check_set("tet_turb_degenerate", "xsmall_turb.vtu", NULL, "tur_mu_f32.raw");
}

/* Averages lie within the range of the cells' values, which the file states. */
static void test_beam_cells(void **state) {
    (void)state;
    const char *path = scratch_data("tet_beam/result_100.vtu");
    if (!path)
        skip();
    const mesh_hints hints = {.field = "E_VonMises", .cells_to_points = true};
    const mesh_copy *a = mesh_files_good(path, &hints);
    float least = a->values[0], most = least;
    for (size_t i = 0; i < a->report.points; i++) {
        least = a->values[i] < least ? a->values[i] : least;
        most = a->values[i] > most ? a->values[i] : most;
    }
    assert_true(least >= 2.2190e7f && least < 1e8f);
    assert_true(most <= 5.3361e9f && most > 3e9f);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_pipe_flow),  cmocka_unit_test(test_beam),
        cmocka_unit_test(test_heart),      cmocka_unit_test(test_turb_degenerate),
        cmocka_unit_test(test_beam_cells),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
