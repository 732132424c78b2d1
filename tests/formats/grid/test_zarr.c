/* test_zarr.c - Zarr folders made by hand: what is read, refused, cut and damaged.
 */
/* marks: bits, long */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <dlfcn.h>
#include <ftw.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "tests/support/scratch.h"
#include "tests/support/volumes.h"

#define ARRAY(more)                                                                          \
    "{\"zarr_format\": 2, \"shape\": [2, 3, 4], \"chunks\": [2, 2, 3], \"dtype\": \">i2\", " \
    "\"compressor\": null, \"fill_value\": -8, \"filters\": null, \"order\": \"C\"" more "}"

static double samples[VOLUMES_SAMPLES];

static const char *folder(const char *name) {
    const char *path = scratch_path(name);
    mkdir(path, 0755);
    return path;
}

/* Chunk (0, j, i) of the test volume, big endian; samples behind the array's edge are 77. */
static size_t put_chunk(int j, int i, uint8_t out[24]) {
    uint8_t *at = out;
    for (int z = 0; z < 2; z++)
        for (int y = 2 * j; y < 2 * j + 2; y++)
            for (int x = 3 * i; x < 3 * i + 3; x++, at += 2) {
                const int value = y < 3 && x < 4 ? 7 * ((z * 3 + y) * 4 + x) - 50 : 77;
                at[0] = (uint8_t)((unsigned)value >> 8);
                at[1] = (uint8_t)value;
            }
    return 24;
}

/* The array with all its chunks; returns its path. */
static const char *make(const char *json) {
    static const char *const names[] = {"z/0.0.0", "z/0.0.1", "z/0.1.0", "z/0.1.1"};
    uint8_t bytes[24];
    folder("z");
    scratch_text("z/.zarray", json);
    for (int c = 0; c < 4; c++)
        scratch_write(names[c], bytes, put_chunk(c / 2, c % 2, bytes));
    return scratch_path("z");
}

static void test_read(void **state) {
    (void)state;
    const char *path = make(ARRAY(""));
    volumes_check(path, NULL, SAMPLE_I16, NULL);
    volumes_faults(path, NULL);
    volumes_refused(path, &(volume_hints){.field = "x"}, ST_USAGE, "one array, without a field");
    volumes_refused(path, &(volume_hints){.step = 1}, ST_USAGE, "no step 1: there is 1");
    volumes_refused(path, &(volume_hints){.component = 2}, ST_USAGE, "no component 2");
    /* A missing chunk is the fill value: x = 3, y < 2. */
    remove(scratch_path("z/0.0.1"));
    grid g;
    assert_int_equal(volumes_read(scratch_path("z"), NULL, &g, samples), ST_OK);
    const int16_t *got = (const int16_t *)(void *)samples;
    for (int n = 0; n < VOLUMES_SAMPLES; n++)
        assert_int_equal(got[n], n % 4 == 3 && n / 4 % 3 < 2 ? -8 : 7 * n - 50);
}

static void test_group(void **state) {
    (void)state;
    static const double map[3][4] = {{2, 0, 0, 5}, {0, 3, 0, 6}, {0, 0, 4, 7}};
    make(ARRAY(""));
    const char *group = folder("g");
    scratch_text("g/.zgroup", "{\"zarr_format\": 2}");
    volumes_refused(group, NULL, ST_UNSUPPORTED, "a Zarr group of 0 arrays");
    remove(scratch_path("g/full"));
    assert_int_equal(rename(scratch_path("z"), scratch_path("g/full")), 0);
    volumes_check(scratch_path("g"), NULL, SAMPLE_I16, NULL);
    volumes_check(scratch_path("g"), &(volume_hints){.field = "full"}, SAMPLE_I16, NULL);
    volumes_refused(scratch_path("g"), &(volume_hints){.field = "../g"}, ST_USAGE, "no array");
    volumes_refused(scratch_path("g"), &(volume_hints){.field = "no"}, ST_USAGE, "no such array");
    static const char image[] =
        "{\"multiscales\": [{\"axes\": [\"z\", \"y\", {\"name\": \"x\"}], \"datasets\": "
        "[{\"path\": "
        "\"full\", \"coordinateTransformations\": [{\"type\": \"scale\", \"scale\": [4, 3, 2]}, "
        "{\"type\": \"translation\", \"translation\": [7, 6, 5]}]}]}]}";
    scratch_text("g/.zattrs", image);
    volumes_check(scratch_path("g"), NULL, SAMPLE_I16, map);
    volumes_faults(scratch_path("g"), NULL);
    scratch_text("g/.zattrs", "{\"multiscales\": [{\"datasets\": [{\"path\": \"../g\"}]}]}");
    volumes_refused(scratch_path("g"), NULL, ST_UNSUPPORTED, "a folder inside this one");
    scratch_text("g/.zattrs", "{\"multiscales\": [{\"datasets\": []}]}");
    volumes_refused(scratch_path("g"), NULL, ST_CORRUPT, "data sets with a path");
    scratch_text("g/.zattrs",
                 "{\"multiscales\": [{\"axes\": [\"y\", \"x\"], \"datasets\": [{\"path\": "
                 "\"full\"}]}]}");
    volumes_refused(scratch_path("g"), NULL, ST_CORRUPT, "a size for each of the image's axes");
}

static void test_refused(void **state) {
    (void)state;
    static const struct {
        const char *json;
        status st;
        const char *said;
    } cases[] = {
        {"", ST_CORRUPT, "expected a JSON object"},
        {"[]", ST_CORRUPT, "expected a JSON object"},
        {"{}", ST_UNSUPPORTED, "\"zarr_format\": expected 2"},
        {"{\"zarr_format\": 2}", ST_UNSUPPORTED, "\"shape\": expected sizes"},
        {"{\"zarr_format\": 2, \"shape\": [2, 3, 4]}", ST_UNSUPPORTED, "\"chunks\": expected"},
        {"{\"zarr_format\": 2, \"shape\": [2, -3, 4]}", ST_CORRUPT, "\"shape\": expected whole"},
        {"{\"zarr_format\": 2, \"shape\": [2, 3, 4], \"chunks\": [2, 2]}", ST_CORRUPT,
         "as many sizes"},
        {ARRAY(", \"dtype\": \"|S4\""), ST_UNSUPPORTED, "\"dtype\": expected bool"},
        {ARRAY(", \"dtype\": \"<c8\""), ST_UNSUPPORTED, "\"dtype\": expected bool"},
        {ARRAY(", \"dtype\": [[\"a\", \"<f4\"]]"), ST_UNSUPPORTED, "\"dtype\": expected bool"},
        {ARRAY(", \"filters\": [{\"id\": \"zfpy\"}]"), ST_UNSUPPORTED, "\"filters\": \"zfpy\""},
        {ARRAY(", \"compressor\": {\"id\": \"zfp\"}"), ST_UNSUPPORTED, "\"zfp\""},
        {ARRAY(", \"compressor\": {\"id\": \"zlib\"}"), ST_CORRUPT, "0.0.0"},
        {ARRAY(", \"compressor\": {\"id\": \"zstd\"}"), ST_CORRUPT, "0.0.0"},
        {ARRAY(", \"compressor\": {\"id\": \"lz4\"}"), ST_CORRUPT, "0.0.0"},
        {ARRAY(", \"fill_value\": 1.5"), ST_UNSUPPORTED, "\"fill_value\""},
        {ARRAY(", \"fill_value\": \"text\""), ST_UNSUPPORTED, "\"fill_value\""},
        {ARRAY(", \"fill_value\": 40000"), ST_UNSUPPORTED, "\"fill_value\""},
        {ARRAY(", \"chunks\": [2, 2, 2]"), ST_CORRUPT, "the 16 bytes expected"},
        {ARRAY(", \"chunks\": [2, 2, 4]"), ST_CORRUPT, "the 32 bytes expected"},
        {ARRAY(", \"chunks\": [2147483647, 2147483647, 2147483647]"), ST_CORRUPT, "no memory"},
        {ARRAY(", \"chunks\": [2000, 2000, 2000]"), ST_NOMEM, ""},
        {ARRAY(", \"shape\": [2, 3, 1]"), ST_UNSUPPORTED, "1 sample along x"},
        {ARRAY(", \"shape\": [2, 3, 2147483647]"), ST_UNSUPPORTED, "at most"},
        {ARRAY(", \"shape\": [6, 4], \"chunks\": [6, 4]"), ST_UNSUPPORTED, "1 sample along z"},
        {ARRAY(", \"shape\": [2,2,2,2,2,2], \"chunks\": [2,2,2,2,2,2]"), ST_UNSUPPORTED,
         "axes that OME-Zarr names"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        volumes_refused(make(cases[i].json), NULL, cases[i].st, cases[i].said);
    const bool blosc = dlopen("libblosc.so.1", RTLD_NOW);
    volumes_refused(make(ARRAY(", \"compressor\": {\"id\": \"blosc\"}")), NULL,
                    blosc ? ST_CORRUPT : ST_UNSUPPORTED,
                    blosc ? "0.0.0: damaged blosc data" : "0.0.0: libblosc.so.1");
    make(ARRAY(""));
    scratch_write("z/0.1.1", "short", 5);
    volumes_refused(scratch_path("z"), NULL, ST_CORRUPT, "0.1.1: this chunk does not hold the 24");
    scratch_write("z/0.1.1", "far too long for a chunk", 25);
    volumes_refused(scratch_path("z"), NULL, ST_CORRUPT, "0.1.1: this chunk does not hold the 24");
}

/* 1,000 damaged JSONs, of the array and of the image that it is in. */
static void test_damaged(void **state) {
    (void)state;
    static const char image[] =
        "{\"multiscales\": [{\"axes\": [\"z\", \"y\", {\"name\": \"x\"}], \"datasets\": "
        "[{\"path\": "
        "\"a\", \"coordinateTransformations\": [{\"type\": \"scale\", \"scale\": [4, 3, 2]}]}]}]}";
    uint64_t random = 7;
    const volume_hints without_chunks = {.trust = {.allow_missing = true}};
    int refused = 0;
    grid g;
    for (int n = 0; n < 1000; n++) {
        char text[600];
        const bool of_image = n % 2;
        strcpy(text,
               of_image ? image : ARRAY(", \"compressor\": {\"id\": \"zlib\", \"level\": 1}"));
        for (int k = n % 5; k >= 0; k--) {
            random = random * 6364136223846793005u + 1442695040888963407u;
            text[(random >> 33) % strlen(text)] = "0123456789-.,:\"[]{}xyz"[(random >> 20) % 22];
        }
        make(of_image ? ARRAY("") : text);
        if (of_image) {
            folder("h");
            scratch_text("h/.zgroup", "{}");
            scratch_text("h/.zattrs", text);
            folder("h/a");
            scratch_text("h/a/.zarray", ARRAY(""));
        }
        refused +=
            volumes_read(scratch_path(of_image ? "h" : "z"), &without_chunks, &g, samples) != ST_OK;
    }
    /* The others changed a number, or a name that is passed over. */
    assert_in_range(refused, 800, 950);
}

static int remove_entry(const char *path, const struct stat *info, int type, struct FTW *at) {
    (void)info, (void)type, (void)at;
    return remove(path);
}

static int remove_folders(void **state) {
    (void)state;
    static const char *const names[] = {"z", "g", "h"};
    for (int i = 0; i < 3; i++)
        nftw(scratch_path(names[i]), remove_entry, 8, FTW_DEPTH | FTW_PHYS);
    return 0;
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_read),
        cmocka_unit_test(test_group),
        cmocka_unit_test(test_refused),
        cmocka_unit_test(test_damaged),
    };
    return cmocka_run_group_tests(tests, NULL, remove_folders);
}
