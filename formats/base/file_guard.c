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
    bool there;     /* `file` is known */
    bool placed;    /* `folder` is known */
    file_id file;   /* with links followed */
    file_id folder; /* of outputs only, as is `name` */
    const char *name;
    char *path;
} entry;

static struct {
    pthread_mutex_t lock;
    atomic_bool watching;
    mem m;
    entry *all;
    size_t count, room;
    /* A hash table of inputs by file, as a folder may have many. 0: free, else 1 + the index in
     * `all`. */
    size_t *slots;
    size_t slot_room, inputs; /* a power of two; inputs <= slot_room / 2 */
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
    /* Look up the folder: cut the path before the name for a moment. */
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

static status refuse_paths(const char *output, const char *other, bool is_output) {
    if (strcmp(output, other) == 0 && is_output)
        return status_describe(ST_USAGE, "%s: two outputs cannot be one file", output);
    if (strcmp(output, other) == 0)
        return status_describe(ST_USAGE, "%s: is an input; the output must be another file",
                               output);
    return status_describe(ST_USAGE,
                           "%s: is the same file as %s, %s; each output must be a file "
                           "of its own",
                           output, other, is_output ? "an output" : "an input");
}

static status refuse(const entry *output, const entry *other) {
    return refuse_paths(output->path, other->path, other->output);
}

/* ---- the table; call with its lock held ---- */

/* Returns the slot of an input, or the free slot where it would go; there is always one. */
static size_t *find_slot(const file_id *id) {
    size_t at = (size_t)(id->inode * 0x9E3779B97F4A7C15u >> 32) ^ (size_t)id->device;
    for (;; at++) {
        size_t *slot = &table.slots[at & (table.slot_room - 1)];
        if (!*slot || same_file(&table.all[*slot - 1].file, id))
            return slot;
    }
}

static void index_inputs(void) {
    memset(table.slots, 0, table.slot_room * sizeof *table.slots);
    table.inputs = 0;
    for (size_t i = 0; i < table.count; i++)
        if (!table.all[i].output) {
            *find_slot(&table.all[i].file) = i + 1;
            table.inputs++;
        }
}

enum { SLOTS_LEAST = 32 };

static status make_slots(void) {
    if (2 * (table.inputs + 1) <= table.slot_room)
        return ST_OK;
    const size_t room = table.slot_room ? 2 * table.slot_room : SLOTS_LEAST;
    size_t *slots = mem_alloc(&table.m, room * sizeof *slots);
    if (!slots)
        return ST_NOMEM;
    mem_free(&table.m, table.slots);
    table.slots = slots;
    table.slot_room = room;
    index_inputs();
    return ST_OK;
}

static bool is_input(const file_id *id) {
    return table.slot_room && *find_slot(id);
}

static status add(entry *e) {
    status st = mem_grow(&table.m, &table.all, sizeof *e, table.count, 16, &table.room);
    if (st == ST_OK && !e->output)
        st = make_slots();
    if (st != ST_OK)
        return st;
    table.all[table.count++] = *e;
    if (!e->output) {
        *find_slot(&e->file) = table.count;
        table.inputs++;
    }
    e->path = NULL;
    return ST_OK;
}

static status add_input(const file_id *id, const char *path) {
    if (is_input(id))
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
    if (table.slot_room)
        index_inputs();
}

static void forget_input(const file_id *id) {
    if (!is_input(id))
        return;
    const size_t i = *find_slot(id) - 1;
    mem_free(&table.m, table.all[i].path);
    table.all[i] = table.all[--table.count];
    index_inputs();
}

/* ---- a job's target ---- */

static status check_target(const mem *m, const struct stat *info, const char *path) {
    const file_guard_target *t = m ? m->target : NULL;
    if (!t || t->device != info->st_dev || t->inode != info->st_ino)
        return ST_OK;
    return refuse_paths(t->path, path, false);
}

void file_guard_aim(mem *m, file_guard_target *t, const char *path) {
    file_id id;
    m->target = NULL;
    if (!find_id(path, &id))
        return;
    *t = (file_guard_target){path, id.device, id.inode};
    m->target = t;
}

status file_guard_named(const mem *m, const char *path) {
    struct stat info;
    return stat(path, &info) == 0 ? check_target(m, &info, path) : ST_OK;
}

/* ---- public functions ---- */

void file_guard_watch(void) {
    table.watching = true;
}

static _Thread_local bool looking;

void file_guard_look(bool looks) {
    looking = looks;
}

status file_guard_opened(const mem *m, int fd, const char *path) {
    struct stat info;
    const bool aimed = m && m->target;
    if ((!table.watching && !aimed) || looking || fstat(fd, &info) != 0)
        return ST_OK;
    status st = check_target(m, &info, path);
    if (st != ST_OK || !table.watching)
        return st;
    pthread_mutex_lock(&table.lock);
    st = add_input(&(file_id){info.st_dev, info.st_ino}, path);
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

status file_guard_each_output(const mem *m, status (*take)(void *ctx, const char *path),
                              void *ctx) {
    status st = m->target ? take(ctx, m->target->path) : ST_OK;
    pthread_mutex_lock(&table.lock);
    for (size_t i = 0; i < table.count && st == ST_OK; i++)
        if (table.all[i].output)
            st = take(ctx, table.all[i].path);
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
    mem_free(&table.m, table.slots);
    table.all = NULL;
    table.slots = NULL;
    table.room = table.slot_room = table.inputs = 0;
    pthread_mutex_unlock(&table.lock);
}
