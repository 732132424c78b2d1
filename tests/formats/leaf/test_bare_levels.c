/* test_bare_levels.c - grids whose coarse levels have no samples: level 0 as in a file with all;
 * what the second reader makes of them; directories that cannot be. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "formats/leaf/leaf_unpacker.h"
#include "formats/leaf/leaf_verify.h"
#include "prep/grid/pyramid.h"
#include "tests/support/leaf_files.h"
#include "tests/support/leaf_image.h"
#include "tests/support/mesh_leaves.h"
#include "tests/support/naive_leaf.h"
#include "tests/support/scratch.h"

static leaf_file *open_file(mem *m, const char *path) {
    leaf_file *f = NULL;
    if (leaf_file_open(m, path, &f) != ST_OK)
        fail_msg("%s", status_text());
    return f;
}

/* ---- sound files ---- */

static void check_coarse(leaf_file *f, uint32_t t, leaf_unpacker *u, void *room) {
    assert_true(f->own[t][0] == INFINITY && f->own[t][1] == -INFINITY);
    assert_true(f->flags[t] == 0 && f->sizes[t] == 0 && f->checksums[t] == 0);
    assert_true(leaf_file_is_bare(f, t) && !leaf_file_is_implied(f, t));
    assert_int_equal(leaf_file_load(f, t, u, room), ST_UNSUPPORTED);
    assert_non_null(strstr(status_text(), "which has no samples"));
    if (f->layout.shells)
        assert_true(f->layout.level_of[t] == 1 ||
                    f->sizes[leaf_layout_shell(&f->layout, 0, t)] == 0);
}

/* Ranges of coarse treelets are those of level 0 below. */
static void check_range(const leaf_file *f, uint32_t t) {
    float lo = INFINITY, hi = -INFINITY;
    const leaf_layout *l = &f->layout;
    for (uint32_t i = l->level[0].first; i < l->treelets; i++) {
        bool below = true;
        for (int a = 0; a < 3; a++)
            below = below && l->place[i][a] >> l->level_of[t] == l->place[t][a];
        lo = below ? fminf(lo, f->own[i][0]) : lo;
        hi = below ? fmaxf(hi, f->own[i][1]) : hi;
    }
    assert_true(f->ranges[t][0] == lo && f->ranges[t][1] == hi);
}

/* Compare level 0, and what the directory and the histogram say of it, with a file of all levels.
 */
static void compare(const char *whole, const char *bare) {
    mem m;
    leaf_unpacker *of_a = NULL, *of_b = NULL;
    mem_init(&m, 0);
    leaf_file *a = open_file(&m, whole), *b = open_file(&m, bare);
    assert_int_equal(leaf_unpacker_create(&m, a, &of_a), ST_OK);
    assert_int_equal(leaf_unpacker_create(&m, b, &of_b), ST_OK);
    char *want = mem_alloc(&m, leaf_layout_payload_max(&a->layout));
    char *got = mem_alloc(&m, leaf_layout_payload_max(&a->layout));
    assert_true(want && got && b->header.bare && b->layout.sampled == 1 && !b->deviations);
    assert_int_equal(a->layout.treelets, b->layout.treelets);
    assert_int_equal(leaf_file_check_level(b, 0), ST_OK);
    assert_int_equal(leaf_file_check_level(b, 1), ST_USAGE);
    assert_non_null(strstr(status_text(), "level 0 alone"));
    for (uint32_t t = 0; t < a->layout.treelets; t++) {
        if (a->layout.level_of[t] > 0) {
            check_coarse(b, t, of_b, got);
            check_range(b, t);
            continue;
        }
        memset(got, 0x55, leaf_layout_payload_bytes(&a->layout, t));
        assert_int_equal(leaf_file_load(a, t, of_a, want), ST_OK);
        if (leaf_file_load(b, t, of_b, got) != ST_OK)
            fail_msg("%s", status_text());
        assert_memory_equal(want, got, leaf_layout_payload_bytes(&a->layout, t));
        assert_memory_equal(a->own[t], b->own[t], sizeof a->own[t]);
        assert_int_equal(a->flags[t], b->flags[t]);
    }
    assert_true(!a->histograms == !b->histograms);
    if (a->histograms)
        assert_memory_equal(a->histograms, b->histograms, sizeof *a->histograms);
    assert_true(a->header.value_min == b->header.value_min &&
                a->header.value_max == b->header.value_max &&
                a->header.non_finite == b->header.non_finite);
    if (leaf_verify(&m, b, 2, NULL) != ST_OK)
        fail_msg("%s", status_text());
    mem_free(&m, want);
    mem_free(&m, got);
    leaf_unpacker_destroy(of_a);
    leaf_unpacker_destroy(of_b);
    leaf_file_close(a);
    leaf_file_close(b);
    assert_int_equal(mem_used(&m), 0);
}

static void same_bytes(const char *a, const char *b) {
    size_t sizes[2];
    char *bytes[2] = {scratch_read(a, &sizes[0]), scratch_read(b, &sizes[1])};
    assert_int_equal(sizes[0], sizes[1]);
    assert_memory_equal(bytes[0], bytes[1], sizes[0]);
    free(bytes[0]);
    free(bytes[1]);
}

/* With other threads, and in the least memory, the bytes are the same; and no more than planned. */
static void check_again(const leaf_case *bare, const char *path) {
    for (int threads = 1; threads <= 4; threads += 3) {
        leaf_case c = *bare;
        convert_plan plan;
        convert_result result;
        mem m;
        c.options.threads = threads;
        c.options.force = true;
        c.options.memory = leaf_files_least(&c);
        mem_init(&m, 0);
        if (leaf_files_try(&m, &c, "again.leaf", &plan, &result) != ST_OK)
            fail_msg("%s", status_text());
        same_bytes(path, scratch_path("again.leaf"));
        assert_true(result.header.file_bytes <= plan.file_bytes);
        assert_true(result.header.payload_bytes <= plan.payload_bytes);
    }
}

/* Convert with all levels and without, and compare; the second reader reads it. */
static void check_case(const leaf_case *c) {
    char whole[256], path[256];
    naive_leaf leaf;
    leaf_case all = *c, bare = *c;
    all.in_place = false;
    bare.options.file.bare = true;
    snprintf(whole, sizeof whole, "%s", leaf_files_make(&all, "whole.leaf"));
    snprintf(path, sizeof path, "%s", leaf_files_make(&bare, "bare.leaf"));
    compare(whole, path);
    if (!naive_leaf_load(&leaf, path))
        fail_msg("%s: %s", sample_name(c->type), leaf.why);
    assert_true(leaf.bare);
    naive_leaf_release(&leaf);
    if (c->in_place)
        return; /* the file names its input, which would be written again */
    assert_true(leaf_files_least(&bare) < leaf_files_least(&all));
    check_again(&bare, path);
}

static leaf_case case_of(uint32_t x, uint32_t y, uint32_t z, sample_type type) {
    leaf_case c = leaf_files_case(x, y, z, type);
    c.options.file.histograms = c.options.file.deviations = true;
    return c;
}

static void test_types(void **state) {
    static const sample_type types[] = {SAMPLE_U8, SAMPLE_I8, SAMPLE_I16, SAMPLE_F32};
    (void)state;
    for (size_t i = 0; i < sizeof types / sizeof *types; i++)
        for (int how = 0; how < 8; how++) {
            leaf_case c = case_of(70, 37, 50, types[i]);
            void *samples = leaf_files_random(&c, i + 1, how & 1 ? 40 : 0);
            c.samples = samples;
            c.options.file.halo = (uint32_t)how >> 1 & 1;
            c.options.file.codec = how & 4 ? LEAF_CODEC_ZSTD : LEAF_CODEC_RAW;
            c.options.file.zstd_level = 1;
            check_case(&c);
            free(samples);
        }
}

/* Few and many levels; the last slab ends with or without halo; empty space; in place. */
static void test_sizes(void **state) {
    static const uint32_t dims[][3] = {{18, 2, 2}, {2, 3, 700}, {300, 18, 17}, {65, 66, 131}};
    (void)state;
    for (size_t i = 0; i < sizeof dims / sizeof *dims; i++)
        for (int how = 0; how < 3; how++) {
            leaf_case c = case_of(dims[i][0], dims[i][1], dims[i][2], SAMPLE_U16);
            uint16_t *samples = leaf_files_random(&c, i, 0);
            c.samples = samples;
            memset(samples, 0, (size_t)dims[i][0] * dims[i][1] * dims[i][2]);
            c.in_place = how == 1;
            c.options.file.codec = how == 2 ? LEAF_CODEC_ZSTD : LEAF_CODEC_RAW;
            c.options.file.zstd_level = 1;
            check_case(&c);
            free(samples);
        }
}

/* What a raw file will be is known beforehand, to the byte. */
static void test_plan(void **state) {
    (void)state;
    leaf_case c = case_of(70, 67, 50, SAMPLE_U8);
    void *samples = leaf_files_random(&c, 3, 0);
    convert_plan plan;
    convert_result result;
    mem m;
    c.samples = samples;
    c.options.file.bare = true;
    c.options.file.run_align_log2 = 6;
    mem_init(&m, c.options.memory);
    assert_int_equal(leaf_files_try(&m, &c, "plan.leaf", &plan, &result), ST_OK);
    assert_int_equal(plan.file_bytes, result.header.file_bytes);
    assert_int_equal(plan.payload_bytes, result.header.payload_bytes);
    assert_int_equal(plan.layout.sampled, 1);
    free(samples);
}

/* Memory that coarse levels take is not planned: for pyramids, and for slabs of theirs. */
static void test_memory(void **state) {
    (void)state;
    grid g = {.type = SAMPLE_U16, .source = SAMPLE_U16, .dims = {900, 700, 500}};
    convert_options o = leaf_files_case(2, 2, 2, SAMPLE_U16).options;
    convert_plan all, bare;
    uint64_t pyramids = 0;
    mem m;
    for (int a = 0; a < 3; a++)
        g.to_world[a][a] = 1;
    mem_init(&m, 0);
    assert_int_equal(convert_plan_make(&m, &g, &o, &all), ST_OK);
    o.file.bare = true;
    assert_int_equal(convert_plan_make(&m, &g, &o, &bare), ST_OK);
    for (uint32_t level = 0; level + 1 < all.layout.levels; level++)
        pyramids += pyramid_memory(SAMPLE_U16, all.layout.level[level].dims, o.threads);
    assert_true(all.memory_least - bare.memory_least > pyramids + 100000);
    assert_true(all.spilled_levels == 0 && bare.spilled_levels == 0);
    assert_true(all.memory - bare.memory > pyramids + slab_memory(&all.layout, 1, &(slab_plan){0}));
}

/* A grid of one level has no others: it is the same file. */
static void test_one_level(void **state) {
    (void)state;
    leaf_case c = case_of(17, 16, 9, SAMPLE_U8);
    void *samples = leaf_files_random(&c, 3, 0);
    char whole[256];
    c.samples = samples;
    snprintf(whole, sizeof whole, "%s", leaf_files_make(&c, "whole.leaf"));
    c.options.file.bare = true;
    same_bytes(whole, leaf_files_make(&c, "bare.leaf"));
    free(samples);
}

/* ---- files that cannot be ---- */

static leaf_image make(uint32_t z, sample_type type, leaf_codec codec, bool bare) {
    leaf_case c = leaf_files_case(20, 19, z, type);
    void *samples = leaf_files_random(&c, 7, type == SAMPLE_F32 ? 20 : 0);
    c.samples = samples;
    c.options.file.codec = codec;
    c.options.file.zstd_level = 1;
    c.options.file.bare = bare;
    c.options.file.deviations = true;
    size_t size;
    char *bytes = scratch_read(leaf_files_make(&c, "made.leaf"), &size);
    free(samples);
    return leaf_image_of(bytes, size);
}

/* Both readers refuse it; this one says so. */
static void refused(const leaf_image *i, bool payloads, const char *said) {
    mem m;
    leaf_file *f = NULL;
    naive_leaf leaf;
    mem_init(&m, 0);
    if (payloads)
        leaf_image_seal_payloads(i);
    leaf_image_seal(i);
    const status st = leaf_file_open_memory(&m, "F.leaf", i->bytes, i->size, &f);
    if (st != ST_CORRUPT && st != ST_UNSUPPORTED)
        fail_msg("opened, where \"%s\" was expected", said);
    if (!strstr(status_text(), said) || strncmp(status_text(), "F.leaf: byte ", 13) != 0)
        fail_msg("\"%s\" in: %s", said, status_text());
    assert_int_equal(mem_used(&m), 0);
    assert_false(naive_leaf_load(&leaf, scratch_write("hostile.leaf", i->bytes, i->size)));
    naive_leaf_release(&leaf);
    free(i->bytes);
}

static void test_flag(void **state) {
    (void)state;
    for (int codec = LEAF_CODEC_RAW; codec <= LEAF_CODEC_ZSTD; codec++) {
        /* 20 x 19 x 18 in treelets of 16^3: the root, then eight. */
        leaf_image i = make(18, SAMPLE_U8, (leaf_codec)codec, false);
        i.header->bare = 1;
        refused(&i, false, "expected section 1073741826 to have 0 bytes");
        i = make(18, SAMPLE_U8, (leaf_codec)codec, true);
        assert_true(i.header->bare == 1 && i.header->treelets == 9);
        i.header->bare = 0;
        refused(&i, false,
                codec == LEAF_CODEC_RAW ? "expected treelet 0's payload to have "
                                        : "expected treelet 0's payload to have at most ");
        i = make(18, SAMPLE_U8, (leaf_codec)codec, true);
        i.header->bare = 2;
        refused(&i, false, "byte 1496: expected bare from 0 to 1, found 2");
        i = make(18, SAMPLE_U8, (leaf_codec)codec, true);
        i.header->gradients = 1;
        refused(&i, false, "byte 1488: expected 0 in a reserved place");
        i = make(18, SAMPLE_U8, (leaf_codec)codec, true);
        i.header->zones = 1;
        refused(&i, false, "byte 1536: expected 0 in a reserved place");
        i = make(18, SAMPLE_U8, (leaf_codec)codec, true);
        i.header->reserved[0] = 1;
        refused(&i, false, "byte 1540: expected 0 in a reserved place");
    }
    leaf_case c = leaf_files_case(17, 17, 17, SAMPLE_U8);
    void *samples = leaf_files_random(&c, 7, 0);
    size_t size;
    c.samples = samples;
    char *bytes = scratch_read(leaf_files_make(&c, "one.leaf"), &size);
    leaf_image i = leaf_image_of(bytes, size);
    free(samples);
    i.header->bare = 1;
    refused(&i, false, "byte 1496: expected bare from 0 to 0, found 1");
}

/* A coarse treelet that has payloads, or says that it has. */
static void test_payloads(void **state) {
    (void)state;
    for (int codec = LEAF_CODEC_RAW; codec <= LEAF_CODEC_ZSTD; codec++) {
        leaf_image i = make(18, SAMPLE_U8, (leaf_codec)codec, true);
        uint64_t *sizes = leaf_image_section(&i, LEAF_SECTION_SIZES);
        uint64_t *offsets = leaf_image_section(&i, LEAF_SECTION_OFFSETS);
        sizes[0] = 64;
        offsets[0] = i.size - 64;
        offsets[0] = codec == LEAF_CODEC_RAW ? offsets[0] / 4096 * 4096 : offsets[0];
        i.header->payload_bytes += 64;
        refused(&i, true, "treelet 0's payload");
        i = make(18, SAMPLE_U8, (leaf_codec)codec, true);
        uint64_t *sums = leaf_image_section(&i, LEAF_SECTION_CHECKSUMS);
        sums[0] = 1;
        refused(&i, false, "expected 0 as the checksum of treelet 0's payload");
    }
    /* With deviations out of the way, the first thing that is wrong are the payloads. */
    leaf_case c = leaf_files_case(20, 19, 18, SAMPLE_U8);
    void *samples = leaf_files_random(&c, 7, 0);
    size_t size;
    c.samples = samples;
    char *bytes = scratch_read(leaf_files_make(&c, "whole.leaf"), &size);
    free(samples);
    leaf_image i = leaf_image_of(bytes, size);
    i.header->bare = 1;
    refused(&i, false, "expected treelet 0's payload to have no bytes, found ");
}

/* A coarse treelet with a range of its own, or a flag. */
static void test_values(void **state) {
    (void)state;
    leaf_image i = make(18, SAMPLE_F32, LEAF_CODEC_RAW, true);
    float(*own)[2] = leaf_image_section(&i, LEAF_SECTION_OWN);
    float(*ranges)[2] = leaf_image_section(&i, LEAF_SECTION_RANGES);
    memcpy(own[0], ranges[0], sizeof own[0]);
    refused(&i, false, "expected no own range of treelet 0, whose level has no samples, found ");
    i = make(18, SAMPLE_F32, LEAF_CODEC_RAW, true);
    uint8_t *flags = leaf_image_section(&i, LEAF_SECTION_FLAGS);
    flags[0] = LEAF_FLAG_NON_FINITE;
    refused(&i, false, "expected no flags of treelet 0, whose level has no samples, found 0x01");
    i = make(18, SAMPLE_F32, LEAF_CODEC_RAW, true);
    ranges = leaf_image_section(&i, LEAF_SECTION_RANGES);
    ranges[0][1] = nextafterf(ranges[0][1], INFINITY);
    refused(&i, false, "expected treelet 0's merged range to be its own and its children's");
}

static void test_mesh(void **state) {
    (void)state;
    mesh_case c = mesh_leaves_cube(3, 1, 1, 7, 15);
    size_t size;
    mem m;
    leaf_file *f = NULL;
    char *bytes = scratch_read(mesh_leaves_make(&c, "mesh.leaf"), &size);
    leaf_image i = leaf_image_of(bytes, size);
    mesh_leaves_release(&c);
    i.header->bare = 1;
    leaf_image_seal(&i);
    mem_init(&m, 0);
    assert_int_equal(leaf_file_open_memory(&m, "F.leaf", i.bytes, i.size, &f), ST_CORRUPT);
    assert_non_null(strstr(status_text(), "byte 1496: expected 0 in a reserved place"));
    free(i.bytes);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_types),     cmocka_unit_test(test_sizes),
        cmocka_unit_test(test_plan),      cmocka_unit_test(test_memory),
        cmocka_unit_test(test_one_level), cmocka_unit_test(test_flag),
        cmocka_unit_test(test_payloads),  cmocka_unit_test(test_values),
        cmocka_unit_test(test_mesh),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
