/* file_guard.h - makes sure that an output is never an input, and never another output.
 *
 * One table for the process: the files it reads and the outputs it announced. A file is identified
 * by device and inode, so symbolic and hard links count. An output that does not exist yet is
 * identified by its folder and name. Only main programs fill the table. Library code asks it, and
 * finds it empty in other programs: there each job has its own target, so that jobs in several
 * threads do not interfere. Any thread.
 */
#ifndef FORMATS_BASE_FILE_GUARD_H
#define FORMATS_BASE_FILE_GUARD_H

#include <stdbool.h>
#include <sys/types.h>

#include "formats/base/mem.h"
#include "formats/base/status.h"

/* file_guard_watch() - from now on each file opened for reading counts as an input, also files that
 * the command line does not name, such as the samples beside a header. */
void file_guard_watch(void);

/* file_guard_input() - register an input by name. "-" is standard input; NULL and missing files are
 * ignored. ST_USAGE when it was announced as an output, ST_NOMEM. */
CHECKED status file_guard_input(const char *path);

/* file_guard_opened() - register an opened input by its descriptor, if watching; called by code
 * that opens files. m: the mem of the job (NULL: no job). ST_USAGE when the file is the job's
 * target; errors as of file_guard_input(). */
CHECKED status file_guard_opened(const mem *m, int fd, const char *path);

/* file_guard_look() - true: files that the calling thread opens from now on do not count, as it
 * only looks at what they are; false: they count again. A file that turns out to be an input is
 * opened again, or named, afterwards. */
void file_guard_look(bool looks);

/* file_guard_output() - announce an output, which need not exist. ST_USAGE when it is an input or
 * was announced before, ST_NOMEM. NULL and "-" are ignored. */
CHECKED status file_guard_output(const char *path);

/* file_guard_check() - ST_USAGE when the file of this name is an input; announces nothing. */
CHECKED status file_guard_check(const char *path);

/* file_guard_each_output() - call take() for the job's target and each announced output, to pass
 * them to a program that this one starts and that reads files of its own. take() must not call the
 * guard. Any result but ST_OK ends the walk. */
CHECKED status file_guard_each_output(const mem *m, status (*take)(void *ctx, const char *path),
                                      void *ctx);

/* file_guard_forget() - stop counting a scratch file, which was written and then read, as an input.
 * It is about to be removed, and another file may get its inode. */
void file_guard_forget(const char *path);

/* file_guard_next() - forget the outputs announced so far, as they are complete. Inputs stay. */
void file_guard_next(void);

/* The file that a job of a library will replace. */
typedef struct file_guard_target {
    const char *path; /* owned by the caller */
    dev_t device;
    ino_t inode;
} file_guard_target;

/* file_guard_aim() - make the file at this path m's target. From now on, opening it with m, by
 * whatever name, is ST_USAGE. *t must live as long as m. If there is no such file, m has no
 * target. */
void file_guard_aim(mem *m, file_guard_target *t, const char *path);

/* file_guard_named() - ST_USAGE when this path is m's target; asked before work begins. */
CHECKED status file_guard_named(const mem *m, const char *path);

/* file_guard_reset() - forget everything, and stop watching. */
void file_guard_reset(void);

#endif
