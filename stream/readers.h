/* readers.h - threads that read, shared by any number of customers.
 *
 * A customer (a loader) joins with a function that does one read. On every change it tells the
 * readers whether it has something to read, and its smallest priority. Threads serve the most
 * urgent customer first, and among equally urgent customers the one served longest ago. The
 * customer alone decides what it reads, into which memory, and how it handles failures. Customers
 * affect each other only by the time that their reads take.
 *
 * Thread-safe. Locks are taken in this order: a customer's own, then the readers'. Customers are
 * called with no lock held.
 */
#ifndef STREAM_READERS_H
#define STREAM_READERS_H

#include <stdbool.h>
#include <stdint.h>

#include "formats/base/mem.h"
#include "formats/base/status.h"

typedef struct readers readers;

/* Memory of the customer, which sets the first two members and zeroes the rest. From join to leave,
 * the rest belongs to the readers. */
typedef struct reader_customer {
    void (*read)(void *ctx); /* do the most urgent read, if there still is one */
    void *ctx;
    bool waiting;      /* there is something to read */
    uint64_t priority; /* while waiting: of its most urgent read; smaller first */
    uint64_t served;   /* the turn when it was served last */
    int busy;          /* threads that read for it now */
    struct reader_customer *next;
} reader_customer;

/* readers_create() - make readers without threads. */
CHECKED status readers_create(mem *m, readers **out);

/* readers_destroy() - end the threads. All customers must have left. NULL is fine. */
void readers_destroy(readers *r);

/* readers_join() - add a customer that has nothing to read yet. From now on there are at least
 * `threads` threads. ST_NOMEM if one cannot be created: then the customer has not joined. */
CHECKED status readers_join(readers *r, reader_customer *c, int threads);

/* readers_leave() - remove a customer, and wait until no thread reads for it. */
void readers_leave(readers *r, reader_customer *c);

/* readers_tell() - set whether the customer has something to read, and its smallest priority. If
 * so, wakes one idle thread. read() must call it again once it has taken a request: so one thread
 * wakes the next as long as there is work. */
void readers_tell(readers *r, reader_customer *c, bool waiting, uint64_t priority);

#endif
