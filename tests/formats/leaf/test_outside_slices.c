/* test_outside_slices.c - files that leave the samples of level 0 in a folder of files, a slice in
 * each: the same payloads as of a file with all; what the second reader makes of it; files that
 * change, vanish or are cut short, before and while samples are read; how many are open; sections
 * that cannot be. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <dirent.h>
#include <fcntl.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "formats/base/file.h"
#include "formats/leaf/leaf_check.h"
#include "formats/leaf/leaf_unpacker.h"
#include "formats/leaf/outside_chunks.h"
#include "tests/support/leaf_compare.h"
#include "tests/support/leaf_files.h"
#include "tests/support/naive_leaf.h"
#include "tests/support/scratch.h"

/* Slices of NX x NY samples, in strips of ROWS rows, of which the last has fewer. In each file the
 * strips lie elsewhere, backwards. */
enum { NX = 41, NY = 37, NZ = 70, ROWS = 8, STRIPS = (NY + ROWS - 1) / ROWS };
enum { CHUNKS = STRIPS * NZ, HEAD = 50, GAP = 3, FILE_ROOM = 4 * NX * NY + 2000 };

/* Samples, and the place that slices_make() fills. */
typedef struct stack {
    leaf_case c;
    chunk_array array;
    chunk_entry table[CHUNKS];
    slice_file slices[NZ];
    sample_place at;
} stack;

static uint32_t rows_of(int strip) {
    return strip < STRIPS - 1 ? ROWS : NY - ROWS * (STRIPS - 1);
}

/* Write the file of slices z .. z + count - 1. */
static void make_file(stack *s, uint32_t z, uint32_t count) {
    static uint8_t bytes[2 * FILE_ROOM];
    const size_t width = sample_size(s->c.type), row = NX * width;
    size_t used = HEAD + z % 7;
    char name[SLICE_FILE_NAME], path[SLICE_FILE_NAME + 16];
    memset(bytes, 0xab, sizeof bytes);
    snprintf(name, sizeof name, "slice %u.bin", z);
    for (uint32_t i = z; i < z + count; i++) {
        snprintf(s->slices[i].name, sizeof s->slices[i].name, "%s", name);
        for (int strip = STRIPS - 1; strip >= 0; strip--) {
            const size_t size = rows_of(strip) * row;
            const char *from =
                (const char *)s->c.samples + ((size_t)i * NY + (size_t)strip * ROWS) * row;
            memcpy(bytes + used, from, size);
            if (s->array.big_endian)
                sample_swap(s->c.type, bytes + used, size / width);
            s->table[i * STRIPS + (uint32_t)strip] = (chunk_entry){used, (uint32_t)size, 0};
            used += size + GAP;
        }
    }
    snprintf(path, sizeof path, "slices/%s", name);
    scratch_write(path, bytes, used);
}

/* Files of `each` slices (of NZ, and up to 2), with the samples of c. */
static void make(stack *s, sample_type type, bool big_endian, uint32_t each) {
    mem m;
    *s = (stack){.c = leaf_files_case(NX, NY, NZ, type)};
    s->c.samples = leaf_files_random(&s->c, 7, 0);
    s->array = (chunk_array){.axes = 3,
                             .chunk = {1, ROWS, NX},
                             .role = {ORDER_Z, ORDER_Y, ORDER_X},
                             .type = type,
                             .big_endian = big_endian,
                             .codec = ZARR_RAW,
                             .separator = '.',
                             .rows = NY};
    (void)mkdir(scratch_path("slices"), 0755);
    for (uint32_t z = 0; z < NZ; z += each)
        make_file(s, z, each);
    mem_init(&m, 0);
    assert_int_equal(slice_folder_mark(&m, scratch_path("slices"), s->slices, NZ), ST_OK);
    assert_int_equal(mem_used(&m), 0);
    s->at = (sample_place){.path = scratch_path("slices"),
                           .big_endian = big_endian,
                           .stored = {.type = type},
                           .chunks = &s->array,
                           .table = s->table,
                           .table_count = CHUNKS,
                           .slices = s->slices};
}

static const char *make_index(stack *s) {
    s->c.in_place = true;
    s->c.place = &s->at;
    const char *path = leaf_files_make(&s->c, "index.leaf");
    s->c.in_place = false;
    return path;
}

static void release(stack *s) {
    free((void *)(uintptr_t)s->c.samples);
}

/* ---- the same samples ---- */

static void test_types(void **state) {
    static const sample_type types[] = {SAMPLE_U8, SAMPLE_I16, SAMPLE_U16, SAMPLE_F32};
    static stack s;
    (void)state;
    for (int i = 0; i < 8; i++) {
        char whole[256], index[256];
        naive_leaf leaf;
        make(&s, types[i / 2], i % 2, i < 6 ? 1 : 2);
        snprintf(index, sizeof index, "%s", make_index(&s));
        snprintf(whole, sizeof whole, "%s", leaf_files_make(&s.c, "whole.leaf"));
        leaf_compare(whole, index, 0, NULL);
        leaf_compare(whole, index, 2 << 20, NULL);
        if (!naive_leaf_load(&leaf, index))
            fail_msg("%s: %s", sample_name(s.c.type), leaf.why);
        naive_leaf_release(&leaf);
        release(&s);
    }
}

/* ---- files that change ---- */

static int open_files(void) {
    DIR *folder = opendir("/proc/self/fd");
    int count = 0;
    assert_non_null(folder);
    while (readdir(folder))
        count++;
    closedir(folder);
    return count;
}

/* What goes wrong with a treelet file, from its opening on. */
typedef struct trial {
    leaf_file *f;
    leaf_unpacker *u;
    char *payload;
    mem m;
} trial;

static status begin(trial *t, const char *index) {
    mem_init(&t->m, 0);
    t->f = NULL;
    const status st = leaf_file_open(&t->m, index, &t->f);
    if (st != ST_OK)
        return st;
    assert_int_equal(leaf_unpacker_create(&t->m, t->f, &t->u), ST_OK);
    t->payload = mem_alloc(&t->m, leaf_layout_payload_max(&t->f->layout));
    assert_non_null(t->payload);
    return ST_OK;
}

/* Load all treelets. Those that fail must say this. Returns the first fault. */
static status load(trial *t, const char *said) {
    status first = ST_OK;
    uint32_t wrong = 0;
    for (uint32_t i = 0; i < t->f->layout.treelets; i++) {
        const status st = leaf_file_load(t->f, i, t->u, t->payload);
        if (st != ST_OK && !strstr(status_text(), said))
            fail_msg("\"%s\" in: %s", said, status_text());
        first = first == ST_OK ? st : first;
        wrong += st != ST_OK;
    }
    assert_true(wrong < t->f->layout.treelets);
    return first;
}

static void end(trial *t) {
    mem_free(&t->m, t->payload);
    leaf_unpacker_destroy(t->u);
    leaf_file_close(t->f);
    assert_int_equal(mem_used(&t->m), 0);
}

static void check_refused(const char *index, status expected, const char *said) {
    trial t;
    assert_int_equal(begin(&t, index), expected);
    if (!strstr(status_text(), said))
        fail_msg("\"%s\" in: %s", said, status_text());
    assert_int_equal(mem_used(&t.m), 0);
}

static void set_time(const char *path, int64_t seconds, uint32_t ns) {
    const struct timespec times[2] = {{seconds, ns}, {seconds, ns}};
    assert_int_equal(utimensat(AT_FDCWD, path, times, 0), 0);
}

static void test_opening(void **state) {
    static stack s;
    char index[256], path[256], bytes[FILE_ROOM];
    size_t size;
    trial t;
    (void)state;
    make(&s, SAMPLE_U16, false, 1);
    snprintf(index, sizeof index, "%s", make_index(&s));
    snprintf(path, sizeof path, "%s", scratch_path("slices/slice 33.bin"));
    const slice_file *then = &s.slices[33];
    const int before = open_files();
    assert_int_equal(begin(&t, index), ST_OK);
    assert_true(open_files() <= before + 2); /* this one, and perhaps a folder */
    assert_int_equal(load(&t, ""), ST_OK);
    assert_true(open_files() <= before + 2);
    end(&t);
    /* Another time, another length, none. */
    set_time(path, 1, 0);
    check_refused(index, ST_CORRUPT, "slices/slice 33.bin: has another time than when ");
    char *all = scratch_read(path, &size);
    memcpy(bytes, all, size);
    free(all);
    scratch_write("slices/slice 33.bin", bytes, size - 1);
    set_time(path, then->modified_s, then->modified_ns);
    check_refused(index, ST_CORRUPT, "slices/slice 33.bin: has ");
    assert_int_equal(remove(path), 0);
    check_refused(index, ST_IO, "index.leaf: its samples lie in another file: ");
    assert_non_null(strstr(status_text(), "slices/slice 33.bin: cannot open"));
    /* A pipe in its place is no reason to wait. */
    assert_int_equal(mkfifo(path, 0600), 0);
    check_refused(index, ST_IO, "slices/slice 33.bin: is a named pipe");
    assert_int_equal(remove(path), 0);
    /* A copy with its time is as good. */
    scratch_write("slices/slice 33.bin", bytes, size);
    set_time(path, then->modified_s, then->modified_ns);
    assert_int_equal(begin(&t, index), ST_OK);
    end(&t);
    /* Other samples, of the same length and time. */
    bytes[HEAD + 5 + 40] ^= 1;
    scratch_write("slices/slice 33.bin", bytes, size);
    set_time(path, then->modified_s, then->modified_ns);
    assert_int_equal(begin(&t, index), ST_OK);
    assert_int_equal(load(&t, "slices: a file from slice "), ST_CORRUPT);
    end(&t);
    release(&s);
}

/* Files that were as then when the index was opened. */
static void test_reading(void **state) {
    static stack s;
    char index[256], path[256];
    trial t;
    (void)state;
    make(&s, SAMPLE_U8, false, 1);
    snprintf(index, sizeof index, "%s", make_index(&s));
    snprintf(path, sizeof path, "%s", scratch_path("slices/slice 40.bin"));
    assert_int_equal(begin(&t, index), ST_OK);
    assert_int_equal(remove(path), 0);
    assert_int_equal(load(&t, "slices/slice 40.bin: cannot open"), ST_IO);
    end(&t);
    release(&s);
    make(&s, SAMPLE_U8, false, 1);
    (void)make_index(&s);
    assert_int_equal(begin(&t, index), ST_OK);
    assert_int_equal(truncate(path, 100), 0);
    set_time(path, s.slices[40].modified_s, s.slices[40].modified_ns);
    assert_int_equal(load(&t, "slices/slice 40.bin: has 100 bytes; it had "), ST_CORRUPT);
    end(&t);
    release(&s);
    make(&s, SAMPLE_U8, false, 1);
    (void)make_index(&s);
    assert_int_equal(begin(&t, index), ST_OK);
    set_time(path, 5, 0);
    assert_int_equal(load(&t, "slices/slice 40.bin: has another time than when "), ST_CORRUPT);
    end(&t);
    release(&s);
}

/* ---- many threads ---- */

enum { THREADS = 4 };

typedef struct reader {
    leaf_file *f;
    uint32_t first, wrong;
    int most;
} reader;

static void *read_all(void *ctx) {
    reader *r = ctx;
    leaf_unpacker *u = NULL;
    mem m;
    mem_init(&m, 0);
    const leaf_layout *l = &r->f->layout;
    char *payload = mem_alloc(&m, leaf_layout_payload_max(l));
    r->wrong = !payload || leaf_unpacker_create(&m, r->f, &u) != ST_OK;
    for (uint32_t i = 0; !r->wrong && i < l->treelets; i++) {
        const int open = open_files();
        r->most = open > r->most ? open : r->most;
        r->wrong += leaf_file_load(r->f, (r->first + i) % l->treelets, u, payload) != ST_OK;
    }
    leaf_unpacker_destroy(u);
    mem_free(&m, payload);
    return NULL;
}

/* With memory for few chunks, so that files are opened again and again: a file a thread, and the
 * folder that a thread counts in. */
static void test_threads(void **state) {
    static stack s;
    pthread_t threads[THREADS];
    reader readers[THREADS];
    mem m;
    (void)state;
    make(&s, SAMPLE_F32, true, 1);
    const char *index = make_index(&s);
    mem_init(&m, 700 << 10);
    leaf_file *f = leaf_compare_open(&m, index);
    const int before = open_files();
    for (uint32_t i = 0; i < THREADS; i++) {
        readers[i] = (reader){.f = f, .first = i * f->layout.treelets / THREADS};
        assert_int_equal(pthread_create(&threads[i], NULL, read_all, &readers[i]), 0);
    }
    for (int i = 0; i < THREADS; i++) {
        pthread_join(threads[i], NULL);
        assert_int_equal(readers[i].wrong, 0);
        assert_true(readers[i].most <= before + THREADS);
    }
    leaf_file_close(f);
    assert_int_equal(mem_used(&m), 0);
    release(&s);
}

/* ---- sections that cannot be ---- */

static void test_names(void **state) {
    const leaf_header h = {.dims = {4, 5, 2}};
    slice_file of[2] = {{.name = "a"}, {.name = "b", .bytes = 9}};
    static const char *const wrong[] = {"", "/etc/passwd", "a/b", "..", ".", "b/"};
    (void)state;
    assert_int_equal(leaf_check_slices("F.leaf", &h, of, 4096), ST_OK);
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        memset(of[1].name, 0, sizeof of[1].name);
        snprintf(of[1].name, sizeof of[1].name, "%s", wrong[i]);
        assert_int_equal(leaf_check_slices("F.leaf", &h, of, 4096), ST_CORRUPT);
        assert_non_null(strstr(status_text(), "F.leaf: byte 4376: expected the name"));
    }
    memset(of[1].name, 'x', sizeof of[1].name);
    assert_int_equal(leaf_check_slices("F.leaf", &h, of, 4096), ST_CORRUPT);
    of[1].name[sizeof of[1].name - 1] = 0;
    assert_int_equal(leaf_check_slices("F.leaf", &h, of, 4096), ST_OK);
    of[1].name[7] = 0;
    assert_int_equal(leaf_check_slices("F.leaf", &h, of, 4096), ST_CORRUPT);
    of[1] = (slice_file){.name = "b", .modified_ns = 1000000000};
    assert_int_equal(leaf_check_slices("F.leaf", &h, of, 4096), ST_CORRUPT);
    of[1] = (slice_file){.name = "b", .reserved = 1};
    assert_int_equal(leaf_check_slices("F.leaf", &h, of, 4096), ST_CORRUPT);
}

/* A chunk must lie in the file of its own slice; form, chunks and header must agree. */
static void test_sections(void **state) {
    leaf_header h = {.dims = {4, 5, 2},
                     .sample_type = SAMPLE_U8,
                     .outside = LEAF_IN_SLICES,
                     .outside_chunks = 4};
    leaf_outside o = {.type = SAMPLE_U8,
                      .components = 1,
                      .path = "a",
                      .form = LEAF_OUTSIDE_SLICES,
                      .axes = 3,
                      .codec = ZARR_RAW,
                      .chunk = {1, 3, 4},
                      .role = {3, 2, 1}};
    const slice_file of[2] = {{.name = "a", .bytes = 12}, {.name = "b", .bytes = 20}};
    chunk_entry e[4] = {{0, 12, 0}, {4, 8, 0}, {0, 20, 0}, {8, 12, 0}};
    (void)state;
    assert_int_equal(leaf_check_outside("F.leaf", &h, &o, 4096), ST_OK);
    assert_int_equal(leaf_check_chunks("F.leaf", &h, &o, e, of, 4096), ST_OK);
    e[1].bytes = 9;
    assert_int_equal(leaf_check_chunks("F.leaf", &h, &o, e, of, 4096), ST_CORRUPT);
    assert_non_null(strstr(status_text(), "byte 4112: expected a chunk in its file"));
    h.outside = LEAF_IN_FILE;
    assert_int_equal(leaf_check_outside("F.leaf", &h, &o, 4096), ST_CORRUPT);
    o.form = LEAF_OUTSIDE_TABLE;
    assert_int_equal(leaf_check_outside("F.leaf", &h, &o, 4096), ST_OK);
    h.outside = LEAF_IN_SLICES;
    assert_int_equal(leaf_check_outside("F.leaf", &h, &o, 4096), ST_CORRUPT);
    o.form = LEAF_OUTSIDE_SLICES;
    o.modified_s = 1;
    assert_int_equal(leaf_check_outside("F.leaf", &h, &o, 4096), ST_CORRUPT);
    o.modified_s = 0;
    o.chunk[0] = 2;
    h.outside_chunks = 2;
    assert_int_equal(leaf_check_outside("F.leaf", &h, &o, 4096), ST_CORRUPT);
    assert_non_null(strstr(status_text(), "chunks of one slice each"));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_types),   cmocka_unit_test(test_opening),
        cmocka_unit_test(test_reading), cmocka_unit_test(test_threads),
        cmocka_unit_test(test_names),   cmocka_unit_test(test_sections),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
