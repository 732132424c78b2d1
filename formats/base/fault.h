/* fault.h - the tests' hook: let the k-th allocation, read or thread creation of this process fail,
 * or let all of a kind take longer.
 *
 * Off by default, and then two relaxed loads. With the table of file_guard.h
 * the only state in the library that is global; only tests set it.
 */
#ifndef FORMATS_BASE_FAULT_H
#define FORMATS_BASE_FAULT_H

#include <stdbool.h>

typedef enum fault_kind {
    FAULT_ALLOC,
    FAULT_READ,
    FAULT_WRITE,
    FAULT_THREAD,
    FAULT_KINDS
} fault_kind;

/* fault_arm() - from now on the k-th operation of this kind fails (k = 1: the next), once; k = 0
 * disarms. */
void fault_arm(fault_kind kind, long k);

/* fault_fired() - whether the armed fault has happened. */
bool fault_fired(fault_kind kind);

/* fault_delay() - from now on each operation of this kind takes so many microseconds more, asleep;
 * 0: none does. */
void fault_delay(fault_kind kind, long us);

/* fault_hit() - asked by the operation itself: true when it must fail now. Sleeps if it is delayed.
 * Thread-safe. */
bool fault_hit(fault_kind kind);

#endif
