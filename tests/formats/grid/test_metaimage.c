/* test_metaimage.c - MHD and MHA: every header feature, refusals that name the line, cut and
 * damaged files.
 */
/* marks: bits */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/support/scratch.h"
#include "tests/support/volumes.h"

static double samples[VOLUMES_SAMPLES];

#define BASE  "ObjectType = Image\nNDims = 3\nDimSize = 4 3 2\n"
#define BYTES BASE "ElementType = MET_UCHAR\n"
#define LOCAL "ElementDataFile = LOCAL\n"

/* The u8 test volume behind a header. */
static const char *local(const char *header) {
    size_t size = volumes_samples(SAMPLE_U8, false, samples);
    return volumes_file("a.mha", header, samples, size);
}

static void test_types(void **state) {
    (void)state;
    static const struct {
        const char *name;
        sample_type type;
    } types[] = {{"MET_UCHAR", SAMPLE_U8},  {"MET_CHAR", SAMPLE_I8},   {"MET_USHORT", SAMPLE_U16},
                 {"MET_SHORT", SAMPLE_I16}, {"MET_UINT", SAMPLE_U32},  {"MET_INT", SAMPLE_I32},
                 {"MET_ULONG", SAMPLE_U32}, {"MET_FLOAT", SAMPLE_F32}, {"MET_DOUBLE", SAMPLE_F64}};
    for (size_t i = 0; i < sizeof types / sizeof *types; i++)
        for (int big = 0; big < 2; big++) {
            char header[300];
            size_t size = volumes_samples(types[i].type, big, samples);
            snprintf(header, sizeof header, "%sElementType = %s\n%s = %s\n%s", BASE, types[i].name,
                     i % 2 ? "ElementByteOrderMSB" : "BinaryDataByteOrderMSB",
                     big ? "True" : "False", LOCAL);
            volumes_check(volumes_file("a.mha", header, samples, size), NULL, types[i].type, NULL);
        }
}

static void test_compressed(void **state) {
    (void)state;
    for (int gzip = 0; gzip < 2; gzip++) {
        size_t size = volumes_samples(SAMPLE_U8, false, samples), packed;
        uint8_t *data = volumes_deflate(samples, size, gzip, 1, &packed);
        char header[300];
        snprintf(header, sizeof header,
                 BYTES "BinaryData = True\nCompressedData = True\nCompressedDataSize = %zu\n" LOCAL,
                 packed);
        const char *path = volumes_file("a.mha", header, data, packed);
        volumes_check(path, NULL, SAMPLE_U8, NULL);
        volumes_truncate(path, NULL, 0);
        volumes_faults(path, NULL);
        /* Not noticed, of three changes a byte: fields of other names, which the format allows to
         * be passed over (ObjectType, and 11 to 16 bytes of each name of three others, whose
         * defaults do), zeros in front of numbers, one slice fewer; of gzip its time, system and
         * flags, too. */
        assert_int_equal(volumes_damage(path, NULL), gzip ? 243 : 224);
        free(data);
    }
}

static void test_text(void **state) {
    (void)state;
    char text[4 * VOLUMES_SAMPLES + 1];
    size_t size = volumes_text(SAMPLE_I16, text);
    volumes_check(volumes_file("a.mha", BASE "ElementType = MET_SHORT\nBinaryData = False\n" LOCAL,
                               text, size),
                  NULL, SAMPLE_I16, NULL);
}

static void test_placement(void **state) {
    (void)state;
    static const struct {
        const char *fields;
        double to_world[3][4];
    } cases[] = {
        {"ElementSpacing = 0.5 1 2\nOffset = 1 2 3\n",
         {{0.5, 0, 0, 1}, {0, 1, 0, 2}, {0, 0, 2, 3}}},
        {"ElementSize = 2 2 2\nPosition = -1 0 1\n", {{2, 0, 0, -1}, {0, 2, 0, 0}, {0, 0, 2, 1}}},
        {"Origin=7 8 9\nElementSpacing=1 1 -1\nElementSize = 5 5 5\n",
         {{1, 0, 0, 7}, {0, 1, 0, 8}, {0, 0, -1, 9}}},
        /* Row a of the matrix is the direction of axis a. */
        {"TransformMatrix = 0 1 0 0 0 1 -1 0 0\nElementSpacing = 2 3 4\n",
         {{0, 0, -4, 0}, {2, 0, 0, 0}, {0, 3, 0, 0}}},
        {"Comment = a = b\nAnatomicalOrientation = RAI\nCenterOfRotation = 0 0 0\n",
         {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char header[500];
        snprintf(header, sizeof header, "%s%s%s", BYTES, cases[i].fields, LOCAL);
        volumes_check(local(header), NULL, SAMPLE_U8, cases[i].to_world);
    }
}

static void test_four_axes(void **state) {
    (void)state;
    const double map[3][4] = {{2, 0, 0, 5}, {0, 3, 0, 6}, {0, 0, 4, 7}};
    volumes_check(local("NDims = 4\nDimSize = 4 3 2 1\nElementType = MET_UCHAR\n"
                        "ElementSpacing = 2 3 4 1\nOffset = 5 6 7 8\n"
                        "TransformMatrix = 1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1\n" LOCAL),
                  NULL, SAMPLE_U8, map);
}

static void test_data_file(void **state) {
    (void)state;
    size_t size = volumes_samples(SAMPLE_U8, false, samples);
    char data[100] = "head.";
    memcpy(data + 5, samples, size);
    scratch_write("a.raw", data, 5 + size);
    volumes_check(scratch_text("a.mhd", BYTES "HeaderSize = 5\nElementDataFile = a.raw\n"), NULL,
                  SAMPLE_U8, NULL);
    volumes_check(scratch_text("a.mhd", BYTES "HeaderSize = -1\nElementDataFile = a.raw"), NULL,
                  SAMPLE_U8, NULL);
    volumes_faults(scratch_text("a.mhd", BYTES "HeaderSize = -1\nElementDataFile = a.raw"), NULL);
    volumes_refused(scratch_text("a.mhd", BYTES "HeaderSize = 6\nElementDataFile = a.raw\n"), NULL,
                    ST_CORRUPT, "a.raw: ends at byte 29");
    volumes_refused(scratch_text("a.mhd", BYTES "ElementDataFile = none.raw\n"), NULL, ST_IO,
                    "none.raw");
}

static void test_refused(void **state) {
    (void)state;
    static const struct {
        const char *header;
        status st;
        const char *said;
    } cases[] = {
        {"", ST_CORRUPT, "no text"},
        {"ObjectType = Image\n", ST_CORRUPT, "no text"},
        {BYTES "CompressedData = Maybe\n" LOCAL, ST_CORRUPT, "line 5: CompressedData"},
        {BYTES "ElementNumberOfChannels = 300\n" LOCAL, ST_UNSUPPORTED, "300 numbers a sample"},
        {BYTES "ElementNumberOfChannels = 3\n" LOCAL, ST_CORRUPT, "expected at least 72 bytes"},
        {BASE "ElementType = MET_STRING\n" LOCAL, ST_UNSUPPORTED, "line 4: ElementType"},
        {BASE LOCAL, ST_CORRUPT, "\"ElementType\""},
        {"NDims = 2\nDimSize = 4 6\nElementType = MET_UCHAR\n" LOCAL, ST_UNSUPPORTED, "three axes"},
        {"NDims = 3\nDimSize = 4 6\nElementType = MET_UCHAR\n" LOCAL, ST_CORRUPT,
         "line 2: DimSize"},
        {"NDims = 3\nDimSize = 4 6 1\nElementType = MET_UCHAR\n" LOCAL, ST_UNSUPPORTED, "along z"},
        {BYTES "ElementSpacing = 1 1\n" LOCAL, ST_CORRUPT, "line 5: ElementSpacing"},
        {BYTES "ElementSpacing = 1 1 0\n" LOCAL, ST_CORRUPT, "do not span"},
        {BYTES "TransformMatrix = 1 0 0 0 1 0 0 0\n" LOCAL, ST_CORRUPT, "TransformMatrix"},
        {BYTES "ElementDataFile = LIST\n", ST_CORRUPT, ""},
        {BYTES "ElementDataFile = a%03d.raw 1 2 1\n", ST_IO, "a001.raw"},
        {"NDims = 3\nDimSize = 1048576 1048576 1048576\nElementType = MET_UCHAR\n" LOCAL,
         ST_CORRUPT, "ends at byte"},
        {"NDims = 3\nDimSize = 4294967295 4294967295 4294967295\nElementType = MET_UCHAR\n"
         "HeaderSize = -1\n" LOCAL,
         ST_UNSUPPORTED, "at most"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        volumes_refused(local(cases[i].header), NULL, cases[i].st, cases[i].said);
}

static void test_truncated(void **state) {
    (void)state;
    const char *path = local(BYTES "ElementSpacing = 1 2 3\n" LOCAL);
    volumes_truncate(path, NULL, 0);
    volumes_faults(path, NULL);
    /* Not noticed, of three changes a byte: 24 samples, ObjectType and its value (17 bytes), the
     * name ElementSpacing (15; others are passed over), and 6 numbers that are others, as sound. */
    assert_int_equal(volumes_damage(path, NULL), 174);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_types),     cmocka_unit_test(test_compressed),
        cmocka_unit_test(test_text),      cmocka_unit_test(test_placement),
        cmocka_unit_test(test_four_axes), cmocka_unit_test(test_data_file),
        cmocka_unit_test(test_refused),   cmocka_unit_test(test_truncated),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
