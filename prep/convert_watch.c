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

/* The file of step `step`, a copy to free; NULL: it has not come. */
static status find_file(const convert_request *a, uint32_t step, char **path) {
    char **paths = a->common.inputs;
    int count = 1;
    *path = NULL;
    const status st = path_pattern_expand(&paths, &count);
    if (st != ST_OK)
        return st;
    if (step < (uint32_t)count && access(paths[step], F_OK) == 0)
        *path = strdup(paths[step]);
    path_pattern_release(paths, count);
    return ST_OK;
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

/* Add the file of the next step, if it has come. *code: if not 0, it could not be. */
static status go_on(convert_request *a, uint32_t steps, status (*one)(convert_request *a),
                    int *code) {
    char *path = NULL;
    status st = find_file(a, steps, &path);
    if (st == ST_OK && !path)
        return rest(a);
    if (st == ST_OK)
        st = settle(a, path);
    if (st == ST_OK && access(path, F_OK) == 0)
        st = add(a, path, one, code);
    free(path);
    return st;
}

int convert_watch_run(convert_request *a, status (*one)(convert_request *a)) {
    uint32_t steps = 0, before = 0;
    int code = 0;
    status st = count_steps(a, &steps);
    while (st == ST_OK && code == 0 && (!a->watch.until || steps < a->watch.until)) {
        before = steps;
        st = go_on(a, steps, one, &code);
        if (st == ST_OK)
            st = count_steps(a, &steps);
        if (st == ST_OK && steps > before + 1)
            st = status_describe(ST_USAGE,
                                 "%s: a file gave it %u steps: --watch takes files of one step",
                                 a->common.output, steps - before);
    }
    /* What went wrong in a process of its own was said there. */
    return code ? code : cli_finish(&a->common, st);
}
