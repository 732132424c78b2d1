/* test_rawfile.c - bare samples described by hints, by a JSON beside them, by their name; and what
 * goes before what.
 */
/* marks: bits */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "tests/support/scratch.h"
#include "tests/support/volumes.h"

static double samples[VOLUMES_SAMPLES];

static const char *write_samples(const char *name, sample_type type, bool big_endian) {
    size_t size = volumes_samples(type, big_endian, samples);
    return scratch_write(name, samples, size);
}

static void test_hints(void **state) {
    (void)state;
    for (int t = SAMPLE_U8; t <= SAMPLE_F64; t++)
        for (int big = 0; big < 2; big++) {
            const volume_hints hints = {
                .dims = {4, 3, 2}, .type = (sample_type)t, .big_endian = big};
            volumes_check(write_samples("a.bin", (sample_type)t, big), &hints, (sample_type)t,
                          NULL);
        }
    const volume_hints hints = {.dims = {4, 3, 2},
                                .type = SAMPLE_U8,
                                .skip = 2,
                                .spacing = {1, 2, -3},
                                .origin = {4, 5, 6},
                                .has_origin = true};
    const double map[3][4] = {{1, 0, 0, 4}, {0, 2, 0, 5}, {0, 0, -3, 6}};
    volumes_samples(SAMPLE_U8, false, samples);
    const char *path = volumes_file("a.bin", "ab", samples, VOLUMES_SAMPLES);
    volumes_check(path, &hints, SAMPLE_U8, map);
    volumes_truncate(path, &hints, 0);
    volumes_faults(path, &hints);
}

static void test_name(void **state) {
    (void)state;
    static const struct {
        const char *name;
        sample_type type;
    } good[] = {{"bonsai_4x3x2_uint8.raw", SAMPLE_U8},
                {"a_b_4x3x2_int16.raw", SAMPLE_I16},
                {"_4x3x2_float32.bin", SAMPLE_F32},
                {"a_9x9_4x3x2_uint16", SAMPLE_U16}};
    for (size_t i = 0; i < sizeof good / sizeof *good; i++) {
        const char *path = write_samples(good[i].name, good[i].type, false);
        volumes_check(path, NULL, good[i].type, NULL);
        volumes_truncate(path, NULL, 0);
        remove(path);
    }
    static const char *const bad[] = {"x.raw",       "x_4x3_uint8.raw",   "x_4x3x2_int128.raw",
                                      "x_4x3x2.raw", "x_0x3x2_uint8.raw", "4x3x2_uint8.raw"};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        volumes_refused(write_samples(bad[i], SAMPLE_U8, false), NULL, ST_UNSUPPORTED, bad[i]);
        remove(scratch_path(bad[i]));
    }
    volumes_refused(write_samples("x_1x12x2_uint8.raw", SAMPLE_U8, false), NULL, ST_UNSUPPORTED,
                    "1 sample along x");
    volumes_refused(write_samples("x_99999x99999x99999_uint8.raw", SAMPLE_U8, false), NULL,
                    ST_CORRUPT, "ends at byte 24");
}

static void test_json(void **state) {
    (void)state;
    static const char json[] =
        "{\"name\": \"A name\", \"type\": \"uint16\", \"size\": [4, 3, 2],\n"
        " \"spacing\": [1, 0.5, 2], \"origin\": [0, 0, -1], \"endian\": \"big\"}";
    const double map[3][4] = {{1, 0, 0, 0}, {0, 0.5, 0, 0}, {0, 0, 2, -1}};
    const char *raw = write_samples("j.raw", SAMPLE_U16, true);
    const char *described = scratch_text("j.json", json);
    grid g;
    volumes_check(described, NULL, SAMPLE_U16, map);
    volumes_check(raw, NULL, SAMPLE_U16, map);
    assert_int_equal(volumes_read(raw, NULL, &g, samples), ST_OK);
    assert_string_equal(g.name, "A name");
    volumes_faults(raw, NULL);
    volumes_faults(described, NULL);
    volumes_truncate(described, NULL, 0);
    /* A hint goes before the JSON, the JSON before the name. */
    const volume_hints hints = {.type = SAMPLE_I16};
    assert_int_equal(volumes_read(raw, &hints, &g, samples), ST_OK);
    assert_int_equal(g.type, SAMPLE_I16);
    raw = write_samples("j_2x2x2_uint8.raw", SAMPLE_U16, true);
    volumes_check(raw, NULL, SAMPLE_U16, map);
    remove(described);
    remove(raw);
    /* The samples by "file", by "url". */
    write_samples("other.raw", SAMPLE_U8, false);
    volumes_check(
        scratch_text("k.json", "{\"file\": \"other.raw\", \"type\": \"uint8\", \"size\": [4,3,2]}"),
        NULL, SAMPLE_U8, NULL);
    volumes_check(scratch_text("k.json",
                               "{\"url\": \"http://x.org/y/other.raw\", \"type\": \"u8\", "
                               "\"size\": [4,3,2]}"),
                  NULL, SAMPLE_U8, NULL);
}

static void test_json_refused(void **state) {
    (void)state;
    static const struct {
        const char *json;
        status st;
        const char *said;
    } cases[] = {
        {"{", ST_CORRUPT, "r.json: line 1"},
        {"[1]", ST_CORRUPT, "JSON object"},
        {"{\"type\": \"uint8\", \"size\": [4, 3]}", ST_CORRUPT, "\"size\": expected three"},
        {"{\"type\": \"uint8\", \"size\": [4, 3, \"2\"]}", ST_CORRUPT, "\"size\""},
        {"{\"type\": \"uint8\", \"size\": [4, 3, 2.5]}", ST_CORRUPT, "whole numbers"},
        {"{\"type\": \"uint8\", \"size\": [4, 3, 1e300]}", ST_CORRUPT, "whole numbers"},
        {"{\"type\": \"int128\", \"size\": [4, 3, 2]}", ST_UNSUPPORTED, "int128"},
        {"{\"type\": \"uint8\", \"size\": [4, 3, 2], \"endian\": \"middle\"}", ST_CORRUPT,
         "endian"},
        {"{\"type\": \"uint8\", \"size\": [4, 3, 2], \"spacing\": 1}", ST_CORRUPT, "spacing"},
        {"{\"type\": \"uint8\", \"size\": [4, 3, 2], \"spacing\": [0, 1, 1]}", ST_CORRUPT, "span"},
        {"{\"type\": \"uint8\", \"size\": [4, 3, 3]}", ST_CORRUPT, "r.raw: ends at byte 24"},
        {"{\"type\": \"uint8\", \"size\": [4, 3, 2], \"file\": \"none.raw\"}", ST_IO, "none.raw"},
        {"{\"type\": \"uint8\"}", ST_UNSUPPORTED, "r.json"},
    };
    write_samples("r.raw", SAMPLE_U8, false);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        volumes_refused(scratch_text("r.json", cases[i].json), NULL, cases[i].st, cases[i].said);
}

static void test_missing(void **state) {
    (void)state;
    volumes_refused(scratch_path("none.raw"), NULL, ST_IO, "none.raw");
    volumes_refused("/", NULL, ST_UNSUPPORTED, "/: a folder without a file of a known format");
    volumes_refused(scratch_text("empty.raw", ""), NULL, ST_CORRUPT, "is empty");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_hints),   cmocka_unit_test(test_name),
        cmocka_unit_test(test_json),    cmocka_unit_test(test_json_refused),
        cmocka_unit_test(test_missing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
