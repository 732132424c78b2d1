/* arrivals.h - treelets that have come or have failed, on their way from the threads that read to
 * those that wait for them.
 *
 * A list without a lock: any thread adds to it, any thread takes all of it. A treelet is in it at
 * most once, so it needs no memory but its own. That a treelet is there is to be seen before it is
 * added: who finds it already in the list need not add it again, since whoever takes it from there
 * looks at it later. */
#ifndef STREAM_ARRIVALS_H
#define STREAM_ARRIVALS_H

#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>

#include "formats/base/mem.h"
#include "formats/base/status.h"

static const uint32_t arrivals_end = UINT32_MAX; /* of a list */

typedef struct arrivals {
    _Atomic uint32_t first;
    uint32_t *next;      /* of a treelet in the list */
    atomic_uchar *there; /* whether it is */
} arrivals;

/* arrivals_init() - an empty list, for so many treelets. Released also where it fails. */
CHECKED status arrivals_init(arrivals *a, mem *m, uint32_t treelets);
void arrivals_release(arrivals *a, mem *m);

/* arrivals_any() - whether there may be something to take. */
static inline bool arrivals_any(const arrivals *a) {
    return atomic_load(&a->first) != arrivals_end;
}

/* arrivals_add() - any thread; of one treelet, one thread at a time. */
void arrivals_add(arrivals *a, uint32_t t);

/* arrivals_take() - the first of all that there are, which are the caller's then; arrivals_end if
 * there are none. arrivals_after() - the one after t. From then on t can be added again: look at
 * the treelet later. */
uint32_t arrivals_take(arrivals *a);
uint32_t arrivals_after(arrivals *a, uint32_t t);

#endif
