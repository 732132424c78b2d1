#include "formats/base/thread.h"

#include <errno.h>
#include <string.h>

#include "formats/base/fault.h"

/* Builds with sanitizers, without optimization or by clang need more: their frames are larger. */
#if defined __SANITIZE_ADDRESS__ || defined __SANITIZE_THREAD__ || !defined __OPTIMIZE__ || \
    defined __clang__
enum { STACK_BYTES = 2 << 20 };
#else
enum { STACK_BYTES = 256 << 10 };
#endif

status thread_start(pthread_t *out, void *(*body)(void *), void *arg, const char *what) {
    pthread_attr_t how;
    int error = fault_hit(FAULT_THREAD) ? EAGAIN : pthread_attr_init(&how);
    if (!error) {
        error = pthread_attr_setstacksize(&how, STACK_BYTES);
        if (!error)
            error = pthread_create(out, &how, body, arg);
        (void)pthread_attr_destroy(&how);
    }
    if (!error)
        return ST_OK;
    return status_describe(ST_NOMEM, "%s could not be created: %s", what,
                           error == EAGAIN ? "no more threads, or no memory for its stack"
                                           : strerror(error));
}
