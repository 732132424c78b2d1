#include "formats/base/work_folder.h"

#include <assert.h>
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "formats/base/clock.h"
#include "formats/base/file_guard.h"

enum { STATES = 2, NAME_ROOM = 16, TRIES = 8, COST = 20 };

static const char SUFFIX[] = ".unfinished";
static const char *const file_names[WORK_FILES] = {
    [WORK_OUTPUT] = "output",      [WORK_WAITING] = "waiting", [WORK_POINTS] = "points",
    [WORK_VALUES] = "values",      [WORK_TETS] = "tets",       [WORK_RUNS] = "runs",
    [WORK_GRADIENTS] = "gradients"};
static const char *const state_names[STATES] = {"state-0", "state-1"};

struct work_folder {
    mem *m;
    char *output, *path, *file; /* file: room for the name of one in it */
    int fd;
    bool synced; /* its name and those of its files are on the disk */
    state_io_head head;
    int slot; /* of the last state; -1: there is none */
    double every, saved_at, saved_in;
};

static const char *name_in(const work_folder *w, const char *name) {
    snprintf(w->file, strlen(w->path) + NAME_ROOM, "%s/%s", w->path, name);
    return w->file;
}

/* ---- opening ---- */

static status in_the_way(const work_folder *w) {
    return status_describe(ST_EXISTS, "%s: is in the way, as unfinished work on %s goes there",
                           w->path, w->output);
}

/* Whether the open folder still has its name. */
static bool still_named(const work_folder *w) {
    struct stat open_one, named;
    return fstat(w->fd, &open_one) == 0 && lstat(w->path, &named) == 0 &&
           open_one.st_dev == named.st_dev && open_one.st_ino == named.st_ino;
}

static status lock(work_folder *w, bool *locked) {
    if (mkdir(w->path, 0777) != 0 && errno != EEXIST)
        return file_failed(errno, w->path, "cannot create");
    w->fd = open(w->path, O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
    if (w->fd < 0)
        return errno == ENOENT ? ST_OK : in_the_way(w);
    int failed;
    do
        failed = flock(w->fd, LOCK_EX | LOCK_NB);
    while (failed && errno == EINTR);
    if (failed && errno == EWOULDBLOCK)
        return status_describe(ST_EXISTS, "%s: another process is making it (%s is locked)",
                               w->output, w->path);
    *locked = still_named(w);
    if (!*locked) { /* that process has just ended, and removed it */
        close(w->fd);
        w->fd = -1;
    }
    return ST_OK;
}

/* Find the last whole state. */
static status find_state(work_folder *w) {
    for (int i = 0; i < STATES; i++) {
        state_io_head head;
        bool found;
        status st = state_io_look(w->m, name_in(w, state_names[i]), &head, &found);
        if (st != ST_OK)
            return st;
        if (found && (w->slot < 0 || head.sequence > w->head.sequence)) {
            w->slot = i;
            w->head = head;
        }
    }
    return ST_OK;
}

/* Remove a file of the work, unless it is an input. */
static void remove_file(const work_folder *w, const char *name) {
    if (file_guard_check(name_in(w, name)) == ST_OK)
        (void)unlink(w->file);
}

static void remove_files(work_folder *w) {
    for (int i = 0; i < STATES; i++)
        remove_file(w, state_names[i]);
    for (int i = 0; i < WORK_FILES; i++)
        remove_file(w, file_names[i]);
    w->slot = -1;
    w->head = (state_io_head){0};
}

static status take(work_folder *w, work_found found) {
    bool locked = false;
    status st = ST_OK;
    for (int i = 0; i < TRIES && st == ST_OK && !locked; i++)
        st = lock(w, &locked);
    if (st == ST_OK && !locked)
        st = status_describe(ST_EXISTS, "%s: other processes are making it", w->output);
    if (st == ST_OK)
        st = find_state(w);
    if (st != ST_OK)
        return st;
    if (w->slot >= 0 && found == WORK_REFUSE)
        return status_describe(ST_EXISTS,
                               "%s: work that ended early is there, %.0f %% done: --resume goes "
                               "on with it, --force begins again",
                               w->path, 100 * w->head.share);
    if (w->slot < 0 || found == WORK_REMOVE)
        remove_files(w);
    return ST_OK;
}

static void release(work_folder *w) {
    if (w->fd >= 0)
        close(w->fd);
    mem_free(w->m, w->output);
    mem_free(w->m, w->path);
    mem_free(w->m, w->file);
    mem_free(w->m, w);
}

status work_folder_open(mem *m, const char *output, work_found found, double every,
                        work_folder **out) {
    work_folder *w = mem_zalloc(m, sizeof *w);
    if (!w)
        return ST_NOMEM;
    *w = (work_folder){.m = m, .fd = -1, .slot = -1, .every = every, .saved_at = clock_seconds()};
    const size_t length = strlen(output) + sizeof SUFFIX;
    w->output = mem_copy_text(m, output);
    w->path = mem_alloc(m, length);
    w->file = mem_alloc(m, length + NAME_ROOM);
    status st = w->output && w->path && w->file ? ST_OK : ST_NOMEM;
    if (st == ST_OK) {
        snprintf(w->path, length, "%s%s", output, SUFFIX);
        st = take(w, found);
    }
    if (st != ST_OK) {
        release(w);
        return st;
    }
    *out = w;
    return ST_OK;
}

bool work_folder_resumes(const work_folder *w) {
    return w->slot >= 0;
}

bool work_folder_published(const work_folder *w) {
    return w->slot >= 0 && access(name_in(w, file_names[WORK_OUTPUT]), F_OK) != 0 &&
           access(w->output, F_OK) == 0;
}

double work_folder_share(const work_folder *w) {
    return w->head.share;
}

uint64_t work_folder_states(const work_folder *w) {
    return w->head.sequence;
}

/* ---- working ---- */

status work_folder_file(work_folder *w, work_file which, bool force, out_file **out) {
    w->synced = false;
    return out_file_continue(w->m, w->output, name_in(w, file_names[which]),
                             force || which != WORK_OUTPUT, out);
}

void work_folder_drop(work_folder *w, work_file which) {
    remove_file(w, file_names[which]);
}

bool work_folder_due(const work_folder *w) {
    const double pause = w->every > COST * w->saved_in ? w->every : COST * w->saved_in;
    return clock_seconds() - w->saved_at >= (w->every > 0 ? pause : 0);
}

/* Put the names of the folder and of its files on the disk, unless they are. Some file systems
 * cannot sync a folder, which is no fault of the files. */
static void sync_names(work_folder *w) {
    if (w->synced)
        return;
    (void)fsync(w->fd);
    const int above = openat(w->fd, "..", O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (above >= 0) {
        (void)fsync(above);
        close(above);
    }
}

status work_folder_save(work_folder *w, out_file *const files[WORK_FILES], double share,
                        state_io_part part, void *ctx) {
    const double start = clock_seconds();
    const state_io_head head = {.sequence = w->head.sequence + 1, .share = share};
    const int slot = w->slot == 0 ? 1 : 0;
    status st = ST_OK;
    for (int i = 0; i < WORK_FILES && st == ST_OK; i++)
        st = files[i] ? out_file_sync(files[i]) : ST_OK;
    if (st != ST_OK)
        return st;
    sync_names(w); /* a state's files must be there when it is */
    st = state_io_save(w->m, name_in(w, state_names[slot]), &head, part, ctx);
    if (st == ST_NOSPACE) {
        /* The room is for the output: the state before this one must do. */
        (void)truncate(name_in(w, state_names[slot]), 0);
        w->saved_at = clock_seconds();
        return ST_OK;
    }
    if (st != ST_OK)
        return st;
    sync_names(w);
    w->synced = head.sequence > 1; /* both files of states are there */
    w->slot = slot;
    w->head = head;
    w->saved_at = clock_seconds();
    w->saved_in = w->saved_at - start;
    return ST_OK;
}

status work_folder_load(work_folder *w, state_io_part part, void *ctx) {
    assert(w->slot >= 0);
    /* The part may open files of the work, whose names go where this one is. */
    char *name = mem_copy_text(w->m, name_in(w, state_names[w->slot]));
    status st = name ? state_io_load(w->m, name, part, ctx) : ST_NOMEM;
    mem_free(w->m, name);
    return st;
}

bool work_folder_close(work_folder *w, bool keep) {
    if (!w)
        return false;
    const bool left = keep && w->slot >= 0;
    if (!left) {
        remove_files(w);
        (void)rmdir(w->path);
    }
    release(w);
    return left;
}
