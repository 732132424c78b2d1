/* thread.h - threads with a stack of a known size. */
#ifndef FORMATS_BASE_THREAD_H
#define FORMATS_BASE_THREAD_H

#include <pthread.h>

#include "formats/base/status.h"

/* thread_start() - run body(arg) on a new thread, which the caller joins. Its stack is 256 KiB; 2
 * MiB in builds whose frames are larger: without optimization, by clang, with sanitizers. No
 * function of the library has a frame above 32 KiB. Recursive functions (sorting, building trees)
 * have small frames and a bounded depth. what: the thread's name in the description. ST_NOMEM when
 * the system gives no more threads, or has no memory for it. */
CHECKED status thread_start(pthread_t *out, void *(*body)(void *), void *arg, const char *what);

#endif
