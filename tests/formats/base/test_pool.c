/* test_pool.c - loops shared out to threads: every index once, errors told, threads that cannot be
 * made.
 */
/* marks: threads, bits */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <stdatomic.h>
#include <stdio.h>
#include <string.h>

#include "formats/base/fault.h"
#include "formats/base/pool.h"

enum { INDICES = 1000, MOST_THREADS = 8 };

typedef struct tally {
    atomic_int seen[INDICES];
    atomic_int bad_worker;
    int threads;
    size_t failing; /* this index and all behind it fail; INDICES: none */
} tally;

static status count(void *ctx, size_t index, int worker) {
    tally *t = ctx;
    atomic_fetch_add(&t->seen[index], 1);
    if (worker < 0 || worker >= t->threads)
        atomic_fetch_add(&t->bad_worker, 1);
    if (index >= t->failing)
        return status_describe(ST_CORRUPT, "index %zu", index);
    return ST_OK;
}

static void reset(tally *t, int threads, size_t failing) {
    memset(t, 0, sizeof *t);
    t->threads = threads;
    t->failing = failing;
}

static void test_every_index_once(void **state) {
    (void)state;
    static tally t;
    mem m;
    mem_init(&m, 0);
    for (int threads = 1; threads <= MOST_THREADS; threads++) {
        pool *p;
        assert_int_equal(pool_create(&m, threads, &p), ST_OK);
        assert_int_equal(pool_threads(p), threads);
        static const size_t counts[] = {0, 1, 2, 7, INDICES};
        for (int round = 0; round < 50; round++) {
            size_t n = counts[round % 5];
            reset(&t, threads, INDICES);
            assert_int_equal(pool_run(p, n, count, &t), ST_OK);
            assert_int_equal(atomic_load(&t.bad_worker), 0);
            for (size_t i = 0; i < INDICES; i++)
                assert_int_equal(atomic_load(&t.seen[i]), i < n);
        }
        pool_destroy(p);
        assert_int_equal(mem_used(&m), 0);
    }
}

static void test_errors(void **state) {
    (void)state;
    static tally t;
    mem m;
    mem_init(&m, 0);
    for (int threads = 1; threads <= MOST_THREADS; threads++) {
        pool *p;
        assert_int_equal(pool_create(&m, threads, &p), ST_OK);
        for (size_t failing = 0; failing < 200; failing += 13) {
            char want[32];
            reset(&t, threads, failing);
            (void)status_describe(ST_OK, "nothing");
            assert_int_equal(pool_run(p, INDICES, count, &t), ST_CORRUPT);
            /* Indices are handed out in order, so the first failing one has run, and is the lowest.
             */
            snprintf(want, sizeof want, "index %zu", failing);
            assert_string_equal(status_text(), want);
            /* The pool still works, and soon stopped handing out indices. */
            size_t ran = 0;
            for (size_t i = 0; i < INDICES; i++)
                ran += (size_t)atomic_load(&t.seen[i]);
            assert_true(ran > failing && ran <= failing + (size_t)threads);
            reset(&t, threads, INDICES);
            assert_int_equal(pool_run(p, INDICES, count, &t), ST_OK);
        }
        pool_destroy(p);
    }
    assert_int_equal(mem_used(&m), 0);
}

static void test_faults(void **state) {
    (void)state;
    mem m;
    mem_init(&m, 0);
    for (long k = 1; k <= 4; k++) {
        pool *p = NULL;
        fault_arm(FAULT_THREAD, k);
        assert_int_equal(pool_create(&m, 5, &p), ST_NOMEM);
        assert_non_null(strstr(status_text(), "of 5 could not be created"));
        assert_null(p);
        assert_int_equal(mem_used(&m), 0);
    }
    fault_arm(FAULT_THREAD, 0);
    for (long k = 1; k <= 2; k++) {
        pool *p = NULL;
        fault_arm(FAULT_ALLOC, k);
        assert_int_equal(pool_create(&m, 5, &p), ST_NOMEM);
        assert_int_equal(mem_used(&m), 0);
    }
    fault_arm(FAULT_ALLOC, 0);
    pool_destroy(NULL);
    assert_true(pool_default_threads() >= 1);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_every_index_once),
        cmocka_unit_test(test_errors),
        cmocka_unit_test(test_faults),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
