#include "formats/base/out_folder.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "formats/base/fault.h"
#include "formats/base/file.h"
#include "formats/base/file_guard.h"
#include "formats/base/partial.h"

struct out_folder {
    mem *m;
    char *path, *temporary; /* path: without a slash at the end */
    int fd;                 /* the folder, locked as long as this is open */
};

/* ---- the folder's name ---- */

static status exists(const char *path) {
    return status_describe(ST_EXISTS,
                           "%s: exists already, and a folder is not replaced, not by --force "
                           "either: remove it first",
                           path);
}

status out_folder_check(const char *path) {
    struct stat info;
    if (strcmp(path, "-") == 0)
        return status_describe(ST_USAGE, "-: a folder cannot go to standard output");
    if (!path[strspn(path, "/")])
        return status_describe(ST_USAGE, "an output without a name");
    status st = file_guard_check(path);
    if (st != ST_OK)
        return st;
    if (lstat(path, &info) == 0)
        return exists(path);
    return errno == ENOENT ? ST_OK : file_failed(errno, path, "cannot create");
}

static void close_folder(out_folder *f) {
    if (f->fd >= 0)
        close(f->fd);
    mem_free(f->m, f->path);
    mem_free(f->m, f->temporary);
    mem_free(f->m, f);
}

void out_folder_discard(out_folder *f) {
    uint64_t bytes;
    if (!f)
        return;
    if (f->fd >= 0)
        (void)partial_remove_folder(f->temporary, &bytes);
    close_folder(f);
}

status out_folder_create(mem *m, const char *path, out_folder **out) {
    status st = out_folder_check(path);
    out_folder *f = st == ST_OK ? mem_zalloc(m, sizeof *f) : NULL;
    if (!f)
        return st == ST_OK ? ST_NOMEM : st;
    *f = (out_folder){.m = m, .path = mem_copy_text(m, path), .fd = -1};
    f->temporary = mem_alloc(m, strlen(path) + PARTIAL_ROOM);
    st = f->path && f->temporary ? ST_OK : ST_NOMEM;
    if (st == ST_OK) {
        for (size_t n = strlen(f->path); n > 1 && f->path[n - 1] == '/'; n--)
            f->path[n - 1] = 0;
        f->fd = partial_open_folder(f->path, f->temporary);
        if (f->fd < 0)
            st = file_failed(errno, path, "cannot create");
    }
    if (st != ST_OK) {
        out_folder_discard(f);
        return st;
    }
    *out = f;
    return ST_OK;
}

/* ---- files in the folder ---- */

static status failed(const out_folder *f, const char *name, int error) {
    char path[PATH_MAX];
    snprintf(path, sizeof path, "%s/%s", f->path, name);
    return file_failed(error, path, "cannot write");
}

/* Make the folders on the way to a file; another thread may be making the same ones. */
static status make_way(const out_folder *f, const char *name) {
    char way[NAME_MAX];
    for (const char *slash = strchr(name, '/'); slash; slash = strchr(slash + 1, '/')) {
        snprintf(way, sizeof way, "%.*s", (int)(slash - name), name);
        if (mkdirat(f->fd, way, 0777) != 0 && errno != EEXIST)
            return failed(f, way, errno);
    }
    return ST_OK;
}

status out_folder_put(out_folder *f, const char *name, const void *bytes, size_t size) {
    status st = make_way(f, name);
    if (st != ST_OK)
        return st;
    const int fd = openat(f->fd, name, O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666);
    if (fd < 0)
        return failed(f, name, errno);
    st = fault_hit(FAULT_WRITE) ? failed(f, name, ENOSPC) : ST_OK;
    const uint64_t start = 0;
    if (st == ST_OK)
        st = file_write_all(fd, f->path, &start, bytes, size);
    if (close(fd) != 0 && st == ST_OK)
        st = failed(f, name, errno);
    return st;
}

/* ---- the end ---- */

/* Rename, never replacing a folder. Where the system cannot refuse a taken name, look first;
 * rename() itself never replaces a folder that has files in it. */
static int rename_new(const out_folder *f) {
    int wrong = renameat2(AT_FDCWD, f->temporary, AT_FDCWD, f->path, RENAME_NOREPLACE);
    if (wrong && (errno == EINVAL || errno == ENOSYS || errno == ENOTSUP)) {
        struct stat info;
        errno = EEXIST;
        wrong = lstat(f->path, &info) == 0 ? -1 : rename(f->temporary, f->path);
    }
    return wrong;
}

static status publish(const out_folder *f) {
    if (syncfs(f->fd) != 0)
        return file_failed(errno, f->path, "cannot write");
    status st = file_guard_check(f->path);
    if (st != ST_OK || rename_new(f) == 0)
        return st;
    return errno == EEXIST || errno == ENOTEMPTY ? exists(f->path)
                                                 : file_failed(errno, f->path, "cannot rename to");
}

status out_folder_commit(out_folder *f) {
    const status st = publish(f);
    if (st == ST_OK)
        close_folder(f);
    else
        out_folder_discard(f);
    return st;
}
