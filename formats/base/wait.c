#include "formats/base/wait.h"

#include <errno.h>
#include <poll.h>
#include <stddef.h>
#include <string.h>

enum { WAIT_MS = 100 };

static bool (*stop_asked)(void);

void wait_stop_when(bool (*asked)(void)) {
    stop_asked = asked;
}

status wait_stopped(const char *name) {
    if (stop_asked && stop_asked())
        return status_describe(ST_STOPPED, "%s: stopped while waiting for it", name);
    return ST_OK;
}

status wait_ready(int fd, short events, const char *name) {
    for (;;) {
        status st = wait_stopped(name);
        if (st != ST_OK)
            return st;
        struct pollfd end = {.fd = fd, .events = events};
        const int ready = poll(&end, 1, WAIT_MS);
        if (ready > 0)
            return ST_OK;
        if (ready < 0 && errno != EINTR)
            return status_describe(errno == ENOMEM ? ST_NOMEM : ST_IO, "%s: cannot wait for: %s",
                                   name, strerror(errno));
    }
}
