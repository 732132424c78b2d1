/* test_outside_samples.c - files that leave the samples of level 0 in their input: the same
 * payloads as of a file with all, whatever the type; what the second reader makes of them; sections
 * that cannot be. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <fcntl.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "formats/leaf/leaf_check.h"
#include "formats/leaf/leaf_unpacker.h"
#include "tests/support/leaf_compare.h"
#include "tests/support/leaf_files.h"
#include "tests/support/leaf_parts.h"
#include "tests/support/naive_leaf.h"
#include "tests/support/scratch.h"

/* The nodes of level 0 that treelet t has samples of. */
static uint64_t nodes_of(const leaf_layout *l, uint32_t t) {
    const leaf_payload p = leaf_layout_payload(l, t);
    uint64_t nodes = 1;
    for (int a = 0; a < 3; a++) {
        const int64_t at = ((int64_t)l->place[t][a] << l->cells_log2) - l->halo;
        const int64_t end = at + p.samples[a], last = l->level[0].dims[a];
        nodes *= (uint64_t)((end < last ? end : last) - (at > 0 ? at : 0));
    }
    return nodes;
}

static uint32_t outside_treelets;

/* What reading a treelet counts. */
static void check_read(const leaf_file *index, uint32_t t, uint64_t read) {
    if (!leaf_file_is_outside(index, t))
        return;
    assert_true(read == leaf_file_bytes_outside(index, t) && read > 0);
    /* Rows more than a page apart are read alone. */
    if (index->header.dims[0] >= 3000)
        assert_int_equal(read, nodes_of(&index->layout, t) * sample_size(index->layout.type));
    outside_treelets++;
}

/* Convert both ways, and compare; the second reader reads both. */
static void check_case(const leaf_case *c) {
    char whole[256], index[256];
    naive_leaf leaf;
    leaf_case in_place = *c;
    in_place.in_place = true;
    snprintf(whole, sizeof whole, "%s", leaf_files_make(c, "whole.leaf"));
    snprintf(index, sizeof index, "%s", leaf_files_make(&in_place, "index.leaf"));
    outside_treelets = 0;
    leaf_compare(whole, index, 0, check_read);
    assert_true(outside_treelets > 0);
    if (!naive_leaf_load(&leaf, index))
        fail_msg("%s: %s", sample_name(c->type), leaf.why);
    naive_leaf_release(&leaf);
}

static void test_types(void **state) {
    static const sample_type types[] = {SAMPLE_U8,  SAMPLE_I8,  SAMPLE_U16, SAMPLE_I16,
                                        SAMPLE_F32, SAMPLE_U32, SAMPLE_I32, SAMPLE_F64};
    (void)state;
    for (size_t i = 0; i < sizeof types / sizeof *types; i++)
        for (int how = 0; how < 8; how++) {
            leaf_case c = leaf_files_case(40, 37, 34, types[i]);
            char *samples = leaf_files_random(&c, i + 1, how & 1 ? 40 : 0);
            c.samples = samples;
            c.options.file.halo = (uint32_t)how >> 1 & 1;
            c.reading.big_endian = how >> 2 & 1;
            c.reading.has_missing = (how & 1) && types[i] != SAMPLE_U32 && types[i] != SAMPLE_I32;
            c.reading.missing = 25;
            check_case(&c);
            free(samples);
        }
}

/* Rows far apart are read one by one; treelets of one cell, and of many. */
static void test_sizes(void **state) {
    static const uint32_t dims[][3] = {{3000, 40, 5}, {2, 2, 2},   {17, 18, 16},
                                       {16, 17, 50},  {65, 66, 3}, {33, 1700, 4}};
    (void)state;
    for (size_t i = 0; i < sizeof dims / sizeof *dims; i++)
        for (uint32_t log2 = 4; log2 <= 6; log2++) {
            leaf_case c = leaf_files_case(dims[i][0], dims[i][1], dims[i][2], SAMPLE_U16);
            c.options.file.cells_log2 = log2;
            void *samples = leaf_files_random(&c, i, 0);
            c.samples = samples;
            check_case(&c);
            free(samples);
        }
}

/* Empty space is implied there, too, and nothing is read for it. */
static void test_empty_space(void **state) {
    leaf_case c = leaf_files_case(70, 50, 40, SAMPLE_F32);
    float *samples = calloc((size_t)70 * 50 * 40, sizeof *samples);
    (void)state;
    assert_non_null(samples);
    for (int i = 0; i < 3000; i++)
        samples[i] = (float)i;
    c.samples = samples;
    check_case(&c);
    free(samples);
}

/* A bit that changes without a trace is found by whoever reads it, and by nobody else. */
static void test_secret_change(void **state) {
    leaf_case c = leaf_files_case(40, 37, 34, SAMPLE_U8);
    void *samples = leaf_files_random(&c, 5, 0);
    leaf_unpacker *u = NULL;
    struct stat info;
    uint32_t wrong = 0;
    mem m;
    (void)state;
    c.samples = samples;
    c.in_place = true;
    const char *index = leaf_files_make(&c, "index.leaf");
    const char *input = scratch_path("input-40x37x34.bin");
    assert_int_equal(stat(input, &info), 0);
    leaf_parts_damage(input, (size_t)40 * 37 * 20 + 40 * 30 + 38);
    const struct timespec times[2] = {info.st_atim, info.st_mtim};
    assert_int_equal(utimensat(AT_FDCWD, input, times, 0), 0);
    mem_init(&m, 0);
    leaf_file *f = leaf_compare_open(&m, index);
    assert_int_equal(leaf_unpacker_create(&m, f, &u), ST_OK);
    char *payload = mem_alloc(&m, leaf_layout_payload_max(&f->layout));
    for (uint32_t t = 0; t < f->layout.treelets; t++) {
        const status st = leaf_file_load(f, t, u, payload);
        wrong += st == ST_CORRUPT && leaf_file_is_outside(f, t) &&
                 strstr(status_text(), "input-40x37x34.bin: the samples of treelet");
        assert_true(st == ST_OK || st == ST_CORRUPT);
    }
    assert_int_equal(wrong, 1);
    mem_free(&m, payload);
    leaf_unpacker_destroy(u);
    leaf_file_close(f);
    free(samples);
}

/* ---- sections that cannot be ---- */

static leaf_outside section = {
    .file_bytes = 1000, .type = SAMPLE_U8, .offset = 20, .components = 1, .path = "in.raw"};

static void refused(const leaf_outside *o, const char *said) {
    const leaf_header h = {.dims = {4, 5, 6}, .sample_type = SAMPLE_U8};
    const status st = leaf_check_outside("F.leaf", &h, o, 4096);
    assert_true(st == ST_CORRUPT || st == ST_UNSUPPORTED);
    if (!strstr(status_text(), said))
        fail_msg("\"%s\" in: %s", said, status_text());
}

static void test_sections(void **state) {
    const leaf_header h = {.dims = {4, 5, 6}, .sample_type = SAMPLE_U8};
    (void)state;
    assert_int_equal(leaf_check_outside("F.leaf", &h, &section, 4096), ST_OK);
    const struct {
        size_t at;
        uint32_t value;
        const char *said;
    } wrong[] = {{offsetof(leaf_outside, modified_ns), 1000000000, "byte 4112: "},
                 {offsetof(leaf_outside, type), 0, "byte 4116: "},
                 {offsetof(leaf_outside, type), SAMPLE_F32, "become f32, and cannot be u8 here"},
                 {offsetof(leaf_outside, offset), 881, "end behind the end of their file"},
                 {offsetof(leaf_outside, offset) + 4, 1 << 30, "end behind the end of their file"},
                 {offsetof(leaf_outside, components), 0, "byte 4128: "},
                 {offsetof(leaf_outside, components), 257, "byte 4128: "},
                 {offsetof(leaf_outside, components), 9, "and cannot be u8 here"},
                 {offsetof(leaf_outside, component), 2, "byte 4132: "},
                 {offsetof(leaf_outside, flags), 8, "byte 4136: "},
                 {offsetof(leaf_outside, flags), LEAF_OUTSIDE_MISSING, "and cannot be u8 here"},
                 {offsetof(leaf_outside, reserved0), 1, "byte 4140: "},
                 {offsetof(leaf_outside, slope) + 4, 0x7ff80000, "byte 4144: "},
                 {offsetof(leaf_outside, reserved), 7, "byte 4168: "},
                 {offsetof(leaf_outside, path), 0, "byte 42"}};
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        leaf_outside o = section;
        memcpy((char *)&o + wrong[i].at, &wrong[i].value, sizeof wrong[i].value);
        refused(&o, wrong[i].said);
    }
    leaf_outside o = section;
    memset(o.path, 'x', sizeof o.path);
    refused(&o, "a text that ends within");
    memset(o.path, 0, sizeof o.path);
    refused(&o, "expected a path");
}

/* From memory nothing can be found beside the file. */
static void test_memory(void **state) {
    leaf_case c = leaf_files_case(40, 37, 34, SAMPLE_U8);
    void *samples = leaf_files_random(&c, 5, 0);
    leaf_file *f = NULL;
    size_t size;
    mem m;
    (void)state;
    c.samples = samples;
    c.in_place = true;
    char *bytes = scratch_read(leaf_files_make(&c, "index.leaf"), &size);
    mem_init(&m, 0);
    assert_int_equal(leaf_file_open_memory(&m, "here.leaf", bytes, size, &f), ST_UNSUPPORTED);
    assert_non_null(strstr(status_text(), "here.leaf: its samples lie in another file"));
    assert_int_equal(mem_used(&m), 0);
    free(bytes);
    free(samples);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_types),       cmocka_unit_test(test_sizes),
        cmocka_unit_test(test_empty_space), cmocka_unit_test(test_sections),
        cmocka_unit_test(test_memory),      cmocka_unit_test(test_secret_change),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
