/* readers.h - threads that read, shared by any number of customers.
 *
 * A customer (a loader) joins with a function that does one read, and says whenever it changes
 * whether it has something to read and how urgent the most urgent of it is. Threads serve the most
 * urgent customer first; of equally urgent ones, the one served longest ago. What is read, into
 * which memory, and what becomes of failures is the customer's affair alone: nothing of one
 * customer reaches another but the time that its reads take.
 *
 * Thread-safe. Locks are taken in this order: a customer's own, then the readers'; customers are
 * called with none.
 */
#ifndef STREAM_READERS_H
#define STREAM_READERS_H

#include <stdbool.h>
#include <stdint.h>

#include "formats/base/mem.h"
#include "formats/base/status.h"

typedef struct readers readers;

/* The customer's own memory, zeroed but for the first two; from join to leave all else belongs to
 * the readers. */
typedef struct reader_customer {
    void (*read)(void *ctx); /* what is most urgent; nothing if that has gone meanwhile */
    void *ctx;
    bool waiting;      /* there is something to read */
    uint64_t priority; /* then, of the most urgent; smaller comes first */
    uint64_t served;   /* the turn when it was served last */
    int busy;          /* threads that read for it now */
    struct reader_customer *next;
} reader_customer;

/* readers_create() - no threads yet. */
CHECKED status readers_create(mem *m, readers **out);

/* readers_destroy() - ends the threads; all customers have left. NULL is fine. */
void readers_destroy(readers *r);

/* readers_join() - one customer more, with nothing to read yet; there are at least so many threads
 * from now on. ST_NOMEM if one cannot be created: the customer has not joined then. */
CHECKED status readers_join(readers *r, reader_customer *c, int threads);

/* readers_leave() - returns when no thread reads for it any more. */
void readers_leave(readers *r, reader_customer *c);

/* readers_tell() - whether the customer has something to read, and how urgent the most urgent of it
 * is. Wakes one thread, if one is idle. A customer tells again in read(), when it has taken
 * something: so one thread wakes the next as long as there is work. */
void readers_tell(readers *r, reader_customer *c, bool waiting, uint64_t priority);

#endif
