/* test_nrrd.c - NRRD: every header feature, refusals that name the line, cut and damaged files,
 * pipes, the writer.
 */
/* marks: threads, bits */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "formats/grid/nrrd_writer.h"
#include "tests/support/scratch.h"
#include "tests/support/volumes.h"

static double samples[VOLUMES_SAMPLES];

#define BASE "NRRD0004\n# made by hand\ntype: uint8\ndimension: 3\nsizes: 4 3 2\n"
#define RAW  BASE "encoding: raw\n"

/* The u8 test volume under a header. */
static const char *plain(const char *header) {
    size_t size = volumes_samples(SAMPLE_U8, false, samples);
    return volumes_file("a.nrrd", header, samples, size);
}

static void test_types(void **state) {
    (void)state;
    for (int t = SAMPLE_U8; t <= SAMPLE_F64; t++) {
        static const char *const names[] = {"",      "uchar", "signed char", "unsigned short",
                                            "int16", "float", "uint",        "int32",
                                            "double"};
        for (int big = 0; big < 2; big++) {
            char header[300];
            size_t size = volumes_samples((sample_type)t, big, samples);
            snprintf(
                header, sizeof header,
                "NRRD0001\ntype: %s\ndimension: 3\nsizes: 4 3 2\nendian: %s\nencoding: raw\n\n",
                names[t], big ? "big" : "little");
            volumes_check(volumes_file("a.nrrd", header, samples, size), NULL, (sample_type)t,
                          NULL);
        }
    }
}

static void test_gzip(void **state) {
    (void)state;
    for (int members = 1; members <= 3; members++) {
        size_t size = volumes_samples(SAMPLE_I16, true, samples), packed;
        uint8_t *data = volumes_deflate(samples, size, true, members, &packed);
        const char *path = volumes_file("a.nrrd",
                                        "NRRD0005\ntype: int16\ndimension: 3\nsizes: 4 3 2\n"
                                        "endian: big\nencoding: gz\n\n",
                                        data, packed);
        free(data);
        volumes_check(path, NULL, SAMPLE_I16, NULL);
    }
}

static void test_text(void **state) {
    (void)state;
    char text[4 * VOLUMES_SAMPLES + 1];
    size_t size = volumes_text(SAMPLE_F32, text);
    static const char header[] =
        "NRRD0003\ntype: float\ndimension: 3\nsizes: 4 3 2\nencoding: ascii\n\n";
    const char *path = volumes_file("a.nrrd", header, text, size);
    volumes_check(path, NULL, SAMPLE_F32, NULL);
    volumes_truncate(path, NULL, 3); /* two of the last three digits may go */
    volumes_faults(path, NULL);
    text[3] = 'x';
    volumes_refused(volumes_file("a.nrrd", header, text, size), NULL, ST_CORRUPT,
                    "no sample of type f32");
    /* u8 takes no negative and no broken numbers. */
    static const char *const bad[] = {"-1", "256", "1.5", "nan", "1e3"};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        char lines[100];
        int length = snprintf(lines, sizeof lines, "%s 0 0 0 0 0 0 0", bad[i]);
        volumes_refused(volumes_file("a.nrrd",
                                     "NRRD0001\ntype: uint8\ndimension: 3\nsizes: 2 2 2\n"
                                     "encoding: text\n\n",
                                     lines, (size_t)length),
                        NULL, ST_CORRUPT, "no sample of type u8");
    }
}

static void test_placement(void **state) {
    (void)state;
    static const struct {
        const char *fields;
        double to_world[3][4];
    } cases[] = {
        {"spacings: 0.5 1 -2\n", {{0.5, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, -2, 0}}},
        {"spacings: nan 1 2\n", {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 2, 0}}},
        {"spacings: 1 1 2\naxis mins: 10 -20 nan\n", {{1, 0, 0, 10}, {0, 1, 0, -20}, {0, 0, 2, 0}}},
        {"axismins: 0 0 0\naxismaxs: 6 6 6\n", {{2, 0, 0, 0}, {0, 3, 0, 0}, {0, 0, 6, 0}}},
        {"axis mins: 0 0 0\naxis maxs: 6 6 6\ncenterings: cell node cell\n",
         {{1.5, 0, 0, 0.75}, {0, 3, 0, 0}, {0, 0, 3, 1.5}}},
        {"space: left-posterior-superior\nspace directions: (1,0,0) (0,-2,0) (0,0,3)\n"
         "space origin: (5, -6, 7e1)\n",
         {{1, 0, 0, 5}, {0, -2, 0, -6}, {0, 0, 3, 70}}},
        /* permuted and oblique, none (a spacing stands in) */
        {"space dimension: 3\nspace directions: (0, 0, 2) ( 1,0 , 0 ) (0,1,0.5)\n",
         {{0, 1, 0, 0}, {0, 0, 1, 0}, {2, 0, 0.5, 0}}},
        {"spacings: 2 1 1\nspace directions: none (0,1,0) (0,0,1)\n",
         {{2, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}},
        {"thicknesses: 1 1 1\nunits: \"mm\" \"mm\" \"mm\"\nkinds: domain domain domain\n"
         "labels: \"a: b\" \"\" \"\"\nmin: 0\nold max: 9\nkey:=value\ncontent: x\n",
         {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char header[500];
        snprintf(header, sizeof header, "%s%s\n", RAW, cases[i].fields);
        volumes_check(plain(header), NULL, SAMPLE_U8, cases[i].to_world);
    }
}

static void test_hints(void **state) {
    (void)state;
    const volume_hints hints = {.spacing = {0, 5, -7}, .origin = {1, 2, 3}, .has_origin = true};
    const double map[3][4] = {{2, 0, 0, 1}, {0, 5, 0, 2}, {0, 0, -7, 3}};
    volumes_check(plain(RAW "spacings: 2 2 2\n\n"), &hints, SAMPLE_U8, map);
}

static void test_four_axes(void **state) {
    (void)state;
    const double map[3][4] = {{2, 0, 0, 5}, {0, 3, 0, 6}, {0, 0, 4, 7}};
    volumes_check(plain("NRRD0004\ntype: uint8\ndimension: 4\nsizes: 1 4 3 2\nencoding: raw\n"
                        "space dimension: 3\nspace directions: none (2,0,0) (0,3,0) (0,0,4)\n"
                        "space origin: (5,6,7)\n\n"),
                  NULL, SAMPLE_U8, map);
    const double other[3][4] = {{2, 0, 0, 0}, {0, 3, 0, 0}, {0, 0, 4, 0}};
    volumes_check(plain("NRRD0004\ntype: uint8\ndimension: 4\nsizes: 4 3 2 1\nencoding: raw\n"
                        "spacings: 2 3 4 9\n\n"),
                  NULL, SAMPLE_U8, other);
    volumes_refused(plain("NRRD0004\ntype: uint8\ndimension: 4\nsizes: 2 2 3 2\nencoding: raw\n\n"),
                    NULL, ST_UNSUPPORTED, "three axes");
    volumes_refused(plain("NRRD0004\ntype: uint8\ndimension: 2\nsizes: 4 6\nencoding: raw\n\n"),
                    NULL, ST_UNSUPPORTED, "1 sample along z");
}

/* ---- data files ---- */

static void test_detached(void **state) {
    (void)state;
    size_t size = volumes_samples(SAMPLE_U8, false, samples);
    char data[200] = "one line\nand another\nxyz";
    size_t before = strlen(data);
    memcpy(data + before, samples, size);
    scratch_write("samples.bin", data, before + size);
    /* The header may end with the file, or with a blank line and anything behind it. */
    volumes_check(scratch_text("a.nhdr", RAW "data file: samples.bin\nbyte skip: -1"), NULL,
                  SAMPLE_U8, NULL);
    volumes_check(scratch_text("a.nhdr", RAW "datafile: ./samples.bin\nlineskip: 2\n"
                                             "byteskip: 3\n\nignored"),
                  NULL, SAMPLE_U8, NULL);
    char header[5000];
    snprintf(header, sizeof header, "%sdata file: %s\nbyte skip: 24\n", RAW,
             scratch_path("samples.bin"));
    volumes_check(scratch_text("a.nhdr", header), NULL, SAMPLE_U8, NULL);
    /* Counted from the end. */
    scratch_write("samples.bin", data, before + size + 5);
    volumes_check(scratch_text("a.nhdr", RAW "data file: samples.bin\nbyte skip: -6\n"), NULL,
                  SAMPLE_U8, NULL);
    volumes_refused(scratch_text("a.nhdr", RAW "data file: samples.bin\nbyte skip: -50\n"), NULL,
                    ST_CORRUPT, "ends before the samples");
    volumes_refused(scratch_text("a.nhdr", RAW "data file: samples.bin\nline skip: 9\n"), NULL,
                    ST_CORRUPT, "no text");
    volumes_refused(scratch_text("a.nhdr", RAW "data file: samples.bin\nbyte skip: 9999\n"), NULL,
                    ST_CORRUPT, "samples.bin: ends at byte");
    scratch_text("lines.txt", "1\n2\n3");
    volumes_refused(scratch_text("a.nhdr", RAW "data file: lines.txt\nline skip: 9\n"), NULL,
                    ST_CORRUPT, "ends 6 lines before the samples");
    volumes_refused(scratch_text("a.nhdr", RAW "data file: none.bin\n"), NULL, ST_IO, "none.bin");
    volumes_refused(scratch_text("a.nhdr", RAW "data file: LIST\nx\n"), NULL, ST_IO, "x: cannot");
    volumes_refused(scratch_text("a.nhdr", RAW "data file: LIST\n"), NULL, ST_CORRUPT, "no file");
    volumes_refused(scratch_text("a.nhdr", RAW "data file: s%03d.bin 1 2 1\n"), NULL, ST_IO,
                    "s001.bin: cannot");
    volumes_refused(scratch_text("a.nhdr", RAW "data file: s%03d.bin 1 2 0\n"), NULL, ST_CORRUPT,
                    "the pattern of names");
    volumes_refused(scratch_text("a.nhdr", RAW "data file: s%03x.bin 1 2 1\n"), NULL, ST_CORRUPT,
                    "the pattern of names");
    volumes_faults(scratch_text("a.nhdr", RAW "data file: samples.bin\nbyte skip: -6"), NULL);
}

static void test_compressed_skip(void **state) {
    (void)state;
    char data[200] = "pad";
    size_t size = volumes_samples(SAMPLE_U8, false, samples), packed;
    memcpy(data + 3, samples, size);
    uint8_t *gz = volumes_deflate(data, 3 + size, true, 1, &packed);
    /* Lines are skipped in the file, bytes in the decompressed data. */
    const char *path = volumes_file(
        "a.nrrd", BASE "encoding: gzip\nline skip: 1\nbyte skip: 3\n\nwhatever\n", gz, packed);
    volumes_check(path, NULL, SAMPLE_U8, NULL);
    path = volumes_file("a.nrrd", BASE "encoding: gzip\nbyte skip: 300\n\n", gz, packed);
    volumes_refused(path, NULL, ST_CORRUPT, "before the samples");
    path = volumes_file("a.nrrd", BASE "encoding: gzip\nbyte skip: -1\n\n", gz, packed);
    volumes_refused(path, NULL, ST_UNSUPPORTED, "raw encoding");
    free(gz);
}

/* ---- refusals ---- */

static void test_refused(void **state) {
    (void)state;
    static const struct {
        const char *header;
        status st;
        const char *said;
    } cases[] = {
        {"NRRD0006\n\n", ST_UNSUPPORTED, "version 6"},
        {"NRRD0000\n\n", ST_CORRUPT, "line 1"},
        {"NRRDwhat\n\n", ST_CORRUPT, "line 1"},
        {"NRRD0004\n\n", ST_CORRUPT, "\"dimension\""},
        {"NRRD0004\nwhat\n\n", ST_CORRUPT, "line 2: expected \"key: value\""},
        {RAW "spacing: 1 1 1\n\n", ST_CORRUPT, "line 7: spacing: no such NRRD field"},
        {RAW "type: uint8\n\n", ST_CORRUPT, "line 7: type: comes twice"},
        {"NRRD0004\ntype: int128\ndimension: 3\nsizes: 4 3 2\nencoding: raw\n\n", ST_UNSUPPORTED,
         "line 2: type: \"int128\""},
        {"NRRD0004\ntype: block\ndimension: 3\nsizes: 4 3 2\nencoding: raw\n\n", ST_UNSUPPORTED,
         "block"},
        {"NRRD0004\ntype: int16\ndimension: 3\nsizes: 4 3 2\nencoding: raw\n\n", ST_CORRUPT,
         "\"endian\""},
        {"NRRD0004\ntype: int16\ndimension: 3\nsizes: 4 3 2\nencoding: raw\nendian: middle\n\n",
         ST_CORRUPT, "line 6: endian"},
        {BASE "encoding: hex\n\n", ST_UNSUPPORTED, "line 6: encoding: \"hex\""},
        {"NRRD0004\ntype: uint8\ndimension: 3\nsizes: 4 3\nencoding: raw\n\n", ST_CORRUPT,
         "line 4: sizes"},
        {"NRRD0004\ntype: uint8\ndimension: 3\nsizes: 4 3 -2\nencoding: raw\n\n", ST_CORRUPT,
         "whole number"},
        {"NRRD0004\ntype: uint8\ndimension: 3\nsizes: 4 3 2.5\nencoding: raw\n\n", ST_CORRUPT,
         "whole number"},
        {"NRRD0004\ntype: uint8\ndimension: 3\nsizes: 4 3 0\nencoding: raw\n\n", ST_CORRUPT,
         "whole number"},
        {"NRRD0004\ntype: uint8\ndimension: 3\nsizes: 4 1 6\nencoding: raw\n\n", ST_UNSUPPORTED,
         "1 sample along y"},
        {"NRRD0004\ntype: uint8\ndimension: 99\nsizes: 4 3 2\nencoding: raw\n\n", ST_CORRUPT,
         "dimension"},
        {RAW "spacings: 1 0 1\n\n", ST_CORRUPT, "do not span space"},
        {RAW "spacings: 1 inf 1\n\n", ST_CORRUPT, "not finite"},
        {RAW "spacings: 1 x 1\n\n", ST_CORRUPT, "line 7: spacings"},
        {RAW "space directions: (1,0,0) (0,1,0)\n\n", ST_CORRUPT, "line 7: space directions"},
        {RAW "space directions: (1,0,0) (0,1,0) (0,0,1) (0,0,1)\n\n", ST_CORRUPT,
         "expected 3 vectors"},
        {RAW "space directions: (1,0) (0,1) (1,1)\n\n", ST_CORRUPT, "three numbers"},
        {RAW "space directions: (1,0,0) (0,1,0) (1,1,0)\n\n", ST_CORRUPT, "do not span space"},
        {RAW "space dimension: 2\n\n", ST_UNSUPPORTED, "space of 3"},
        {RAW "space origin: 1,2,3\n\n", ST_CORRUPT, "line 7: space origin"},
        {RAW "leafcast axis 0:=0 1 2\n\n", ST_CORRUPT, "fewer than 4 coordinates"},
        {RAW "leafcast axis 0:=0 1 2 3 4\n\n", ST_CORRUPT, "more than 4 coordinates"},
        {RAW "leafcast axis 1:=0 1 1\n\n", ST_CORRUPT, "coordinate 2 along y"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        volumes_refused(plain(cases[i].header), NULL, cases[i].st, cases[i].said);
}

static void test_hostile_sizes(void **state) {
    (void)state;
    static const char *const sizes[] = {"1048576 1048576 1048576",
                                        "4294967295 4294967295 4294967295", "4 3 3",
                                        "99999999999999999999 2 2", "1000000 2 2"};
    static const char *const encodings[] = {"raw", "raw\nbyte skip: -1", "text"};
    for (size_t s = 0; s < sizeof sizes / sizeof *sizes; s++)
        for (size_t e = 0; e < sizeof encodings / sizeof *encodings; e++) {
            char header[300];
            snprintf(header, sizeof header,
                     "NRRD0004\ntype: uint8\ndimension: 3\nsizes: %s\nencoding: %s\n\n", sizes[s],
                     encodings[e]);
            double got[VOLUMES_SAMPLES];
            grid g;
            status st = volumes_read(plain(header), NULL, &g, got);
            assert_true(st == ST_CORRUPT || st == ST_UNSUPPORTED);
        }
    /* A gzip file of so few bytes cannot hold a gigabyte, whatever it says. */
    size_t packed;
    uint8_t *gz = volumes_deflate("x", 1, true, 1, &packed);
    volumes_refused(volumes_file("a.nrrd",
                                 "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 1024 1024 1024\n"
                                 "encoding: gzip\n\n",
                                 gz, packed),
                    NULL, ST_CORRUPT, "at least");
    free(gz);
}

/* ---- cut and damaged ---- */

static void test_truncated(void **state) {
    (void)state;
    const char *path = plain(RAW "spacings: 1 2 3\nleafcast axis 2:=0 5\n\n");
    volumes_truncate(path, NULL, 0);
    volumes_faults(path, NULL);
    size_t size = volumes_samples(SAMPLE_U8, false, samples), packed;
    uint8_t *gz = volumes_deflate(samples, size, true, 2, &packed);
    path = volumes_file("a.nrrd", BASE "encoding: gzip\n\n", gz, packed);
    volumes_truncate(path, NULL, 0);
    volumes_faults(path, NULL);
    free(gz);
}

static void test_damaged(void **state) {
    (void)state;
    size_t size = volumes_samples(SAMPLE_U8, false, samples), packed;
    uint8_t *gz = volumes_deflate(samples, size, true, 1, &packed);
    scratch_write("a.gz", gz, packed);
    free(gz);
    const char *path = scratch_text("a.nhdr", BASE "encoding: gzip\ndata file: a.gz\n");
    /* What is not noticed, of three changes a byte: 13 bytes of the comment, version 5 for 4, zeros
     * in front of two numbers, and one slice fewer, behind which bytes may follow. */
    assert_int_equal(volumes_damage(path, NULL), 43);
    /* Damage to the data is found, but for gzip's own time stamp, flags and system (bytes 4 to 9).
     */
    char *data = scratch_read(scratch_path("a.gz"), &size);
    double got[VOLUMES_SAMPLES];
    grid g;
    for (size_t n = 0; n < size; n++) {
        data[n] ^= 0x21;
        scratch_write("a.gz", data, size);
        status st = volumes_read(path, NULL, &g, got);
        if (n < 4 || n > 9)
            assert_int_equal(st, ST_CORRUPT);
        else
            assert_int_equal(st, ST_OK);
        data[n] ^= 0x21;
    }
    free(data);
}

static void test_trailing(void **state) {
    (void)state;
    size_t size = volumes_samples(SAMPLE_U8, false, samples), packed;
    mem m;
    mem_init(&m, 0);
    for (int gzip = 0; gzip < 2; gzip++) {
        char all[300];
        memcpy(all, samples, size);
        strcpy(all + size, "spare");
        uint8_t *gz = volumes_deflate(all, size + 5, true, 1, &packed);
        const char *path = volumes_file("a.nrrd", gzip ? BASE "encoding: gzip\n\n" : RAW "\n",
                                        gzip ? (char *)gz : all, gzip ? packed : size + 5);
        free(gz);
        volume *v;
        uint64_t trailing = 0;
        assert_int_equal(volume_open(&m, path, NULL, &v), ST_OK);
        assert_int_equal(volume_read(v, VOLUMES_NZ, all), ST_OK);
        assert_int_equal(volume_finish(v, &trailing), ST_OK);
        assert_int_equal(trailing, 5);
        volume_close(v);
    }
    assert_int_equal(mem_used(&m), 0);
}

/* ---- pipes ---- */

typedef struct feed {
    int fd;
    const char *data;
    size_t size;
} feed;

static void *write_slowly(void *ctx) {
    feed *f = ctx;
    for (size_t n = 0; n < f->size; n++)
        if (write(f->fd, f->data + n, 1) != 1)
            break;
    close(f->fd);
    return NULL;
}

/* Read "-" while another thread writes the file into it, byte by byte. */
static status read_piped(const char *data, size_t size, double *got) {
    int ends[2], kept = dup(STDIN_FILENO);
    assert_int_equal(pipe(ends), 0);
    assert_true(dup2(ends[0], STDIN_FILENO) >= 0);
    close(ends[0]);
    feed f = {ends[1], data, size};
    pthread_t writer;
    assert_int_equal(pthread_create(&writer, NULL, write_slowly, &f), 0);
    grid g;
    status st = volumes_read("-", NULL, &g, got);
    pthread_join(writer, NULL);
    if (kept >= 0) {
        dup2(kept, STDIN_FILENO);
        close(kept);
    }
    return st;
}

static void test_pipe(void **state) {
    (void)state;
    size_t bytes = volumes_samples(SAMPLE_U8, false, samples), packed, size;
    uint8_t *gz = volumes_deflate(samples, bytes, true, 2, &packed);
    const char *const paths[2] = {plain(RAW "\n"),
                                  volumes_file("b.nrrd", BASE "encoding: gzip\n\n", gz, packed)};
    free(gz);
    for (int i = 0; i < 2; i++) {
        char *data = scratch_read(paths[i], &size);
        double got[VOLUMES_SAMPLES];
        assert_int_equal(read_piped(data, size, got), ST_OK);
        assert_memory_equal(got, samples, bytes);
        assert_int_equal(read_piped(data, size - 1, got), ST_CORRUPT);
        assert_non_null(strstr(status_text(), "standard input"));
        assert_int_equal(read_piped(data, 30, got), ST_CORRUPT);
        free(data);
    }
    double got[VOLUMES_SAMPLES];
    assert_int_equal(read_piped("hello, world", 12, got), ST_UNSUPPORTED);
    assert_int_equal(read_piped("", 0, got), ST_CORRUPT);
}

/* ---- rectilinear axes, and the writer ---- */

static void test_axes(void **state) {
    (void)state;
    mem m;
    mem_init(&m, 0);
    volume *v;
    const char *path = plain(RAW "spacings: 9 -9 9\nleafcast axis 0:=0 1 10 11.5\n"
                                 "leafcast axis 1:=3 2 1\n\n");
    volume_hints hints = {.axis_file = {NULL, NULL, scratch_text("z.txt", "-5\n\n7\n")}};
    assert_int_equal(volume_open(&m, path, &hints, &v), ST_OK);
    const grid *g = volume_grid(v);
    const double x[4] = {0, 1, 10, 11.5}, z[2] = {-5, 7};
    assert_memory_equal(g->axis[0], x, sizeof x);
    assert_memory_equal(g->axis[2], z, sizeof z);
    /* Spacings scale coordinates, but those of a hint. y: decreasing ones turn -9 round. */
    assert_true(g->axis[1][0] == -3 && g->axis[1][2] == -1);
    assert_true(g->to_world[0][0] == 9 && g->to_world[1][1] == 9 && g->to_world[2][2] == 1);
    volume_close(v);
    hints.axis_file[2] = scratch_path("none");
    volumes_refused(path, &hints, ST_IO, "none");
    hints.axis_file[2] = scratch_text("z.txt", "1 2 3");
    volumes_refused(path, &hints, ST_CORRUPT, "more than 2 coordinates");
    hints.axis_file[2] = scratch_text("z.txt", "1, 2");
    volumes_faults(path, &hints);
    assert_int_equal(mem_used(&m), 0);
}

static void test_written(void **state) {
    (void)state;
    mem m;
    mem_init(&m, 0);
    for (int t = SAMPLE_U8; t <= SAMPLE_F64; t++) {
        const uint32_t dims[3] = {VOLUMES_NX, VOLUMES_NY, VOLUMES_NZ};
        const double map[3][4] = {{0.1, 0, 0, -1e6}, {0, -1e-9, 0.5, 3}, {0, 0, 1e12, 1.0 / 3}};
        grid g;
        grid_init(&g, dims, (sample_type)t);
        memcpy(g.to_world, map, sizeof map);
        volumes_samples((sample_type)t, false, samples);
        nrrd_writer *w;
        const char *path = scratch_path("w.nrrd");
        assert_int_equal(nrrd_writer_create(&m, path, true, &g, &w), ST_OK);
        assert_int_equal(nrrd_writer_append(w, samples, 20), ST_OK);
        assert_int_equal(nrrd_writer_append(w, (char *)samples + 20 * sample_size(g.type), 4),
                         ST_OK);
        assert_int_equal(nrrd_writer_commit(w), ST_OK);
        volumes_check(path, NULL, (sample_type)t, map);
        assert_int_equal(nrrd_writer_create(&m, path, false, &g, &w), ST_EXISTS);
    }
    assert_int_equal(mem_used(&m), 0);
}

static void test_written_axes(void **state) {
    (void)state;
    mem m;
    mem_init(&m, 0);
    const uint32_t dims[3] = {VOLUMES_NX, VOLUMES_NY, VOLUMES_NZ};
    const double x[4] = {0.1, 0.2, 1e3, 1e60}, y[3] = {2, 1, -1};
    grid g;
    grid_init(&g, dims, SAMPLE_U8);
    assert_int_equal(grid_set_axis(&g, &m, "x", 0, x), ST_OK);
    assert_int_equal(grid_set_axis(&g, &m, "y", 1, y), ST_OK);
    volumes_samples(SAMPLE_U8, false, samples);
    nrrd_writer *w;
    const char *path = scratch_path("w.nrrd");
    assert_int_equal(nrrd_writer_create(&m, path, true, &g, &w), ST_OK);
    assert_int_equal(nrrd_writer_append(w, samples, VOLUMES_SAMPLES), ST_OK);
    assert_int_equal(nrrd_writer_commit(w), ST_OK);
    volume *v;
    assert_int_equal(volume_open(&m, path, NULL, &v), ST_OK);
    const grid *back = volume_grid(v);
    for (int a = 0; a < 3; a++)
        assert_memory_equal(back->axis[a], g.axis[a], dims[a] * sizeof(double));
    assert_memory_equal(back->to_world, g.to_world, sizeof g.to_world);
    volume_close(v);
    grid_release(&g, &m);
    assert_int_equal(mem_used(&m), 0);
}

/* ---- real data ---- */

static void test_stent(void **state) {
    (void)state;
    const char *path = scratch_data("stent/stent.nrrd");
    if (!path) {
        print_message("no stent/stent.nrrd\n");
        skip();
    }
    char *packed = strdup(path);
    mem m;
    mem_init(&m, 1 << 20);
    volume *v;
    assert_int_equal(volume_open(&m, packed, NULL, &v), ST_OK);
    const grid *g = volume_grid(v);
    assert_int_equal(g->dims[2], 256);
    char *data = malloc(grid_samples(g) * 4);
    for (uint32_t k = 0; k < 256; k += 32)
        assert_int_equal(volume_read(v, 32, data + k * grid_slice_bytes(g)), ST_OK);
    assert_int_equal(volume_finish(v, NULL), ST_OK);
    char command[5000], *raw = malloc(grid_samples(g) * 4 + 1);
    snprintf(command, sizeof command, "zstd -dcq '%s'",
             scratch_data("stent/stent_128x128x256_float32.raw.zst"));
    FILE *f = popen(command, "r");
    size_t got = f ? fread(raw, 1, grid_samples(g) * 4 + 1, f) : 0;
    if (f)
        pclose(f);
    bool known = got > 0; /* the zstd tool may be missing */
    if (known) {
        assert_int_equal(got, grid_samples(g) * 4);
        assert_memory_equal(data, raw, got);
    }
    free(data);
    free(raw);
    free(packed);
    volume_close(v);
    assert_int_equal(mem_used(&m), 0);
    if (!known)
        skip();
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_types),        cmocka_unit_test(test_gzip),
        cmocka_unit_test(test_text),         cmocka_unit_test(test_placement),
        cmocka_unit_test(test_hints),        cmocka_unit_test(test_four_axes),
        cmocka_unit_test(test_detached),     cmocka_unit_test(test_compressed_skip),
        cmocka_unit_test(test_refused),      cmocka_unit_test(test_hostile_sizes),
        cmocka_unit_test(test_truncated),    cmocka_unit_test(test_damaged),
        cmocka_unit_test(test_trailing),     cmocka_unit_test(test_pipe),
        cmocka_unit_test(test_axes),         cmocka_unit_test(test_written),
        cmocka_unit_test(test_written_axes), cmocka_unit_test(test_stent),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
