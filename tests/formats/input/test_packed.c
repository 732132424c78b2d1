/* test_packed.c - files packed by gzip, bzip2, xz and zstd read as they were before: in one member
 * or several, cut, damaged, within a budget; and files that only look packed stay as they are.
 */
/* marks: bits */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <bzlib.h>
#include <cmocka.h>
#include <lzma.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <zstd.h>

#include "formats/input/byte_stream.h"
#include "formats/input/unpack_stream.h"
#include "tests/support/scratch.h"
#include "tests/support/volumes.h"

enum { ROOM = 1 << 16, PACKERS = 4 };

static size_t pack_gzip(const void *data, size_t size, uint8_t *out) {
    size_t packed;
    uint8_t *bytes = volumes_deflate(data, size, true, 1, &packed);
    memcpy(out, bytes, packed);
    free(bytes);
    return packed;
}

static size_t pack_bzip2(const void *data, size_t size, uint8_t *out) {
    unsigned room = ROOM;
    char *from = (char *)(uintptr_t)data;
    assert_int_equal(BZ2_bzBuffToBuffCompress((char *)out, &room, from, (unsigned)size, 1, 0, 0),
                     BZ_OK);
    return room;
}

static size_t pack_xz(const void *data, size_t size, uint8_t *out) {
    size_t at = 0;
    assert_int_equal(lzma_easy_buffer_encode(1, LZMA_CHECK_CRC64, NULL, data, size, out, &at, ROOM),
                     LZMA_OK);
    return at;
}

/* With a checksum: what was altered is to be found. */
static size_t pack_zstd(const void *data, size_t size, uint8_t *out) {
    ZSTD_CCtx *c = ZSTD_createCCtx();
    ZSTD_CCtx_setParameter(c, ZSTD_c_checksumFlag, 1);
    const size_t packed = ZSTD_compress2(c, out, ROOM, data, size);
    ZSTD_freeCCtx(c);
    assert_false(ZSTD_isError(packed));
    return packed;
}

static const struct {
    const char *suffix;
    size_t (*pack)(const void *data, size_t size, uint8_t *out);
} packers[PACKERS] = {
    {".gz", pack_gzip}, {".bz2", pack_bzip2}, {".xz", pack_xz}, {".zst", pack_zstd}};

static const char *name_of(const char *stem, int p) {
    static char name[64];
    snprintf(name, sizeof name, "%s%s", stem, packers[p].suffix);
    return name;
}

/* Bytes that pack, but not to nothing. */
static void fill(uint8_t *data, size_t size) {
    uint32_t x = 1;
    for (size_t i = 0; i < size; i++) {
        x = x * 1664525 + 1013904223;
        data[i] = (uint8_t)((i >> 3) + (x >> 31));
    }
}

/* All of a file into out, of ROOM bytes, `step` bytes a read. */
static status read_all(mem *m, const char *path, size_t step, uint8_t *out, size_t *size) {
    byte_stream *s = NULL;
    status st = byte_stream_open(m, path, &s);
    *size = 0;
    for (size_t got = 1; st == ST_OK && got > 0; *size += got) {
        assert_true(*size + step <= ROOM);
        st = byte_stream_read(s, out + *size, step, &got);
    }
    byte_stream_close(s);
    return st;
}

static void check_reads(const char *path, const uint8_t *want, size_t size) {
    static uint8_t got[ROOM];
    for (size_t step = 1; step < 10000; step = step * 7 + 3) {
        mem m;
        mem_init(&m, 0);
        size_t count;
        assert_int_equal(read_all(&m, path, step, got, &count), ST_OK);
        assert_int_equal(count, size);
        assert_memory_equal(got, want, size);
        assert_int_equal(mem_used(&m), 0);
    }
}

static void test_members(void **state) {
    (void)state;
    static uint8_t data[20000], packed[2 * ROOM];
    fill(data, sizeof data);
    for (int p = 0; p < PACKERS; p++) {
        size_t size = packers[p].pack(data, sizeof data, packed);
        assert_true(size < sizeof data);
        check_reads(scratch_write(name_of("one", p), packed, size), data, sizeof data);
        /* Two members, one behind the other; and what is behind the last is no part of it. */
        size = packers[p].pack(data, 7000, packed);
        size += packers[p].pack(data + 7000, sizeof data - 7000, packed + size);
        memcpy(packed + size, "rest", 4);
        check_reads(scratch_write(name_of("two", p), packed, size + 4), data, sizeof data);
        size = packers[p].pack(data, 0, packed);
        check_reads(scratch_write(name_of("none", p), packed, size), data, 0);
    }
}

/* zstd's tools put frames without content between others. */
static void test_skippable(void **state) {
    (void)state;
    static uint8_t data[3000], packed[ROOM];
    fill(data, sizeof data);
    size_t size = pack_zstd(data, 1000, packed);
    memcpy(packed + size, "\x53\x2a\x4d\x18\x05\0\0\0table", 13);
    size += 13;
    size += pack_zstd(data + 1000, sizeof data - 1000, packed + size);
    check_reads(scratch_write("table.zst", packed, size), data, sizeof data);
}

/* Cut anywhere it is an error; altered anywhere it is one, or the text is the same. */
static void test_damage(void **state) {
    (void)state;
    static uint8_t data[600], packed[ROOM], got[ROOM];
    fill(data, sizeof data);
    for (int p = 0; p < PACKERS; p++) {
        const size_t size = packers[p].pack(data, sizeof data, packed);
        for (size_t at = 0; at < size; at++) {
            mem m;
            mem_init(&m, 0);
            size_t count;
            status st =
                read_all(&m, scratch_write(name_of("cut", p), packed, at), 100, got, &count);
            /* Less than the mark is no packed file. */
            assert_true(st == ST_CORRUPT || (at < PACKER_PEEK && st == ST_OK && count == at));
            packed[at] ^= 0x24;
            st = read_all(&m, scratch_write(name_of("odd", p), packed, size), 100, got, &count);
            packed[at] ^= 0x24;
            assert_true(st != ST_OK || at < PACKER_PEEK ||
                        (count == sizeof data && memcmp(got, data, count) == 0));
            assert_int_equal(mem_used(&m), 0);
        }
    }
}

/* What the libraries allocate is counted: a window that the budget does not hold is refused. */
static void test_budget(void **state) {
    (void)state;
    static uint8_t data[20000], packed[ROOM], got[ROOM];
    fill(data, sizeof data);
    for (int p = 0; p < PACKERS; p++) {
        const char *path =
            scratch_write(name_of("m", p), packed, packers[p].pack(data, sizeof data, packed));
        mem m;
        size_t count, limit;
        status st = ST_NOMEM;
        for (limit = 1024; st == ST_NOMEM; limit += 8192) {
            mem_init(&m, limit);
            st = read_all(&m, path, 1000, got, &count);
            assert_int_equal(mem_used(&m), 0);
        }
        assert_int_equal(st, ST_OK);
        assert_true(limit > 2 * BYTE_STREAM_BUFFER + 20000);
    }
}

static void test_faults(void **state) {
    (void)state;
    static uint8_t samples[8 * VOLUMES_SAMPLES], packed[ROOM];
    char text[512];
    const char *header = "NRRD0004\ntype: int16\ndimension: 3\nsizes: 4 3 2\nencoding: raw\n"
                         "endian: big\n\n";
    const size_t size = volumes_samples(SAMPLE_I16, true, samples);
    memcpy(text, header, strlen(header));
    memcpy(text + strlen(header), samples, size);
    for (int p = 0; p < PACKERS; p++) {
        const char *path = scratch_write(name_of("v.nrrd", p), packed,
                                         packers[p].pack(text, strlen(header) + size, packed));
        volumes_check(path, NULL, SAMPLE_I16, NULL);
        volumes_faults(path, NULL);
    }
}

/* Raw samples may begin as packed files do: only a name makes them one. */
static void test_names(void **state) {
    (void)state;
    static uint8_t data[2000], packed[ROOM];
    fill(data, sizeof data);
    for (int p = 0; p < PACKERS; p++) {
        const size_t size = packers[p].pack(data, sizeof data, packed);
        check_reads(scratch_write("samples.raw", packed, size), packed, size);
        /* And a name alone does not. */
        check_reads(scratch_write(name_of("plain", p), data, sizeof data), data, sizeof data);
        mem m;
        byte_stream *s = NULL;
        mem_init(&m, 0);
        assert_int_equal(byte_stream_open(&m, scratch_write(name_of("a.vtu", p), packed, size), &s),
                         ST_OK);
        assert_non_null(strstr(byte_stream_kind(s), "a.vtu"));
        assert_null(strstr(byte_stream_kind(s), packers[p].suffix));
        assert_non_null(strstr(byte_stream_path(s), packers[p].suffix));
        byte_stream_close(s);
        assert_int_equal(mem_used(&m), 0);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_members), cmocka_unit_test(test_skippable),
        cmocka_unit_test(test_damage),  cmocka_unit_test(test_budget),
        cmocka_unit_test(test_faults),  cmocka_unit_test(test_names)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
