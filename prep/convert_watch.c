#include "prep/convert_watch.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "formats/base/clock.h"
#include "formats/base/file_guard.h"
#include "formats/base/path_pattern.h"
#include "formats/leaf/leaf_file.h"

/* ---- what is there ---- */

/* The steps that the output has; 0: it is not there. */
static status count_steps(const convert_request *a, uint32_t *steps) {
    mem m;
    leaf_file *f = NULL;
    *steps = 0;
    if (access(a->common.output, F_OK) != 0)
        return ST_OK;
    mem_init(&m, a->common.memory);
    file_guard_look(true);
    const status st = leaf_file_open(&m, a->common.output, &f);
    file_guard_look(false);
    if (st == ST_OK)
        *steps = f->header.steps;
    leaf_file_close(f);
    return st;
}

/* A watch while it goes on. */
typedef struct watching {
    convert_request *a;
    uint32_t steps; /* of the output */
    char *last;     /* the file that gave the newest one; NULL: an earlier run took it */
} watching;

static status came_late(const char *last) {
    return status_describe(ST_USAGE,
                           "%s: a file before it came after it was added, and is in no step: "
                           "--watch takes files in the order of their names",
                           last);
}

/* Which of the files that are there, in order, is the next one: the first behind the last that was
 * taken. *next: count, if it has not come. */
static status find_next(const watching *w, char *const *paths, int count, int *next) {
    *next = 0;
    while (*next < count &&
           (w->last ? path_pattern_compare(paths[*next], w->last) <= 0 : *next < (int)w->steps))
        ++*next;
    return *next > (int)w->steps ? came_late(w->last) : ST_OK;
}

/* The file of the next step, a copy to free; NULL: it has not come. */
static status find_file(const watching *w, char **path) {
    char **paths = w->a->common.inputs;
    int count = 1, next;
    *path = NULL;
    status st = path_pattern_expand(&paths, &count);
    if (st != ST_OK)
        return st;
    /* A pattern that nothing fits stays as it is. */
    if (access(paths[0], F_OK) == 0)
        st = find_next(w, paths, count, &next);
    else
        next = count;
    if (st == ST_OK && next < count)
        *path = strdup(paths[next]);
    path_pattern_release(paths, count);
    return st;
}

/* ---- waiting ---- */

static status rest(convert_request *a) {
    const struct timespec a_while = {.tv_nsec = 50000000};
    (void)nanosleep(&a_while, NULL);
    return progress_ask(cli_progress(&a->common), "watch");
}

static bool same_state(const struct stat *a, const struct stat *b) {
    return a->st_size == b->st_size && a->st_ino == b->st_ino &&
           a->st_mtim.tv_sec == b->st_mtim.tv_sec && a->st_mtim.tv_nsec == b->st_mtim.tv_nsec;
}

/* Wait until a file has not changed for a while, or is gone. */
static status settle(convert_request *a, const char *path) {
    struct stat was = {0}, now;
    double since = clock_seconds();
    while (stat(path, &now) == 0 &&
           (!same_state(&was, &now) || clock_seconds() - since < a->watch.settle)) {
        if (!same_state(&was, &now))
            since = clock_seconds();
        was = now;
        const status st = rest(a);
        if (st != ST_OK)
            return st;
    }
    return ST_OK;
}

/* ---- adding ---- */

/* Convert a file in a process of its own: whatever becomes of that, the next one begins anew.
 * *code: how it ended. */
static status add(convert_request *a, char *path, status (*one)(convert_request *a), int *code) {
    int how = 0;
    fflush(NULL);
    const pid_t child = fork();
    if (child < 0)
        return status_describe(ST_FAILED, "cannot start a process: %s", strerror(errno));
    if (child == 0) {
        a->common.inputs = &path;
        a->common.input = path;
        exit(cli_finish(&a->common, one(a)));
    }
    while (waitpid(child, &how, 0) < 0 && errno == EINTR)
        ;
    *code = WIFEXITED(how) ? WEXITSTATUS(how) : 128 + WTERMSIG(how);
    return ST_OK;
}

/* Note that a file has been added. It is the watch's from now on. */
static status note_added(watching *w, char *path) {
    const uint32_t before = w->steps;
    free(w->last);
    w->last = path;
    const status st = count_steps(w->a, &w->steps);
    if (st != ST_OK || w->steps == before + 1)
        return st;
    return status_describe(ST_USAGE, "%s: %s gave it %u steps: --watch takes files of one step",
                           w->a->common.output, path, w->steps - before);
}

/* Add the file of the next step, if it has come. *code: if not 0, it could not be. */
static status go_on(watching *w, status (*one)(convert_request *a), int *code) {
    char *path = NULL;
    status st = find_file(w, &path);
    if (st == ST_OK && !path)
        return rest(w->a);
    if (st == ST_OK)
        st = settle(w->a, path);
    const bool there = st == ST_OK && access(path, F_OK) == 0;
    if (there)
        st = add(w->a, path, one, code);
    if (there && st == ST_OK && *code == 0)
        return note_added(w, path);
    free(path);
    return st;
}

int convert_watch_run(convert_request *a, status (*one)(convert_request *a)) {
    watching w = {.a = a};
    int code = 0;
    status st = count_steps(a, &w.steps);
    while (st == ST_OK && code == 0 && (!a->watch.until || w.steps < a->watch.until))
        st = go_on(&w, one, &code);
    free(w.last);
    /* What went wrong in a process of its own was said there. */
    return code ? code : cli_finish(&a->common, st);
}
