/* arrivals.h - a list of treelets that have come or failed, from the threads that read to the
 * threads that wait.
 *
 * The list has no lock: any thread adds to it, any thread takes all of it. It holds a treelet at
 * most once, so its memory is fixed. Publish a treelet's new state before adding the treelet. If
 * the treelet is in the list already, it is not added again: whoever takes it from the list reads
 * its state later, and so sees the new one. */
#ifndef STREAM_ARRIVALS_H
#define STREAM_ARRIVALS_H

#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>

#include "formats/base/mem.h"
#include "formats/base/status.h"

static const uint32_t arrivals_end = UINT32_MAX; /* ends a list */

typedef struct arrivals {
    _Atomic uint32_t first;
    uint32_t *next;      /* per treelet in the list: the treelet after it */
    atomic_uchar *there; /* per treelet: 1 while it is in the list */
} arrivals;

/* arrivals_init() - make an empty list. Call arrivals_release() also after a failure. */
CHECKED status arrivals_init(arrivals *a, mem *m, uint32_t treelets);
void arrivals_release(arrivals *a, mem *m);

/* arrivals_any() - returns whether there may be something to take. */
static inline bool arrivals_any(const arrivals *a) {
    return atomic_load(&a->first) != arrivals_end;
}

/* arrivals_add() - add treelet t. Any thread; for one treelet, one thread at a time. */
void arrivals_add(arrivals *a, uint32_t t);

/* arrivals_take() - take the whole list. Returns its first treelet, or arrivals_end if it is empty.
 * arrivals_after() - returns the treelet after t in a list taken. From then on t can be added
 * again, so look at t's state only afterwards. */
uint32_t arrivals_take(arrivals *a);
uint32_t arrivals_after(arrivals *a, uint32_t t);

#endif
