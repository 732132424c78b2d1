#include "formats/base/sleepers.h"

#include <errno.h>
#include <math.h>
#include <time.h>

enum { ON_THE_WAY = 1, ONE = 2 };

void sleepers_init(sleepers *s) {
    atomic_init(&s->state, 0);
    sem_init(&s->wakes, 0, 0);
}

void sleepers_release(sleepers *s) {
    sem_destroy(&s->wakes);
}

uint32_t sleepers_lie_down(sleepers *s) {
    return (atomic_fetch_add(&s->state, ONE) + ONE) / ONE;
}

/* Take the wake that a claim promised. */
static void take_wake(sleepers *s) {
    while (sem_wait(&s->wakes) != 0)
        ;
    atomic_fetch_and(&s->state, ~(uint32_t)ON_THE_WAY);
}

void sleepers_get_up(sleepers *s) {
    uint32_t state = atomic_load(&s->state);
    while (state >= ONE)
        if (atomic_compare_exchange_weak(&s->state, &state, state - ONE))
            return;
    take_wake(s); /* all sleepers that lay are claimed, so this one is */
}

/* Wait for a wake. Returns whether one came before this time. */
static bool wait_until(sleepers *s, double until) {
    const struct timespec at = {(time_t)until, (long)(1e9 * (until - floor(until)))};
    int failed = 0;
    do
        failed = sem_clockwait(&s->wakes, CLOCK_MONOTONIC, &at);
    while (failed && errno == EINTR);
    return !failed;
}

void sleepers_sleep(sleepers *s, double until) {
    if (until == (double)INFINITY)
        take_wake(s);
    else if (wait_until(s, until))
        atomic_fetch_and(&s->state, ~(uint32_t)ON_THE_WAY);
    else
        sleepers_get_up(s);
}

bool sleepers_claim(sleepers *s) {
    uint32_t state = atomic_load(&s->state);
    while (state >= ONE && !(state & ON_THE_WAY))
        if (atomic_compare_exchange_weak(&s->state, &state, (state - ONE) | ON_THE_WAY))
            return true;
    return false;
}

void sleepers_wake(sleepers *s) {
    sem_post(&s->wakes);
}

void sleepers_wake_all(sleepers *s) {
    uint32_t state = atomic_load(&s->state);
    while (!atomic_compare_exchange_weak(&s->state, &state, state & ON_THE_WAY))
        ;
    for (; state >= ONE; state -= ONE)
        sem_post(&s->wakes);
}
