/* test_arrivals.c - what comes to threads that sleep: no wake-up is lost, none is sent twice, and
 * of what comes nothing is lost and nothing comes twice; without a lock.
 */
/* marks: threads */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <math.h>
#include <pthread.h>
#include <unistd.h>

#include "formats/base/clock.h"
#include "formats/base/pool.h"
#include "formats/base/sleepers.h"
#include "stream/arrivals.h"

enum { STUCK_S = 120, BRINGERS = 3, TAKERS = 4, TREELETS = 8, ROUNDS = 4000 };

/* ---- One thread ---- */

/* One is on the way at a time; all are woken together; each wake ends one sleep. */
static void test_claims(void **state) {
    (void)state;
    sleepers s;
    sleepers_init(&s);
    assert_false(sleepers_claim(&s));
    assert_int_equal(sleepers_lie_down(&s), 1);
    assert_int_equal(sleepers_lie_down(&s), 2);
    assert_true(sleepers_claim(&s));
    assert_false(sleepers_claim(&s)); /* one is on the way */
    assert_int_equal(sleepers_lie_down(&s), 2);
    sleepers_wake(&s);
    sleepers_sleep(&s, (double)INFINITY);
    assert_true(sleepers_claim(&s));
    sleepers_wake(&s);
    sleepers_sleep(&s, (double)INFINITY);
    sleepers_get_up(&s);
    assert_false(sleepers_claim(&s));
    assert_int_equal(sleepers_lie_down(&s), 1);
    assert_int_equal(sleepers_lie_down(&s), 2);
    sleepers_wake_all(&s);
    assert_false(sleepers_claim(&s));
    sleepers_sleep(&s, (double)INFINITY);
    sleepers_sleep(&s, (double)INFINITY);
    sleepers_release(&s);
}

/* The alarm rings, and a wake that was promised meanwhile is taken. */
static void test_alarm_time(void **state) {
    (void)state;
    sleepers s;
    sleepers_init(&s);
    (void)sleepers_lie_down(&s);
    const double until = clock_seconds() + 0.02;
    sleepers_sleep(&s, until);
    assert_true(clock_seconds() >= until);
    assert_false(sleepers_claim(&s)); /* it is up */
    (void)sleepers_lie_down(&s);
    assert_true(sleepers_claim(&s));
    sleepers_wake(&s);
    sleepers_get_up(&s); /* takes the wake along */
    (void)sleepers_lie_down(&s);
    const double again = clock_seconds() + 0.02;
    sleepers_sleep(&s, again);
    assert_true(clock_seconds() >= again);
    sleepers_release(&s);
}

static void test_list(void **state) {
    (void)state;
    mem m;
    arrivals a = {0};
    mem_init(&m, 0);
    assert_int_equal(arrivals_init(&a, &m, TREELETS), ST_OK);
    assert_false(arrivals_any(&a));
    assert_int_equal(arrivals_take(&a), arrivals_end);
    arrivals_add(&a, 3);
    arrivals_add(&a, 5);
    arrivals_add(&a, 3); /* is there already */
    assert_true(arrivals_any(&a));
    assert_int_equal(arrivals_take(&a), 5);
    assert_int_equal(arrivals_after(&a, 5), 3);
    arrivals_add(&a, 5);
    assert_int_equal(arrivals_after(&a, 3), arrivals_end);
    assert_int_equal(arrivals_take(&a), 5);
    assert_int_equal(arrivals_after(&a, 5), arrivals_end);
    arrivals_release(&a, &m);
    assert_int_equal(mem_used(&m), 0);
}

static void test_no_memory(void **state) {
    (void)state;
    mem m;
    arrivals a = {0};
    mem_init(&m, 16);
    assert_int_equal(arrivals_init(&a, &m, 1000), ST_NOMEM);
    arrivals_release(&a, &m);
    assert_int_equal(mem_used(&m), 0);
}

/* ---- Many ---- */

/* Bringers raise numbers of treelets; takers carry what is new over to `taken`. */
typedef struct exchange {
    arrivals list;
    sleepers sleepers;
    atomic_int raised[TREELETS]; /* what a treelet is to be looked at for */
    pthread_mutex_t lock;
    int taken[TREELETS]; /* guarded by lock */
    atomic_int bringing;
} exchange;

static void tell(exchange *x) {
    if (sleepers_claim(&x->sleepers))
        sleepers_wake(&x->sleepers);
}

/* A treelet that is this bringer's alone. */
static void bring(exchange *x, uint32_t t) {
    for (int i = 1; i <= ROUNDS; i++) {
        atomic_store(&x->raised[t], i);
        arrivals_add(&x->list, t);
        tell(x);
        if (i % 64 == 0)
            usleep(20); /* so that takers find nothing, and sleep */
    }
    atomic_fetch_sub(&x->bringing, 1);
    tell(x);
}

static void carry(exchange *x) {
    pthread_mutex_lock(&x->lock);
    for (uint32_t t = arrivals_take(&x->list), after; t != arrivals_end; t = after) {
        after = arrivals_after(&x->list, t);
        x->taken[t] = atomic_load(&x->raised[t]);
    }
    pthread_mutex_unlock(&x->lock);
}

/* Until nothing more is brought. The next one is told, too. */
static void take(exchange *x) {
    for (;;) {
        carry(x);
        (void)sleepers_lie_down(&x->sleepers);
        const bool over = atomic_load(&x->bringing) == 0;
        if (over || arrivals_any(&x->list)) {
            sleepers_get_up(&x->sleepers);
            tell(x);
        } else {
            sleepers_sleep(&x->sleepers, (double)INFINITY);
        }
        if (over)
            break;
    }
    carry(x);
    tell(x);
}

static status bring_or_take(void *ctx, size_t index, int worker) {
    (void)worker;
    if (index < BRINGERS)
        bring(ctx, (uint32_t)index);
    else
        take(ctx);
    return ST_OK;
}

/* A lost wake-up would leave takers asleep for ever, a lost arrival an old number. */
static void test_nothing_is_lost(void **state) {
    (void)state;
    mem m;
    pool *threads;
    exchange x = {.bringing = BRINGERS};
    mem_init(&m, 0);
    pthread_mutex_init(&x.lock, NULL);
    sleepers_init(&x.sleepers);
    assert_int_equal(arrivals_init(&x.list, &m, TREELETS), ST_OK);
    assert_int_equal(pool_create(&m, BRINGERS + TAKERS, &threads), ST_OK);
    alarm(STUCK_S);
    assert_int_equal(pool_run(threads, BRINGERS + TAKERS, bring_or_take, &x), ST_OK);
    alarm(0);
    for (uint32_t t = 0; t < BRINGERS; t++)
        assert_int_equal(x.taken[t], ROUNDS);
    assert_false(arrivals_any(&x.list));
    assert_false(sleepers_claim(&x.sleepers));
    pool_destroy(threads);
    arrivals_release(&x.list, &m);
    sleepers_release(&x.sleepers);
    pthread_mutex_destroy(&x.lock);
    assert_int_equal(mem_used(&m), 0);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_claims), cmocka_unit_test(test_alarm_time),
        cmocka_unit_test(test_list), cmocka_unit_test(test_no_memory),
        cmocka_unit_test(test_nothing_is_lost)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
