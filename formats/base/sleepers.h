/* sleepers.h - threads that sleep until there is news, and are woken one at a time.
 *
 * News is whatever the sleepers look at before they sleep: a list, a flag. Who has news publishes
 * it first, and then wakes somebody. Who finds none lies down, looks once more, and only then
 * sleeps:
 *
 *     publish the news                        sleepers_lie_down(s)
 *     if (sleepers_claim(s))                  if (there is news) sleepers_get_up(s)
 *         sleepers_wake(s)                    else sleepers_sleep(s, until)
 *                                             look
 *
 * No wake-up is lost, provided that the news is published and looked at with
 * memory_order_seq_cst: all these steps have one order then. Either lying down comes before the
 * claim, which finds the sleeper; or it comes after the claim, and so after the news, which the
 * sleeper's second look finds.
 *
 * Only one is on the way at a time: a claim fails while a thread that was claimed before is not up
 * yet. It is up before it looks, so it will see these news, too; it may then wake the next. So a
 * flood of news does not wake threads that find it done by others.
 *
 * A claim is a promise: the sleeper is not up before the wake. So what the sleeper keeps alive
 * while it sleeps, this object among it, is there until sleepers_wake() returns. Whoever claims
 * holding a lock can therefore give it back first: no lock is held while a thread starts up.
 */
#ifndef FORMATS_BASE_SLEEPERS_H
#define FORMATS_BASE_SLEEPERS_H

#include <semaphore.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>

typedef struct sleepers {
    _Atomic uint32_t state; /* 2 x threads that lie and are not claimed, + 1: one is on the way */
    sem_t wakes;            /* posted once for each that is claimed */
} sleepers;

void sleepers_init(sleepers *s);
void sleepers_release(sleepers *s); /* nobody lies */

/* sleepers_lie_down() - the thread sleeps soon. How many lie now, it included; those that are on
 * the way do not count. */
uint32_t sleepers_lie_down(sleepers *s);

/* sleepers_sleep() - after lying down: until woken, or until this time of clock_seconds(); INFINITY
 * for none. The thread is up then. */
void sleepers_sleep(sleepers *s, double until);

/* sleepers_get_up() - in place of sleeping. */
void sleepers_get_up(sleepers *s);

/* sleepers_claim() - whether one is to be woken, by sleepers_wake(), which must follow. No lock, no
 * system call. */
bool sleepers_claim(sleepers *s);
void sleepers_wake(sleepers *s);

/* sleepers_wake_all() - who lies now. */
void sleepers_wake_all(sleepers *s);

#endif
