/* test_level_rows.c - the inner loops that make and compare levels: the same bits from each ISA as
 * from plain C, for rows of any length, and nothing written beside them.
 */
/* marks: bits */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "formats/leaf/deviation_rows.h"
#include "prep/grid/pyramid_rows.h"
#include "tests/support/fields.h"

enum { NODES_MAX = 200, GUARD = 64, ROWS = 2 * DEVIATION_BRICK + 1 };

static const sample_type types[] = {SAMPLE_U8, SAMPLE_I8, SAMPLE_U16, SAMPLE_I16, SAMPLE_F32};
enum { TYPES = sizeof types / sizeof *types };

/* Of all bits, or the two ends of a type alone: sums are as large as they can be. */
static void fill(field_random *r, sample_type type, void *samples, size_t count, bool ends) {
    const size_t size = sample_size(type);
    unsigned char *bytes = samples;
    if (type == SAMPLE_F32) {
        float *f = samples;
        for (size_t i = 0; i < count; i++)
            f[i] = field_random_below(r, 50) == 0 && ends
                       ? INFINITY
                       : (float)(field_random_in(r, -1, 1) *
                                 pow(10, (double)field_random_below(r, 30)));
        return;
    }
    for (size_t i = 0; i < count * size; i++)
        bytes[i] = (unsigned char)field_random_below(r, 256);
    for (size_t i = 0; ends && i < count; i++) {
        const bool is_signed = type == SAMPLE_I8 || type == SAMPLE_I16;
        const bool high = field_random_below(r, 8) > 0;
        memset(bytes + i * size, high ? 255 : 0, size);
        bytes[i * size + size - 1] = high ? (is_signed ? 127 : 255) : (is_signed ? 128 : 0);
    }
}

/* ---- Filters ---- */

static char outputs[2][(NODES_MAX + GUARD) * sizeof(double)];

static void begin_outputs(void) {
    memset(outputs, 0x5A, sizeof outputs);
}

static void compare_outputs(const char *what, sample_type type, int isa, uint32_t nodes) {
    if (memcmp(outputs[0], outputs[1], sizeof outputs[0]) != 0)
        fail_msg("%s of %s, %u nodes: not the same from %s", what, sample_name(type), nodes,
                 cpu_isa_name((cpu_isa)isa));
}

static void check_filters(field_random *r, sample_type type, int isa, uint32_t nodes, bool ends) {
    const pyramid_rows *rows[2] = {pyramid_rows_for(CPU_SCALAR, type),
                                   pyramid_rows_for((cpu_isa)isa, type)};
    static char samples[NODES_MAX * sizeof(float)], sums[PYRAMID_TAPS][NODES_MAX * sizeof(double)];
    static char planes[PYRAMID_TAPS][NODES_MAX * sizeof(double)];
    const uint32_t coarse = nodes / 2 + 1;
    const uint32_t a = (uint32_t)field_random_below(r, coarse + 1);
    const uint32_t b = a + (uint32_t)field_random_below(r, coarse + 1 - a);
    const void *taps[PYRAMID_TAPS], *whole[PYRAMID_TAPS];
    assert_int_equal(rows[0]->sum_size, rows[1]->sum_size);
    for (int i = 0; i < PYRAMID_TAPS; i++) {
        const void *same[PYRAMID_TAPS];
        fill(r, type, samples, nodes, ends && type != SAMPLE_F32);
        rows[0]->x(samples, nodes, sums[i], 0, coarse);
        for (int d = 0; d < PYRAMID_TAPS; d++)
            same[d] = sums[i];
        rows[0]->y(same, planes[i], 0, coarse);
        taps[i] = sums[i];
        whole[i] = planes[i];
    }
    begin_outputs();
    for (int i = 0; i < 2; i++)
        rows[i]->x(samples, nodes, outputs[i], a, b);
    compare_outputs("sums along x", type, isa, nodes);
    begin_outputs();
    for (int i = 0; i < 2; i++)
        rows[i]->y(taps, outputs[i], a, b);
    compare_outputs("sums along y", type, isa, nodes);
    begin_outputs();
    for (int i = 0; i < 2; i++)
        rows[i]->z(whole, outputs[i], a, b);
    compare_outputs("means", type, isa, nodes);
}

static void test_filters(void **state) {
    (void)state;
    field_random r = {FIELD_SEED};
    for (int isa = CPU_SCALAR; isa <= (int)cpu_best(); isa++)
        for (int t = 0; t < TYPES; t++)
            for (uint32_t nodes = 2; nodes < NODES_MAX; nodes++)
                check_filters(&r, types[t], isa, nodes, nodes % 2);
}

/* ---- Differences ---- */

static void check_differences(field_random *r, sample_type type, int isa, uint32_t nodes,
                              bool weighted) {
    static char fine[ROWS * NODES_MAX * sizeof(float)];
    static char coarse[2][ROWS * NODES_MAX * sizeof(float)];
    const uint32_t width = nodes / 2 + 1;
    double weight[2][NODES_MAX];
    const size_t bytes = deviation_band_bytes(nodes);
    deviation_band *band[2];
    void *scratch = malloc(deviation_scratch_bytes(nodes));
    deviation_slice s = {.type = type,
                         .fine = fine,
                         .nodes = nodes,
                         .rows = 1 + (uint32_t)field_random_below(r, ROWS),
                         .fine_row = nodes,
                         .coarse = {coarse[0], coarse[1]},
                         .coarse_row = width,
                         .weight_z = 0.5};
    for (int i = 0; i < NODES_MAX; i++)
        weight[0][i] = weight[1][i] = field_random_in(r, 0, 1);
    if (weighted) {
        s.weight[0] = weight[0];
        s.weight[1] = weight[1];
    }
    for (int i = 0; i < 2; i++) {
        band[i] = aligned_alloc(64, (bytes + 63) / 64 * 64);
        deviation_band_begin(band[i], nodes);
        band[i]->numbers = deviation_numbers_of(type, weighted);
    }
    for (int z = 0; z < 3; z++) {
        fill(r, type, fine, (size_t)ROWS * nodes, z == 1);
        fill(r, type, coarse[0], (size_t)ROWS * width, z == 1);
        fill(r, type, coarse[1], (size_t)ROWS * width, z == 1);
        for (int i = 0; i < 2; i++)
            deviation_rows_for(i ? (cpu_isa)isa : CPU_SCALAR, type, band[i]->numbers)(&s, scratch,
                                                                                      band[i]);
    }
    if (memcmp(band[0], band[1], bytes) != 0)
        fail_msg("differences of %s, %u nodes: not the same from %s", sample_name(type), nodes,
                 cpu_isa_name((cpu_isa)isa));
    for (int i = 0; i < 2; i++)
        free(band[i]);
    free(scratch);
}

static void test_differences(void **state) {
    (void)state;
    field_random r = {FIELD_SEED + 1};
    for (int isa = CPU_SCALAR + 1; isa <= (int)cpu_best(); isa++)
        for (int t = 0; t < TYPES; t++)
            for (uint32_t nodes = 2; nodes < NODES_MAX; nodes += 1 + nodes / 40)
                for (int weighted = 0; weighted < 2; weighted++)
                    check_differences(&r, types[t], isa, nodes, weighted);
}

/* Eighths are exact: the same as doubles where these are, halfway between all coarse nodes. */
static void test_eighths(void **state) {
    (void)state;
    field_random r = {FIELD_SEED + 2};
    enum { NODES = 67 };
    static char fine[ROWS * NODES * sizeof(float)], coarse[2][ROWS * NODES * sizeof(float)];
    double half[NODES];
    for (int i = 0; i < NODES; i++)
        half[i] = 0.5;
    char *scratch = malloc(deviation_scratch_bytes(NODES));
    deviation_band *band = aligned_alloc(64, (deviation_band_bytes(NODES) + 63) / 64 * 64);
    for (int t = 0; t < TYPES - 1; t++)
        for (int n = 0; n < 40; n++) {
            double found[2][2 * (NODES / DEVIATION_BRICK + 1)];
            deviation_slice s = {.type = types[t],
                                 .fine = fine,
                                 .nodes = NODES,
                                 .rows = ROWS,
                                 .fine_row = NODES,
                                 .coarse = {coarse[0], coarse[n % 2]},
                                 .coarse_row = NODES / 2 + 1,
                                 .weight_z = n % 2 ? 0.5 : 0.0};
            fill(&r, types[t], fine, (size_t)ROWS * NODES, n % 3 == 0);
            fill(&r, types[t], coarse[0], (size_t)ROWS * NODES, n % 3 == 0);
            fill(&r, types[t], coarse[1], (size_t)ROWS * NODES, n % 3 == 1);
            for (int weighted = 0; weighted < 2; weighted++) {
                s.weight[0] = s.weight[1] = weighted ? half : NULL;
                deviation_band_begin(band, NODES);
                deviation_compare(&s, scratch, band);
                for (uint32_t i = 0; i < sizeof *found / sizeof **found; i++)
                    found[weighted][i] = deviation_of_brick(band, i / 2, i % 2);
            }
            assert_memory_equal(found[0], found[1], sizeof found[0]);
            assert_true(found[0][0] > 0);
        }
    free(band);
    free(scratch);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_filters),
                                       cmocka_unit_test(test_differences),
                                       cmocka_unit_test(test_eighths)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
