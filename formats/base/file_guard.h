/* file_guard.h - an output is never an input, and never another output.
 *
 * One table for the process: the files it reads and the outputs it announced. Files are told apart
 * by device and inode, so symbolic and hard links count; an output that is not there yet, by its
 * folder and its name. Only main programs fill the table. Library code asks it, and finds it empty
 * in other programs. Any thread.
 */
#ifndef FORMATS_BASE_FILE_GUARD_H
#define FORMATS_BASE_FILE_GUARD_H

#include "formats/base/status.h"

/* file_guard_watch() - from now on each file that is opened for reading counts as an input: also
 * those that the command line does not name, such as the samples beside a header. */
void file_guard_watch(void);

/* file_guard_input() - an input by name; "-" is standard input; NULL and missing files are
 * ignored. ST_USAGE when it was announced as an output, ST_NOMEM. */
CHECKED status file_guard_input(const char *path);

/* file_guard_opened() - for those that open files: an input by its descriptor, if watched for.
 * Errors as of file_guard_input(). */
CHECKED status file_guard_opened(int fd, const char *path);

/* file_guard_output() - announce an output, which need not be there. ST_USAGE when it is an input
 * or was announced before, ST_NOMEM. NULL and "-" are none. */
CHECKED status file_guard_output(const char *path);

/* file_guard_check() - ST_USAGE when what stands under this name is an input; announces nothing. */
CHECKED status file_guard_check(const char *path);

/* file_guard_forget() - a scratch file that was written, then read: it is no input, and about to
 * go. Another file may get its inode. */
void file_guard_forget(const char *path);

/* file_guard_next() - forget the outputs announced so far: they are complete. Inputs stay. */
void file_guard_next(void);

/* file_guard_reset() - forget everything, watch no more. */
void file_guard_reset(void);

#endif
