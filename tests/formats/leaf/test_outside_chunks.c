/* test_outside_chunks.c - files that leave the samples of level 0 in the chunks of an array: the
 * same payloads as of a file with all, whatever the array; what the second reader makes of them;
 * chunks that change; sections that cannot be. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <fcntl.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

#include "formats/grid/volume.h"
#include "formats/leaf/leaf_check.h"
#include "formats/leaf/leaf_unpacker.h"
#include "formats/leaf/outside_chunks.h"
#include "formats/leaf/outside_samples.h"
#include "prep/grid/convert.h"
#include "tests/support/leaf_compare.h"
#include "tests/support/leaf_files.h"
#include "tests/support/naive_leaf.h"
#include "tests/support/scratch.h"
#include "tests/support/zarr_files.h"

static const zarr_files plain = {
    .axes = 3, .shape = {34, 37, 40}, .chunk = {10, 16, 13}, .type = SAMPLE_U8, .separator = '.'};

static uint32_t cells_log2 = 4;

/* Convert an array; in place or not. given: a place instead of its own; NULL: its own. */
static const char *convert_at(const char *input, const volume_hints *hints, const char *name,
                              bool in_place, const sample_place *given) {
    leaf_case c = leaf_files_case(2, 2, 2, SAMPLE_U8);
    convert_options o = c.options;
    convert_plan plan;
    convert_result result;
    leaf_outside outside;
    sample_place at;
    volume *v = NULL;
    mem m;
    mem_init(&m, 0);
    status st = volume_open(&m, input, hints, &v);
    if (st == ST_OK && in_place) {
        assert_true(volume_place(v, &at));
        at = given ? *given : at;
        o.file.chunks = at.table;
        o.file.chunk_count = at.table_count;
        leaf_parameters_compress(&o.file, 1);
        o.file.outside = &outside;
        st = outside_samples_describe(&m, &at, scratch_path(name), &outside);
    }
    o.force = true;
    o.file.cells_log2 = cells_log2;
    if (st == ST_OK)
        st = convert_plan_make(&m, volume_grid(v), &o, &plan);
    if (st == ST_OK)
        st = convert_run(&m, v, scratch_path(name), &o, &plan, NULL, &result);
    volume_close(v);
    if (st != ST_OK)
        fail_msg("%s", status_text());
    assert_int_equal(mem_used(&m), 0);
    return scratch_path(name);
}

static const char *convert(const char *input, const volume_hints *hints, const char *name,
                           bool in_place) {
    return convert_at(input, hints, name, in_place, NULL);
}

/* Convert an array both ways, and compare; the second reader reads both. */
static uint64_t check_case(const zarr_files *z, const volume_hints *hints, size_t limit) {
    char whole[256], index[256];
    naive_leaf leaf;
    const char *input = zarr_files_make(z, "a.zarr");
    snprintf(whole, sizeof whole, "%s", convert(input, hints, "whole.leaf", false));
    snprintf(index, sizeof index, "%s", convert(input, hints, "index.leaf", true));
    const uint64_t read = leaf_compare(whole, index, limit, NULL);
    if (!naive_leaf_load(&leaf, index))
        fail_msg("%s: %s", sample_name(z->type), leaf.why);
    naive_leaf_release(&leaf);
    return read;
}

static void test_types(void **state) {
    static const sample_type types[] = {SAMPLE_U8,  SAMPLE_I8,  SAMPLE_U16, SAMPLE_I16, SAMPLE_F32,
                                        SAMPLE_U32, SAMPLE_I32, SAMPLE_F64, SAMPLE_U64, SAMPLE_I64};
    static const char *const packers[] = {NULL, "zlib", "zstd"};
    (void)state;
    for (size_t i = 0; i < sizeof types / sizeof *types; i++)
        for (int how = 0; how < 8; how++) {
            zarr_files z = plain;
            z.type = types[i];
            z.big_endian = how & 1;
            z.fortran = how >> 1 & 1;
            z.shuffled = how >> 2 & 1;
            z.separator = how & 1 ? '/' : '.';
            z.packer = packers[(i + (size_t)how) % 3];
            z.absent = how == 5 ? 3 : 0;
            const volume_hints hints = {.has_missing = how == 6 && sample_size(z.type) < 4,
                                        .missing = 25};
            check_case(&z, &hints, 0);
        }
}

static void test_axes(void **state) {
    static const zarr_files cases[] = {
        {4, {34, 21, 22, 3}, {9, 7, 22, 2}, SAMPLE_U8, false, false, '.', NULL, false, 0},
        {4, {5, 20, 21, 22}, {2, 7, 30, 5}, SAMPLE_I16, true, true, '.', "zlib", false, 0},
        {5, {3, 4, 20, 21, 22}, {2, 3, 7, 30, 5}, SAMPLE_F32, true, false, '/', NULL, true, 4},
        {3, {20, 21, 22}, {1, 1, 1}, SAMPLE_U16, true, false, '.', NULL, false, 0},
        {3, {20, 21, 22}, {100, 100, 100}, SAMPLE_U16, false, false, '.', "zstd", false, 0},
        {3, {70, 66, 20}, {3, 40, 200}, SAMPLE_U8, false, true, '.', NULL, false, 2}};
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        for (uint32_t component = 0; component < (cases[i].axes > 3 ? 3U : 1U); component++) {
            volume_hints hints = {.step = i == 1 || i == 2 ? 2 : 0};
            hints.component = i == 1 ? 0 : component;
            check_case(&cases[i], &hints, 0);
        }
}

/* Boxes that are gathered in several parts. */
static void test_parts(void **state) {
    const zarr_files z = {
        4, {70, 67, 68, 3}, {33, 34, 35, 3}, SAMPLE_F64, false, false, '.', NULL, false, 0};
    (void)state;
    cells_log2 = 6;
    check_case(&z, NULL, 0);
    cells_log2 = 4;
}

/* A whole layer of chunks in memory: each is read once. Room for one: as often as boxes need it. */
static void test_reading(void **state) {
    zarr_files z = plain;
    (void)state;
    z.type = SAMPLE_U16;
    const uint64_t chunk = 2 * 10 * 16 * 13, all = 4 * 3 * 4 * chunk;
    assert_int_equal(check_case(&z, NULL, 0), all);
    assert_true(check_case(&z, NULL, 400 << 10) >= all);
    z.chunk[0] = z.chunk[1] = z.chunk[2] = 64;
    assert_int_equal(check_case(&z, NULL, 0), 2 * 64 * 64 * 64);
    /* One chunk of 512 KiB, with no room for more than that. */
    assert_int_equal(check_case(&z, NULL, 1 << 20), 2 * 64 * 64 * 64);
}

/* ---- all chunks in one file ---- */

enum { TABLE = 4 * 3 * 4 };

/* Put the chunks of an array, stored in four ways, behind each other: with or without the filter,
 * packed or not, with or without a checksum; each seventh is not there. */
static void make_table(const zarr_files *z, chunk_entry table[TABLE]) {
    static const char *const names[] = {"t0.zarr", "t1.zarr", "t2.zarr", "t3.zarr"};
    char *all = malloc(1 << 20);
    size_t used = 100, size;
    assert_non_null(all);
    memset(all, 1, 1 << 20);
    for (int how = 0; how < 4; how++) {
        zarr_files stored = *z;
        stored.shuffled = !(how & 1);
        stored.packer = how & 2 ? NULL : "zlib";
        stored.absent = 0;
        zarr_files_make(&stored, names[how]);
    }
    for (unsigned n = 0; n < TABLE; n++) {
        char path[512];
        const bool summed = n % 5;
        snprintf(path, sizeof path, "%s/%u.%u.%u", scratch_path(names[n % 4]), n / 12, n / 4 % 3,
                 n % 4);
        char *bytes = scratch_read(path, &size);
        memcpy(all + used, bytes, size);
        free(bytes);
        size += summed ? 4 : 0;
        table[n] = (chunk_entry){used, (uint32_t)size, n % 4 | (summed ? 0 : 4)};
        if ((n / 12 + 4 * (n / 4 % 3 + 3 * (n % 4))) % (unsigned)z->absent == 0)
            table[n] = (chunk_entry){0};
        used += size + 3;
    }
    scratch_write("all.chunks", all, used);
    free(all);
}

static void test_table(void **state) {
    char whole[256], index[256];
    chunk_entry table[TABLE];
    zarr_files z = plain;
    naive_leaf leaf;
    leaf_file *f = NULL;
    mem m;
    (void)state;
    z.type = SAMPLE_I16;
    z.big_endian = true;
    z.absent = 7;
    make_table(&z, table);
    const zarr_number number = {SAMPLE_I16, true};
    const chunk_array array = {
        .axes = 3,
        .chunk = {10, 16, 13},
        .role = {ORDER_Z, ORDER_Y, ORDER_X},
        .type = SAMPLE_I16,
        .big_endian = true,
        .codec = ZARR_STREAM,
        .summed = true,
        .filters = {1, {{.kind = 0, .plain = number, .coded = number, .element = 2}}},
        .fill = {9}};
    const char *input = zarr_files_make(&z, "a.zarr");
    const sample_place at = {.path = scratch_path("all.chunks"),
                             .big_endian = true,
                             .stored = {.type = SAMPLE_I16},
                             .chunks = &array,
                             .table = table,
                             .table_count = TABLE};
    snprintf(whole, sizeof whole, "%s", convert(input, NULL, "whole.leaf", false));
    snprintf(index, sizeof index, "%s", convert_at(input, NULL, "index.leaf", true, &at));
    leaf_compare(whole, index, 0, NULL);
    leaf_compare(whole, index, 5 << 20, NULL);
    if (!naive_leaf_load(&leaf, index))
        fail_msg("%s", leaf.why);
    naive_leaf_release(&leaf);
    mem_init(&m, 0);
    assert_int_equal(leaf_file_open(&m, index, &f), ST_OK);
    assert_int_equal(f->header.outside_chunks, TABLE);
    assert_memory_equal(f->chunks, table, sizeof table);
    assert_non_null(strstr(outside_samples_path(f->samples), "all.chunks"));
    leaf_file_close(f);
    assert_int_equal(mem_used(&m), 0);
}

/* ---- strips of pages ---- */

enum { STRIP = 5, STRIPS = (37 + STRIP - 1) / STRIP, ROW = 40 };

/* A strip of a page: big endian, differences along rows or not, packed or not. Returns its bytes.
 */
static size_t make_strip(const zarr_files *z, int slice, int strip, int rows, bool packed,
                         bool differences, uint8_t *out) {
    uint8_t numbers[2 * STRIP * ROW], *to = packed ? numbers : out;
    for (int y = 0; y < rows; y++)
        for (int x = 0; x < ROW; x++) {
            const int at[ZARR_FILES_AXES] = {slice, strip * STRIP + y, x};
            const int before[ZARR_FILES_AXES] = {slice, strip * STRIP + y, x - 1};
            unsigned v = (unsigned)zarr_files_value(z, at);
            if (differences && x > 0)
                v -= (unsigned)zarr_files_value(z, before);
            to[2 * (y * ROW + x)] = (uint8_t)(v >> 8);
            to[2 * (y * ROW + x) + 1] = (uint8_t)v;
        }
    uLongf size = compressBound(sizeof numbers);
    if (packed)
        assert_int_equal(compress(out, &size, numbers, (uLong)(2 * rows * ROW)), Z_OK);
    return packed ? size : (size_t)(2 * rows * ROW);
}

/* Slices in strips, of which the last has fewer rows, or as many: then what is in them is not
 * looked at. */
static void check_strips(bool packed, bool differences, bool fill_last) {
    static chunk_entry table[34 * STRIPS];
    char whole[256], index[256];
    zarr_files z = plain;
    naive_leaf leaf;
    size_t used = 10;
    z.type = SAMPLE_U16;
    uint8_t *all = malloc(1 << 20);
    assert_non_null(all);
    memset(all, 7, 1 << 20);
    for (int n = 0; n < 34 * STRIPS; n++) {
        const int left = 37 - n % STRIPS * STRIP, rows = left < STRIP && !fill_last ? left : STRIP;
        const size_t size =
            make_strip(&z, n / STRIPS, n % STRIPS, rows, packed, differences, all + used);
        table[n] = (chunk_entry){used, (uint32_t)size, 0};
        used += size + 1;
    }
    scratch_write("pages", all, used);
    free(all);
    const zarr_number number = {SAMPLE_U16, true};
    const zarr_filter rows = {
        .kind = ZARR_FILTER_ROWS, .plain = number, .coded = number, .element = 1, .row = ROW};
    const chunk_array array = {.axes = 3,
                               .chunk = {1, STRIP, ROW},
                               .role = {ORDER_Z, ORDER_Y, ORDER_X},
                               .type = SAMPLE_U16,
                               .big_endian = true,
                               .codec = packed ? ZARR_STREAM : ZARR_RAW,
                               .filters = {differences, {rows}},
                               .rows = 37};
    const char *input = zarr_files_make(&z, "a.zarr");
    const sample_place at = {.path = scratch_path("pages"),
                             .big_endian = true,
                             .stored = {.type = SAMPLE_U16},
                             .chunks = &array,
                             .table = table,
                             .table_count = 34 * STRIPS};
    snprintf(whole, sizeof whole, "%s", convert(input, NULL, "whole.leaf", false));
    snprintf(index, sizeof index, "%s", convert_at(input, NULL, "index.leaf", true, &at));
    leaf_compare(whole, index, 0, NULL);
    leaf_compare(whole, index, 5 << 20, NULL);
    if (!naive_leaf_load(&leaf, index))
        fail_msg("%s", leaf.why);
    naive_leaf_release(&leaf);
}

static void test_strips(void **state) {
    (void)state;
    for (int how = 0; how < 8; how++)
        check_strips(how & 1, how >> 1 & 1, how >> 2);
}

/* ---- several threads ---- */

enum { THREADS = 6 };

typedef struct reader {
    leaf_file *f;
    mem *m;
    const uint64_t *sums;
    uint32_t first;
    uint64_t read;
    int wrong;
} reader;

static void *read_all(void *arg) {
    reader *r = arg;
    const leaf_layout *l = &r->f->layout;
    leaf_unpacker *u = NULL;
    char *payload = mem_alloc(r->m, leaf_layout_payload_max(l));
    r->wrong = !payload || leaf_unpacker_create(r->m, r->f, &u) != ST_OK;
    for (uint32_t i = 0; !r->wrong && i < l->treelets; i++) {
        const uint32_t t = (r->first + i) % l->treelets;
        r->wrong += leaf_file_load(r->f, t, u, payload) != ST_OK;
    }
    r->read = leaf_unpacker_take(u);
    leaf_unpacker_destroy(u);
    mem_free(r->m, payload);
    return NULL;
}

/* Threads that begin at different treelets of one file, whose budget keeps all chunks, some, or
 * one. Checksums tell whether samples are right. */
static void test_threads(void **state) {
    const size_t limits[] = {0, 2 << 20, 700 << 10};
    zarr_files z = plain;
    (void)state;
    z.shape[0] = 80;
    z.chunk[0] = z.chunk[1] = z.chunk[2] = 30;
    z.shuffled = true;
    z.type = SAMPLE_U16;
    const char *index = convert(zarr_files_make(&z, "a.zarr"), NULL, "index.leaf", true);
    for (size_t k = 0; k < sizeof limits / sizeof *limits; k++) {
        pthread_t threads[THREADS];
        reader readers[THREADS];
        uint64_t read = 0;
        mem m, other;
        mem_init(&m, limits[k]);
        mem_init(&other, 0);
        leaf_file *f = leaf_compare_open(&m, index);
        const size_t opened = mem_peak(&m);
        for (uint32_t i = 0; i < THREADS; i++) {
            readers[i] = (reader){.f = f, .m = &other, .first = i * f->layout.treelets / THREADS};
            assert_int_equal(pthread_create(&threads[i], NULL, read_all, &readers[i]), 0);
        }
        for (int i = 0; i < THREADS; i++) {
            pthread_join(threads[i], NULL);
            assert_int_equal(readers[i].wrong, 0);
            read += readers[i].read;
        }
        const uint64_t all = 3 * 2 * 2 * 2 * 30 * 30 * 30;
        /* Shells of level 1 count, too. */
        assert_true(read >= all);
        if (k == 0)
            assert_true(read < all + 200000);
        /* The room for chunks was counted when the file was opened. */
        if (limits[k])
            assert_int_equal(mem_peak(&m), opened);
        leaf_file_close(f);
        assert_int_equal(mem_used(&m) + mem_used(&other), 0);
    }
}

/* ---- changes ---- */

static status load_all(const char *index, const char *said) {
    leaf_unpacker *u = NULL;
    leaf_file *f = NULL;
    uint32_t wrong = 0;
    mem m;
    mem_init(&m, 0);
    status first = leaf_file_open(&m, index, &f);
    if (first != ST_OK)
        return first;
    assert_int_equal(leaf_unpacker_create(&m, f, &u), ST_OK);
    char *payload = mem_alloc(&m, leaf_layout_payload_max(&f->layout));
    for (uint32_t t = 0; t < f->layout.treelets; t++) {
        const status st = leaf_file_load(f, t, u, payload);
        if (st != ST_OK && !strstr(status_text(), said))
            fail_msg("\"%s\" in: %s", said, status_text());
        first = first == ST_OK ? st : first;
        wrong += st != ST_OK;
    }
    assert_true(wrong < f->layout.treelets);
    mem_free(&m, payload);
    leaf_unpacker_destroy(u);
    leaf_file_close(f);
    assert_int_equal(mem_used(&m), 0);
    return first;
}

static void test_changes(void **state) {
    char index[256], outside[256];
    zarr_files z = plain;
    char bytes[10 * 16 * 13] = {1, 2, 3};
    (void)state;
    const char *input = zarr_files_make(&z, "a.zarr");
    snprintf(index, sizeof index, "%s", convert(input, NULL, "index.leaf", true));
    assert_int_equal(load_all(index, ""), ST_OK);
    scratch_write("a.zarr/1.1.1", bytes, sizeof bytes);
    assert_int_equal(load_all(index, "a.zarr: chunks "), ST_CORRUPT);
    assert_non_null(strstr(status_text(), "the samples of treelet"));
    scratch_write("a.zarr/1.1.1", bytes, 100);
    assert_int_equal(load_all(index, "a.zarr/1.1.1: this chunk does not hold"), ST_CORRUPT);
    assert_int_equal(remove(scratch_path("a.zarr/1.1.1")), 0);
    assert_int_equal(load_all(index, ", of which 1.1.1 is not there: the samples of"), ST_CORRUPT);
    assert_int_equal(remove(scratch_path("a.zarr/1.2.1")), 0);
    assert_int_equal(load_all(index, " not there: the samples of"), ST_CORRUPT);
    /* A link that leaves the folder is not followed, as in a conversion. */
    zarr_files_make(&z, "a.zarr");
    snprintf(index, sizeof index, "%s", convert(input, NULL, "index.leaf", true));
    snprintf(outside, sizeof outside, "%s", scratch_path("moved"));
    assert_int_equal(rename(scratch_path("a.zarr/1.1.1"), outside), 0);
    assert_int_equal(symlink(outside, scratch_path("a.zarr/1.1.1")), 0);
    assert_int_equal(load_all(index, "1.1.1: lies outside of its folder, which was not allowed"),
                     ST_UNSUPPORTED);
    const volume_hints trusting = {.trust = {.follow_links = true}};
    snprintf(index, sizeof index, "%s", convert(input, &trusting, "index.leaf", true));
    assert_int_equal(load_all(index, ""), ST_OK);
    /* Links within the folder that the user gave are its own. */
    mkdir(scratch_path("group"), 0755);
    scratch_text("group/.zgroup", "{\"zarr_format\": 2}");
    (void)remove(scratch_path("a.zarr/1.1.1"));
    assert_int_equal(rename(scratch_path("a.zarr"), scratch_path("group/a")), 0);
    assert_int_equal(rename(outside, scratch_path("group/chunk")), 0);
    assert_int_equal(symlink("../chunk", scratch_path("group/a/1.1.1")), 0);
    snprintf(index, sizeof index, "%s", convert(scratch_path("group"), NULL, "index.leaf", true));
    assert_int_equal(load_all(index, ""), ST_OK);
}

/* The array's description must be the same, in size and bytes; its time does not count. */
static void test_description(void **state) {
    zarr_files z = plain;
    struct stat info;
    size_t size;
    (void)state;
    const char *input = zarr_files_make(&z, "b.zarr");
    const char *index = convert(input, NULL, "index.leaf", true);
    const char *json = scratch_path("b.zarr/.zarray");
    assert_int_equal(stat(json, &info), 0);
    const struct timespec then[2] = {info.st_atim, info.st_mtim}, other[2] = {{1, 0}, {1, 0}};
    assert_int_equal(utimensat(AT_FDCWD, json, other, 0), 0);
    assert_int_equal(load_all(index, ""), ST_OK);
    char *text = scratch_read(json, &size);
    *strstr(text, "\"fill_value\": 9") = ' '; /* any change at all */
    scratch_write("b.zarr/.zarray", text, size);
    assert_int_equal(utimensat(AT_FDCWD, json, then, 0), 0);
    assert_int_equal(load_all(index, ""), ST_CORRUPT);
    assert_non_null(strstr(status_text(), "b.zarr/.zarray: is another one than when"));
    scratch_write("b.zarr/.zarray", text, size - 1);
    assert_int_equal(load_all(index, ""), ST_CORRUPT);
    assert_non_null(strstr(status_text(), "b.zarr/.zarray: has "));
    assert_int_equal(remove(json), 0);
    assert_int_equal(load_all(index, ""), ST_IO);
    free(text);
}

/* ---- sections that cannot be ---- */

static leaf_outside section = {
    .file_bytes = 1000,
    .type = SAMPLE_U16,
    .components = 2,
    .component = 1,
    .path = "a/.zarray",
    .form = LEAF_OUTSIDE_FILES,
    .axes = 4,
    .codec = ZARR_STREAM,
    .filters = 1,
    .chunk = {10, 20, 30, 2},
    .role = {3, 2, 1, 4},
    .filter = {{.kind = 1, .element = 2, .type = SAMPLE_U16, .coded_type = SAMPLE_U16}}};

static status check_section(const leaf_outside *o) {
    const leaf_header h = {.dims = {4, 5, 6}, .sample_type = SAMPLE_U16};
    return leaf_check_outside("F.leaf", &h, o, 8192);
}

static void test_sections(void **state) {
    (void)state;
    assert_int_equal(check_section(&section), ST_OK);
#define AT(field) offsetof(leaf_outside, field)
    const struct {
        size_t at;
        uint32_t value;
        const char *said;
    } wrong[] = {{AT(form), 0, "byte 122"},
                 {AT(form), 3, "chunks of one slice each"},
                 {AT(form), 4, "byte 12288: "},
                 {AT(form), 2, "byte 1500: expected 1 chunks in a table, found 0"},
                 {AT(axes), 2, "byte 12292: "},
                 {AT(axes), 9, "byte 12292: "},
                 {AT(axes), 3, "a size of chunks for each axis, and no more"},
                 {AT(axes), 5, "a size of chunks for each axis, and no more"},
                 {AT(chunk_flags), 32, "byte 12296: "},
                 {AT(codec), 0, "byte 12300: "},
                 {AT(codec), 6, "byte 12300: "},
                 {AT(filters), 9, "byte 12304: "},
                 {AT(filters), 2, "byte 12440: "},
                 {AT(filters), 0, "byte 12400: "},
                 {AT(step), 1, "an axis each for x, y, z"},
                 {AT(step), 1U << 31, "byte 12308: "},
                 {AT(reserved1), 1, "byte 12316: "},
                 {AT(chunk), 0, "a size of chunks for each axis"},
                 {AT(chunk), 1U << 31, "byte 12336: "},
                 {AT(chunk), INT32_MAX, "chunks of at most 2^32 bytes"},
                 {AT(role), 1, "an axis each for x, y, z"},
                 {AT(role), 5, "an axis each for x, y, z"},
                 {AT(role), 6, "byte 12368: "},
                 {AT(role) + 12, 0, "an axis each for x, y, z"},
                 {AT(role) + 16, 5, "a size of chunks for each axis, and no more"},
                 {AT(filter), 0, "byte 12400: "},
                 {AT(filter), 7, "byte 12400: "},
                 {AT(filter) + 4, 257, "filters that can be undone"},
                 {AT(filter) + 8, SAMPLE_I16, "filters that can be undone"},
                 {AT(filter) + 8, 0, "byte 12408: "},
                 {AT(filter) + 12, SAMPLE_U8, "filters that can be undone"},
                 {AT(filter) + 12, 12, "byte 12412: "},
                 {AT(filter) + 16, 4, "byte 12416: "},
                 {AT(filter) + 20, 1, "byte 12420: "},
                 {AT(filter) + 40 + 24, 1, "byte 12464: "},
                 {AT(reserved2) + 76, 1, "byte 12796: "},
                 {AT(offset), 1, "are described in a file"},
                 {AT(file_bytes), 1 << 23, "are described in a file"}};
#undef AT
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        leaf_outside o = section;
        memcpy((char *)&o + wrong[i].at, &wrong[i].value, sizeof wrong[i].value);
        assert_int_equal(check_section(&o) == ST_OK, false);
        if (!strstr(status_text(), wrong[i].said))
            fail_msg("%zu: \"%s\" in: %s", i, wrong[i].said, status_text());
    }
    leaf_outside o = section;
    o.filter[0].kind = 3;
    assert_int_equal(check_section(&o), ST_CORRUPT); /* a scale of 0 */
    o.filter[0].scale = 2;
    assert_int_equal(check_section(&o), ST_OK);
}

static void test_entries(void **state) {
    const leaf_header h = {.dims = {4, 5, 6}, .sample_type = SAMPLE_U16, .outside_chunks = 2};
    leaf_outside o = section;
    chunk_entry e[2] = {{0, 0, 0}, {900, 100, 7}};
    (void)state;
    o.form = LEAF_OUTSIDE_TABLE;
    assert_int_equal(leaf_check_chunks("F.leaf", &h, &o, e, NULL, 4096), ST_OK);
    const chunk_entry wrong[] = {{1, 0, 0},          {0, 0, 1},    {900, 101, 0},
                                 {UINT64_MAX, 1, 0}, {1001, 1, 0}, {0, 9, 8}};
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        e[1] = wrong[i];
        assert_int_equal(leaf_check_chunks("F.leaf", &h, &o, e, NULL, 4096), ST_CORRUPT);
        assert_non_null(strstr(status_text(), "byte 4112: "));
    }
    /* What only chunks in files have. */
    const leaf_header one = {.dims = {4, 5, 6}, .sample_type = SAMPLE_U16, .outside_chunks = 1};
    assert_int_equal(leaf_check_outside("F.leaf", &one, &o, 4096), ST_OK);
    assert_int_equal(leaf_check_outside("F.leaf", &h, &o, 4096), ST_CORRUPT);
    o.chunk_flags = LEAF_CHUNKS_LINKS;
    assert_int_equal(leaf_check_outside("F.leaf", &one, &o, 4096), ST_CORRUPT);
    o.chunk_flags = 0;
    o.sum = 1;
    assert_int_equal(leaf_check_outside("F.leaf", &one, &o, 4096), ST_CORRUPT);
    o.sum = 0;
    o.levels_up = 1;
    assert_int_equal(leaf_check_outside("F.leaf", &one, &o, 4096), ST_CORRUPT);
    o.levels_up = 0;
    /* Rows may be missing where y is slowest, and of what can end early. */
    o.chunk_flags = LEAF_CHUNKS_CUT;
    assert_int_equal(leaf_check_outside("F.leaf", &one, &o, 4096), ST_CORRUPT);
    assert_non_null(strstr(status_text(), "chunks that can lack rows"));
    o.chunk[0] = 1;
    leaf_header six = one;
    six.outside_chunks = 6;
    assert_int_equal(leaf_check_outside("F.leaf", &six, &o, 4096), ST_OK);
    o.codec = ZARR_LZF;
    assert_int_equal(leaf_check_outside("F.leaf", &six, &o, 4096), ST_CORRUPT);
    o.codec = ZARR_RAW;
    assert_int_equal(leaf_check_outside("F.leaf", &six, &o, 4096), ST_OK);
    o.chunk_flags |= LEAF_CHUNKS_FORTRAN;
    assert_int_equal(leaf_check_outside("F.leaf", &six, &o, 4096), ST_CORRUPT);
    o.chunk_flags = LEAF_CHUNKS_CUT;
    o.filter[0].kind = ZARR_FILTER_ROWS + 1;
    o.filter[0].row = 60;
    assert_int_equal(leaf_check_outside("F.leaf", &six, &o, 4096), ST_OK);
    const uint32_t rows[] = {0, 61, 120, 1U << 31};
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        o.filter[0].row = rows[i];
        assert_int_equal(leaf_check_outside("F.leaf", &six, &o, 4096) == ST_OK, false);
    }
    o.filter[0].row = 60;
    o.filter[0].element = 7;
    assert_int_equal(leaf_check_outside("F.leaf", &six, &o, 4096), ST_CORRUPT);
    o.filter[0].element = 2;
    o.form = LEAF_OUTSIDE_FILES;
    assert_int_equal(leaf_check_outside("F.leaf", &h, &o, 4096), ST_CORRUPT);
}

/* A description of chunks that no memory holds, and that are not there, is no harm. */
static void test_budget(void **state) {
    zarr_files z = plain;
    leaf_file *f = NULL;
    mem m;
    (void)state;
    z.chunk[0] = z.chunk[1] = z.chunk[2] = 64;
    const char *index = convert(zarr_files_make(&z, "a.zarr"), NULL, "index.leaf", true);
    mem_init(&m, 300 << 10);
    assert_int_equal(leaf_file_open(&m, index, &f), ST_NOMEM);
    assert_int_equal(mem_used(&m), 0);
    mem_init(&m, 600 << 10);
    assert_int_equal(leaf_file_open(&m, index, &f), ST_OK);
    leaf_file_close(f);
    assert_int_equal(mem_used(&m), 0);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_types),    cmocka_unit_test(test_axes),
        cmocka_unit_test(test_table),    cmocka_unit_test(test_entries),
        cmocka_unit_test(test_strips),   cmocka_unit_test(test_parts),
        cmocka_unit_test(test_reading),  cmocka_unit_test(test_threads),
        cmocka_unit_test(test_changes),  cmocka_unit_test(test_description),
        cmocka_unit_test(test_sections), cmocka_unit_test(test_budget),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
