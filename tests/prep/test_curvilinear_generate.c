/* test_curvilinear_generate.c - generated curvilinear grids: shapes that close and do not fold, the
 * same bytes from any threads, read back node by node; faults.
 */
/* marks: bits */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "formats/base/fault.h"
#include "formats/base/hexahedron.h"
#include "formats/curvilinear/curvilinear_input.h"
#include "formats/leaf/leaf_verify.h"
#include "prep/generate/curvilinear_generate.h"
#include "prep/leafcast_prep.h"
#include "tests/support/scratch.h"

static mem m;

static curvilinear_generate_options options(curvilinear_shape shape, const char *name) {
    return (curvilinear_generate_options){.info = field_find("gyroid"),
                                          .shape = shape,
                                          .dims = {9, 6, 12},
                                          .threads = 1,
                                          .output = scratch_path(name),
                                          .force = true};
}

static void place(curvilinear_shape shape, const uint32_t dims[3], uint32_t i, uint32_t j,
                  uint32_t k, float out[3]) {
    const uint32_t at[3] = {i, j, k};
    double share[3];
    for (int a = 0; a < 3; a++)
        share[a] = (double)at[a] / (dims[a] - 1);
    curvilinear_shape_place(shape, share, out);
}

static int sense_at(curvilinear_shape shape, const uint32_t dims[3], uint32_t i, uint32_t j,
                    uint32_t k) {
    double p[HEX_CORNERS][3];
    for (uint32_t c = 0; c < HEX_CORNERS; c++) {
        float corner[3];
        place(shape, dims, i + (c & 1), j + (c >> 1 & 1), k + (c >> 2), corner);
        for (int a = 0; a < 3; a++)
            p[c][a] = (double)corner[a];
    }
    return hexahedron_sense((const double(*)[3])p);
}

static void test_shapes(void **state) {
    (void)state;
    static const uint32_t sizes[][3] = {{2, 2, 2}, {3, 9, 5}, {17, 8, 21}, {40, 40, 3}};
    static const char *const names[] = {"warp", "annulus", "twisted"};
    for (int s = 0; s < CURVILINEAR_SHAPES; s++) {
        curvilinear_shape shape;
        assert_true(curvilinear_shape_find(names[s], &shape) && shape == (curvilinear_shape)s);
        for (size_t n = shape == CURVILINEAR_ANNULUS ? 2 : 0; n < 4; n++)
            for (uint32_t k = 0; k + 1 < sizes[n][2]; k++)
                for (uint32_t j = 0; j + 1 < sizes[n][1]; j++)
                    for (uint32_t i = 0; i + 1 < sizes[n][0]; i++)
                        assert_int_equal(sense_at(shape, sizes[n], i, j, k),
                                         shape == CURVILINEAR_ANNULUS ? -1 : 1);
    }
    curvilinear_shape none;
    assert_false(curvilinear_shape_find("torus", &none));
    for (uint32_t k = 0; k < 5; k++) {
        float first[3], last[3];
        place(CURVILINEAR_ANNULUS, (const uint32_t[3]){7, 3, 5}, 0, 2, k, first);
        place(CURVILINEAR_ANNULUS, (const uint32_t[3]){7, 3, 5}, 6, 2, k, last);
        assert_memory_equal(first, last, sizeof first);
    }
}

static void check_file(const curvilinear_generate_options *o) {
    curvilinear_input *x = NULL;
    const uint32_t *n = o->dims;
    const size_t nodes = (size_t)n[0] * n[1] * n[2];
    if (curvilinear_input_open(&m, o->output, NULL, &x) != ST_OK)
        fail_msg("%s", status_text());
    const curvilinear_source *s = curvilinear_input_source(x);
    assert_int_equal(s->zones, 1);
    assert_memory_equal(s->nodes[0], n, sizeof o->dims);
    float(*p)[3] = malloc(nodes * sizeof *p), *got = malloc(nodes * sizeof *got),
    *expected = malloc(nodes * sizeof *expected);
    assert_true(p && got && expected);
    assert_int_equal(s->places(s->own, 0, 0, n[2], p), ST_OK);
    assert_int_equal(s->values(s->own, 0, 0, 0, n[2], got), ST_OK);
    for (size_t i = 0; i < nodes; i++) {
        float at[3];
        place(o->shape, n, (uint32_t)(i % n[0]), (uint32_t)(i / n[0] % n[1]),
              (uint32_t)(i / n[0] / n[1]), at);
        assert_memory_equal(p[i], at, sizeof at);
    }
    field *f = NULL;
    pool *one = NULL;
    const field_choice which = {o->info, o->seed, 0};
    const field_block all = {0, n[2], 0, n[1]};
    assert_int_equal(pool_create(&m, 1, &one), ST_OK);
    assert_int_equal(field_create(&m, &which, n, nodes, &f), ST_OK);
    assert_int_equal(field_fill(f, one, &all, SAMPLE_F32, expected), ST_OK);
    assert_memory_equal(got, expected, nodes * sizeof *got);
    field_destroy(f);
    pool_destroy(one);
    free(p);
    free(got);
    free(expected);
    curvilinear_input_close(x);
}

static void test_files(void **state) {
    (void)state;
    for (int s = 0; s < CURVILINEAR_SHAPES; s++) {
        curvilinear_generate_options o = options((curvilinear_shape)s, "a.vts");
        assert_int_equal(curvilinear_generate(&m, &o, NULL), ST_OK);
        check_file(&o);
        o.threads = 3;
        o.output = scratch_path("b.vts");
        assert_int_equal(curvilinear_generate(&m, &o, NULL), ST_OK);
        scratch_same("threads", scratch_path("a.vts"), scratch_path("b.vts"));
        assert_int_equal(mem_used(&m), 0);
    }
}

/* By the library: two shapes are two steps, whose nodes move; their field is the file's. */
static void test_library(void **state) {
    (void)state;
    const curvilinear_generate_options one = options(CURVILINEAR_WARP, "one.vts"),
                                       two = options(CURVILINEAR_TWISTED, "two.vts");
    const char *const in[] = {one.output, two.output};
    const char *out = scratch_path("library.leaf");
    leafcast_convert_options o = {.size = sizeof o, .replace = true};
    assert_int_equal(curvilinear_generate(&m, &one, NULL), ST_OK);
    assert_int_equal(curvilinear_generate(&m, &two, NULL), ST_OK);
    assert_int_equal(leafcast_convert_steps(in, 2, NULL, out, &o), LEAFCAST_OK);
    leaf_file *f = NULL;
    assert_int_equal(leaf_file_open(&m, out, &f), ST_OK);
    assert_true(f->header.kind == LEAF_KIND_CURVILINEAR && f->header.steps == 2);
    assert_true(f->header.moving && f->header.zones == 1);
    assert_string_equal(f->names[0], "gyroid");
    assert_int_equal(leaf_verify(&m, f, 1, NULL), ST_OK);
    leaf_file_close(f);
    assert_int_equal(leafcast_convert_path(in[0], out, &o), LEAFCAST_OK);
    o.fields = (const char *const[]){"none"};
    o.field_count = 1;
    assert_int_equal(leafcast_convert_path(in[0], out, &o), LEAFCAST_USAGE);
    o.field_count = 0;
    o.fields = NULL;
    o.zstd_level = 1;
    assert_int_equal(leafcast_convert_steps(in, 2, NULL, out, &o), LEAFCAST_OK);
    assert_int_equal(leaf_file_open(&m, out, &f), ST_OK);
    assert_true(f->header.codec == LEAF_CODEC_ZSTD && f->header.moving);
    assert_int_equal(leaf_verify(&m, f, 1, NULL), ST_OK);
    leaf_file_close(f);
}

static void test_faults(void **state) {
    (void)state;
    static const fault_kind kinds[] = {FAULT_ALLOC, FAULT_WRITE};
    const curvilinear_generate_options o = options(CURVILINEAR_WARP, "f.vts");
    const size_t files = scratch_count();
    for (size_t k = 0; k < sizeof kinds / sizeof *kinds; k++) {
        bool fired = true;
        for (long n = 1; fired; n++) {
            fault_arm(kinds[k], n);
            const status st = curvilinear_generate(&m, &o, NULL);
            fired = fault_fired(kinds[k]);
            fault_arm(kinds[k], 0);
            assert_int_equal(mem_used(&m), 0);
            if (st != ST_OK)
                assert_true(fired && scratch_count() == files);
            else
                assert_int_equal(remove(o.output), 0);
        }
    }
}

int main(void) {
    mem_init(&m, 0);
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_shapes), cmocka_unit_test(test_files),
                                       cmocka_unit_test(test_library),
                                       cmocka_unit_test(test_faults)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
