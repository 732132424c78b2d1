/* test_block_runs.c - blocks of nearly one size: none overlaps another, all memory goes back, and
 * where runs do not pay each block counts by itself.
 */
/* marks: threads */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <stdint.h>
#include <string.h>

#include "formats/base/block_runs.h"
#include "formats/base/fault.h"
#include "formats/base/pool.h"
#include "tests/support/watched.h"

enum { BYTES = 47104, COUNT = 400, MIB = 1 << 20 };

/* Sizes that runs hold, and some that they do not. */
static size_t size_of(size_t i) {
    static const size_t sizes[] = {BYTES, BYTES - 1, BYTES / 2 + 1, BYTES, BYTES / 2, 1, BYTES + 1};
    return sizes[i % (sizeof sizes / sizeof *sizes)];
}

typedef struct held {
    block_runs *runs;
    uint8_t *blocks[COUNT];
} held;

static void take(held *h, size_t i) {
    h->blocks[i] = block_runs_alloc(h->runs, size_of(i));
    assert_non_null(h->blocks[i]);
    assert_int_equal((uintptr_t)h->blocks[i] % 64, 0);
    memset(h->blocks[i], (int)(i % 251), size_of(i));
}

static void give(held *h, size_t i) {
    for (size_t k = 0; k < size_of(i); k++)
        assert_int_equal(h->blocks[i][k], i % 251);
    block_runs_free(h->runs, h->blocks[i], size_of(i));
}

static void test_blocks(void **state) {
    static held h;
    mem m;
    (void)state;
    mem_init(&m, 0);
    assert_int_equal(block_runs_create(&m, BYTES, COUNT, &h.runs), ST_OK);
    const size_t none = mem_used(&m);
    for (size_t round = 0; round < 3; round++) {
        for (size_t i = 0; i < COUNT; i++)
            take(&h, i);
        /* Free some, in an order of their own, and take them again. */
        for (size_t i = 0; i < COUNT; i += 3)
            give(&h, i);
        for (size_t i = 0; i < COUNT; i += 3)
            take(&h, i);
        for (size_t i = 0; i < COUNT; i++)
            give(&h, (i * 149 + round) % COUNT);
        assert_int_equal(mem_used(&m), none);
    }
    block_runs_destroy(h.runs);
    block_runs_destroy(NULL);
    assert_int_equal(mem_used(&m), 0);
}

/* The bytes in use for one block. */
static size_t taken_by_one(size_t limit, size_t bytes, size_t count) {
    block_runs *runs;
    mem m;
    mem_init(&m, limit);
    assert_int_equal(block_runs_create(&m, bytes, count, &runs), ST_OK);
    const size_t none = mem_used(&m);
    void *block = block_runs_alloc(runs, bytes);
    assert_non_null(block);
    const size_t taken = mem_used(&m) - none;
    block_runs_free(runs, block, bytes);
    assert_int_equal(mem_used(&m), none);
    block_runs_destroy(runs);
    return taken;
}

static void test_where_runs_pay(void **state) {
    (void)state;
    assert_int_equal(taken_by_one(0, BYTES, COUNT) == 2 * MIB, !WATCHED_MEMORY);
    assert_true(taken_by_one(64 * MIB, BYTES, COUNT) < BYTES + 256); /* a budget */
    assert_true(taken_by_one(0, BYTES, 10) < BYTES + 256);           /* few */
    assert_true(taken_by_one(0, MIB, COUNT) < MIB + 256);            /* large */
}

static void test_no_memory(void **state) {
    block_runs *runs;
    mem m;
    (void)state;
    for (size_t limit = 0; limit <= MIB; limit += MIB) {
        mem_init(&m, limit);
        assert_int_equal(block_runs_create(&m, BYTES, COUNT, &runs), ST_OK);
        fault_arm(FAULT_ALLOC, 1);
        assert_null(block_runs_alloc(runs, BYTES));
        assert_non_null(strstr(status_text(), "47104 bytes"));
        fault_arm(FAULT_ALLOC, 0);
        void *block = block_runs_alloc(runs, BYTES);
        assert_non_null(block);
        block_runs_free(runs, block, BYTES);
        block_runs_destroy(runs);
        assert_int_equal(mem_used(&m), 0);
    }
}

/* Threads that free what others took. */
static status take_and_give(void *ctx, size_t index, int worker) {
    held *h = ctx;
    (void)worker;
    for (int round = 0; round < 20; round++) {
        uint8_t *block = block_runs_alloc(h->runs, BYTES);
        if (!block)
            return ST_NOMEM;
        memset(block, (int)index, BYTES);
        for (size_t k = 0; k < BYTES; k += 997)
            if (block[k] != (uint8_t)index)
                return ST_CORRUPT;
        block_runs_free(h->runs, block, BYTES);
    }
    block_runs_free(h->runs, h->blocks[index], BYTES);
    return ST_OK;
}

static void test_threads(void **state) {
    static held h;
    mem m;
    pool *p;
    (void)state;
    mem_init(&m, 0);
    assert_int_equal(pool_create(&m, 4, &p), ST_OK);
    const size_t none = mem_used(&m);
    assert_int_equal(block_runs_create(&m, BYTES, COUNT, &h.runs), ST_OK);
    for (size_t i = 0; i < COUNT; i++)
        h.blocks[i] = block_runs_alloc(h.runs, BYTES);
    assert_int_equal(pool_run(p, COUNT, take_and_give, &h), ST_OK);
    block_runs_destroy(h.runs);
    assert_int_equal(mem_used(&m), none);
    pool_destroy(p);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_blocks),
        cmocka_unit_test(test_where_runs_pay),
        cmocka_unit_test(test_no_memory),
        cmocka_unit_test(test_threads),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
