/* child.h - a helper process: it is fed through a socket, and read through two pipes.
 *
 * One thread per child. The end of its standard error is kept, as far as it fits.
 */
#ifndef FORMATS_BASE_CHILD_H
#define FORMATS_BASE_CHILD_H

#include <stdbool.h>
#include <stddef.h>
#include <sys/types.h>

#include "formats/base/status.h"

typedef struct child {
    pid_t pid;
    int feed;     /* its standard input. A socket, not a pipe: send() can be told to raise no
                     SIGPIPE */
    int result;   /* its standard output; -1: the child shares this process's */
    int complain; /* its standard error */
    status (*wait)(void *ctx); /* NULL, or set after the start: asked every tenth of a second while
                                  child_feed() waits; any result but ST_OK ends the feeding */
    void *wait_ctx;
    size_t said;
    char words[STATUS_TEXT_MAX]; /* the end of its standard error; child_end() drops trailing line
                                    feeds */
} child;

/* child_start() - run a program; argv as for exec. With result, child_read() reads its standard
 * output. Signals that this process ignores are at their default in the child. Call child_end() in
 * any case. */
CHECKED status child_start(const char *program, char *const argv[], bool result, child *c);

/* child_feed() - write to the child's standard input. Its standard error is read meanwhile, so the
 * child may write before it reads. Returns false when the child reads no more (its words say why),
 * or when wait() ended the feeding.
 * child_fed() - close the child's standard input. */
bool child_feed(child *c, const void *data, size_t size);
void child_fed(child *c);

/* child_read() - read the next size bytes of its output. *got is smaller only at the end of the
 * output. wait(ctx) is asked between parts, and every tenth of a second while there is nothing to
 * read. Any result but ST_OK ends the reading and is returned. */
CHECKED status child_read(child *c, void *data, size_t size, size_t *got, status (*wait)(void *ctx),
                          void *ctx);

/* child_kill() - kill the child; child_end() must follow. */
void child_kill(child *c);

/* child_end() - read the rest of its standard error and wait for its end. *code: its exit status,
 * or 128 + the signal that ended it. */
CHECKED status child_end(child *c, int *code);

#endif
