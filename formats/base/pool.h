/* pool.h - a fixed set of threads that share out the indices of a loop.
 *
 * Results must not depend on which worker gets which index. The error returned is that of the
 * lowest failing index among those that ran. One loop at a time. No body may wait for another one:
 * they may run one after the other.
 */
#ifndef FORMATS_BASE_POOL_H
#define FORMATS_BASE_POOL_H

#include <stddef.h>

#include "formats/base/mem.h"
#include "formats/base/status.h"

typedef struct pool pool;

/* A loop body: index in [0, count), worker in [0, pool_threads()) for per-thread scratch. */
typedef status (*pool_body)(void *ctx, size_t index, int worker);

/* pool_create() - threads >= 1 workers, the caller being one of them; ST_NOMEM if a thread cannot
 * be created. */
CHECKED status pool_create(mem *m, int threads, pool **out);

/* pool_create_host() - a pool on the caller's threads. run() calls work(arg, i) once for every i
 * below count, on any threads, and returns when all of these calls have returned. */
typedef void (*pool_run_host)(void *host, int count, void (*work)(void *arg, int index), void *arg);
CHECKED status pool_create_host(mem *m, int threads, pool_run_host run, void *host, pool **out);

/* pool_destroy() - waits for the workers to end. NULL is fine. */
void pool_destroy(pool *p);

int pool_threads(const pool *p);

/* pool_run() - call body for every index, in any order, in parallel; returns when all are done.
 * After the first error no further index is started. */
CHECKED status pool_run(pool *p, size_t count, pool_body body, void *ctx);

/* pool_run_range() - the same for the indices from first up to end - 1: a loop in pieces, between
 * which the caller may look up. */
CHECKED status pool_run_range(pool *p, size_t first, size_t end, pool_body body, void *ctx);

/* pool_default_threads() - the number of CPUs this process may run on. */
int pool_default_threads(void);

#endif
