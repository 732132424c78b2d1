/* test_chunk_cache.c - decoded chunks that several threads share: read once, kept within a budget,
 * made again when they have gone; chunks that cannot be read, or are larger than the budget. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <pthread.h>
#include <stdio.h>
#include <string.h>

#include "formats/base/fault.h"
#include "formats/grid/chunk_cache.h"
#include "tests/support/scratch.h"
#include "tests/support/zarr_files.h"

enum { SIDE = 32, CHUNKS = 4, ALL = SIDE * CHUNKS, CHUNK_BYTES = SIDE * SIDE * SIDE };

static const zarr_files files = {.axes = 3,
                                 .shape = {ALL, ALL, ALL},
                                 .chunk = {SIDE, SIDE, SIDE},
                                 .type = SAMPLE_U8,
                                 .separator = '.'};
static const chunk_array array = {.axes = 3,
                                  .chunk = {SIDE, SIDE, SIDE},
                                  .role = {ORDER_Z, ORDER_Y, ORDER_X},
                                  .separator = '.',
                                  .type = SAMPLE_U8,
                                  .codec = ZARR_RAW,
                                  .fill = {77}};
static mem m;

static chunk_cache *open_cache(const char *folder, size_t limit) {
    chunk_cache *c = NULL;
    const chunk_home in = {.path = folder, .trusted = folder};
    mem_init(&m, limit);
    assert_int_equal(chunk_cache_create(&m, &array, &in, &c), ST_OK);
    return c;
}

static void close_cache(chunk_cache *c) {
    chunk_cache_destroy(c);
    assert_int_equal(mem_used(&m), 0);
}

/* Read a box of one number in a chunk, and compare it. Returns the bytes that were read. */
static uint64_t visit(chunk_cache *c, uint32_t x, uint32_t y, uint32_t z) {
    const uint32_t first[ORDER_AXES] = {x * SIDE + 3, y * SIDE + 4, z * SIDE + 5};
    const uint32_t end[ORDER_AXES] = {first[0] + 1, first[1] + 1, first[2] + 1, 1, 1};
    const int at[ZARR_FILES_AXES] = {(int)first[2], (int)first[1], (int)first[0]};
    uint8_t number = 0;
    uint64_t read = 0;
    assert_int_equal(chunk_cache_gather(c, first, end, &number, &read), ST_OK);
    assert_int_equal(number, (int)zarr_files_value(&files, at));
    return read;
}

/* A box that many chunks meet has each number at its place. */
static void test_box(void **state) {
    static uint8_t box[20 * 70 * 90];
    const uint32_t first[ORDER_AXES] = {11, 29, 55}, end[ORDER_AXES] = {101, 99, 75, 1, 1};
    uint64_t read = 0;
    (void)state;
    chunk_cache *c = open_cache(zarr_files_make(&files, "a.zarr"), 0);
    assert_int_equal(chunk_cache_gather(c, first, end, box, &read), ST_OK);
    for (int z = 0, n = 0; z < 20; z++)
        for (int y = 0; y < 70; y++)
            for (int x = 0; x < 90; x++, n++) {
                const int at[ZARR_FILES_AXES] = {55 + z, 29 + y, 11 + x};
                assert_int_equal(box[n], (int)zarr_files_value(&files, at));
            }
    assert_int_equal(read, (uint64_t)4 * 4 * 2 * CHUNK_BYTES);
    close_cache(c);
}

/* Those not needed for longest go. The budget is a quarter: of 2 MiB a half, less what reading
 * needs. */
static void test_order(void **state) {
    enum { LIMIT = 2 << 20 };
    uint32_t kept = 0;
    (void)state;
    chunk_cache *c = open_cache(scratch_path("a.zarr"), LIMIT);
    assert_in_range(mem_used(&m), LIMIT / 4, LIMIT / 4 + (64 << 10));
    assert_int_equal(visit(c, 0, 0, 0), CHUNK_BYTES);
    /* The first stays while it is needed, however many others come. */
    for (uint32_t n = 1; n < 64; n++) {
        assert_int_equal(visit(c, n % 4, n / 4 % 4, n / 16), CHUNK_BYTES);
        assert_int_equal(visit(c, 0, 0, 0), 0);
    }
    for (uint32_t n = 63; n > 40 && visit(c, n % 4, n / 4 % 4, n / 16) == 0; n--)
        kept++;
    assert_in_range(kept, 4, LIMIT / 4 / CHUNK_BYTES - 1);
    assert_in_range(mem_peak(&m), 1, LIMIT / 4 + (64 << 10));
    close_cache(c);
}

/* A chunk without a file is the fill value, and costs nothing. One that cannot be read is tried
 * again. */
static void test_trouble(void **state) {
    const uint32_t first[ORDER_AXES] = {0}, end[ORDER_AXES] = {2, 1, 1, 1, 1};
    uint8_t numbers[2];
    uint64_t read = 0;
    char *bytes = scratch_read(scratch_path("a.zarr/0.0.0"), NULL);
    (void)state;
    chunk_cache *c = open_cache(scratch_path("a.zarr"), 0);
    scratch_write("a.zarr/0.0.0", "short", 5);
    for (int i = 0; i < 3; i++) {
        assert_int_equal(chunk_cache_gather(c, first, end, numbers, &read), ST_CORRUPT);
        assert_non_null(strstr(status_text(), "a.zarr/0.0.0: this chunk does not hold"));
    }
    assert_int_equal(read, 15);
    scratch_write("a.zarr/0.0.0", bytes, CHUNK_BYTES);
    free(bytes);
    assert_int_equal(visit(c, 0, 0, 0), CHUNK_BYTES);
    close_cache(c);
    assert_int_equal(remove(scratch_path("a.zarr/3.3.3")), 0);
    c = open_cache(scratch_path("a.zarr"), 0);
    const uint32_t far[ORDER_AXES] = {ALL - 2, ALL - 1, ALL - 1}, behind[] = {ALL, ALL, ALL, 1, 1};
    read = 0;
    assert_int_equal(chunk_cache_gather(c, far, behind, numbers, &read), ST_OK);
    assert_true(numbers[0] == 77 && numbers[1] == 77 && read == 0);
    close_cache(c);
    zarr_files_make(&files, "a.zarr");
}

/* Where an allocation fails, the call fails, or is done with what others let go; nothing is lost.
 */
static void test_faults(void **state) {
    chunk_cache *c = open_cache(scratch_path("a.zarr"), 0);
    const uint32_t first[ORDER_AXES] = {SIDE - 1}, end[ORDER_AXES] = {SIDE + 1, 1, 1, 1, 1};
    uint8_t numbers[2];
    uint64_t read = 0;
    int failed = 0;
    (void)state;
    for (int k = 1; k < 40; k++) {
        fault_arm(FAULT_ALLOC, k);
        const status st = chunk_cache_gather(c, first, end, numbers, &read);
        fault_arm(FAULT_ALLOC, 0);
        assert_true(st == ST_OK || st == ST_NOMEM);
        failed += st == ST_NOMEM;
    }
    assert_true(failed > 0);
    assert_int_equal(chunk_cache_gather(c, first, end, numbers, &read), ST_OK);
    close_cache(c);
}

/* ---- several threads ---- */

enum { THREADS = 8, ROUNDS = 400 };

typedef struct visitor {
    chunk_cache *c;
    uint32_t seed;
    uint64_t read;
} visitor;

static void *wander(void *arg) {
    visitor *v = arg;
    for (int i = 0; i < ROUNDS; i++) {
        v->seed = v->seed * 1664525 + 1013904223;
        v->read += visit(v->c, v->seed >> 30, v->seed >> 28 & 3, v->seed >> 26 & 3);
    }
    return NULL;
}

static uint64_t run_threads(size_t limit) {
    pthread_t threads[THREADS];
    visitor visitors[THREADS];
    uint64_t read = 0;
    chunk_cache *c = open_cache(scratch_path("a.zarr"), limit);
    const size_t opened = mem_peak(&m);
    for (uint32_t i = 0; i < THREADS; i++) {
        visitors[i] = (visitor){.c = c, .seed = i};
        assert_int_equal(pthread_create(&threads[i], NULL, wander, &visitors[i]), 0);
    }
    for (int i = 0; i < THREADS; i++) {
        pthread_join(threads[i], NULL);
        read += visitors[i].read;
    }
    assert_int_equal(mem_peak(&m), opened);
    close_cache(c);
    return read;
}

static void *follow(void *arg) {
    visitor *v = arg;
    for (uint32_t i = 0; i < 16; i++)
        v->read += visit(v->c, i % 4, i / 4, 0);
    return NULL;
}

/* Threads that all want the same chunk while it is made, slowly, wait for the one that makes it. */
static void test_company(void **state) {
    pthread_t threads[THREADS];
    visitor visitors[THREADS];
    uint64_t read = 0;
    (void)state;
    chunk_cache *c = open_cache(scratch_path("a.zarr"), 0);
    fault_delay(FAULT_ALLOC, 2000);
    for (int i = 0; i < THREADS; i++) {
        visitors[i] = (visitor){.c = c};
        assert_int_equal(pthread_create(&threads[i], NULL, follow, &visitors[i]), 0);
    }
    for (int i = 0; i < THREADS; i++) {
        pthread_join(threads[i], NULL);
        read += visitors[i].read;
    }
    fault_delay(FAULT_ALLOC, 0);
    assert_int_equal(read, 16 * CHUNK_BYTES);
    close_cache(c);
}

static void test_threads(void **state) {
    (void)state;
    /* Room for all: each is read by one thread, however many want it. */
    assert_int_equal(run_threads(0), (uint64_t)CHUNKS * CHUNKS * CHUNKS * CHUNK_BYTES);
    /* For some, and for one at a time. */
    assert_true(run_threads(4 << 20) > (uint64_t)CHUNKS * CHUNKS * CHUNKS * CHUNK_BYTES);
    assert_true(run_threads(250 << 10) > (uint64_t)CHUNKS * CHUNKS * CHUNKS * CHUNK_BYTES);
    mem_init(&m, 150 << 10);
    chunk_cache *c = NULL;
    const chunk_home in = {.path = "x", .trusted = "x"};
    assert_int_equal(chunk_cache_create(&m, &array, &in, &c), ST_NOMEM);
    assert_int_equal(mem_used(&m), 0);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_box),     cmocka_unit_test(test_order),
        cmocka_unit_test(test_trouble), cmocka_unit_test(test_faults),
        cmocka_unit_test(test_threads), cmocka_unit_test(test_company),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
