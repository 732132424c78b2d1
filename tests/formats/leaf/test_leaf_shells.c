/* test_leaf_shells.c - shells that several threads share: made once, kept while they are held. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <pthread.h>
#include <string.h>

#include "formats/leaf/leaf_shells.h"

static mem m;

static int setup(void **state) {
    (void)state;
    mem_init(&m, 0);
    return 0;
}

static int teardown(void **state) {
    (void)state;
    assert_int_equal(mem_used(&m), 0);
    return 0;
}

/* A compressed layout with many families. */
static leaf_layout layout_of(void) {
    leaf_layout l;
    assert_int_equal(leaf_layout_init(&l, &m, (uint32_t[3]){200, 200, 200}, 4, 1, SAMPLE_U8),
                     ST_OK);
    assert_true(leaf_layout_repeat(&l, 1, 1, true));
    assert_true(l.shells > 20);
    return l;
}

static leaf_shells *shells_of(leaf_layout *l, int threads, size_t count) {
    leaf_shells *s = NULL;
    const size_t bytes = count * leaf_layout_shell_max(l), before = mem_used(&m);
    assert_int_equal(leaf_shells_create(&m, l, threads, bytes, &s), ST_OK);
    assert_non_null(s);
    assert_true(mem_used(&m) - before <= leaf_shells_memory(l, threads, bytes));
    return s;
}

/* Hold a shell, make it if need be, and let go. Returns whether it was there. */
static bool visit(leaf_shells *s, uint32_t p) {
    void *samples;
    const bool made = leaf_shells_hold(s, p, &samples);
    if (!made)
        memset(samples, (int)p, 100);
    for (int i = 0; i < 100; i++)
        assert_int_equal(((uint8_t *)samples)[i], (uint8_t)p);
    leaf_shells_release(s, p, true);
    return made;
}

/* Those not needed for longest go. */
static void test_order(void **state) {
    (void)state;
    leaf_layout l = layout_of();
    leaf_shells *s = shells_of(&l, 1, 3);
    for (uint32_t p = 0; p < 3; p++)
        assert_false(visit(s, p));
    assert_true(visit(s, 0));
    assert_false(visit(s, 3)); /* instead of 1 */
    assert_true(visit(s, 2));
    assert_true(visit(s, 0));
    assert_false(visit(s, 1));
    assert_false(visit(s, 3));
    leaf_shells_destroy(s);
    leaf_layout_release(&l);
}

/* One that could not be made is not there for the next; one in use stays. */
static void test_failure(void **state) {
    (void)state;
    leaf_layout l = layout_of();
    leaf_shells *s = shells_of(&l, 2, 2);
    void *held, *other;
    assert_false(leaf_shells_hold(s, 7, &held));
    leaf_shells_release(s, 7, false);
    assert_false(leaf_shells_hold(s, 7, &held));
    memset(held, 7, 100);
    for (uint32_t p = 10; p < 20; p++)
        assert_false(visit(s, p));
    leaf_shells_release(s, 7, true);
    assert_true(leaf_shells_hold(s, 7, &other));
    assert_ptr_equal(other, held);
    leaf_shells_release(s, 7, true);
    leaf_shells_destroy(s);
    leaf_layout_release(&l);
}

/* As little room as there may be: one for each thread. */
static void test_none(void **state) {
    (void)state;
    leaf_layout l = layout_of();
    leaf_shells *s = shells_of(&l, 3, 0);
    for (uint32_t p = 0; p < 9; p++)
        assert_false(visit(s, p % 4));
    leaf_shells_destroy(s);
    assert_true(leaf_layout_repeat(&l, 1, 1, false));
    assert_int_equal(leaf_shells_create(&m, &l, 3, 1 << 20, &s), ST_OK);
    assert_null(s);
    leaf_layout_release(&l);
}

enum { THREADS = 4, VISITS = 4000 };

static void *visit_many(void *arg) {
    leaf_shells *s = arg;
    static const uint32_t stride[] = {1, 5, 7, 11};
    static uint32_t next;
    const uint32_t mine = stride[__atomic_fetch_add(&next, 1, __ATOMIC_RELAXED) % THREADS];
    for (uint32_t i = 0; i < VISITS; i++)
        (void)visit(s, i * mine % 13);
    return NULL;
}

static void test_threads(void **state) {
    (void)state;
    leaf_layout l = layout_of();
    leaf_shells *s = shells_of(&l, THREADS, 6);
    pthread_t threads[THREADS];
    for (int i = 0; i < THREADS; i++)
        assert_int_equal(pthread_create(&threads[i], NULL, visit_many, s), 0);
    for (int i = 0; i < THREADS; i++)
        pthread_join(threads[i], NULL);
    leaf_shells_destroy(s);
    leaf_layout_release(&l);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_order, setup, teardown),
        cmocka_unit_test_setup_teardown(test_failure, setup, teardown),
        cmocka_unit_test_setup_teardown(test_none, setup, teardown),
        cmocka_unit_test_setup_teardown(test_threads, setup, teardown)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
