/* test_grid_readers.c - readers of NIfTI, NumPy, MRC, PVM and SLC: files made by hand, byte by
 * byte; what is refused, cut and damaged.
 */
/* marks: bits, long */
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

/* Fields of a binary header: at, of so many bytes. */
static void put(uint8_t *header, int at, int bytes, bool big, uint64_t value) {
    for (int i = 0; i < bytes; i++)
        header[at + i] = (uint8_t)(value >> 8 * (big ? bytes - 1 - i : i));
}

static void put_f32(uint8_t *header, int at, bool big, float value) {
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    put(header, at, 4, big, bits);
}

static void put_f64(uint8_t *header, int at, bool big, double value) {
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    put(header, at, 8, big, bits);
}

static const char *with_samples(const char *name, const uint8_t *header, size_t bytes,
                                sample_type type, bool big) {
    const size_t size = volumes_samples(type, big, samples);
    uint8_t *all = malloc(bytes + size);
    memcpy(all, header, bytes);
    memcpy(all + bytes, samples, size);
    const char *path = scratch_write(name, all, bytes + size);
    free(all);
    return path;
}

/* Up to four bytes of the first 512 changed. */
static void damage(char *data, size_t size, uint64_t *random) {
    for (int n = 1 + (int)(*random >> 60 & 3); n > 0; n--) {
        *random = *random * 6364136223846793005u + 1442695040888963407u;
        data[(*random >> 33) % (size < 512 ? size : 512)] = (char)(*random >> 20);
    }
}

/* Cut anywhere, and 1,000 times damaged: errors, or results. */
static void hurt(const char *path, size_t spare) {
    double room[VOLUMES_SAMPLES];
    uint64_t random = 1;
    size_t size;
    int refused = 0;
    grid g;
    volumes_truncate(path, NULL, spare);
    volumes_faults(path, NULL);
    char *data = scratch_read(path, &size), *copy = malloc(size);
    for (int n = 0; n < 1000; n++) {
        memcpy(copy, data, size);
        damage(copy, size, &random);
        scratch_write(strrchr(path, '/') + 1, copy, size);
        refused += volumes_read(path, NULL, &g, room) != ST_OK;
    }
    /* Most of a header means something; how much depends on the format. */
    assert_in_range(refused, 100, 1000);
    scratch_write(strrchr(path, '/') + 1, data, size);
    free(copy);
    free(data);
}

/* ---- NIfTI ---- */

enum { NIFTI1 = 352, NIFTI2 = 544 };

/* A NIfTI-1 header of the test volume; spacings 2, 3, 4; neither sform nor qform. */
static void nifti1(uint8_t h[NIFTI1], int code, int bytes, bool big) {
    static const int dims[8] = {3, 4, 3, 2, 1, 1, 1, 1};
    memset(h, 0, NIFTI1);
    put(h, 0, 4, big, 348);
    for (int i = 0; i < 8; i++)
        put(h, 40 + 2 * i, 2, big, (uint64_t)dims[i]);
    put(h, 70, 2, big, (uint64_t)code);
    put(h, 72, 2, big, 8 * (uint64_t)bytes);
    put_f32(h, 76, big, 1);
    for (int a = 0; a < 3; a++)
        put_f32(h, 80 + 4 * a, big, (float)(a + 2));
    put_f32(h, 108, big, NIFTI1);
    memcpy(h + 344, "n+1", 4);
}

static const double nifti_map[3][4] = {{2, 0, 0, 0}, {0, 3, 0, 0}, {0, 0, 4, 0}};

static const struct {
    sample_type type;
    int code;
} nifti_types[] = {{SAMPLE_U8, 2},   {SAMPLE_I16, 4},  {SAMPLE_I32, 8},   {SAMPLE_F32, 16},
                   {SAMPLE_F64, 64}, {SAMPLE_I8, 256}, {SAMPLE_U16, 512}, {SAMPLE_U32, 768}};

static void test_nifti_types(void **state) {
    (void)state;
    uint8_t h[NIFTI1];
    for (size_t i = 0; i < sizeof nifti_types / sizeof *nifti_types; i++)
        for (int big = 0; big < 2; big++) {
            const sample_type t = nifti_types[i].type;
            nifti1(h, nifti_types[i].code, (int)sample_size(t), big);
            volumes_check(with_samples("a.nii", h, sizeof h, t, big), NULL, t, nifti_map);
        }
}

static void test_nifti_placement(void **state) {
    (void)state;
    uint8_t h[NIFTI1];
    nifti1(h, 4, 2, true);
    /* Half a turn about x, in the quaternion; the third axis mirrored. */
    put(h, 252, 2, true, 1);
    put_f32(h, 256, true, 1);
    for (int a = 0; a < 3; a++)
        put_f32(h, 268 + 4 * a, true, (float)(10 * a - 5));
    put_f32(h, 76, true, -1);
    const double half_turn[3][4] = {{2, 0, 0, -5}, {0, -3, 0, 5}, {0, 0, 4, 15}};
    volumes_check(with_samples("a.nii", h, sizeof h, SAMPLE_I16, true), NULL, SAMPLE_I16,
                  half_turn);
    /* The sform goes before it: turned and sheared. */
    const double rows[3][4] = {{0.5, -2, 0.25, 7}, {1, 0.5, -1, -8}, {0, 3, 4, 9.5}};
    put(h, 254, 2, true, 2);
    for (int i = 0; i < 12; i++)
        put_f32(h, 280 + 4 * i, true, (float)rows[i / 4][i % 4]);
    volumes_check(with_samples("a.nii", h, sizeof h, SAMPLE_I16, true), NULL, SAMPLE_I16, rows);
    hurt(with_samples("a.nii", h, sizeof h, SAMPLE_I16, true), 0);
}

static void test_nifti2(void **state) {
    (void)state;
    static const int dims[8] = {3, 4, 3, 2, 1, 1, 1, 1};
    for (int big = 0; big < 2; big++) {
        uint8_t h[NIFTI2] = {0};
        put(h, 0, 4, big, 540);
        memcpy(h + 4, "n+2\0\r\n\x1a\n", 8);
        put(h, 12, 2, big, 512);
        put(h, 14, 2, big, 16);
        for (int i = 0; i < 8; i++)
            put(h, 16 + 8 * i, 8, big, (uint64_t)dims[i]);
        for (int a = 0; a < 3; a++)
            put_f64(h, 112 + 8 * a, big, a + 2);
        put(h, 168, 8, big, NIFTI2);
        const char *path = with_samples("a.nii", h, sizeof h, SAMPLE_U16, big);
        volumes_check(path, NULL, SAMPLE_U16, nifti_map);
        if (big)
            hurt(path, 0);
    }
}

static void test_nifti_pair(void **state) {
    (void)state;
    uint8_t h[NIFTI1];
    nifti1(h, 4, 2, false);
    memcpy(h + 344, "ni1", 4);
    put_f32(h, 108, false, 6);
    const char *path = scratch_write("a.hdr", h, 348);
    volumes_refused(path, NULL, ST_IO, "a.img");
    volumes_check((volumes_samples(SAMPLE_I16, false, samples),
                   volumes_file("a.img", "behind", samples, 2 * VOLUMES_SAMPLES),
                   scratch_path("a.hdr")),
                  NULL, SAMPLE_I16, nifti_map);
    volumes_faults(scratch_path("a.hdr"), NULL);
    volumes_refused(scratch_write("a.bin", h, 348), NULL, ST_UNSUPPORTED, "header alone");
    volumes_file("a.img", "behind", samples, 2 * VOLUMES_SAMPLES - 1);
    volumes_refused(scratch_path("a.hdr"), NULL, ST_CORRUPT, "a.img: ends at byte 53");
}

static void test_nifti_refused(void **state) {
    (void)state;
    static const struct {
        int at, bytes;
        uint64_t value;
        status st;
        const char *said;
    } cases[] = {
        {40, 2, 0, ST_CORRUPT, "dim[0] is 0"},
        {40, 2, 8, ST_CORRUPT, "dim[0] is 8"},
        {40, 2, 2, ST_UNSUPPORTED, "1 sample along z"},
        {42, 2, 0, ST_CORRUPT, "dim[1] is 0"},
        {44, 2, 0xffff, ST_CORRUPT, "dim[2] is -1"},
        {70, 2, 1, ST_UNSUPPORTED, "datatype 1"},
        {70, 2, 1536, ST_UNSUPPORTED, "datatype 1536"},
        {80, 4, 0, ST_CORRUPT, "do not span"},
        {80, 4, 0x7fc00000, ST_CORRUPT, "not finite"},
        {108, 4, 0x7f800000, ST_CORRUPT, "vox_offset is inf"},
        {108, 4, 0x43af8000, ST_CORRUPT, "expected at least"}, /* 351 */
        {108, 4, 0x42000000, ST_CORRUPT, "vox_offset is 32"},
        {42, 2, 32767, ST_CORRUPT, "ends at byte"},
    };
    uint8_t h[NIFTI1];
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        nifti1(h, 4, 2, false);
        put(h, cases[i].at, cases[i].bytes, false, cases[i].value);
        if (cases[i].value == 0x43af8000)
            put(h, 46, 2, false, 3);
        volumes_refused(with_samples("a.nii", h, sizeof h, SAMPLE_I16, false), NULL, cases[i].st,
                        cases[i].said);
    }
    nifti1(h, 4, 2, false);
    put_f32(h, 112, false, 2);
    put(h, 116, 4, false, 0x7fc00000);
    volumes_refused(with_samples("a.nii", h, sizeof h, SAMPLE_I16, false), NULL, ST_CORRUPT,
                    "scl_inter is nan");
    /* As many samples as 64 bits count, and more. */
    nifti1(h, 4, 2, false);
    put(h, 40, 2, false, 7);
    for (int i = 1; i < 8; i++)
        put(h, 40 + 2 * i, 2, false, 32767);
    volumes_refused(with_samples("a.nii", h, sizeof h, SAMPLE_I16, false), NULL, ST_UNSUPPORTED,
                    "steps and components");
}

/* ---- NumPy ---- */

/* The test volume under a header with this dictionary; returns the path. */
static const char *npy(int version, const char *text, sample_type type, bool big) {
    uint8_t h[256];
    const size_t front = version == 1 ? 10 : 12;
    const size_t length = (strlen(text) + front + 64) / 64 * 64 - front;
    memset(h, ' ', sizeof h);
    memcpy(h, "\x93NUMPY", 6);
    put(h, 6, 2, false, (uint64_t)version);
    put(h, 8, (int)front - 8, false, length);
    memcpy(h + front, text, strlen(text));
    h[front + length - 1] = '\n';
    return with_samples("a.npy", h, front + length, type, big);
}

static void test_npy(void **state) {
    (void)state;
    static const char *const names[] = {"", "|u1", "|i1", "<u2", "<i2", "<f4", "<u4", "<i4", "<f8"};
    for (int t = SAMPLE_U8; t <= SAMPLE_F64; t++)
        for (int big = 0; big < 2; big++) {
            char text[200], name[4];
            strcpy(name, names[t]);
            if (big && *name == '<')
                *name = '>';
            snprintf(text, sizeof text,
                     "{'descr': '%s', 'fortran_order': False, 'shape': (2, 3, 4), }", name);
            volumes_check(npy(1 + t % 3, text, (sample_type)t, big), NULL, (sample_type)t, NULL);
        }
    hurt(npy(1, "{'descr': '>i4', 'fortran_order': False, 'shape': (2, 3, 4), }", SAMPLE_I32, true),
         0);
}

/* In Fortran order of its axes the test volume is that of 2 x 3 x 4 turned around. */
static void test_npy_fortran(void **state) {
    (void)state;
    const char *path =
        npy(1, "{'descr': '<i2', 'fortran_order': True, 'shape': (4, 3, 2), }", SAMPLE_I16, false);
    double room[VOLUMES_SAMPLES];
    const int16_t *got = (const int16_t *)(void *)room;
    grid g;
    assert_int_equal(volumes_read(path, NULL, &g, room), ST_OK);
    assert_true(g.dims[0] == 2 && g.dims[1] == 3 && g.dims[2] == 4);
    for (int z = 0; z < 4; z++)
        for (int y = 0; y < 3; y++)
            for (int x = 0; x < 2; x++)
                assert_int_equal(got[(z * 3 + y) * 2 + x], 7 * ((x * 3 + y) * 4 + z) - 50);
    hurt(path, 0);
}

static void test_npy_refused(void **state) {
    (void)state;
    static const struct {
        const char *text;
        status st;
        const char *said;
    } cases[] = {
        {"", ST_CORRUPT, "expected 'descr'"},
        {"{'descr': '<i2'}", ST_CORRUPT, "expected True or False"},
        {"{'descr': '<i2', 'fortran_order': False}", ST_CORRUPT, "expected 'shape'"},
        {"{'descr': '<i2', 'fortran_order': False, 'shape': (2, 3", ST_CORRUPT, "sizes from 1 on"},
        {"{'descr': '<i2', 'fortran_order': False, 'shape': (2, 0, 4)}", ST_CORRUPT, "from 1 on"},
        {"{'descr': '<i2', 'fortran_order': False, 'shape': (2, -3, 4)}", ST_CORRUPT, "from 1 on"},
        {"{'descr': '<i2', 'fortran_order': False, 'shape': (6, 4)}", ST_UNSUPPORTED,
         "1 sample along z"},
        {"{'descr': '<i2', 'fortran_order': True, 'shape': (2, 3, 5)}", ST_CORRUPT, "ends at byte"},
        {"{'descr': '<i2', 'fortran_order': True, 'shape': (1048576, 1048576, 1048576)}",
         ST_CORRUPT, "ends at byte"},
        {"{'descr': '<f16', 'fortran_order': True, 'shape': (2, 3, 4)}", ST_UNSUPPORTED, "complex"},
        {"{'descr': [('a', '<i2')], 'fortran_order': True, 'shape': (2, 3, 4)}", ST_UNSUPPORTED,
         "complex"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        volumes_refused(npy(1, cases[i].text, SAMPLE_I16, false), NULL, cases[i].st, cases[i].said);
    volumes_refused(npy(4, cases[0].text, SAMPLE_I16, false), NULL, ST_UNSUPPORTED, "version 4");
    volumes_refused(scratch_write("a.npy", "\x93NUMPY\2\0\0\0\0\1", 12), NULL, ST_CORRUPT,
                    "a header of 16777216 bytes");
}

/* ---- MRC ---- */

enum { MRC = 1024, EXTENDED = 80 };

static void mrc(uint8_t h[MRC + EXTENDED], int mode, bool big) {
    memset(h, 0, MRC + EXTENDED);
    for (int a = 0; a < 3; a++) {
        put(h, 4 * a, 4, big, (uint64_t)(4 - a));
        put(h, 28 + 4 * a, 4, big, (uint64_t)(4 - a));
        put_f32(h, 40 + 4 * a, big, (float)((4 - a) * (a + 2))); /* spacings 2, 3, 4 */
        put_f32(h, 52 + 4 * a, big, 90);
        put(h, 64 + 4 * a, 4, big, (uint64_t)a + 1);
        put_f32(h, 196 + 4 * a, big, (float)(a - 7));
    }
    put(h, 12, 4, big, (uint64_t)mode);
    put(h, 92, 4, big, EXTENDED);
    memcpy(h + 208, "MAP ", 4);
    h[212] = big ? 0x11 : 0x44;
}

static void test_mrc(void **state) {
    (void)state;
    static const double map[3][4] = {{2, 0, 0, -7}, {0, 3, 0, -6}, {0, 0, 4, -5}};
    static const double turned[3][4] = {{0, 0, 2, 8}, {3, 0, 0, -9}, {0, 4, 0, 4}};
    static const struct {
        int mode;
        sample_type type;
    } modes[] = {{0, SAMPLE_I8}, {1, SAMPLE_I16}, {2, SAMPLE_F32}, {6, SAMPLE_U16}};
    uint8_t h[MRC + EXTENDED];
    for (size_t i = 0; i < sizeof modes / sizeof *modes; i++)
        for (int big = 0; big < 2; big++) {
            mrc(h, modes[i].mode, big);
            volumes_check(with_samples("a.mrc", h, sizeof h, modes[i].type, big), NULL,
                          modes[i].type, map);
            h[212] = 0; /* the order shows without the stamp, too */
            volumes_check(with_samples("a.mrc", h, sizeof h, modes[i].type, big), NULL,
                          modes[i].type, map);
        }
    /* Bytes of IMOD are unsigned, unless a flag says otherwise. */
    mrc(h, 0, false);
    put(h, 152, 4, false, 1146047817);
    volumes_check(with_samples("a.mrc", h, sizeof h, SAMPLE_U8, false), NULL, SAMPLE_U8, map);
    h[156] = 1;
    volumes_check(with_samples("a.mrc", h, sizeof h, SAMPLE_I8, false), NULL, SAMPLE_I8, map);
    /* Columns along y, rows along z, sections along x; starts where there is no origin. */
    mrc(h, 1, true);
    for (int a = 0; a < 3; a++) {
        put(h, 64 + 4 * a, 4, true, (uint64_t)(a + 1) % 3 + 1);
        put(h, 16 + 4 * a, 4, true, a == 0 ? (uint64_t)-3 : a == 1 ? 1 : 4);
        put_f32(h, 196 + 4 * a, true, 0);
    }
    const char *path = with_samples("a.mrc", h, sizeof h, SAMPLE_I16, true);
    volumes_check(path, NULL, SAMPLE_I16, turned);
    hurt(path, 0);
}

/* ---- FreeSurfer ---- */

enum { MGH = 284 };

static void mgh(uint8_t h[MGH], int type, bool placed) {
    memset(h, 0, MGH);
    put(h, 0, 4, true, 1);
    for (int a = 0; a < 3; a++)
        put(h, 4 + 4 * a, 4, true, (uint64_t)(4 - a));
    put(h, 16, 4, true, 1);
    put(h, 20, 4, true, (uint64_t)type);
    put(h, 28, 2, true, placed);
    for (int a = 0; a < 3; a++) {
        put_f32(h, 30 + 4 * a, true, (float)(a + 2));
        put_f32(h, 42 + 4 * (3 * a + a), true, 1);
        put_f32(h, 78 + 4 * a, true, (float)a);
    }
}

static void test_mgh(void **state) {
    (void)state;
    static const double map[3][4] = {{2, 0, 0, -4}, {0, 3, 0, 1 - 4.5}, {0, 0, 4, 2 - 4}};
    static const double own[3][4] = {{-1, 0, 0, 2}, {0, 0, 1, -1}, {0, -1, 0, 1.5}};
    static const struct {
        int code;
        sample_type type;
    } types[] = {
        {0, SAMPLE_U8}, {1, SAMPLE_I32}, {3, SAMPLE_F32}, {4, SAMPLE_I16}, {10, SAMPLE_U16}};
    uint8_t h[MGH];
    for (size_t i = 0; i < sizeof types / sizeof *types; i++) {
        mgh(h, types[i].code, true);
        volumes_check(with_samples("a.mgh", h, sizeof h, types[i].type, true), NULL, types[i].type,
                      map);
    }
    mgh(h, 4, false);
    volumes_check(with_samples("a.bin", h, sizeof h, SAMPLE_I16, true), NULL, SAMPLE_I16, own);
    mgh(h, 4, true);
    hurt(with_samples("a.mgh", h, sizeof h, SAMPLE_I16, true), 0);
}

static void test_mrc_refused(void **state) {
    (void)state;
    static const struct {
        int at;
        uint64_t value;
        status st;
        const char *said;
    } cases[] = {
        {0, 0, ST_CORRUPT, "byte 0: 0 samples"},
        {4, 0x80000000, ST_CORRUPT, "byte 4: -2147483648"},
        {8, 1, ST_UNSUPPORTED, "1 sample along z"},
        {0, 0x7fffffff, ST_UNSUPPORTED, "at most"},
        {0, 0x80000, ST_CORRUPT, "ends at byte"},
        {12, 4, ST_UNSUPPORTED, "mode 4"},
        {12, 101, ST_UNSUPPORTED, "mode 101"},
        {40, 0x7fc00000, ST_CORRUPT, "not finite"},
        {60, 0, ST_OK, ""},
        {60, 0x43340000, ST_CORRUPT, "not"}, /* 180 degrees */
        {92, 0x80000000, ST_CORRUPT, "extended header of -2147483648"},
        {92, 0x7fffffff, ST_CORRUPT, "ends at byte"},
    };
    uint8_t h[MRC + EXTENDED];
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        mrc(h, 1, false);
        put(h, cases[i].at, 4, false, cases[i].value);
        const char *path = with_samples("a.mrc", h, sizeof h, SAMPLE_I16, false);
        if (cases[i].st != ST_OK)
            volumes_refused(path, NULL, cases[i].st, cases[i].said);
    }
}

/* ---- PVM ---- */

/* Bits, the highest of a byte first. */
typedef struct bit_writer {
    uint8_t bytes[2048];
    size_t count; /* bits */
} bit_writer;

static void put_bits(bit_writer *w, int bits, unsigned value) {
    for (int b = bits - 1; b >= 0; b--, w->count++)
        if (value >> b & 1)
            w->bytes[w->count / 8] |= (uint8_t)(0x80 >> w->count % 8);
}

/* One run: the differences of its values to their predictions, with 8 bits each, or as few as do.
 */
static void put_run(bit_writer *w, const int *difference, int count) {
    int width = 0;
    for (int i = 0; i < count; i++)
        while (width == 0
                   ? difference[i] != 0
                   : difference[i] < -(1 << (width - 1)) || difference[i] >= 1 << (width - 1))
            width = width ? width + 1 : 2;
    put_bits(w, 7, (unsigned)count);
    put_bits(w, 3, width ? (unsigned)width - 1 : 0);
    for (int i = 0; i < count && width; i++)
        put_bits(w, width, (unsigned)(difference[i] + (1 << (width - 1))));
}

/* data as DDS packs it, with runs of `run` values; returns the path. */
static const char *dds(char version, const uint8_t *data, size_t size, unsigned skip,
                       unsigned strip, int run) {
    bit_writer w = {.count = 8 * 8};
    uint8_t apart[512];
    size_t n = 0;
    int difference[127], held = 0;
    memcpy(w.bytes, "DDS v3?\n", 8);
    w.bytes[6] = (uint8_t)version;
    put_bits(&w, 2, skip - 1);
    put_bits(&w, 16, strip - 1);
    for (size_t c = 0; c < skip; c++)
        for (size_t i = c; i < size; i += skip)
            apart[n++] = data[i];
    for (size_t i = 0; i < size; i++) {
        int guess = i ? apart[i - 1] : 0;
        if (strip > 1 && i > strip)
            guess += apart[i - strip] - apart[i - strip - 1];
        difference[held++] = (int8_t)(uint8_t)(apart[i] - guess);
        if (held == run || i + 1 == size) {
            put_run(&w, difference, held);
            held = 0;
        }
    }
    put_bits(&w, 7, 0);
    return scratch_write("a.pvm", w.bytes, (w.count + 31) / 32 * 4);
}

/* The test volume's bytes under a header; returns their number. */
static size_t pvm(const char *header, sample_type type, const char *behind, uint8_t *out) {
    const size_t front = strlen(header);
    const size_t size = volumes_samples(type, true, samples);
    memcpy(out, header, front);
    memcpy(out + front, samples, size);
    if (*behind)
        memcpy(out + front + size, behind, 4);
    return front + size + (*behind ? 4 : 0);
}

static const struct {
    const char *header, *behind;
    sample_type type;
    double spacing[3];
} pvms[] = {
    {"PVM\n4 3 2\n1\n", "", SAMPLE_U8, {1, 1, 1}},
    {"PVM2\n4 3 2\n1 1.5 2\n2\n", "", SAMPLE_U16, {1, 1.5, 2}},
    {"PVM3\n4 3 2\n0.5 1 3e-1\n2\n", "d\0\0\0", SAMPLE_U16, {0.5, 1, 0.3}},
};

static void check_pvm(const char *path, int i) {
    double map[3][4] = {{0}};
    for (int a = 0; a < 3; a++)
        map[a][a] = pvms[i].spacing[a];
    volumes_check(path, NULL, pvms[i].type, (const double(*)[4])map);
    /* What is behind the samples is the format's. */
    mem m;
    volume *v = NULL;
    char slice[64];
    uint64_t trailing = 9;
    mem_init(&m, 0);
    assert_int_equal(volume_open(&m, path, NULL, &v), ST_OK);
    assert_int_equal(volume_read(v, 1, slice), ST_OK);
    assert_int_equal(volume_read(v, 1, slice), ST_OK);
    assert_int_equal(volume_finish(v, &trailing), ST_OK);
    assert_int_equal(trailing, 0);
    volume_close(v);
}

static void test_pvm(void **state) {
    (void)state;
    uint8_t file[512];
    for (int i = 0; i < 3; i++) {
        const size_t size = pvm(pvms[i].header, pvms[i].type, pvms[i].behind, file);
        const char *path = scratch_write("a.pvm", file, size);
        check_pvm(path, i);
        hurt(path, *pvms[i].behind ? 4 : 0);
        for (unsigned skip = 1; skip <= 4; skip++)
            for (int e = 0; e < 2; e++)
                for (int run = 1; run < 128; run += 21)
                    check_pvm(dds(e ? 'e' : 'd', file, size, skip, i == 1 ? 1 : 7 * skip, run), i);
        hurt(dds(i == 0 ? 'd' : 'e', file, size, (unsigned)i + 1, 12, 20), 9);
    }
}

static void test_pvm_refused(void **state) {
    (void)state;
    static const struct {
        const char *header;
        status st;
        const char *said;
    } cases[] = {
        {"PVM\n4 3\n1\n", ST_CORRUPT, "line 4"},
        {"PVM\n4 -3 2\n1\n", ST_CORRUPT, "a number of voxels"},
        {"PVM\n4 3 2\n5\n", ST_CORRUPT, "1 to 4 bytes"},
        {"PVM2\n4 3 2\n1\n", ST_CORRUPT, "line 4"},
        {"PVM2\n4 3 2\n1 0 1\n1\n", ST_CORRUPT, "do not span"},
        {"PVM\n4 3 1\n1\n", ST_UNSUPPORTED, "1 sample along z"},
        {"PVM\n4 3 9999\n1\n", ST_CORRUPT, "ends at byte"},
    };
    uint8_t file[512];
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const size_t size = pvm(cases[i].header, SAMPLE_U8, "", file);
        volumes_refused(scratch_write("a.pvm", file, size), NULL, cases[i].st, cases[i].said);
    }
    volumes_refused(dds('d', (const uint8_t *)"P", 1, 1, 1, 1), NULL, ST_CORRUPT, "expected PVM");
}

/* ---- SLC ---- */

static const double slc_map[3][4] = {{0.5, 0, 0, 0}, {0, 2, 0, 0}, {0, 0, 1.25, 0}};
enum { SLC_PLANE = 4 * 3 };

/* A slice in runs: of each byte alone, of up to `most` that follow (literal), or of equal ones. */
static size_t pack_slice(const uint8_t *from, int most, uint8_t *to) {
    size_t size = 0;
    for (int i = 0, n; i < SLC_PLANE; i += n) {
        n = SLC_PLANE - i < most ? SLC_PLANE - i : most;
        to[size] = (uint8_t)(0x80 | n);
        memcpy(to + size + 1, from + i, (size_t)n);
        if (n == 1) {
            while (i + n < SLC_PLANE && from[i + n] == from[i])
                n++;
            to[size] = (uint8_t)n;
        }
        size += to[size] & 0x80 ? (size_t)n + 1 : 2;
    }
    to[size++] = 0;
    return size;
}

/* most: 0 is not packed. */
static size_t slc(const char *head, int most, uint8_t *out) {
    size_t at = strlen(head);
    const uint8_t *bytes = (const uint8_t *)samples;
    memcpy(out, head, at);
    const size_t size = volumes_samples(SAMPLE_U8, true, samples);
    for (size_t i = 0; most && i < size; i += SLC_PLANE) {
        uint8_t packed[64];
        const size_t n = pack_slice(bytes + i, most, packed);
        at += (size_t)sprintf((char *)out + at, "%zu X", n);
        memcpy(out + at, packed, n);
        at += n;
    }
    if (most)
        return at;
    memcpy(out + at, samples, size);
    return at + size;
}

static void test_slc(void **state) {
    (void)state;
    uint8_t file[512];
    const char *plain = "11111\n4 3 2\n8\n0.5 2 1.25\n1 2 0 0\n1 2 Xrrggbb";
    const char *packed = "11111 4 3 2 8 0.500000 2.0 1.25 1 2 0 1\n0 0 X";
    const char *path = scratch_write("a.slc", file, slc(plain, 0, file));
    volumes_check(path, NULL, SAMPLE_U8, slc_map);
    hurt(path, 0);
    volumes_check(scratch_write("a", file, slc(plain, 0, file)), NULL, SAMPLE_U8, slc_map);
    for (int most = 1; most <= SLC_PLANE; most++) {
        path = scratch_write("a.slc", file, slc(packed, most, file));
        volumes_check(path, NULL, SAMPLE_U8, slc_map);
        if (most % 5 == 1)
            hurt(path, 1);
    }
}

static void test_slc_refused(void **state) {
    (void)state;
    static const struct {
        const char *text;
        status st;
        const char *said;
    } cases[] = {
        {"11111\n4 3\n", ST_CORRUPT, "a number of voxels"},
        {"11111 4 3 0 8 1 1 1 0 0 0 0 0 0 X", ST_CORRUPT, "a number of voxels"},
        {"11111 4 3 2 8 1 0 1 0 0 0 0 0 0 X", ST_CORRUPT, "do not span"},
        {"11111 4 3 2 16 1 1 1 0 0 0 0 0 0 X", ST_UNSUPPORTED, "16 bits a voxel"},
        {"11111 4 3 2 8 1 1 1 0 0 0 2 0 0 X", ST_CORRUPT, "0 or 1: how it is packed"},
        {"11111 4 3 2 8 1 1 1 0 0 0 0 -1 0 X", ST_CORRUPT, "a size of the icon"},
        {"11111 4 3 2 8 1 1 1 0 0 0 0 9 9 Xabc", ST_CORRUPT, "a.slc"},
        {"11111 4 3 2 8 1 1 1 0 0 0 0 0 0 Y", ST_CORRUPT, "expected X"},
        {"11111 4 3 2 8 1 1 1 0 0 0 1 0 0 X5 X\x0c"
         "a\x01",
         ST_CORRUPT, "ends at byte"},
        {"11111 4 3 2 8 1 1 1 0 0 0 1 0 0 X2 X\x0d"
         "abc",
         ST_CORRUPT, "more voxels"},
        {"11111 4 3 2 8 1 1 1 0 0 0 1 0 0 X2 X\x0b"
         "abc",
         ST_CORRUPT, "end before it does"},
        {"11111 4 3 2 8 1 1 1 0 0 0 1 0 0 X4 X\x0c"
         "a  9Z",
         ST_CORRUPT, "expected"},
        {"11111 4 3 2 8 1 1 1 0 0 0 1 0 0 X-1 X", ST_CORRUPT, "bytes of a packed slice"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        volumes_refused(scratch_write("a.slc", cases[i].text, strlen(cases[i].text)), NULL,
                        cases[i].st, cases[i].said);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_slc),           cmocka_unit_test(test_slc_refused),
        cmocka_unit_test(test_nifti_types),   cmocka_unit_test(test_nifti_placement),
        cmocka_unit_test(test_nifti2),        cmocka_unit_test(test_nifti_pair),
        cmocka_unit_test(test_nifti_refused), cmocka_unit_test(test_npy),
        cmocka_unit_test(test_npy_fortran),   cmocka_unit_test(test_npy_refused),
        cmocka_unit_test(test_mrc),           cmocka_unit_test(test_mrc_refused),
        cmocka_unit_test(test_mgh),           cmocka_unit_test(test_pvm),
        cmocka_unit_test(test_pvm_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
