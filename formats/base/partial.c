#include "formats/base/partial.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdio.h>
#include <string.h>
#include <sys/file.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <sys/statfs.h>
#include <unistd.h>

#include "formats/base/file_guard.h"

enum { RANDOM_TRIES = 16, FOLDERS_DEEP = 16 };

static partial_leftover on_leftover;

void partial_on_leftover(partial_leftover say) {
    on_leftover = say;
}

/* How many bytes of the path temporary names begin with: all, except for names near the system's
 * limit. */
static int stem(const char *path) {
    const size_t suffix = strlen(".partial-") + 16, most = NAME_MAX - suffix;
    const char *slash = strrchr(path, '/');
    const size_t length = strlen(slash ? slash + 1 : path);
    return (int)(strlen(path) - (length > most ? length - most : 0));
}

static void slot_name(const char *path, int slot, char *name) {
    snprintf(name, strlen(path) + PARTIAL_ROOM, "%.*s.partial-%d", stem(path), path, slot);
}

/* Whether the name still belongs to the open file. Another process may have removed it, and made a
 * new one. */
static bool still_named(int fd, const char *name, struct stat *info) {
    struct stat named;
    return fstat(fd, info) == 0 && lstat(name, &named) == 0 && info->st_dev == named.st_dev &&
           info->st_ino == named.st_ino;
}

/* Whether all who could write the file see a lock: true for file systems of a single machine. */
static bool locks_are_seen(int fd) {
    static const uint32_t local[] = {
        0xEF53,     /* ext2, ext3, ext4 */
        0x58465342, /* XFS */
        0x9123683E, /* Btrfs */
        0x01021994, /* tmpfs */
        0x858458F6, /* ramfs */
        0x794C7630, /* overlay */
        0x2FC12FC1, /* ZFS */
        0xF2F52010, /* F2FS */
        0xCA451A4E, /* bcachefs */
        0x3153464A, /* JFS */
        0x4D44,     /* FAT */
        0x2011BAB0, /* exFAT */
        0x7366746E, /* NTFS */
    };
    struct statfs info;
    if (fstatfs(fd, &info) != 0)
        return false;
    for (size_t i = 0; i < sizeof local / sizeof *local; i++)
        if ((uint32_t)info.f_type == local[i])
            return true;
    return false;
}

static int lock(int fd) {
    int failed;
    do
        failed = flock(fd, LOCK_EX | LOCK_NB);
    while (failed && errno == EINTR);
    return failed;
}

/* Remove a file that nobody has locked. Keep it locked meanwhile: no other process can then take it
 * for a leftover too, and remove a newer file of its name. */
static void remove_leftover(const char *name) {
    struct stat info;
    if (lstat(name, &info) != 0 || !S_ISREG(info.st_mode) || file_guard_check(name) != ST_OK)
        return; /* an input stays, whatever its name */
    const int fd = open(name, O_RDWR | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
    if (fd < 0)
        return;
    if (lock(fd) == 0 && still_named(fd, name, &info)) {
        const bool removed = locks_are_seen(fd) && unlink(name) == 0;
        if (on_leftover)
            on_leftover(name, (uint64_t)info.st_size, removed);
    }
    close(fd);
}

/* Create and lock a file. Returns -1 and EEXIST also when another process took the new file for a
 * leftover before it was locked. That process then removes it; this one must not. */
static int create(const char *name) {
    const int fd = open(name, O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (fd < 0)
        return -1;
    struct stat info;
    const bool taken = lock(fd) != 0 && errno == EWOULDBLOCK;
    if (!taken && still_named(fd, name, &info))
        return fd;
    close(fd);
    errno = EEXIST;
    return -1;
}

/* ---- folders ---- */

/* Remove the contents of an open folder, and close it. Returns whether all is gone. */
static bool empty_folder(int fd, int deep, uint64_t *bytes) {
    DIR *d = fdopendir(fd);
    bool empty = d != NULL;
    if (!d)
        close(fd);
    for (const struct dirent *e; d && (e = readdir(d));) {
        struct stat info;
        if (strcmp(e->d_name, ".") == 0 || strcmp(e->d_name, "..") == 0)
            continue;
        bool gone = fstatat(fd, e->d_name, &info, AT_SYMLINK_NOFOLLOW) == 0;
        if (gone && S_ISDIR(info.st_mode)) {
            const int below =
                openat(fd, e->d_name, O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
            gone = below >= 0 && deep < FOLDERS_DEEP && empty_folder(below, deep + 1, bytes) &&
                   unlinkat(fd, e->d_name, AT_REMOVEDIR) == 0;
        } else if (gone) {
            gone = unlinkat(fd, e->d_name, 0) == 0;
            *bytes += gone ? (uint64_t)info.st_size : 0;
        }
        empty &= gone;
    }
    if (d)
        closedir(d);
    return empty;
}

static int open_folder(const char *name) {
    return open(name, O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
}

bool partial_remove_folder(const char *name, uint64_t *bytes) {
    const int fd = open_folder(name);
    *bytes = 0;
    return fd >= 0 && empty_folder(fd, 0, bytes) && rmdir(name) == 0;
}

/* Does the same as remove_leftover() for a folder. */
static void remove_left_folder(const char *name) {
    struct stat info;
    uint64_t bytes = 0;
    const int fd = open_folder(name);
    if (fd < 0)
        return;
    if (lock(fd) == 0 && still_named(fd, name, &info)) {
        const bool removed = locks_are_seen(fd) && partial_remove_folder(name, &bytes);
        if (on_leftover)
            on_leftover(name, bytes, removed);
    }
    close(fd);
}

static int create_folder(const char *name) {
    struct stat info;
    if (mkdir(name, 0777) != 0)
        return -1;
    const int fd = open_folder(name);
    if (fd < 0)
        return -1;
    const bool taken = lock(fd) != 0 && errno == EWOULDBLOCK;
    if (!taken && still_named(fd, name, &info))
        return fd;
    close(fd);
    errno = EEXIST;
    return -1;
}

int partial_open_folder(const char *path, char *name) {
    for (int slot = 1; slot <= PARTIAL_SLOTS; slot++) {
        slot_name(path, slot, name);
        remove_left_folder(name);
    }
    for (int slot = 1; slot <= PARTIAL_SLOTS; slot++) {
        slot_name(path, slot, name);
        const int fd = create_folder(name);
        if (fd >= 0 || errno != EEXIST)
            return fd;
    }
    errno = EBUSY;
    return -1;
}

/* ---- files ---- */

int partial_open(const char *path, char *name) {
    for (int slot = 1; slot <= PARTIAL_SLOTS; slot++) {
        slot_name(path, slot, name);
        remove_leftover(name);
    }
    for (int slot = 1; slot <= PARTIAL_SLOTS; slot++) {
        slot_name(path, slot, name);
        const int fd = create(name);
        if (fd >= 0 || errno != EEXIST)
            return fd;
    }
    /* Many processes write to it, or other files have these names. */
    for (int i = 0; i < RANDOM_TRIES; i++) {
        uint64_t number = 0;
        if (getrandom(&number, sizeof number, 0) < 0)
            return -1;
        snprintf(name, strlen(path) + PARTIAL_ROOM, "%.*s.partial-%016llx", stem(path), path,
                 (unsigned long long)number);
        const int fd = create(name);
        if (fd >= 0 || errno != EEXIST)
            return fd;
    }
    errno = EBUSY;
    return -1;
}
