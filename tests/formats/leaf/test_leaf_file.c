/* test_leaf_file.c - treelet files cut short, damaged, and made to do harm: refused, each of them.
 */
/* marks: bits */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "formats/base/fault.h"
#include "formats/base/hash.h"
#include "formats/leaf/leaf_check.h"
#include "formats/leaf/leaf_verify.h"
#include "tests/support/fields.h"
#include "tests/support/leaf_files.h"
#include "tests/support/leaf_image.h"
#include "tests/support/scratch.h"

static mem m;

/* Three treelets or seven, in two levels; rectilinear and with missing samples if so asked. */
static leaf_image make(bool large, leaf_codec codec) {
    leaf_case c =
        leaf_files_case(20, large ? 19 : 10, large ? 4 : 6, large ? SAMPLE_F32 : SAMPLE_U8);
    void *samples = leaf_files_random(&c, FIELD_SEED, large ? 25 : 0);
    c.samples = samples;
    c.options.file.codec = codec;
    c.options.file.zstd_level = 3;
    c.options.file.halo = !large;
    if (large)
        c.axis_file[2] = scratch_text("z.txt", "0 1 4 9");
    size_t size;
    char *bytes = scratch_read(leaf_files_make(&c, "made.leaf"), &size);
    free(samples);
    return leaf_image_of(bytes, size);
}

/* What was opened with this status is looked at, and closed. */
static status finish(status st, leaf_file *f, bool payloads) {
    if (st == ST_OK && payloads)
        st = leaf_verify(&m, f, 1, NULL);
    leaf_file_close(f);
    if (mem_used(&m))
        fail_msg("%zu bytes left in memory", mem_used(&m));
    return st;
}

static status try_open(const char *path, bool payloads) {
    leaf_file *f = NULL;
    const status st = leaf_file_open(&m, path, &f);
    return finish(st, f, payloads);
}

static status try_image(const leaf_image *i, bool payloads) {
    leaf_file *f = NULL;
    const status st = leaf_file_open_memory(&m, "the image", i->bytes, i->size, &f);
    return finish(st, f, payloads);
}

static bool refused(status st) {
    return st == ST_CORRUPT || st == ST_UNSUPPORTED;
}

/* As it lies in memory: refused, and the description names the file and says something. */
static void check_refused(const leaf_image *i, const char *what) {
    status st = try_image(i, false);
    if (!refused(st) || !strstr(status_text(), "the image"))
        fail_msg("%s: status %d: %s", what, st, status_text());
}

static void test_sound(void **state) {
    (void)state;
    for (int large = 0; large < 2; large++)
        for (int codec = LEAF_CODEC_RAW; codec <= LEAF_CODEC_ZSTD; codec++) {
            leaf_image i = make(large, (leaf_codec)codec);
            assert_int_equal(try_open(scratch_path("made.leaf"), true), ST_OK);
            leaf_image_seal(&i);
            assert_int_equal(try_image(&i, true), ST_OK);
            free(i.bytes);
        }
}

static void test_truncated(void **state) {
    (void)state;
    leaf_image i = make(false, LEAF_CODEC_RAW);
    const char *path = scratch_write("short.leaf", i.bytes, i.size);
    for (size_t length = i.size; length-- > 0;) {
        assert_int_equal(truncate(path, (off_t)length), 0);
        status st = try_open(path, false);
        if (st != ST_CORRUPT || !strstr(status_text(), path))
            fail_msg("%zu of %zu bytes: status %d: %s", length, i.size, st, status_text());
        const leaf_image shorter = {.bytes = i.bytes, .size = length};
        check_refused(&shorter, "cut short in memory");
    }
    /* Longer is wrong, too. */
    char *longer = calloc(1, i.size + 4096);
    memcpy(longer, i.bytes, i.size);
    assert_int_equal(try_open(scratch_write("long.leaf", longer, i.size + 1), false), ST_CORRUPT);
    assert_int_equal(try_open(scratch_write("long.leaf", longer, i.size + 4096), false),
                     ST_CORRUPT);
    free(longer);
    free(i.bytes);
}

/* Every byte of header, table and directory with every bit but one way of changing it; payloads and
 * gaps now and then. */
static void test_flipped(void **state) {
    (void)state;
    for (int codec = LEAF_CODEC_RAW; codec <= LEAF_CODEC_ZSTD; codec++) {
        leaf_image i = make(codec == LEAF_CODEC_RAW, (leaf_codec)codec);
        for (size_t at = 0; at < i.size; at += leaf_image_is_directory(&i, at) ? 1 : 29) {
            i.bytes[at] ^= (char)(1 << (at % 8));
            status st = try_image(&i, !leaf_image_is_directory(&i, at));
            if (!refused(st))
                fail_msg("byte %zu: status %d: %s", at, st, status_text());
            i.bytes[at] ^= (char)(1 << (at % 8));
        }
        assert_int_equal(try_image(&i, true), ST_OK);
        free(i.bytes);
    }
}

/* Header fields that lie, with checksums that do not. */
static void test_lying_header(void **state) {
    (void)state;
    leaf_image i = make(true, LEAF_CODEC_RAW);
    const leaf_header sound = *i.header;
    static const uint32_t values[] = {
        0,        1,         2, 3, 4, 5, 7, 9, 20, 33, 64, 65, 255, 4096, 1u << 20, (1u << 20) + 1,
        1u << 31, UINT32_MAX};
    for (size_t at = offsetof(leaf_header, version); at < offsetof(leaf_header, value_min); at += 4)
        for (size_t n = 0; n < sizeof values / sizeof values[0]; n++) {
            *i.header = sound;
            memcpy(i.bytes + at, &values[n], sizeof values[n]);
            /* Nothing follows from the number of samples that are none, but that there are some. */
            bool free_choice =
                at == offsetof(leaf_header, non_finite) && values[n] > 0 && values[n] < 20 * 19 * 4;
            /* Any type could have been the source as well: with missing data, integers are stored
             * so. */
            free_choice |= at == offsetof(leaf_header, source_type) && values[n] >= SAMPLE_U8 &&
                           values[n] <= SAMPLE_I64;
            /* Payloads as large as they can be are raw with any codec. */
            free_choice |= at == offsetof(leaf_header, codec) && values[n] == LEAF_CODEC_ZSTD;
            if (memcmp(&sound, i.header, sizeof sound) == 0 || free_choice)
                continue;
            leaf_image_seal(&i);
            char what[64];
            snprintf(what, sizeof what, "header field at %zu = %u", at, values[n]);
            check_refused(&i, what);
        }
    *i.header = sound;
    free(i.bytes);
}

static void test_lying_values(void **state) {
    (void)state;
    leaf_image i = make(true, LEAF_CODEC_RAW);
    const leaf_header sound = *i.header;
    static const double values[] = {NAN, INFINITY, -INFINITY, 1e300};
    for (size_t n = 0; n < 4; n++) {
        i.header->value_min = values[n];
        leaf_image_seal(&i);
        check_refused(&i, "value_min");
        *i.header = sound;
        i.header->to_world[7] = n < 3 ? values[n] : 0;
        i.header->to_world[0] = n < 3 ? 1 : 0;
        leaf_image_seal(&i);
        check_refused(&i, "to_world");
        *i.header = sound;
        i.header->rounding_error = n ? -1 : NAN;
        leaf_image_seal(&i);
        check_refused(&i, "rounding_error");
        *i.header = sound;
    }
    memset(i.header->name, 'x', sizeof i.header->name);
    leaf_image_seal(&i);
    check_refused(&i, "a name without an end");
    *i.header = sound;
    i.header->provenance[1000] = 'x';
    leaf_image_seal(&i);
    check_refused(&i, "something behind a text");
    *i.header = sound;
    i.header->reserved[2000] = 1;
    leaf_image_seal(&i);
    check_refused(&i, "reserved bytes");
    free(i.bytes);
}

static void test_lying_table(void **state) {
    (void)state;
    leaf_image i = make(true, LEAF_CODEC_RAW);
    leaf_section sound[LEAF_SECTION_AXES];
    memcpy(sound, i.table, sizeof sound);
    static const uint64_t values[] = {0,          1,          63,         64,        4096,
                                      1ULL << 31, 1ULL << 32, 1ULL << 63, UINT64_MAX};
    for (int n = 0; n < LEAF_SECTION_AXES; n++)
        for (size_t k = 0; k < 5 * (sizeof values / sizeof values[0]); k++) {
            uint64_t v = values[k / 5];
            leaf_section *s = &i.table[n];
            switch (k % 5) {
            case 0: s->kind = (uint32_t)v; break;
            case 1: s->version = (uint32_t)v; break;
            case 2: s->offset = v; break;
            case 3: s->offset += v; break;
            default: s->bytes = v; break;
            }
            if (memcmp(sound, i.table, sizeof sound) != 0) {
                leaf_image_seal(&i);
                check_refused(&i, "section table");
            }
            memcpy(i.table, sound, sizeof sound);
        }
    free(i.bytes);
}

static void check_u64(const leaf_image *i, uint32_t kind) {
    static const uint64_t values[] = {
        0, 1, 64, 4096, 8192, 1ULL << 32, 1ULL << 63, UINT64_MAX, UINT64_MAX - 4095};
    uint64_t *array = leaf_image_section(i, kind);
    for (uint64_t t = 0; t < i->header->treelets; t++)
        for (size_t n = 0; n < 2 * (sizeof values / sizeof values[0]); n++) {
            uint64_t sound = array[t];
            array[t] = n % 2 ? values[n / 2] : sound + values[n / 2];
            if (array[t] != sound) {
                leaf_image_seal(i);
                check_refused(i, "payload offsets and sizes");
            }
            array[t] = sound;
        }
}

static void check_floats(const leaf_image *i, uint32_t kind) {
    static const float values[] = {NAN, INFINITY, -INFINITY, -1e38F, 1e38F, 0.123F};
    float *array = leaf_image_section(i, kind);
    for (uint64_t n = 0; n < 2 * i->header->treelets; n++)
        for (size_t k = 0; k < sizeof values / sizeof values[0]; k++) {
            float sound = array[n];
            array[n] = values[k];
            leaf_image_seal(i);
            /* An own range inside the merged one of a coarse treelet could be so; verify finds that
             * it is not. */
            assert_true(refused(try_image(i, true)));
            array[n] = sound;
        }
}

static void test_lying_directory(void **state) {
    (void)state;
    for (int codec = LEAF_CODEC_RAW; codec <= LEAF_CODEC_ZSTD; codec++) {
        leaf_image i = make(true, (leaf_codec)codec);
        check_u64(&i, LEAF_SECTION_OFFSETS);
        check_u64(&i, LEAF_SECTION_SIZES);
        check_floats(&i, LEAF_SECTION_RANGES);
        check_floats(&i, LEAF_SECTION_OWN);
        uint8_t *flags = leaf_image_section(&i, LEAF_SECTION_FLAGS);
        for (uint64_t t = 0; t < i.header->treelets; t++) {
            flags[t] ^= 2;
            leaf_image_seal(&i);
            check_refused(&i, "flags");
            flags[t] ^= 3;
            leaf_image_seal(&i);
            assert_true(refused(try_image(&i, true)));
            flags[t] ^= 1;
        }
        double *axes = leaf_image_section(&i, LEAF_SECTION_AXES);
        static const double values[] = {NAN, INFINITY, -1, 1e9};
        for (size_t n = 0; n < 4; n++) {
            double sound = axes[20 + 19 + 2];
            axes[20 + 19 + 2] = values[n];
            leaf_image_seal(&i);
            check_refused(&i, "axes");
            axes[20 + 19 + 2] = sound;
        }
        free(i.bytes);
    }
}

/* Payloads that are wrong with checksums that are right: what verify is for. */
static void test_lying_payloads(void **state) {
    (void)state;
    leaf_image i = make(false, LEAF_CODEC_RAW);
    const uint64_t *offsets = leaf_image_section(&i, LEAF_SECTION_OFFSETS);
    const uint64_t *sizes = leaf_image_section(&i, LEAF_SECTION_SIZES);
    uint64_t *checksums = leaf_image_section(&i, LEAF_SECTION_CHECKSUMS);
    int differ = 0, border = 0, passed = 0;
    for (uint64_t t = 0; t < i.header->treelets; t++) {
        const uint64_t checksum = checksums[t];
        for (uint64_t at = 0; at < sizes[t]; at++) {
            char *byte = i.bytes + offsets[t] + at;
            *byte ^= 1;
            checksums[t] = hash_bytes(i.bytes + offsets[t], (size_t)sizes[t]);
            leaf_image_seal(&i);
            status st = try_image(&i, true);
            /* A sample that nothing repeats, within its block's range, is just another sample. */
            if (st != ST_CORRUPT && (at < 192 || st != ST_OK))
                fail_msg("treelet %d byte %d: status %d", (int)t, (int)at, st);
            passed += st == ST_OK;
            differ += st == ST_CORRUPT && strstr(status_text(), "differ in samples") != NULL;
            border += st == ST_CORRUPT && strstr(status_text(), "at the volume's border") != NULL;
            *byte ^= 1;
        }
        checksums[t] = checksum;
    }
    assert_true(differ > 10 && border > 10 && passed > 10);
    free(i.bytes);
}

/* Compressed bytes that are none, or of something else. */
static void test_lying_frames(void **state) {
    (void)state;
    leaf_image i = make(true, LEAF_CODEC_ZSTD);
    const uint64_t *offsets = leaf_image_section(&i, LEAF_SECTION_OFFSETS);
    const uint64_t *sizes = leaf_image_section(&i, LEAF_SECTION_SIZES);
    uint64_t *checksums = leaf_image_section(&i, LEAF_SECTION_CHECKSUMS);
    for (uint64_t t = 0; t < i.header->treelets; t++) {
        const uint64_t checksum = checksums[t];
        char *stored = i.bytes + offsets[t];
        for (uint64_t at = 0; at < sizes[t]; at += 5)
            for (int bit = 0; bit < 8; bit += 3) {
                stored[at] ^= (char)(1 << bit);
                checksums[t] = hash_bytes(stored, (size_t)sizes[t]);
                leaf_image_seal(&i);
                /* Whatever it decompresses to, it never ends in anything but an answer. */
                status st = try_image(&i, true);
                assert_true(st == ST_OK || st == ST_CORRUPT);
                assert_true(st == ST_CORRUPT || at >= 8);
                stored[at] ^= (char)(1 << bit);
            }
        checksums[t] = checksum;
    }
    free(i.bytes);
}

/* A header that fits itself, for a grid that no file of this size can hold. */
static void test_lying_dims(void **state) {
    (void)state;
    static const uint32_t dims[][3] = {
        {1 << 20, 1 << 19, 2}, {65536, 65536, 2048}, {1 << 20, 2, 2}, {2000, 2000, 2000}};
    for (int large = 0; large < 2; large++) {
        leaf_image i = make(large, LEAF_CODEC_RAW);
        for (size_t n = 0; n < sizeof dims / sizeof dims[0]; n++) {
            leaf_layout l;
            sample_type type = (sample_type)i.header->sample_type;
            assert_int_equal(leaf_layout_levels(&l, dims[n], 4, i.header->halo, type), ST_OK);
            memcpy(i.header->dims, dims[n], sizeof dims[n]);
            i.header->levels = l.levels;
            i.header->treelets = l.treelets;
            for (uint32_t k = 0; k < 6; k++)
                i.table[k].bytes = leaf_section_bytes(i.header, k + 1);
            leaf_image_seal(&i);
            check_refused(&i, "dims");
            assert_true(mem_peak(&m) < 1 << 20);
        }
        free(i.bytes);
    }
}

/* Ranges that agree with each other, but not with the samples. */
static void test_lying_ranges(void **state) {
    (void)state;
    leaf_image i = make(true, LEAF_CODEC_RAW);
    float(*own)[2] = leaf_image_section(&i, LEAF_SECTION_OWN),
    (*merged)[2] = leaf_image_section(&i, LEAF_SECTION_RANGES);
    for (uint64_t k = 0; k < 2 * i.header->treelets; k++) {
        const uint64_t t = k / 2, end = k % 2;
        const float sound[4] = {own[t][0], own[t][1], merged[t][0], merged[t][1]};
        const float root[2] = {merged[0][0], merged[0][1]}, lie = end ? 100 : -100;
        const double least = i.header->value_min, most = i.header->value_max;
        own[t][end] = merged[t][end] = merged[0][end] = lie;
        if (t >= 1)
            *(end ? &i.header->value_max : &i.header->value_min) = (double)lie;
        leaf_image_seal(&i);
        assert_int_equal(try_image(&i, false), ST_OK);
        assert_int_equal(try_image(&i, true), ST_CORRUPT);
        assert_non_null(strstr(status_text(), "expected samples in exactly"));
        memcpy(own[t], sound, sizeof own[t]);
        memcpy(merged[t], sound + 2, sizeof merged[t]);
        memcpy(merged[0], root, sizeof root);
        i.header->value_min = least;
        i.header->value_max = most;
    }
    i.header->value_max += 1;
    leaf_image_seal(&i);
    check_refused(&i, "value_max");
    i.header->value_max -= 1;
    i.header->non_finite += 1;
    leaf_image_seal(&i);
    assert_int_equal(try_image(&i, false), ST_OK);
    assert_int_equal(try_image(&i, true), ST_CORRUPT);
    memset(leaf_image_section(&i, LEAF_SECTION_FLAGS), 0, (size_t)i.header->treelets);
    leaf_image_seal(&i);
    check_refused(&i, "non-finite samples in no treelet");
    free(i.bytes);
}

/* A section of a kind from the future: passed over when it says so, and sound all the same. */
static void test_ancillary(void **state) {
    (void)state;
    leaf_image i = make(false, LEAF_CODEC_RAW);
    /* The file has room for it between the directory and the first payload, at 8192. */
    const uint64_t payloads = 8192, at = (i.sections_end + 64 + 63) / 64 * 64;
    const uint32_t n = i.header->sections;
    const uint64_t *offsets =
        (const uint64_t *)(void *)leaf_image_section(&i, LEAF_SECTION_OFFSETS);
    uint64_t first = offsets[0];
    for (uint64_t t = 1; t < i.header->treelets; t++)
        first = offsets[t] < first ? offsets[t] : first;
    assert_true(first == payloads && at + 100 <= payloads);
    /* Make room for an entry: all sections move by 64. */
    memmove(i.bytes + i.table[0].offset + 64, i.bytes + i.table[0].offset,
            i.sections_end - i.table[0].offset);
    memset(i.bytes + LEAF_HEADER_BYTES + n * sizeof *i.table, 0,
           (size_t)(i.table[0].offset + 64 - LEAF_HEADER_BYTES - n * sizeof *i.table));
    for (uint32_t k = 0; k < n; k++)
        i.table[k].offset += 64;
    i.table[n] = (leaf_section){
        .kind = LEAF_SECTION_ANCILLARY | 77, .version = 9, .offset = at, .bytes = 100};
    i.header->sections = n + 1;
    memset(i.bytes + at, 0x5A, 100);
    leaf_image_seal(&i);
    assert_int_equal(try_image(&i, true), ST_OK);
    i.bytes[at + 50] = 0;
    check_refused(&i, "an ancillary section with a wrong checksum");
    i.bytes[at + 50] = 0x5A;
    i.bytes[at + 100] = 1;
    check_refused(&i, "something behind the last section");
    i.bytes[at + 100] = 0;
    i.table[n].kind = 77;
    leaf_image_seal(&i);
    check_refused(&i, "a kind that must be known");
    free(i.bytes);
}

static void test_not_one(void **state) {
    (void)state;
    assert_int_equal(try_open(scratch_text("empty.leaf", ""), false), ST_CORRUPT);
    char page[5000] = "NRRD0004\n";
    assert_int_equal(try_open(scratch_write("other.leaf", page, sizeof page), false), ST_CORRUPT);
    assert_int_equal(try_open(scratch_path("absent.leaf"), false), ST_IO);
    assert_int_equal(try_open("/dev/zero", false), ST_IO);
}

/* Each allocation and each read fails in turn, of opening and of verifying. */
static void test_faults(void **state) {
    (void)state;
    static const fault_kind kinds[] = {FAULT_ALLOC, FAULT_READ, FAULT_THREAD};
    leaf_image i = make(true, LEAF_CODEC_ZSTD);
    for (size_t n = 0; n < sizeof kinds / sizeof kinds[0]; n++) {
        long k = 0;
        for (bool fired = true; fired;) {
            leaf_file *f = NULL;
            fault_arm(kinds[n], ++k);
            status st = leaf_file_open(&m, scratch_path("made.leaf"), &f);
            if (st == ST_OK)
                st = leaf_verify(&m, f, 2, NULL);
            fired = fault_fired(kinds[n]);
            fault_arm(kinds[n], 0);
            leaf_file_close(f);
            assert_int_equal(st == ST_OK, !fired);
            assert_int_equal(mem_used(&m), 0);
        }
        assert_true(k > 1);
    }
    free(i.bytes);
}

static int set_up(void **state) {
    (void)state;
    mem_init(&m, 0);
    return 0;
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup(test_sound, set_up),
        cmocka_unit_test_setup(test_truncated, set_up),
        cmocka_unit_test_setup(test_flipped, set_up),
        cmocka_unit_test_setup(test_lying_header, set_up),
        cmocka_unit_test_setup(test_lying_values, set_up),
        cmocka_unit_test_setup(test_lying_table, set_up),
        cmocka_unit_test_setup(test_lying_directory, set_up),
        cmocka_unit_test_setup(test_lying_payloads, set_up),
        cmocka_unit_test_setup(test_lying_frames, set_up),
        cmocka_unit_test_setup(test_lying_dims, set_up),
        cmocka_unit_test_setup(test_lying_ranges, set_up),
        cmocka_unit_test_setup(test_ancillary, set_up),
        cmocka_unit_test_setup(test_not_one, set_up),
        cmocka_unit_test_setup(test_faults, set_up),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
