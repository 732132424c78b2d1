/* file.h - files read at offsets, and outputs that appear under their name only when complete.
 *
 * Reading: any number of threads may read one `file` at once. Writing: one thread per
 * `out_file`, but for out_file_write_at() and out_file_read_at() at places no other thread writes.
 */
#ifndef FORMATS_BASE_FILE_H
#define FORMATS_BASE_FILE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <sys/types.h>

#include "formats/base/mem.h"
#include "formats/base/status.h"

typedef struct file file;

/* file_open() - a regular file for reading; ST_IO with the system's reason otherwise, at once for
 * named pipes, devices, sockets and folders. ST_USAGE when it was announced as an output, see
 * file_guard.h; ST_NOMEM. The path is copied. */
CHECKED status file_open(mem *m, const char *path, file **out);
void file_close(file *f); /* NULL is fine */

/* file_open_pipe() - a descriptor to read what comes in order: of a file, a pipe or a terminal;
 * ST_IO for anything else. Does not wait for a pipe's writer: wait_ready() before each read. */
CHECKED status file_open_pipe(const char *path, int *fd);

/* file_open_memory() - bytes of the caller's, read as a file is; they stay as they are until it is
 * closed. name: its path in messages. */
CHECKED status file_open_memory(mem *m, const char *name, const void *bytes, size_t size,
                                file **out);

/* file_open_part() - bytes [offset, offset + size) of another file, which may be closed before this
 * one; they are then 0 .. size - 1 of this one, and need not be there. Its path says which part it
 * is. `of` is no part itself. */
CHECKED status file_open_part(mem *m, const file *of, uint64_t offset, uint64_t size, file **out);

const char *file_path(const file *f);
uint64_t file_size(const file *f);
int file_descriptor(const file *f); /* byte 0 is at file_offset(); -1: in memory */
uint64_t file_offset(const file *f);
const void *file_memory(const file *f); /* where byte 0 is; NULL: not in memory */

/* file_read_at() - exactly size bytes; ST_CORRUPT ("ends at byte N, expected ...") past the end,
 * ST_IO on an error. */
CHECKED status file_read_at(file *f, uint64_t offset, void *buffer, size_t size);

typedef struct out_file out_file;

/* file_kind_name() - what is no regular file, by its mode: "a folder", "a named pipe". */
const char *file_kind_name(mode_t mode);

/* out_file_create() - open a temporary file beside path, see partial.h. ST_EXISTS when path
 * exists and force is false, or when it is no regular file. ST_USAGE when it is an input, see
 * file_guard.h, or "-", or empty. Data that is also read back (a spill, a header written last) goes
 * through out_file_read_at(). */
CHECKED status out_file_create(mem *m, const char *path, bool force, out_file **out);

/* out_file_check() - what out_file_create() would return, told before work begins; leaves nothing.
 */
CHECKED status out_file_check(mem *m, const char *path, bool force);

/* out_file_scratch() - a temporary file beside path that has no name and vanishes on close. */
CHECKED status out_file_scratch(mem *m, const char *path, out_file **out);

/* out_file_scratch_path() - the path beside which temporary files of an output go: its own, or for
 * standard output ("-" or NULL) one in $TMPDIR, else /tmp, with the program's name and the user's
 * number. Free *path in any case. */
CHECKED status out_file_scratch_path(mem *m, const char *output, const char *program, char **path);

/* Writing: ST_NOSPACE when the disk is full or the file may not grow further (quota, RLIMIT_FSIZE
 * with SIGXFSZ ignored). */
CHECKED status out_file_write_at(out_file *f, uint64_t offset, const void *data, size_t size);
CHECKED status out_file_append(out_file *f, const void *data,
                               size_t size); /* at the end of what was appended */
/* out_file_cut() - it ends at `size`, before where it did. */
CHECKED status out_file_cut(out_file *f, uint64_t size);
CHECKED status out_file_read_at(out_file *f, uint64_t offset, void *buffer, size_t size);
const char *out_file_temporary(const out_file *f); /* where it is now; NULL: nowhere */

/* out_file_commit() - fsync, rename to the final name (refusing to overwrite without force), fsync
 * the folder, close. On an error the temporary file is removed. Consumes f in any case. */
CHECKED status out_file_commit(out_file *f);

/* out_file_discard() - remove the temporary file and close. NULL is fine. */
void out_file_discard(out_file *f);

/* file_write_all() - for streams such as standard output: size bytes to a descriptor, at *offset
 * or, when that is NULL, where it stands; `path` names it in the description. Waits for a pipe's
 * reader by wait_ready(), so ST_STOPPED, too. */
CHECKED status file_write_all(int fd, const char *path, const uint64_t *offset, const void *data,
                              size_t size);

/* file_failed() - describe a failed system call: "path: doing: reason". ST_NOSPACE, ST_NOMEM or
 * ST_IO, by the error number. */
status file_failed(int error, const char *path, const char *doing);

#endif
