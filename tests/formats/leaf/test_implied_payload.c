/* test_implied_payload.c - empty space costs no bytes: treelets of one value are left out of the
 * file, and read as if they were there.
 */
/* marks: bits */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "formats/leaf/leaf_check.h"
#include "formats/leaf/leaf_unpacker.h"
#include "formats/leaf/leaf_verify.h"
#include "stream/source.h"
#include "tests/support/leaf_files.h"
#include "tests/support/leaf_image.h"
#include "tests/support/naive_leaf.h"
#include "tests/support/scratch.h"

enum { NX = 90, NY = 70, NZ = 60 };

static mem m;

static void put(sample_type type, char *at, double value) {
    const int whole = type == SAMPLE_F32 ? 0 : (int)value;
    const float real = (float)value;
    if (type == SAMPLE_F32)
        memcpy(at, &real, sizeof real);
    else if (sample_size(type) == 1)
        *at = (char)whole;
    else
        memcpy(at, &(uint16_t){(uint16_t)whole}, 2);
}

/* Noise in a corner, and one value, or none, elsewhere. */
static void *samples_of(const leaf_case *c, double value) {
    char *samples = leaf_files_random(c, 7, 0);
    const size_t width = sample_size(c->type);
    size_t i = 0;
    for (uint32_t z = 0; z < NZ; z++)
        for (uint32_t y = 0; y < NY; y++)
            for (uint32_t x = 0; x < NX; x++, i++)
                if (x >= 20 || y >= 20 || z >= 20)
                    put(c->type, samples + i * width, value);
    memcpy(samples, samples + width, width); /* two alike at the start mean nothing */
    return samples;
}

static leaf_case case_of(sample_type type, uint32_t halo, leaf_codec codec) {
    leaf_case c = leaf_files_case(NX, NY, NZ, type);
    c.options.file.halo = halo;
    c.options.file.codec = codec;
    c.options.file.zstd_level = 3;
    return c;
}

/* Every sample of every level is there, and the pyramid is what it is without implied payloads:
 * naive_leaf_load() checks all that FORMAT.md says, among it that none is stored in vain. */
static void check_file(const leaf_case *c, const char *path) {
    naive_leaf naive;
    if (!naive_leaf_load(&naive, path))
        fail_msg("%s", naive.why);
    size_t i = 0;
    for (long z = 0; z < NZ; z++)
        for (long y = 0; y < NY; y++)
            for (long x = 0; x < NX; x++, i++) {
                const float got = naive_leaf_sample(&naive, 0, x, y, z);
                const float want = (float)sample_get(c->type, c->samples, i);
                assert_memory_equal(&got, &want, sizeof got);
            }
    naive_leaf_release(&naive);
}

/* Each backend gives what leaf_file_load() does, and takes it back. */
static void check_sources(leaf_file *f) {
    char *payload = mem_alloc(&m, leaf_layout_payload_max(&f->layout));
    leaf_unpacker *u = NULL;
    assert_int_equal(leaf_unpacker_create(&m, f, &u), ST_OK);
    for (int kind = SOURCE_AUTO; kind <= SOURCE_ARENA; kind++) {
        source *s = NULL;
        assert_int_equal(source_open(&m, f, (source_kind)kind, &s), ST_OK);
        for (uint32_t p = 0; p < f->layout.treelets; p++) {
            const void *got = NULL;
            assert_int_equal(source_load(s, p, u, &got), ST_OK);
            assert_int_equal(leaf_file_load(f, p, u, payload), ST_OK);
            assert_memory_equal(got, payload, leaf_layout_payload_bytes(&f->layout, p));
            source_evict(s, p, got);
        }
        source_close(s);
    }
    mem_free(&m, payload);
    leaf_unpacker_destroy(u);
}

/* leaf_verify() recomputes the codes of what leaf_file_load() makes. */
static uint32_t check_readers(const char *path) {
    leaf_file *f = NULL;
    uint32_t implied = 0;
    assert_int_equal(leaf_file_open(&m, path, &f), ST_OK);
    assert_int_equal(leaf_verify(&m, f, 2, NULL), ST_OK);
    check_sources(f);
    for (uint32_t p = 0; p < f->layout.treelets; p++)
        implied += leaf_file_is_implied(f, p);
    leaf_file_close(f);
    assert_int_equal(mem_used(&m), 0);
    return implied;
}

static uint32_t check_value(sample_type type, uint32_t halo, leaf_codec codec, double value) {
    leaf_case c = case_of(type, halo, codec);
    void *samples = samples_of(&c, value);
    c.samples = samples;
    const char *path = leaf_files_make(&c, "a.leaf");
    check_file(&c, path);
    const uint32_t implied = check_readers(path);
    free(samples);
    return implied;
}

static void test_types(void **state) {
    (void)state;
    static const sample_type types[] = {SAMPLE_U8, SAMPLE_I8, SAMPLE_U16, SAMPLE_I16, SAMPLE_F32};
    for (size_t i = 0; i < sizeof types / sizeof *types; i++)
        for (uint32_t halo = 0; halo < 2; halo++)
            for (int codec = LEAF_CODEC_RAW; codec <= LEAF_CODEC_ZSTD; codec++) {
                const double value = types[i] == SAMPLE_I8 || types[i] == SAMPLE_I16 ? -7 : 77;
                /* Of 6 x 5 x 4, 3 x 3 x 2, 2 x 2 x 1, 1 treelets; 2^3 have noise, 1, 1, 1 above,
                 * and with a halo those beside the noise are not of one value. */
                const uint32_t implied = check_value(types[i], halo, (leaf_codec)codec, value);
                assert_in_range(implied, 120, 143 - 11);
            }
}

static void test_no_data(void **state) {
    (void)state;
    assert_in_range(check_value(SAMPLE_F32, 1, LEAF_CODEC_RAW, NAN), 100, 132);
    assert_in_range(check_value(SAMPLE_F32, 1, LEAF_CODEC_ZSTD, NAN), 100, 132);
    assert_in_range(check_value(SAMPLE_F32, 1, LEAF_CODEC_RAW, 0), 100, 132);
    assert_in_range(check_value(SAMPLE_F32, 1, LEAF_CODEC_RAW, 1e-42), 100, 132);
}

/* Of the treelets of full resolution. */
static uint32_t implied_with(double value) {
    leaf_case c = case_of(SAMPLE_F32, 1, LEAF_CODEC_RAW);
    void *samples = samples_of(&c, value);
    leaf_file *f = NULL;
    uint32_t implied = 0;
    c.samples = samples;
    assert_int_equal(leaf_file_open(&m, leaf_files_make(&c, "b.leaf"), &f), ST_OK);
    for (uint32_t p = 0; p < f->layout.treelets; p++)
        implied += f->layout.level_of[p] == 0 && leaf_file_is_implied(f, p);
    leaf_file_close(f);
    free(samples);
    return implied;
}

/* What a range cannot tell is kept: infinity, -0, other bits of NaN. */
static void test_kept(void **state) {
    (void)state;
    const uint32_t odd_bits = 0x7fc00001;
    float odd;
    memcpy(&odd, &odd_bits, sizeof odd);
    assert_in_range(implied_with(1), 80, 120);
    assert_int_equal(implied_with(INFINITY), 0);
    assert_int_equal(implied_with(-0.0), 0);
    assert_int_equal(implied_with((double)odd), 0);
}

/* A volume of one value has no payload at all. */
static void test_nothing_else(void **state) {
    (void)state;
    for (int codec = LEAF_CODEC_RAW; codec <= LEAF_CODEC_ZSTD; codec++) {
        leaf_case c = case_of(SAMPLE_U16, 1, (leaf_codec)codec);
        void *samples = calloc((size_t)NX * NY * NZ, 2);
        c.samples = samples;
        const char *path = leaf_files_make(&c, "c.leaf");
        check_file(&c, path);
        assert_int_equal(check_readers(path), 143);
        size_t size;
        free(scratch_read(path, &size));
        assert_true(size <= 20480);
        free(samples);
    }
}

/* The bytes do not depend on who was first. */
static void test_threads(void **state) {
    (void)state;
    for (int codec = LEAF_CODEC_RAW; codec <= LEAF_CODEC_ZSTD; codec++) {
        leaf_case c = case_of(SAMPLE_U8, 1, (leaf_codec)codec);
        void *samples = samples_of(&c, 3);
        size_t sizes[2];
        char *bytes[2];
        c.samples = samples;
        for (int i = 0; i < 2; i++) {
            c.options.threads = 1 + 3 * i;
            bytes[i] = scratch_read(leaf_files_make(&c, i ? "d.leaf" : "e.leaf"), &sizes[i]);
        }
        assert_int_equal(sizes[0], sizes[1]);
        assert_memory_equal(bytes[0], bytes[1], sizes[0]);
        free(bytes[0]);
        free(bytes[1]);
        free(samples);
    }
}

static void check_refused(const leaf_image *i) {
    leaf_file *f = NULL;
    leaf_image_seal(i);
    assert_int_equal(leaf_file_open_memory(&m, "the image", i->bytes, i->size, &f), ST_CORRUPT);
    assert_int_equal(mem_used(&m), 0);
}

/* A file cannot say of noise that it is one value. */
static void test_lies(void **state) {
    (void)state;
    leaf_case c = case_of(SAMPLE_U8, 1, LEAF_CODEC_ZSTD);
    void *samples = samples_of(&c, 3);
    size_t size;
    c.samples = samples;
    char *bytes = scratch_read(leaf_files_make(&c, "f.leaf"), &size);
    leaf_image i = leaf_image_of(bytes, size);
    uint64_t *sizes = leaf_image_section(&i, LEAF_SECTION_SIZES), kept = sizes[0];
    assert_true(kept > 0);
    sizes[0] = 0;
    check_refused(&i);
    sizes[0] = kept;
    uint32_t implied = 0;
    while (sizes[implied])
        implied++;
    sizes[implied] = 64;
    check_refused(&i);
    sizes[implied] = 0;
    uint64_t *sums = leaf_image_section(&i, LEAF_SECTION_CHECKSUMS);
    sums[implied] = 1;
    check_refused(&i);
    sums[implied] = 0;
    uint64_t *offsets = leaf_image_section(&i, LEAF_SECTION_OFFSETS);
    offsets[implied] = 0;
    check_refused(&i);
    free(i.bytes);
    free(samples);
}

int main(void) {
    mem_init(&m, 0);
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_types),   cmocka_unit_test(test_no_data),
        cmocka_unit_test(test_kept),    cmocka_unit_test(test_nothing_else),
        cmocka_unit_test(test_threads), cmocka_unit_test(test_lies)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
