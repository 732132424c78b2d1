/* disk_calls.h - the system's calls that change a disk, noted in the log (disk_log.h) and passed
 * on. A test program includes it once: then these are its own. Syncs are noted alone.
 */
#ifndef TESTS_SUPPORT_DISK_CALLS_H
#define TESTS_SUPPORT_DISK_CALLS_H

#include <dlfcn.h>
#include <fcntl.h>
#include <stdarg.h>
#include <stdio.h>
#include <sys/stat.h>
#include <unistd.h>

#include "tests/support/disk_log.h"

#define REAL(type, name, ...) ((type(*)(__VA_ARGS__))dlsym(RTLD_NEXT, name))

static int open_noted(const char *path, int flags, mode_t mode) {
    struct stat s;
    const bool is_new = (flags & O_CREAT) && lstat(path, &s) != 0;
    const int fd = REAL(int, "open64", const char *, int, ...)(path, flags, mode);
    if (fd >= 0 && is_new)
        disk_log_made(path, false);
    return fd;
}

static ssize_t pwrite_noted(int fd, const void *data, size_t size, off_t at) {
    const ssize_t put =
        REAL(ssize_t, "pwrite64", int, const void *, size_t, off_t)(fd, data, size, at);
    if (put > 0)
        disk_log_written(fd, (uint64_t)at, data, (size_t)put);
    return put;
}

static int cut_noted(int fd, off_t size) {
    const int rc = REAL(int, "ftruncate64", int, off_t)(fd, size);
    if (rc == 0)
        disk_log_cut(fd, (uint64_t)size);
    return rc;
}

/* The C library has two names of some. */
#define OPEN(name)                                                      \
    int name##_here(const char *path, int flags, ...) __asm__(#name);   \
    int name##_here(const char *path, int flags, ...) {                 \
        va_list args;                                                   \
        va_start(args, flags);                                          \
        const mode_t mode = flags & O_CREAT ? va_arg(args, mode_t) : 0; \
        va_end(args);                                                   \
        return open_noted(path, flags, mode);                           \
    }
#define PWRITE(name)                                                                     \
    ssize_t name##_here(int fd, const void *data, size_t size, off_t at) __asm__(#name); \
    ssize_t name##_here(int fd, const void *data, size_t size, off_t at) {               \
        return pwrite_noted(fd, data, size, at);                                         \
    }
#define CUT(name)                                       \
    int name##_here(int fd, off_t size) __asm__(#name); \
    int name##_here(int fd, off_t size) {               \
        return cut_noted(fd, size);                     \
    }
OPEN(open)
OPEN(open64)
PWRITE(pwrite)
PWRITE(pwrite64)
CUT(ftruncate)
CUT(ftruncate64)

/* A file that somebody else makes when a state has been saved; or NULL. */
static const char *taken;
static int syncs;

/* Noted alone: nothing here depends on the disk, and it takes long. */
int fsync(int fd) {
    disk_log_synced(fd);
    if (taken && ++syncs == 8) {
        fclose(fopen(taken, "wb"));
        taken = NULL;
        syncs = 0;
    }
    return 0;
}

int mkdir(const char *path, mode_t mode) {
    const int rc = REAL(int, "mkdir", const char *, mode_t)(path, mode);
    if (rc == 0)
        disk_log_made(path, true);
    return rc;
}

int unlink(const char *path) {
    const int rc = REAL(int, "unlink", const char *)(path);
    if (rc == 0)
        disk_log_moved(path, NULL);
    return rc;
}

int rmdir(const char *path) {
    const int rc = REAL(int, "rmdir", const char *)(path);
    if (rc == 0)
        disk_log_moved(path, NULL);
    return rc;
}

int rename(const char *from, const char *to) {
    const int rc = REAL(int, "rename", const char *, const char *)(from, to);
    if (rc == 0)
        disk_log_moved(from, to);
    return rc;
}

int renameat2(int a, const char *from, int b, const char *to, unsigned flags) {
    const int rc = REAL(int, "renameat2", int, const char *, int, const char *,
                        unsigned)(a, from, b, to, flags);
    if (rc == 0)
        disk_log_moved(from, to);
    return rc;
}

#endif
