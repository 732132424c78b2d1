#include "tests/support/disk_log.h"

#include <errno.h>
#include <limits.h>
#include <pthread.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmocka.h>

#include "tests/support/fields.h"

enum { OPS_MAX = 1 << 16, FILES_MAX = 1 << 12 };

typedef enum op_kind {
    OP_CREATE,
    OP_FOLDER,
    OP_WRITE,
    OP_CUT,
    OP_SYNC,
    OP_MOVE,
    OP_REMOVE
} op_kind;

typedef struct op {
    op_kind kind;
    int file; /* -1: a folder */
    char *name, *to;
    uint64_t offset;
    size_t size;
    char *data;
} op;

typedef struct named {
    char name[PATH_MAX];
    int file; /* -1: a folder; -2: no longer there */
} named;

typedef struct content {
    char *bytes;
    size_t size;
} content;

static struct {
    pthread_mutex_t lock;
    bool on;
    char folder[PATH_MAX];
    op *ops;
    size_t count;
    named *names;
    int name_count, files;
} disk = {.lock = PTHREAD_MUTEX_INITIALIZER};

/* ---- names ---- */

static named *find_name(named *names, int count, const char *name) {
    for (int i = 0; i < count; i++)
        if (names[i].file != -2 && strcmp(names[i].name, name) == 0)
            return &names[i];
    return NULL;
}

static void put_name(named *names, int *count, const char *name, int file) {
    named *n = find_name(names, *count, name);
    if (!n) {
        assert_true(*count < FILES_MAX);
        n = &names[(*count)++];
        snprintf(n->name, sizeof n->name, "%s", name);
    }
    n->file = file;
}

/* The part of a path below the folder; NULL: it is elsewhere. */
static const char *below(const char *path) {
    const size_t length = strlen(disk.folder);
    return disk.on && strncmp(path, disk.folder, length) == 0 && path[length] == '/'
               ? path + length + 1
               : NULL;
}

/* The path of a descriptor. */
static const char *path_of(int fd, char path[PATH_MAX]) {
    char link[64];
    snprintf(link, sizeof link, "/proc/self/fd/%d", fd);
    const ssize_t length = readlink(link, path, PATH_MAX - 1);
    path[length > 0 ? length : 0] = '\0';
    return path;
}

/* ---- noting ---- */

static op *note(op_kind kind, const char *name, int file) {
    assert_true(disk.count < OPS_MAX);
    op *o = &disk.ops[disk.count++];
    *o = (op){.kind = kind, .file = file, .name = strdup(name)};
    return o;
}

static void note_new(const char *name, int file) {
    (void)note(file < 0 ? OP_FOLDER : OP_CREATE, name, file);
    put_name(disk.names, &disk.name_count, name, file);
}

static void note_data(op_kind kind, int fd, uint64_t offset, const void *data, size_t size) {
    char path[PATH_MAX];
    pthread_mutex_lock(&disk.lock);
    const char *name = below(path_of(fd, path));
    const named *n = name ? find_name(disk.names, disk.name_count, name) : NULL;
    if (n || (kind == OP_SYNC && disk.on && strcmp(path, disk.folder) == 0)) {
        op *o = note(kind, n ? name : "", n ? n->file : -1);
        o->offset = offset;
        o->size = size;
        o->data = data ? malloc(size + 1) : NULL;
        if (data)
            memcpy(o->data, data, size);
    }
    pthread_mutex_unlock(&disk.lock);
}

void disk_log_made(const char *path, bool folder) {
    const int error = errno;
    pthread_mutex_lock(&disk.lock);
    if (below(path))
        note_new(below(path), folder ? -1 : disk.files++);
    pthread_mutex_unlock(&disk.lock);
    errno = error;
}

void disk_log_written(int fd, uint64_t offset, const void *data, size_t size) {
    note_data(OP_WRITE, fd, offset, data, size);
}

void disk_log_cut(int fd, uint64_t size) {
    note_data(OP_CUT, fd, size, NULL, 0);
}

void disk_log_synced(int fd) {
    note_data(OP_SYNC, fd, 0, NULL, 0);
}

void disk_log_moved(const char *from, const char *to) {
    pthread_mutex_lock(&disk.lock);
    const char *a = below(from), *b = to ? below(to) : NULL;
    named *n = a ? find_name(disk.names, disk.name_count, a) : NULL;
    if (n) {
        op *o = note(to ? OP_MOVE : OP_REMOVE, a, n->file);
        o->to = b ? strdup(b) : NULL;
        const int file = n->file;
        n->file = -2;
        if (b)
            put_name(disk.names, &disk.name_count, b, file);
    }
    pthread_mutex_unlock(&disk.lock);
}

void disk_log_begin(const char *folder) {
    disk.ops = calloc(OPS_MAX, sizeof *disk.ops);
    disk.names = calloc(FILES_MAX, sizeof *disk.names);
    assert_true(disk.ops && disk.names);
    disk.count = 0;
    disk.name_count = disk.files = 0;
    snprintf(disk.folder, sizeof disk.folder, "%s", folder);
    disk.on = true;
}

size_t disk_log_end(void) {
    disk.on = false;
    return disk.count;
}

void disk_log_release(void) {
    for (size_t i = 0; i < disk.count; i++) {
        free(disk.ops[i].name);
        free(disk.ops[i].to);
        free(disk.ops[i].data);
    }
    free(disk.ops);
    free(disk.names);
    disk.ops = NULL;
    disk.names = NULL;
}

/* ---- replaying ---- */

static void resize(content *c, size_t size) {
    c->bytes = realloc(c->bytes, size + 1);
    assert_non_null(c->bytes);
    if (size > c->size)
        memset(c->bytes + c->size, 0, size - c->size);
    c->size = size;
}

/* Do the first `size` bytes of a write, or a cut. */
static void change(content *c, const op *o, size_t size) {
    if (o->kind == OP_CUT) {
        resize(c, o->offset);
    } else if (size > 0) {
        if (o->offset + size > c->size)
            resize(c, o->offset + size);
        memcpy(c->bytes + o->offset, o->data, size);
    }
}

/* The last call before `count` that syncs a file, or (-1) a folder; SIZE_MAX: none. */
static size_t last_sync(size_t count, int file) {
    while (count-- > 0)
        if (disk.ops[count].kind == OP_SYNC && disk.ops[count].file == file)
            return count;
    return SIZE_MAX;
}

static bool is_change(const op *o, int file) {
    return o->file == file && (o->kind == OP_WRITE || o->kind == OP_CUT);
}

/* What is in a file. r: NULL: all that was written. */
static content content_of(int file, size_t count, field_random *r) {
    content c = {0};
    const size_t sync = r ? last_sync(count, file) : count;
    size_t *loose = calloc(count + 1, sizeof *loose), found = 0;
    resize(&c, 0);
    for (size_t i = 0; i < count; i++) {
        if (!is_change(&disk.ops[i], file))
            continue;
        if (sync != SIZE_MAX && i < sync)
            change(&c, &disk.ops[i], disk.ops[i].size);
        else
            loose[found++] = i;
    }
    for (; found > 0; found--) {
        const size_t n = field_random_bits(r) % found;
        const op *o = &disk.ops[loose[n]];
        const uint64_t chance = field_random_bits(r) % 4;
        if (chance > 0)
            change(&c, o, chance == 1 ? field_random_bits(r) % (o->size + 1) : o->size);
        loose[n] = loose[found - 1];
    }
    free(loose);
    return c;
}

/* The names after the first `count` calls. Returns how many there are. */
static int names_after(size_t count, named *names) {
    int known = 0;
    for (size_t i = 0; i < count; i++) {
        const op *o = &disk.ops[i];
        if (o->kind == OP_CREATE || o->kind == OP_FOLDER)
            put_name(names, &known, o->name, o->file);
        if (o->kind == OP_MOVE || o->kind == OP_REMOVE)
            find_name(names, known, o->name)->file = -2;
        if (o->kind == OP_MOVE && o->to)
            put_name(names, &known, o->to, o->file);
    }
    return known;
}

static void write_out(const named *n, size_t count, field_random *r, const char *folder) {
    char path[2 * PATH_MAX];
    snprintf(path, sizeof path, "%s/%s", folder, n->name);
    if (n->file == -1) {
        assert_int_equal(mkdir(path, 0777), 0);
        return;
    }
    content c = content_of(n->file, count, r);
    FILE *f = fopen(path, "wb");
    assert_non_null(f);
    assert_int_equal(fwrite(c.bytes, 1, c.size, f), c.size);
    assert_int_equal(fclose(f), 0);
    free(c.bytes);
}

void disk_log_replay(size_t count, uint64_t seed, const char *folder) {
    field_random chance = {seed}, *r = seed ? &chance : NULL;
    named *names = calloc(FILES_MAX, sizeof *names);
    const size_t sync = last_sync(count, -1), least = sync == SIZE_MAX ? 0 : sync;
    assert_non_null(names);
    const size_t until = r ? least + field_random_bits(r) % (count - least + 1) : count;
    const int known = names_after(until, names);
    for (int pass = 0; pass < 2; pass++) /* folders first */
        for (int i = 0; i < known; i++)
            if (names[i].file >= -1 && (names[i].file == -1) == (pass == 0))
                write_out(&names[i], count, r, folder);
    free(names);
}
