/* wait.h - wait for the other end of a pipe until a stop is asked for.
 *
 * A read or write of a pipe waits inside the system, and does not notice a signal that another
 * thread takes. So code that reads or writes a pipe waits here first, or by a poll() of its own.
 * Signals belong to the process, so there is one question for all, whether one came. A main program
 * sets it, before it starts threads; without it nothing stops a wait.
 */
#ifndef FORMATS_BASE_WAIT_H
#define FORMATS_BASE_WAIT_H

#include <stdbool.h>

#include "formats/base/status.h"

/* wait_stop_when() - set the question whether to stop. It is asked now and then while something
 * waits, on any thread. */
void wait_stop_when(bool (*asked)(void));

/* wait_stopped() - ST_STOPPED where a stop was asked for, else ST_OK; `name` is for the
 * description. */
CHECKED status wait_stopped(const char *name);

/* wait_ready() - wait until fd can be read (events: POLLIN) or written (POLLOUT) without waiting,
 * is at its end, or has an error, which the read or write then reports. ST_STOPPED within about a
 * tenth of a second after a stop is asked for; `name` is for the description. */
CHECKED status wait_ready(int fd, short events, const char *name);

#endif
