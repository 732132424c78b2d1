/* fault.h - the tests' hook: make the k-th allocation, read, write or thread creation of this
 * process fail, or make all of one kind take longer.
 *
 * Off by default; it then costs two relaxed loads. Together with the table of file_guard.h this is
 * the only global state in the library; only tests set it.
 */
#ifndef FORMATS_BASE_FAULT_H
#define FORMATS_BASE_FAULT_H

#include <stdbool.h>

typedef enum fault_kind {
    FAULT_ALLOC,
    FAULT_READ,
    FAULT_WRITE,
    FAULT_THREAD,
    FAULT_KINDS, /* that make a call fail */
    /* A mapped file's pages are lost for a moment, and there again: nothing may fail. */
    FAULT_PAGES = FAULT_KINDS,
    FAULT_ALL
} fault_kind;

/* fault_arm() - make the k-th operation of this kind from now on fail, once (k = 1: the next); k =
 * 0 disarms. */
void fault_arm(fault_kind kind, long k);

/* fault_fired() - whether the armed fault has happened. */
bool fault_fired(fault_kind kind);

/* fault_delay() - make each operation of this kind sleep for `us` microseconds first; 0: no
 * delay. */
void fault_delay(fault_kind kind, long us);

/* fault_hit() - called by the operation itself: returns true when it must fail now. Sleeps if a
 * delay is set. Thread-safe. */
bool fault_hit(fault_kind kind);

#endif
