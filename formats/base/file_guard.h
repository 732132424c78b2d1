/* file_guard.h - an output is never an input, and never another output.
 *
 * One table for the process: the files it reads and the outputs it announced. Files are told apart
 * by device and inode, so symbolic and hard links count; an output that is not there yet, by its
 * folder and its name. Only main programs fill the table. Library code asks it, and finds it empty
 * in other programs: there a job has a target of its own, so that jobs in several threads do not
 * meet. Any thread.
 */
#ifndef FORMATS_BASE_FILE_GUARD_H
#define FORMATS_BASE_FILE_GUARD_H

#include <stdbool.h>
#include <sys/types.h>

#include "formats/base/mem.h"
#include "formats/base/status.h"

/* file_guard_watch() - from now on each file that is opened for reading counts as an input: also
 * those that the command line does not name, such as the samples beside a header. */
void file_guard_watch(void);

/* file_guard_input() - an input by name; "-" is standard input; NULL and missing files are
 * ignored. ST_USAGE when it was announced as an output, ST_NOMEM. */
CHECKED status file_guard_input(const char *path);

/* file_guard_opened() - for those that open files: an input by its descriptor, if watched for, of
 * the job that m belongs to (NULL: of none). ST_USAGE when it is the job's target; errors as of
 * file_guard_input(). */
CHECKED status file_guard_opened(const mem *m, int fd, const char *path);

/* file_guard_look() - the calling thread looks at files to see what they are: what it opens
 * meanwhile does not count. What turns out to be an input is opened again, or named, afterwards. */
void file_guard_look(bool looks);

/* file_guard_output() - announce an output, which need not be there. ST_USAGE when it is an input
 * or was announced before, ST_NOMEM. NULL and "-" are none. */
CHECKED status file_guard_output(const char *path);

/* file_guard_check() - ST_USAGE when what stands under this name is an input; announces nothing. */
CHECKED status file_guard_check(const char *path);

/* file_guard_each_output() - the job's target, and those that are announced, for a program that
 * this one starts: it reads files of its own. take() calls nothing of the guard; what it returns
 * other than ST_OK ends the walk. */
CHECKED status file_guard_each_output(const mem *m, status (*take)(void *ctx, const char *path),
                                      void *ctx);

/* file_guard_forget() - a scratch file that was written, then read: it is no input, and about to
 * go. Another file may get its inode. */
void file_guard_forget(const char *path);

/* file_guard_next() - forget the outputs announced so far: they are complete. Inputs stay. */
void file_guard_next(void);

/* The file that a job of a library will replace. */
typedef struct file_guard_target {
    const char *path; /* the caller's */
    dev_t device;
    ino_t inode;
} file_guard_target;

/* file_guard_aim() - makes the file at this path m's target. Opening it with m is ST_USAGE from now
 * on, by whatever name. *t must live as long as m. Without a file there m has no target. */
void file_guard_aim(mem *m, file_guard_target *t, const char *path);

/* file_guard_named() - ST_USAGE when this path is m's target: told before work begins. */
CHECKED status file_guard_named(const mem *m, const char *path);

/* file_guard_reset() - forget everything, watch no more. */
void file_guard_reset(void);

#endif
