/* thread.h - threads with a stack of a known size. */
#ifndef FORMATS_BASE_THREAD_H
#define FORMATS_BASE_THREAD_H

#include <pthread.h>

#include "formats/base/status.h"

/* thread_start() - body(arg) on a thread of its own, which the caller joins. Its stack is 256 KiB;
 * 2 MiB in builds whose frames are larger: without optimization, by clang, with sanitizers. No
 * function of the library has more than 32 KiB of its own. Those that call themselves (sorting,
 * building trees) have small frames and a bounded depth. what: who it is, for the description.
 * ST_NOMEM when the system gives no more threads, or has no memory for it. */
CHECKED status thread_start(pthread_t *out, void *(*body)(void *), void *arg, const char *what);

#endif
