/* file.h - files read at offsets, and outputs that appear under their name only when complete.
 *
 * Reading: any number of threads may read one `file` at once. Writing: one thread per `out_file`;
 * only out_file_write_at() and out_file_read_at() may run in parallel, at places that no other
 * thread writes.
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

/* file_open() - open a regular file for reading. Returns ST_IO with the system's reason on failure,
 * at once for named pipes, devices, sockets and folders. ST_USAGE when it was announced as an
 * output, see file_guard.h; ST_NOMEM. The path is copied. */
CHECKED status file_open(mem *m, const char *path, file **out);
void file_close(file *f); /* NULL is fine */

/* file_open_pipe() - open a file, a pipe or a terminal to be read in order; ST_IO for anything
 * else. Does not wait for a pipe's writer: call wait_ready() before each read. */
CHECKED status file_open_pipe(const char *path, int *fd);

/* file_open_memory() - read the caller's bytes as a file. They must stay unchanged until it is
 * closed. name: its path in messages. */
CHECKED status file_open_memory(mem *m, const char *name, const void *bytes, size_t size,
                                file **out);

/* file_open_part() - open bytes [offset, offset + size) of another file as bytes 0 .. size - 1 of
 * this one. The part is cut where the other file ends, or what that is a part of. That one may be
 * closed first. The path of the new one says where in the whole file it begins. */
CHECKED status file_open_part(mem *m, const file *of, uint64_t offset, uint64_t size, file **out);

/* file_look_again() - the length of a file that others make longer. What is there is as it was. */
CHECKED status file_look_again(file *f);

const char *file_path(const file *f);
uint64_t file_size(const file *f);
int file_descriptor(const file *f); /* -1: in memory. Byte 0 of f is at file_offset() */
uint64_t file_offset(const file *f);
const void *file_memory(const file *f); /* address of byte 0; NULL: not in memory */

/* file_read_at() - exactly size bytes; ST_CORRUPT ("ends at byte N, expected ...") past the end,
 * ST_IO on an error. */
CHECKED status file_read_at(file *f, uint64_t offset, void *buffer, size_t size);

typedef struct out_file out_file;

/* file_kind_name() - what a mode other than a regular file's is called: "a folder", "a named
 * pipe". */
const char *file_kind_name(mode_t mode);

/* out_file_create() - open a temporary file beside path, see partial.h. Returns ST_EXISTS when path
 * exists and force is false, or when it is no regular file. ST_USAGE when it is an input, see
 * file_guard.h, or "-", or empty. To read back what was written (a spill, a header written last),
 * use out_file_read_at(). */
CHECKED status out_file_create(mem *m, const char *path, bool force, out_file **out);

/* out_file_continue() - the same as out_file_create(), in a temporary file of the caller's, which
 * is made if it is not there: it keeps what it holds, and stays when it is discarded. */
CHECKED status out_file_continue(mem *m, const char *path, const char *temporary, bool force,
                                 out_file **out);

/* out_file_check() - what out_file_create() would return, to be asked before work begins. Leaves no
 * file behind. */
CHECKED status out_file_check(mem *m, const char *path, bool force);

/* out_file_scratch() - a temporary file beside path that has no name and vanishes on close. */
CHECKED status out_file_scratch(mem *m, const char *path, out_file **out);

/* out_file_scratch_path() - the path beside which an output's temporary files go: the output's own.
 * For standard output ("-" or NULL) it is a path in $TMPDIR, else /tmp, made of the program's name
 * and the user's number. Free *path in any case. */
CHECKED status out_file_scratch_path(mem *m, const char *output, const char *program, char **path);

/* Writing: ST_NOSPACE when the disk is full or the file may not grow further (quota, RLIMIT_FSIZE
 * with SIGXFSZ ignored). */
CHECKED status out_file_write_at(out_file *f, uint64_t offset, const void *data, size_t size);
CHECKED status out_file_append(out_file *f, const void *data,
                               size_t size); /* behind what was appended before */
/* out_file_cut() - shorten the file to `size`. */
CHECKED status out_file_cut(out_file *f, uint64_t size);

/* out_file_size() - the bytes that it has; 0 if the system does not tell. */
uint64_t out_file_size(const out_file *f);
CHECKED status out_file_read_at(out_file *f, uint64_t offset, void *buffer, size_t size);

/* out_file_sync() - wait until what was written is on the disk. */
CHECKED status out_file_sync(out_file *f);
const char *out_file_temporary(const out_file *f); /* its present path; NULL: it has none */

/* out_file_commit() - fsync, rename to the final name (refusing to overwrite without force), fsync
 * the folder, close. On an error the temporary file is removed, if out_file_create() made it.
 * Consumes f in any case. */
CHECKED status out_file_commit(out_file *f);

/* out_file_discard() - remove the temporary file and close. NULL is fine. */
void out_file_discard(out_file *f);

/* file_write_all() - write size bytes to a descriptor, for streams such as standard output: at
 * *offset or, when that is NULL, at the current position. `path` names it in the description. Waits
 * for a pipe's reader by wait_ready(), so it may return ST_STOPPED, too. */
CHECKED status file_write_all(int fd, const char *path, const uint64_t *offset, const void *data,
                              size_t size);

/* file_failed() - describe a failed system call: "path: doing: reason". Returns ST_NOSPACE,
 * ST_NOMEM or ST_IO, by the error number. */
status file_failed(int error, const char *path, const char *doing);

#endif
