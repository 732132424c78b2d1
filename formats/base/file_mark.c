#include "formats/base/file_mark.h"

#include <assert.h>
#include <errno.h>
#include <sys/stat.h>
#include <time.h>

static file_mark mark_of(const struct stat *s) {
    return (file_mark){.device = (uint64_t)s->st_dev,
                       .inode = (uint64_t)s->st_ino,
                       .size = (uint64_t)s->st_size,
                       .modified_s = s->st_mtim.tv_sec,
                       .modified_ns = s->st_mtim.tv_nsec};
}

status file_mark_take(const file *f, file_mark *mark) {
    struct stat s;
    *mark = (file_mark){0};
    if (file_memory(f))
        return ST_OK;
    if (fstat(file_descriptor(f), &s) != 0)
        return file_failed(errno, file_path(f), "looking at its size");
    *mark = mark_of(&s);
    return ST_OK;
}

status file_mark_check_name(const file *f, const file_mark *mark) {
    struct stat s;
    if (file_memory(f) || stat(file_path(f), &s) != 0)
        return ST_OK;
    const file_mark named = mark_of(&s);
    if (named.device == mark->device && named.inode == mark->inode)
        return ST_OK;
    return status_describe(
        ST_CORRUPT, "%s changed while it was open: another file has taken its place", file_path(f));
}

status file_mark_check(const file *f, const file_mark *mark) {
    struct stat s;
    const char *path = file_path(f);
    assert(file_offset(f) == 0);
    if (file_memory(f))
        return ST_OK;
    if (fstat(file_descriptor(f), &s) != 0)
        return file_failed(errno, path, "looking at its size");
    const file_mark now = mark_of(&s);
    if (now.size != mark->size)
        return status_describe(ST_CORRUPT,
                               "%s changed while it was open: it had %llu bytes, and has %llu now",
                               path, (unsigned long long)mark->size, (unsigned long long)now.size);
    if (now.modified_s != mark->modified_s || now.modified_ns != mark->modified_ns)
        return status_describe(ST_CORRUPT, "%s changed while it was open: it was written to", path);
    return file_mark_check_name(f, mark);
}

status file_mark_compare(const file_mark *now, const file_mark *then, const char *path,
                         const char *by) {
    if (now->size != then->size)
        return status_describe(
            ST_CORRUPT, "%s: has %llu bytes; it had %llu when %s was made of it: convert it again",
            path, (unsigned long long)now->size, (unsigned long long)then->size, by);
    if (now->modified_s == then->modified_s && now->modified_ns == then->modified_ns)
        return ST_OK;
    return status_describe(ST_CORRUPT,
                           "%s: has another time than when %s was made of it, as if it had been "
                           "written to: convert it again, or give it its time back",
                           path, by);
}

void file_mark_settle(const file_mark *mark) {
    enum { TRIES = 100 }; /* a bound: a file's time that lies ahead is not worth waiting for */
    const struct timespec a_while = {.tv_nsec = 1000000};
    struct timespec now;
    for (int i = 0; i < TRIES; i++) {
        /* The clock that gives files their times. */
        if (clock_gettime(CLOCK_REALTIME_COARSE, &now) != 0 || now.tv_sec > mark->modified_s + 1 ||
            now.tv_sec < mark->modified_s - 1)
            return;
        if (now.tv_sec > mark->modified_s ||
            (now.tv_sec == mark->modified_s && now.tv_nsec > mark->modified_ns))
            return;
        (void)nanosleep(&a_while, NULL);
    }
}
