/* sleepers.h - threads that sleep until there is news, and are woken one at a time.
 *
 * News is whatever the sleepers look at before they sleep: a list, a flag. A thread with news
 * publishes it first, then wakes a sleeper. A thread that finds no news lies down, looks once more,
 * and only then sleeps:
 *
 *     publish the news                        sleepers_lie_down(s)
 *     if (sleepers_claim(s))                  if (there is news) sleepers_get_up(s)
 *         sleepers_wake(s)                    else sleepers_sleep(s, until)
 *                                             look
 *
 * No wake-up is lost, provided that the news is published and looked at with memory_order_seq_cst:
 * all these steps then have one order. Either lying down comes before the claim, which finds the
 * sleeper. Or it comes after the claim, and so after the news: the sleeper's second look finds it.
 *
 * Only one thread is on its way up at a time: a claim fails while a thread claimed before is not up
 * yet. That thread looks only after it is up, so it sees this news, too. It may then wake the next.
 * So a flood of news does not wake threads that would find it already handled.
 *
 * A claimed sleeper does not get up before the wake. So all that it keeps alive while it sleeps,
 * this object included, exists until sleepers_wake() returns. A thread that claims while holding a
 * lock can therefore release the lock first: no lock is held while a thread starts up.
 */
#ifndef FORMATS_BASE_SLEEPERS_H
#define FORMATS_BASE_SLEEPERS_H

#include <semaphore.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>

typedef struct sleepers {
    _Atomic uint32_t state; /* 2 x threads lying down unclaimed, + 1 while a claimed one is on its
                               way up */
    sem_t wakes;            /* posted once per claimed thread */
} sleepers;

void sleepers_init(sleepers *s);
void sleepers_release(sleepers *s); /* no thread may be lying down */

/* sleepers_lie_down() - announce that this thread will sleep. Returns how many lie now, this one
 * included; claimed threads do not count. */
uint32_t sleepers_lie_down(sleepers *s);

/* sleepers_sleep() - after lying down: sleep until woken, or until this time of clock_seconds()
 * (INFINITY: no limit). The thread is up afterwards. */
void sleepers_sleep(sleepers *s, double until);

/* sleepers_get_up() - get up instead of sleeping. */
void sleepers_get_up(sleepers *s);

/* sleepers_claim() - claim a sleeper. If true, the caller must call sleepers_wake(). No lock, no
 * system call. */
bool sleepers_claim(sleepers *s);
void sleepers_wake(sleepers *s);

/* sleepers_wake_all() - wake all that lie now. */
void sleepers_wake_all(sleepers *s);

#endif
