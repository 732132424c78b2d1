/* wait.h - waiting for the other end of a pipe, as long as nobody asks to stop.
 *
 * A read or write of a pipe waits inside the system, where a signal that another thread takes goes
 * unseen. So readers and writers of one ask here first, or wait by a poll() of their own. Signals
 * belong to the process, and so does the question whether one came: a main program sets it once,
 * before its threads; without one nothing stops a wait.
 */
#ifndef FORMATS_BASE_WAIT_H
#define FORMATS_BASE_WAIT_H

#include <stdbool.h>

#include "formats/base/status.h"

/* wait_stop_when() - asked now and then while something waits, on any thread. */
void wait_stop_when(bool (*asked)(void));

/* wait_stopped() - ST_STOPPED where a stop was asked for, else ST_OK; `name` is for the
 * description. */
CHECKED status wait_stopped(const char *name);

/* wait_ready() - until fd can be read (events: POLLIN) or written (POLLOUT) without waiting, is at
 * its end, or has an error, which the read or write will then tell. ST_STOPPED within about a tenth
 * of a second after a stop is asked for; `name` is for the description. */
CHECKED status wait_ready(int fd, short events, const char *name);

#endif
