/* child.h - a helper process: fed through one pipe, heard through two others.
 *
 * One thread per child. What it says on its standard error is kept, as far as it fits.
 */
#ifndef FORMATS_BASE_CHILD_H
#define FORMATS_BASE_CHILD_H

#include <stdbool.h>
#include <stddef.h>
#include <sys/types.h>

#include "formats/base/status.h"

typedef struct child {
    pid_t pid;
    int feed;     /* its standard input; a socket, not a pipe: send() can be told to raise no
                     SIGPIPE */
    int result;   /* its standard output; -1 where it has this process's */
    int complain; /* its standard error */
    status (*wait)(void *ctx); /* NULL, or set after the start: asked every tenth of a second while
                                  child_feed() waits; other than ST_OK ends the feeding */
    void *wait_ctx;
    size_t said;
    char words[STATUS_TEXT_MAX]; /* the end of what it said, without line feeds at the end */
} child;

/* child_start() - run a program; argv as for exec. With result, its standard output is read by
 * child_read(). Signals that this process ignores are as usual in the child. End it in any case. */
CHECKED status child_start(const char *program, char *const argv[], bool result, child *c);

/* child_feed() - what the child says meanwhile is heard, so that it may speak before it listens.
 * false: it listens no more, and will say why; or wait() has ended the feeding. child_fed() - that
 * was all. */
bool child_feed(child *c, const void *data, size_t size);
void child_fed(child *c);

/* child_read() - the next size bytes of its output; *got is smaller only at the end. While there is
 * nothing, and between parts, wait(ctx) is asked every tenth of a second; what it returns other
 * than ST_OK ends the reading. */
CHECKED status child_read(child *c, void *data, size_t size, size_t *got, status (*wait)(void *ctx),
                          void *ctx);

/* child_kill() - it is not waited for any longer; child_end() follows. */
void child_kill(child *c);

/* child_end() - hear the rest of its words, wait for its end: *code is its exit status, or 128 +
 * the signal that ended it. */
CHECKED status child_end(child *c, int *code);

#endif
