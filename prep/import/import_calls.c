/* import_calls.c - replaces the C library's functions that open files, so that all calls of an
 * importer and of its libraries go through file_door.h.
 *
 * It is linked into importers alone. Calls inside of the C library are not replaced: they read
 * system files, which the fence leaves open. Errors are errno codes, without descriptions.
 */
#undef _FORTIFY_SOURCE
#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "prep/import/crash.h"
#include "prep/import/file_door.h"

#define PUBLIC __attribute__((visibility("default")))

/* ---- before all others ---- */

/* Run before all else: libraries start threads when they are loaded, and Landlock holds only
 * threads that start later. */
#ifndef IMPORT_UNFENCED
static void begin(int argc, char **argv, char **environment) {
    (void)argc;
    (void)argv;
    crash_begin();
    file_door_build(environment);
}

__attribute__((section(".preinit_array"), used)) static void (*const first)(int, char **,
                                                                            char **) = begin;
#endif

/* ---- descriptors ---- */

/* The mode argument exists only if a file may be created. */
#define WITH_MODE(mode, flags)                 \
    do {                                       \
        if ((flags) & (O_CREAT | O_TMPFILE)) { \
            va_list rest;                      \
            va_start(rest, flags);             \
            (mode) = va_arg(rest, mode_t);     \
            va_end(rest);                      \
        }                                      \
    } while (0)

PUBLIC int open(const char *path, int flags, ...) {
    mode_t mode = 0;
    WITH_MODE(mode, flags);
    return file_door_open(AT_FDCWD, path, flags, mode);
}

PUBLIC int open64(const char *path, int flags, ...) {
    mode_t mode = 0;
    WITH_MODE(mode, flags);
    return file_door_open(AT_FDCWD, path, flags, mode);
}

PUBLIC int openat(int folder, const char *path, int flags, ...) {
    mode_t mode = 0;
    WITH_MODE(mode, flags);
    return file_door_open(folder, path, flags, mode);
}

PUBLIC int openat64(int folder, const char *path, int flags, ...) {
    mode_t mode = 0;
    WITH_MODE(mode, flags);
    return file_door_open(folder, path, flags, mode);
}

PUBLIC int creat(const char *path, mode_t mode) {
    return file_door_open(AT_FDCWD, path, O_CREAT | O_WRONLY | O_TRUNC, mode);
}

PUBLIC int creat64(const char *path, mode_t mode) {
    return creat(path, mode);
}

/* Variants that programs built with _FORTIFY_SOURCE call. */
int __open_2(const char *path, int flags);
int __open64_2(const char *path, int flags);
int __openat_2(int folder, const char *path, int flags);
int __openat64_2(int folder, const char *path, int flags);

PUBLIC int __open_2(const char *path, int flags) {
    return file_door_open(AT_FDCWD, path, flags, 0);
}

PUBLIC int __open64_2(const char *path, int flags) {
    return file_door_open(AT_FDCWD, path, flags, 0);
}

PUBLIC int __openat_2(int folder, const char *path, int flags) {
    return file_door_open(folder, path, flags, 0);
}

PUBLIC int __openat64_2(int folder, const char *path, int flags) {
    return file_door_open(folder, path, flags, 0);
}

/* ---- streams and folders ---- */

static int flags_of(const char *mode) {
    const bool both = strchr(mode, '+') != NULL;
    const int access = both ? O_RDWR : *mode == 'r' ? O_RDONLY : O_WRONLY;
    const int make = *mode == 'w' ? O_CREAT | O_TRUNC : *mode == 'a' ? O_CREAT | O_APPEND : 0;
    return access | make | (strchr(mode, 'x') ? O_EXCL : 0) | (strchr(mode, 'e') ? O_CLOEXEC : 0);
}

PUBLIC FILE *fopen(const char *path, const char *mode) {
    if (!strchr("rwa", *mode) || !*mode) {
        errno = EINVAL;
        return NULL;
    }
    const int fd = file_door_open(AT_FDCWD, path, flags_of(mode), 0666);
    FILE *stream = fd < 0 ? NULL : fdopen(fd, mode);
    if (fd >= 0 && !stream)
        close(fd);
    return stream;
}

PUBLIC FILE *fopen64(const char *path, const char *mode) {
    return fopen(path, mode);
}

PUBLIC DIR *opendir(const char *path) {
    const int fd = file_door_open(AT_FDCWD, path, O_RDONLY | O_DIRECTORY | O_CLOEXEC, 0);
    DIR *folder = fd < 0 ? NULL : fdopendir(fd);
    if (fd >= 0 && !folder)
        close(fd);
    return folder;
}

/* ---- names ---- */

PUBLIC int unlink(const char *path) {
    return file_door_unlink(path);
}

PUBLIC int rename(const char *from, const char *to) {
    return file_door_rename(from, to, 0);
}

PUBLIC int renameat2(int from_folder, const char *from, int to_folder, const char *to,
                     unsigned flags) {
    if (from_folder == AT_FDCWD && to_folder == AT_FDCWD)
        return file_door_rename(from, to, flags);
    errno = EACCES;
    return -1;
}

PUBLIC int link(const char *from, const char *to) {
    return file_door_link(from, to);
}
