#include "formats/base/file_guard.h"

#include <pthread.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "formats/base/mem.h"

typedef struct file_id {
    dev_t device;
    ino_t inode;
} file_id;

typedef struct entry {
    bool output;
    bool there;     /* file is known */
    bool placed;    /* folder is known */
    file_id file;   /* links followed */
    file_id folder; /* outputs only, as the next */
    const char *name;
    char *path;
} entry;

static struct {
    pthread_mutex_t lock;
    atomic_bool watching;
    mem m;
    entry *all;
    size_t count, room;
} table = {.lock = PTHREAD_MUTEX_INITIALIZER};

static bool same_file(const file_id *a, const file_id *b) {
    return a->device == b->device && a->inode == b->inode;
}

static bool find_id(const char *path, file_id *id) {
    struct stat info;
    if (stat(path, &info) != 0)
        return false;
    *id = (file_id){info.st_dev, info.st_ino};
    return true;
}

/* ---- one entry ---- */

static status describe_output(const char *path, entry *e) {
    *e = (entry){.output = true, .path = mem_copy_text(&table.m, path)};
    if (!e->path)
        return ST_NOMEM;
    char *slash = strrchr(e->path, '/');
    e->name = slash ? slash + 1 : e->path;
    e->there = find_id(path, &e->file);
    /* The folder: what is before the name, for a moment without it. */
    const char first = *e->name;
    e->path[e->name - e->path] = 0;
    e->placed = find_id(slash ? e->path : ".", &e->folder);
    e->path[e->name - e->path] = first;
    return ST_OK;
}

static status describe_input(const file_id *id, const char *path, entry *e) {
    *e = (entry){.there = true, .file = *id, .path = mem_copy_text(&table.m, path)};
    return e->path ? ST_OK : ST_NOMEM;
}

static bool collide(const entry *a, const entry *b) {
    if (a->there && b->there && same_file(&a->file, &b->file))
        return true;
    return a->placed && b->placed && same_file(&a->folder, &b->folder) &&
           strcmp(a->name, b->name) == 0;
}

static status refuse(const entry *output, const entry *other) {
    const char *kind = other->output ? "an output" : "an input";
    if (strcmp(output->path, other->path) == 0 && other->output)
        return status_describe(ST_USAGE, "%s: two outputs cannot be one file", output->path);
    if (strcmp(output->path, other->path) == 0)
        return status_describe(ST_USAGE, "%s: is an input; the output must be another file",
                               output->path);
    return status_describe(ST_USAGE,
                           "%s: is the same file as %s, %s; each output must be a file "
                           "of its own",
                           output->path, other->path, kind);
}

/* ---- the table; under its lock ---- */

static status add(entry *e) {
    status st = mem_grow(&table.m, &table.all, sizeof *e, table.count, 16, &table.room);
    if (st != ST_OK)
        return st;
    table.all[table.count++] = *e;
    e->path = NULL;
    return ST_OK;
}

static status add_input(const file_id *id, const char *path) {
    for (size_t i = 0; i < table.count; i++)
        if (!table.all[i].output && same_file(&table.all[i].file, id))
            return ST_OK;
    entry e;
    status st = describe_input(id, path, &e);
    for (size_t i = 0; i < table.count && st == ST_OK; i++)
        if (table.all[i].output && collide(&e, &table.all[i]))
            st = refuse(&table.all[i], &e);
    if (st == ST_OK)
        st = add(&e);
    mem_free(&table.m, e.path);
    return st;
}

static status check_output(const char *path, bool announce) {
    entry e;
    status st = describe_output(path, &e);
    for (size_t i = 0; i < table.count && st == ST_OK; i++)
        if ((announce || !table.all[i].output) && collide(&e, &table.all[i]))
            st = refuse(&e, &table.all[i]);
    if (st == ST_OK && announce)
        st = add(&e);
    mem_free(&table.m, e.path);
    return st;
}

static void forget(bool inputs_too) {
    size_t kept = 0;
    for (size_t i = 0; i < table.count; i++)
        if (table.all[i].output || inputs_too)
            mem_free(&table.m, table.all[i].path);
        else
            table.all[kept++] = table.all[i];
    table.count = kept;
}

/* There is one of a file at most. */
static void forget_input(const file_id *id) {
    size_t i = 0;
    while (i < table.count && (table.all[i].output || !same_file(&table.all[i].file, id)))
        i++;
    if (i == table.count)
        return;
    mem_free(&table.m, table.all[i].path);
    table.all[i] = table.all[--table.count];
}

/* ---- the doors ---- */

void file_guard_watch(void) {
    table.watching = true;
}

status file_guard_opened(int fd, const char *path) {
    struct stat info;
    if (!table.watching || fstat(fd, &info) != 0)
        return ST_OK;
    pthread_mutex_lock(&table.lock);
    status st = add_input(&(file_id){info.st_dev, info.st_ino}, path);
    pthread_mutex_unlock(&table.lock);
    return st;
}

status file_guard_input(const char *path) {
    file_id id;
    if (!path)
        return ST_OK;
    const bool standard = strcmp(path, "-") == 0;
    if (!find_id(standard ? "/dev/stdin" : path, &id))
        return ST_OK;
    pthread_mutex_lock(&table.lock);
    status st = add_input(&id, standard ? "standard input" : path);
    pthread_mutex_unlock(&table.lock);
    return st;
}

status file_guard_output(const char *path) {
    if (!path || strcmp(path, "-") == 0)
        return ST_OK;
    pthread_mutex_lock(&table.lock);
    status st = check_output(path, true);
    pthread_mutex_unlock(&table.lock);
    return st;
}

status file_guard_check(const char *path) {
    pthread_mutex_lock(&table.lock);
    status st = table.count ? check_output(path, false) : ST_OK;
    pthread_mutex_unlock(&table.lock);
    return st;
}

void file_guard_next(void) {
    pthread_mutex_lock(&table.lock);
    forget(false);
    pthread_mutex_unlock(&table.lock);
}

void file_guard_forget(const char *path) {
    file_id id;
    pthread_mutex_lock(&table.lock);
    if (find_id(path, &id))
        forget_input(&id);
    pthread_mutex_unlock(&table.lock);
}

void file_guard_reset(void) {
    pthread_mutex_lock(&table.lock);
    table.watching = false;
    forget(true);
    mem_free(&table.m, table.all);
    table.all = NULL;
    table.room = 0;
    pthread_mutex_unlock(&table.lock);
}
