#include "formats/base/file.h"

#include <assert.h>
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "formats/base/fault.h"
#include "formats/base/file_guard.h"
#include "formats/base/partial.h"
#include "formats/base/wait.h"

struct file {
    mem *m;
    int fd;
    const char *memory; /* the bytes, in place of fd; else NULL */
    uint64_t offset;    /* of byte 0, within fd or memory */
    uint64_t size;
    char *path;
    char *whole; /* of a part: the path that was opened; else NULL */
};

struct out_file {
    mem *m;
    int fd;
    bool force;
    uint64_t end;
    char *path;
    char *temporary; /* NULL: a scratch file, without a name */
    bool stays;      /* the temporary file, when it is discarded */
};

/* One read or write call moves at most this much, so that sizes fit every system's ssize_t. */
static const size_t CHUNK = (size_t)1 << 30;
enum { LARGE = 64 << 10 };

status file_failed(int error, const char *path, const char *doing) {
    bool full = error == ENOSPC || error == EFBIG || error == EDQUOT;
    status st = error == ENOMEM ? ST_NOMEM : full ? ST_NOSPACE : ST_IO;
    return status_describe(st, "%s: %s: %s", path, doing, strerror(error));
}

/* ---- reading ---- */

const char *file_kind_name(mode_t mode) {
    return S_ISDIR(mode)    ? "a folder"
           : S_ISFIFO(mode) ? "a named pipe"
           : S_ISSOCK(mode) ? "a socket"
                            : "a device";
}

static status wrong_kind(const char *path, mode_t mode, const char *wanted) {
    return status_describe(ST_IO, "%s: is %s, expected %s", path, file_kind_name(mode), wanted);
}

/* O_NONBLOCK: a named pipe without a writer must not block the open. It does not affect regular
 * files. */
static status open_any(const char *path, int *fd, struct stat *info) {
    *fd = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY);
    if (*fd < 0) {
        const int error = errno;
        if (error == ENXIO && stat(path, info) == 0)
            return wrong_kind(path, info->st_mode, "a file");
        return file_failed(error, path, "cannot open");
    }
    return fstat(*fd, info) == 0 ? ST_OK : file_failed(errno, path, "cannot look at");
}

static status open_regular(file *f, const char *path) {
    struct stat info;
    status st = open_any(path, &f->fd, &info);
    if (st != ST_OK)
        return st;
    if (!S_ISREG(info.st_mode))
        return wrong_kind(path, info.st_mode, "a regular file");
    f->size = (uint64_t)info.st_size;
    return file_guard_opened(f->m, f->fd, path);
}

static status make_file(mem *m, const char *path, file **out) {
    file *f = mem_zalloc(m, sizeof *f);
    if (!f)
        return ST_NOMEM;
    f->m = m;
    f->fd = -1;
    f->path = mem_copy_text(m, path);
    if (!f->path) {
        file_close(f);
        return ST_NOMEM;
    }
    *out = f;
    return ST_OK;
}

status file_open(mem *m, const char *path, file **out) {
    file *f = NULL;
    status st = make_file(m, path, &f);
    if (st == ST_OK)
        st = open_regular(f, path);
    if (st != ST_OK) {
        file_close(f);
        return st;
    }
    *out = f;
    return ST_OK;
}

status file_open_memory(mem *m, const char *name, const void *bytes, size_t size, file **out) {
    static const char none;
    status st = make_file(m, name, out);
    if (st != ST_OK)
        return st;
    (*out)->memory = size ? bytes : &none;
    (*out)->size = size;
    return ST_OK;
}

status file_open_pipe(const char *path, int *fd) {
    struct stat info;
    status st = open_any(path, fd, &info);
    if (st == ST_OK && !S_ISFIFO(info.st_mode) && !S_ISREG(info.st_mode) && !isatty(*fd))
        st = wrong_kind(path, info.st_mode, "a file or a pipe");
    if (st != ST_OK && *fd >= 0)
        close(*fd);
    return st;
}

status file_open_part(mem *m, const file *of, uint64_t offset, uint64_t size, file **out) {
    file *f = NULL;
    const char *path = of->whole ? of->whole : of->path;
    status st = of->memory
                    ? file_open_memory(m, path, of->memory, (size_t)(of->offset + of->size), &f)
                    : file_open(m, path, &f);
    if (st != ST_OK)
        return st;
    const size_t room = strlen(path) + 64;
    char *name = mem_alloc(m, room);
    if (!name) {
        file_close(f);
        return ST_NOMEM;
    }
    if (of->whole)
        size = offset >= of->size ? 0 : size < of->size - offset ? size : of->size - offset;
    offset += of->offset;
    snprintf(name, room, "%s (from byte %llu)", path, (unsigned long long)offset);
    f->whole = f->path;
    f->path = name;
    const uint64_t behind = f->size > offset ? f->size - offset : 0;
    f->offset = offset;
    f->size = size < behind ? size : behind;
    *out = f;
    return ST_OK;
}

status file_look_again(file *f) {
    struct stat info;
    assert(f->offset == 0);
    if (f->memory)
        return ST_OK;
    if (fstat(f->fd, &info) != 0)
        return file_failed(errno, f->path, "cannot look at");
    f->size = (uint64_t)info.st_size;
    return ST_OK;
}

void file_close(file *f) {
    if (!f)
        return;
    if (f->fd >= 0)
        close(f->fd);
    mem_free(f->m, f->whole);
    mem_free(f->m, f->path);
    mem_free(f->m, f);
}

const char *file_path(const file *f) {
    return f->path;
}

uint64_t file_size(const file *f) {
    return f->size;
}

int file_descriptor(const file *f) {
    return f->fd;
}

uint64_t file_offset(const file *f) {
    return f->offset;
}

const void *file_memory(const file *f) {
    return f->memory ? f->memory + f->offset : NULL;
}

static status read_at(int fd, const char *path, uint64_t offset, void *buffer, size_t size) {
    if (fault_hit(FAULT_READ))
        return file_failed(EIO, path, "cannot read");
    for (size_t done = 0; done < size;) {
        size_t step = size - done < CHUNK ? size - done : CHUNK;
        ssize_t got = pread(fd, (char *)buffer + done, step, (off_t)(offset + done));
        if (got == 0)
            return status_describe(
                ST_CORRUPT, "%s: ends at byte %llu, expected %zu bytes from %llu", path,
                (unsigned long long)(offset + done), size, (unsigned long long)offset);
        if (got < 0 && errno != EINTR)
            return file_failed(errno, path, "cannot read");
        done += got > 0 ? (size_t)got : 0;
    }
    return ST_OK;
}

status file_read_at(file *f, uint64_t offset, void *buffer, size_t size) {
    /* Report a read past the end with the file's true size, before an offset can overflow. */
    if (offset > f->size || size > f->size - offset)
        return status_describe(ST_CORRUPT, "%s: ends at byte %llu, expected %zu bytes from %llu",
                               f->path, (unsigned long long)f->size, size,
                               (unsigned long long)offset);
    if (!f->memory)
        return read_at(f->fd, f->path, f->offset + offset, buffer, size);
    memcpy(buffer, f->memory + f->offset + offset, size);
    return ST_OK;
}

/* ---- writing ---- */

static status open_temporary(out_file *f) {
    f->temporary = mem_alloc(f->m, strlen(f->path) + PARTIAL_ROOM);
    if (!f->temporary)
        return ST_NOMEM;
    f->fd = partial_open(f->path, f->temporary);
    return f->fd >= 0 ? ST_OK : file_failed(errno, f->path, "cannot create");
}

static void close_out(out_file *f) {
    if (f->fd >= 0)
        close(f->fd);
    mem_free(f->m, f->temporary);
    mem_free(f->m, f->path);
    mem_free(f->m, f);
}

void out_file_discard(out_file *f) {
    if (!f)
        return;
    if (f->fd >= 0 && f->temporary && !f->stays)
        unlink(f->temporary);
    close_out(f);
}

static status exists(const char *path) {
    struct stat info;
    if (stat(path, &info) != 0 && lstat(path, &info) == 0)
        return status_describe(
            ST_EXISTS,
            "%s: exists already: a symbolic link that leads nowhere (--force replaces it)", path);
    return status_describe(ST_EXISTS, "%s: exists already (--force overwrites it)", path);
}

/* Check what has the final name. It may be replaced only if it is a regular file and no input, and
 * only with force. A symbolic link counts as existing, wherever it leads. */
static status check_target(const char *path, bool force) {
    if (strcmp(path, "-") == 0)
        return status_describe(ST_USAGE, "-: this cannot go to standard output (./- is a file)");
    if (!*path)
        return status_describe(ST_USAGE, "an output without a name");
    status st = file_guard_check(path);
    if (st != ST_OK)
        return st;
    struct stat info;
    if (stat(path, &info) == 0 && !S_ISREG(info.st_mode))
        return status_describe(ST_EXISTS, "%s: exists already and is not a regular file", path);
    if (lstat(path, &info) != 0)
        return errno == ENOENT ? ST_OK : file_failed(errno, path, "cannot create");
    return force ? ST_OK : exists(path);
}

static status make_out(mem *m, const char *path, bool force, out_file **out) {
    out_file *f = mem_zalloc(m, sizeof *f);
    if (!f)
        return ST_NOMEM;
    f->m = m;
    f->fd = -1;
    f->force = force;
    f->path = mem_copy_text(m, path);
    if (!f->path) {
        close_out(f);
        return ST_NOMEM;
    }
    *out = f;
    return ST_OK;
}

status out_file_create(mem *m, const char *path, bool force, out_file **out) {
    status st = check_target(path, force);
    out_file *f = NULL;
    if (st == ST_OK)
        st = make_out(m, path, force, &f);
    if (st != ST_OK)
        return st;
    st = open_temporary(f);
    if (st != ST_OK) {
        out_file_discard(f);
        return st;
    }
    *out = f;
    return ST_OK;
}

static status open_kept(out_file *f, const char *temporary) {
    f->stays = true;
    f->temporary = mem_copy_text(f->m, temporary);
    if (!f->temporary)
        return ST_NOMEM;
    f->fd = open(temporary, O_RDWR | O_CREAT | O_NOFOLLOW | O_CLOEXEC, 0666);
    return f->fd >= 0 ? ST_OK : file_failed(errno, temporary, "cannot create");
}

status out_file_continue(mem *m, const char *path, const char *temporary, bool force,
                         out_file **out) {
    status st = check_target(path, force);
    out_file *f = NULL;
    if (st == ST_OK)
        st = make_out(m, path, force, &f);
    if (st != ST_OK)
        return st;
    st = open_kept(f, temporary);
    if (st != ST_OK) {
        out_file_discard(f);
        return st;
    }
    *out = f;
    return ST_OK;
}

status out_file_check(mem *m, const char *path, bool force) {
    out_file *probe = NULL;
    status st = out_file_create(m, path, force, &probe);
    out_file_discard(probe);
    return st;
}

/* The folder a path lies in, opened; -1 and errno on failure. */
static int open_folder(mem *m, const char *path, int flags) {
    const char *slash = strrchr(path, '/');
    char *folder = mem_copy_text(m, slash ? path : ".");
    if (!folder) {
        errno = ENOMEM;
        return -1;
    }
    if (slash)
        folder[slash == path ? 1 : slash - path] = 0;
    int fd = open(folder, flags | O_CLOEXEC, 0600);
    int error = errno;
    mem_free(m, folder);
    errno = error;
    return fd;
}

status out_file_scratch_path(mem *m, const char *output, const char *program, char **path) {
    if (output && strcmp(output, "-") != 0) {
        *path = mem_copy_text(m, output);
        return *path ? ST_OK : ST_NOMEM;
    }
    const char *folder = getenv("TMPDIR");
    if (!folder || !*folder)
        folder = "/tmp";
    const size_t size = strlen(folder) + strlen(program) + 32;
    *path = mem_alloc(m, size);
    if (!*path)
        return ST_NOMEM;
    snprintf(*path, size, "%s/%s-%ld", folder, program, (long)getuid());
    return ST_OK;
}

status out_file_scratch(mem *m, const char *path, out_file **out) {
    out_file *f = NULL;
    status st = make_out(m, path, false, &f);
    if (st != ST_OK)
        return st;
    f->fd = open_folder(m, path, O_TMPFILE | O_RDWR | O_EXCL);
    if (f->fd < 0 && (errno == EOPNOTSUPP || errno == EISDIR)) {
        /* A file system without nameless files: create one, then remove its name. */
        st = open_temporary(f);
        if (st == ST_OK)
            unlink(f->temporary);
        mem_free(m, f->temporary);
        f->temporary = NULL;
    } else if (f->fd < 0) {
        st = file_failed(errno, path, "cannot create a temporary file beside");
    }
    if (st != ST_OK) {
        close_out(f);
        return st;
    }
    *out = f;
    return ST_OK;
}

/* Whether a write may block until someone reads. */
static bool may_wait(int fd, const uint64_t *offset) {
    struct stat info;
    return !offset && !(fstat(fd, &info) == 0 && S_ISREG(info.st_mode));
}

status file_write_all(int fd, const char *path, const uint64_t *offset, const void *data,
                      size_t size) {
    if (fault_hit(FAULT_WRITE))
        return file_failed(ENOSPC, path, "cannot write");
    /* A pipe that poll() calls ready takes at least PIPE_BUF bytes. A longer write would block
     * inside the call, where nobody can stop it. */
    const bool waits = may_wait(fd, offset);
    const size_t most = waits ? PIPE_BUF : CHUNK;
    for (size_t done = 0; done < size;) {
        status st = waits ? wait_ready(fd, POLLOUT, path) : ST_OK;
        if (st != ST_OK)
            return st;
        const size_t step = size - done < most ? size - done : most;
        const char *from = (const char *)data + done;
        ssize_t put =
            offset ? pwrite(fd, from, step, (off_t)(*offset + done)) : write(fd, from, step);
        if (put < 0 && errno != EINTR && errno != EAGAIN)
            return file_failed(errno, path, "cannot write");
        done += put > 0 ? (size_t)put : 0;
    }
    return ST_OK;
}

/* Large pieces are on their way to the disk at once, so that a sync at the end has little to wait
 * for. */
status out_file_write_at(out_file *f, uint64_t offset, const void *data, size_t size) {
    const uint64_t from = offset;
    const status st = file_write_all(f->fd, f->path, &offset, data, size);
    if (st == ST_OK && f->temporary && size >= LARGE)
        (void)sync_file_range(f->fd, (off_t)from, (off_t)size, SYNC_FILE_RANGE_WRITE);
    return st;
}

status out_file_cut(out_file *f, uint64_t size) {
    errno = 0;
    if (fault_hit(FAULT_WRITE) || ftruncate(f->fd, (off_t)size) != 0)
        return file_failed(errno ? errno : EIO, f->path, "cannot be shortened");
    return ST_OK;
}

uint64_t out_file_size(const out_file *f) {
    struct stat info;
    return fstat(f->fd, &info) == 0 ? (uint64_t)info.st_size : 0;
}

status out_file_append(out_file *f, const void *data, size_t size) {
    status st = out_file_write_at(f, f->end, data, size);
    if (st == ST_OK)
        f->end += size;
    return st;
}

status out_file_read_at(out_file *f, uint64_t offset, void *buffer, size_t size) {
    return read_at(f->fd, f->path, offset, buffer, size);
}

const char *out_file_temporary(const out_file *f) {
    return f->temporary;
}

/* For file systems with neither RENAME_NOREPLACE nor hard links: claim the name with an empty file,
 * then replace that. */
static int claim_and_rename(const out_file *f) {
    const int fd = open(f->path, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (fd < 0)
        return -1;
    close(fd);
    if (rename(f->temporary, f->path) == 0)
        return 0;
    const int error = errno;
    unlink(f->path);
    errno = error;
    return -1;
}

/* Give the file its final name; never replace another that appeared meanwhile. */
static status rename_new(const out_file *f) {
    int failed = renameat2(AT_FDCWD, f->temporary, AT_FDCWD, f->path, RENAME_NOREPLACE);
    if (failed && (errno == EINVAL || errno == ENOSYS)) {
        /* A file system without RENAME_NOREPLACE: a hard link refuses an existing name as well. */
        failed = link(f->temporary, f->path);
        if (!failed)
            unlink(f->temporary);
        else if (errno != EEXIST)
            failed = claim_and_rename(f);
    }
    if (!failed)
        return ST_OK;
    return errno == EEXIST ? exists(f->path) : file_failed(errno, f->path, "cannot rename to");
}

status out_file_sync(out_file *f) {
    if (fault_hit(FAULT_WRITE))
        return file_failed(ENOSPC, f->path, "cannot write");
    return fsync(f->fd) == 0 ? ST_OK : file_failed(errno, f->path, "cannot write");
}

static status publish(out_file *f) {
    status st = out_file_sync(f);
    if (st == ST_OK)
        st = check_target(f->path, true);
    if (st == ST_OK && !f->force)
        return rename_new(f);
    if (st == ST_OK && rename(f->temporary, f->path) != 0)
        st = file_failed(errno, f->path, "cannot rename to");
    return st;
}

status out_file_commit(out_file *f) {
    status st = publish(f);
    if (st != ST_OK) {
        out_file_discard(f);
        return st;
    }
    /* Sync the folder, too, since it holds the name. Some file systems cannot sync a folder, which
     * is no fault of the file. */
    int folder = open_folder(f->m, f->path, O_RDONLY | O_DIRECTORY);
    if (folder >= 0) {
        (void)fsync(folder);
        close(folder);
    }
    close_out(f);
    return ST_OK;
}
