#include "prep/import/file_door.h"

#include <errno.h>
#include <fcntl.h>
#include <ftw.h>
#include <libgen.h>
#include <limits.h>
#include <link.h>
#include <pthread.h>
#include <semaphore.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include "formats/base/file_guard.h"
#include "prep/import/fence.h"
#include "prep/import/import_limits.h"

/* ---- the doorman ---- */

enum { STACK_BYTES = 128 << 10 };

static struct {
    pthread_mutex_t turn;
    sem_t asked, answered;
    void (*job)(void *ctx);
    void *ctx;
    bool there;
} doorman = {.turn = PTHREAD_MUTEX_INITIALIZER};

static void wait_for(sem_t *s) {
    while (sem_wait(s) != 0)
        continue;
}

static void *serve(void *unused) {
    for (;;) {
        wait_for(&doorman.asked);
        doorman.job(doorman.ctx);
        sem_post(&doorman.answered);
    }
    return unused;
}

/* Run a job by the doorman. Without one the caller runs it, as then it has all rights. */
static void ask(void (*job)(void *ctx), void *ctx) {
    if (!doorman.there) {
        job(ctx);
        return;
    }
    pthread_mutex_lock(&doorman.turn);
    doorman.job = job;
    doorman.ctx = ctx;
    sem_post(&doorman.asked);
    wait_for(&doorman.answered);
    pthread_mutex_unlock(&doorman.turn);
}

static bool hire(void) {
    pthread_t thread;
    pthread_attr_t attributes;
    sigset_t all, before;
    if (sem_init(&doorman.asked, 0, 0) != 0 || sem_init(&doorman.answered, 0, 0) != 0 ||
        pthread_attr_init(&attributes) != 0)
        return false;
    /* Leave signals to the other threads. */
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &before);
    bool hired = pthread_attr_setstacksize(&attributes, STACK_BYTES) == 0;
    hired = hired && pthread_create(&thread, &attributes, serve, NULL) == 0;
    pthread_sigmask(SIG_SETMASK, &before, NULL);
    pthread_attr_destroy(&attributes);
    return hired && pthread_detach(thread) == 0;
}

/* ---- what all threads may read ---- */

static const char *const of_the_system[] = {"/usr",
                                            "/lib",
                                            "/lib32",
                                            "/lib64",
                                            "/etc/ld.so.cache",
                                            "/etc/localtime",
                                            "/etc/locale.alias",
                                            "/etc/dcmtk",
                                            "/etc/libdcmtk",
                                            "/proc/self",
                                            "/proc/cpuinfo",
                                            "/proc/filesystems",
                                            "/proc/meminfo",
                                            "/proc/stat",
                                            "/proc/sys/vm",
                                            "/sys/devices/system",
                                            "/sys/fs/cgroup",
                                            "/sys/kernel/mm",
                                            "/dev/random",
                                            "/dev/urandom",
                                            "/dev/zero"};

/* Variables with the user's folders of plugins and dictionaries. */
static const char *const of_the_user[] = {"HDF5_PLUGIN_PATH",  "DCMDICTPATH", "LD_LIBRARY_PATH",
                                          "OIIO_LIBRARY_PATH", "LOCPATH",     "GCONV_PATH"};

static char *const *environment; /* NAME=value; NULL behind the last */

static const char *variable(const char *name) {
    const size_t length = strlen(name);
    for (char *const *at = environment; at && *at; at++)
        if (strncmp(*at, name, length) == 0 && (*at)[length] == '=')
            return *at + length + 1;
    return NULL;
}

static void allow_list(fence *f, const char *list) {
    char path[PATH_MAX];
    while (list && *list) {
        const int length = (int)strcspn(list, ":");
        if (*list == '/' && snprintf(path, sizeof path, "%.*s", length, list) < PATH_MAX)
            fence_allow(f, path, FENCE_READ | FENCE_LIST);
        list += length + (list[length] == ':');
    }
}

/* Allow the folder of a library that the program is linked with: more libraries and plugins lie
 * beside it. */
static int allow_library(struct dl_phdr_info *info, size_t size, void *f) {
    char path[PATH_MAX];
    (void)size;
    const char *slash = info->dlpi_name[0] == '/' ? strrchr(info->dlpi_name, '/') : NULL;
    if (slash && slash > info->dlpi_name && slash - info->dlpi_name < PATH_MAX) {
        snprintf(path, sizeof path, "%.*s", (int)(slash - info->dlpi_name), info->dlpi_name);
        fence_allow(f, path, FENCE_READ | FENCE_LIST);
    }
    return 0;
}

static void allow_system(fence *f) {
    for (size_t i = 0; i < sizeof of_the_system / sizeof *of_the_system; i++)
        fence_allow(f, of_the_system[i], FENCE_READ | FENCE_LIST);
    for (size_t i = 0; i < sizeof of_the_user / sizeof *of_the_user; i++)
        allow_list(f, variable(of_the_user[i]));
    dl_iterate_phdr(allow_library, f);
    fence_allow(f, "/dev/null", FENCE_READ | FENCE_WRITE);
}

static struct {
    bool files, calls, granted;
    const char *output; /* as granted */
    size_t folder;      /* bytes of its folder's name, slash included */
} door;

void file_door_build(char *const *given) {
    fence f;
    environment = given;
    if (fence_begin(&f)) {
        allow_system(&f);
        doorman.there = hire();
        door.files = doorman.there && fence_close(&f);
        if (!door.files && f.rules >= 0)
            close(f.rules);
    }
    door.calls = fence_calls();
}

/* ---- rights of this run ---- */

typedef struct grant {
    const file_door_grants *g;
    bool done;
} grant;

static fence *walked; /* nftw() passes no context */

/* Allow the target of a link in a folder of slices. */
static int allow_link(const char *path, const struct stat *info, int kind, struct FTW *at) {
    struct stat to;
    (void)info;
    (void)at;
    if (kind == FTW_SL && stat(path, &to) == 0 && S_ISREG(to.st_mode))
        fence_allow(walked, path, FENCE_READ);
    return 0;
}

static void allow_folder_of(fence *f, const char *path) {
    char folder[PATH_MAX];
    if (snprintf(folder, sizeof folder, "%s", path) < PATH_MAX)
        fence_allow(f, dirname(folder), FENCE_READ | FENCE_LIST);
}

static void allow_input(fence *f, const char *path, bool beside) {
    enum { FOLDERS_OPEN = 16 };
    char real[PATH_MAX];
    struct stat info;
    fence_allow(f, path, FENCE_READ | FENCE_LIST);
    walked = f;
    if (stat(path, &info) == 0 && S_ISDIR(info.st_mode))
        nftw(path, allow_link, FOLDERS_OPEN, FTW_PHYS);
    if (!beside)
        return;
    allow_folder_of(f, path);
    if (realpath(path, real))
        allow_folder_of(f, real);
}

static void allow_output(fence *f, const char *path) {
    char folder[PATH_MAX];
    if (snprintf(folder, sizeof folder, "%s", path) < PATH_MAX)
        fence_allow(f, dirname(folder), FENCE_READ | FENCE_LIST | FENCE_WRITE);
}

static void restrict_doorman(void *ctx) {
    grant *to = ctx;
    const file_door_grants *g = to->g;
    fence f;
    if (!fence_begin(&f))
        return;
    allow_system(&f);
    for (int i = 0; i < g->input_count; i++)
        allow_input(&f, g->inputs[i], g->beside);
    if (g->anywhere)
        fence_allow(&f, "/", FENCE_READ | FENCE_LIST);
    if (door.output)
        allow_output(&f, door.output);
    to->done = fence_close(&f);
}

const char *file_door_grant(const file_door_grants *g) {
    grant to = {g, false};
    if (g->output && strcmp(g->output, "-") != 0) {
        const char *slash = strrchr(g->output, '/');
        door.folder = slash ? (size_t)(slash - g->output) + 1 : 0;
        door.output = g->output;
    }
    if (doorman.there)
        ask(restrict_doorman, &to);
    door.granted = true;
    door.files = door.files && to.done;
    if (door.files && door.calls)
        return NULL;
    return door.files   ? "system calls (no seccomp here)"
           : door.calls ? "files (no Landlock here)"
                        : "files or system calls (neither Landlock nor seccomp here)";
}

/* ---- passing calls on ---- */

typedef struct passage {
    int call;
    long argument[5];
    long result; /* as from the system call; negative: an error number */
} passage;

static void pass(void *ctx) {
    passage *p = ctx;
    const long *a = p->argument;
    const long got = syscall(p->call, a[0], a[1], a[2], a[3], a[4]);
    p->result = got < 0 ? -errno : got;
}

/* Try with the caller's own rights, which suffice for system files. Else ask the doorman. */
static long go(passage *p) {
    pass(p);
    if (p->result != -EACCES || !doorman.there || !door.granted)
        return p->result;
    ask(pass, p);
    return p->result;
}

static int result_of(long got) {
    if (got >= 0)
        return (int)got;
    errno = (int)-got;
    return -1;
}

/* Returns whether a path is the output or a temporary file of it. Nothing else in its folder is. */
static bool is_output(const char *path) {
    if (!doorman.there)
        return true;
    if (!door.output || strncmp(path, door.output, door.folder) != 0)
        return false;
    const char *name = path + door.folder;
    return !strchr(name, '/') &&
           (strcmp(name, door.output + door.folder) == 0 || strstr(name, ".partial-"));
}

static int refuse(void) {
    errno = EACCES;
    return -1;
}

static struct {
    pthread_mutex_t lock;
    status_note note;
} inputs = {.lock = PTHREAD_MUTEX_INITIALIZER};

static bool announce(int fd, const char *path) {
    const status st = file_guard_opened(NULL, fd, path);
    if (st == ST_OK)
        return true;
    pthread_mutex_lock(&inputs.lock);
    if (inputs.note.st == ST_OK)
        status_note_take(&inputs.note, st);
    pthread_mutex_unlock(&inputs.lock);
    return false;
}

/* fd was opened without blocking. patient: for a caller that would have blocked. */
static int take_input(int fd, const char *path, bool patient) {
    struct stat info;
    const bool seen = fstat(fd, &info) == 0;
    if (patient && seen && (S_ISFIFO(info.st_mode) || S_ISSOCK(info.st_mode))) {
        close(fd);
        errno = ENXIO;
        return -1;
    }
    if (patient)
        fcntl(fd, F_SETFL, fcntl(fd, F_GETFL) & ~O_NONBLOCK);
    if (!seen || !S_ISREG(info.st_mode))
        return fd;
    if (!announce(fd, path)) {
        close(fd);
        return refuse();
    }
    import_limits_opened((uint64_t)info.st_size);
    return fd;
}

int file_door_open(int folder, const char *path, int flags, mode_t mode) {
    const bool writes = (flags & O_ACCMODE) != O_RDONLY || (flags & (O_CREAT | O_TRUNC));
    const bool patient = !writes && !(flags & (O_NONBLOCK | O_PATH));
    passage p = {SYS_openat, {folder, (long)path, flags | (patient ? O_NONBLOCK : 0), mode}, 0};
    if (writes && !is_output(path)) {
        pass(&p); /* /dev/null is open to anyone */
        return result_of(p.result);
    }
    const int fd = result_of(go(&p));
    return fd < 0 || writes || (flags & O_PATH) ? fd : take_input(fd, path, patient);
}

int file_door_unlink(const char *path) {
    passage p = {SYS_unlinkat, {AT_FDCWD, (long)path, 0}, 0};
    return is_output(path) ? result_of(go(&p)) : refuse();
}

int file_door_rename(const char *from, const char *to, unsigned flags) {
    passage p = {SYS_renameat2, {AT_FDCWD, (long)from, AT_FDCWD, (long)to, flags}, 0};
    return is_output(from) && is_output(to) ? result_of(go(&p)) : refuse();
}

int file_door_link(const char *from, const char *to) {
    passage p = {SYS_linkat, {AT_FDCWD, (long)from, AT_FDCWD, (long)to, 0}, 0};
    return is_output(from) && is_output(to) ? result_of(go(&p)) : refuse();
}

/* ---- results ---- */

status file_door_refused(void) {
    pthread_mutex_lock(&inputs.lock);
    const status st = inputs.note.st == ST_OK ? ST_OK : status_note_raise(&inputs.note);
    pthread_mutex_unlock(&inputs.lock);
    return st;
}
